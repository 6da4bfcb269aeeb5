// SPDX-License-Identifier: GPL-3.0-or-later
#include "spins.hpp"

#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include "newton.hpp"
#include "parts.hpp"

namespace statejump::truss::detail {

namespace {

/// Resistance to a spin below this fraction of the stiffest element counts as none, as in the
/// search for mechanisms.
constexpr double free_share = 1e-13;
/// Stiffness of the springs over that of the stiffest element. It is far above free_share, and far
/// below the torsional stiffness of beams, (radius/length)² of the axial one.
constexpr double spring_share = 1e-9;
/// Sine of the angle up to which beams count as parallel.
constexpr double parallel = 1e-9;

Vector3d axis_of(const Model& model, const Beam& beam) {
  return (model.nodes[index(beam.second)].position + beam.offset_second -
          model.nodes[index(beam.first)].position - beam.offset_first)
      .normalized();
}

/// Beams in rows: parallel beams that share a node are in one row.
std::vector<std::vector<int>> rows_of(const Model& model) {
  const auto count = model.beams.size();
  std::vector<int> root(count);
  std::iota(root.begin(), root.end(), 0);
  const auto find = [&](int one) {
    while (root[index(one)] != one) one = root[index(one)] = root[index(root[index(one)])];
    return one;
  };
  std::vector<std::vector<int>> at(model.nodes.size());
  for (std::size_t b = 0; b < count; ++b) {
    for (const int node : {model.beams[b].first, model.beams[b].second}) {
      for (const int other : at[index(node)]) {
        const Vector3d own = axis_of(model, model.beams[b]);
        if (own.cross(axis_of(model, model.beams[index(other)])).norm() > parallel) continue;
        root[index(find(static_cast<int>(b)))] = find(other);
        break;
      }
      at[index(node)].push_back(static_cast<int>(b));
    }
  }
  std::vector<std::vector<int>> rows(count);
  for (std::size_t b = 0; b < count; ++b) {
    rows[index(find(static_cast<int>(b)))].push_back(static_cast<int>(b));
  }
  std::erase_if(rows, [](const std::vector<int>& row) { return row.empty(); });
  return rows;
}

/// Nodes of a row of beams.
std::vector<int> nodes_of(const Model& model, const std::vector<int>& row) {
  std::vector<int> nodes;
  for (const int b : row) {
    nodes.push_back(model.beams[index(b)].first);
    nodes.push_back(model.beams[index(b)].second);
  }
  std::sort(nodes.begin(), nodes.end());
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  return nodes;
}

/// Displacements of a spin of nodes by 1 rad. Empty if a constraint couples their rotations to
/// others.
std::optional<Eigen::SparseVector<double>> spin_of(const System& system,
                                                   const std::vector<int>& nodes,
                                                   const Vector3d& axis) {
  Eigen::SparseVector<double> spin(system.displacements());
  for (const int n : nodes) {
    const NodeDofs& dofs = system.dofs().at(rotation_site(system.model(), n));
    if (dofs.sums != nullptr) return std::nullopt;
    for (int i = 0; i < dofs.freedoms; ++i) {
      const double along = system.model().nodes[index(n)].arm * dofs.directions->col(i).dot(axis);
      if (along != 0.0) spin.coeffRef(dofs.row + i) = along;
    }
  }
  return spin;
}

double largest(const Eigen::SparseVector<double>& of) {
  double most = 0.0;
  for (Eigen::SparseVector<double>::InnerIterator it(of); it; ++it) {
    most = std::max(most, std::abs(it.value()));
  }
  return most;
}

}  // namespace

std::vector<SpinSpring> spin_springs(const Model& model) {
  if (model.beams.empty()) return {};
  const System system(model);
  if (!system.dofs().has_rotations()) return {};
  const Eigen::SparseMatrix<double> lower = system.penalty_stiffness(
      VectorXd::Zero(system.unknowns()), 0.0, system.all_stick(), JointModel::pins, 1.0, 0.0);
  const Eigen::SparseMatrix<double> stiffness = lower.selfadjointView<Eigen::Lower>();
  std::vector<SpinSpring> found;
  for (const std::vector<int>& row : rows_of(model)) {
    const Beam& first = model.beams[index(row.front())];
    const Vector3d axis = axis_of(model, first);
    const std::vector<int> nodes = nodes_of(model, row);
    const auto spin = spin_of(system, nodes, axis);
    if (!spin || spin->nonZeros() == 0) continue;
    const Eigen::SparseVector<double> force = stiffness * *spin;
    if (largest(force) > free_share * system.stiffness_scale() * largest(*spin)) continue;
    double moment = 0.0;
    for (const int n : nodes) moment += axis.dot(model.nodes[index(n)].moment);
    if (moment != 0.0) continue;
    const auto turns = std::find_if(nodes.begin(), nodes.end(), [&](int n) {
      const NodeDofs& dofs = system.dofs().at(rotation_site(model, n));
      return dofs.freedoms > 0 && !(dofs.directions->transpose() * axis).isZero(0.0);
    });
    found.push_back({first.name, *turns, spring_share * system.stiffness_scale(), axis});
  }
  return found;
}

}  // namespace statejump::truss::detail
