// SPDX-License-Identifier: GPL-3.0-or-later
#include "spins.hpp"

#include <Eigen/SparseCore>
#include <algorithm>
#include <boost/pending/disjoint_sets.hpp>
#include <cmath>
#include <set>
#include <utility>
#include <variant>

#include "newton.hpp"
#include "parts.hpp"

namespace statejump::truss::detail {

namespace {

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

using Sets = boost::disjoint_sets_with_storage<>;

/// The members of each set, at the place of its representative.
std::vector<std::vector<int>> members(Sets& sets, std::size_t count) {
  std::vector<std::vector<int>> found(count);
  for (std::size_t one = 0; one < count; ++one) {
    found[sets.find_set(one)].push_back(static_cast<int>(one));
  }
  return found;
}

/// Nodes that rotate together about some axis: those of a rigid arm or a hinge.
Sets joined_nodes(const Model& model) {
  Sets nodes(model.nodes.size());
  for (const Joint& joint : model.joints) {
    if (const auto* arm = std::get_if<RigidArm>(&joint)) nodes.union_set(arm->node, arm->master);
    if (const auto* hinge = std::get_if<Hinge>(&joint)) {
      nodes.union_set(hinge->second, hinge->first);
    }
  }
  return nodes;
}

/// Beams and nodes that may spin together.
struct Row {
  std::vector<int> beams;
  std::vector<int> nodes;
};

/// Rows of parallel beams that share nodes, also by rigid arms and hinges.
std::vector<Row> rows_of(const Model& model) {
  Sets nodes = joined_nodes(model);
  Sets beams(model.beams.size());
  std::vector<std::vector<int>> at(model.nodes.size());
  for (int b = 0; b < static_cast<int>(model.beams.size()); ++b) {
    const Beam& beam = model.beams[index(b)];
    const Vector3d axis = axis_of(model, beam);
    for (const int node : {beam.first, beam.second}) {
      std::vector<int>& others = at[nodes.find_set(node)];
      for (const int other : others) {
        if (axis.cross(axis_of(model, model.beams[index(other)])).norm() > parallel) continue;
        beams.union_set(b, other);
        break;
      }
      others.push_back(b);
    }
  }
  const std::vector<std::vector<int>> joined = members(nodes, model.nodes.size());
  std::vector<Row> rows;
  for (std::vector<int>& row : members(beams, model.beams.size())) {
    if (row.empty()) continue;
    std::set<int> touched;
    for (const int b : row) {
      for (const int node : {model.beams[index(b)].first, model.beams[index(b)].second}) {
        const std::vector<int>& together = joined[nodes.find_set(node)];
        touched.insert(together.begin(), together.end());
      }
    }
    rows.push_back({std::move(row), {touched.begin(), touched.end()}});
  }
  // In the order of the beams, so that the note names the same beam of a row however sets merge.
  std::sort(rows.begin(), rows.end(),
            [](const Row& a, const Row& b) { return a.beams.front() < b.beams.front(); });
  return rows;
}

/// Displacements of a spin of nodes by 1 rad. Rotations that constraints determine follow.
Eigen::SparseVector<double> spin_of(const System& system, const std::vector<int>& nodes,
                                    const Vector3d& axis) {
  Eigen::SparseVector<double> spin(system.displacements());
  for (const int n : nodes) {
    const NodeDofs& dofs = system.dofs().at(rotation_site(system.model(), n));
    if (dofs.sums != nullptr) continue;
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

/// Whether moments of the nodes do work in a spin. Their parts along the axis are rounded.
bool is_driven(const Model& model, const std::vector<int>& nodes, const Vector3d& axis) {
  double moment = 0.0, size = 0.0;
  for (const int n : nodes) {
    moment += axis.dot(model.nodes[index(n)].moment);
    size += model.nodes[index(n)].moment.norm();
  }
  return std::abs(moment) > 1e-12 * size;
}

}  // namespace

std::vector<SpinSpring> spin_springs(const System& system) {
  const Model& model = system.model();
  if (model.beams.empty() || !system.dofs().has_rotations()) return {};
  const Eigen::SparseMatrix<double> lower = system.penalty_stiffness(
      VectorXd::Zero(system.unknowns()), 0.0, system.all_stick(), JointModel::pins, 1.0, 0.0);
  const Eigen::SparseMatrix<double> stiffness = lower.selfadjointView<Eigen::Lower>();
  std::vector<SpinSpring> found;
  for (const Row& row : rows_of(model)) {
    const Beam& first = model.beams[index(row.beams.front())];
    const Vector3d axis = axis_of(model, first);
    const Eigen::SparseVector<double> spin = spin_of(system, row.nodes, axis);
    if (spin.nonZeros() == 0) continue;
    const Eigen::SparseVector<double> force = stiffness * spin;
    if (largest(force) > free_share * system.stiffness_scale() * largest(spin)) continue;
    if (is_driven(model, row.nodes, axis)) continue;
    const auto turns = std::find_if(row.nodes.begin(), row.nodes.end(), [&](int n) {
      const NodeDofs& dofs = system.dofs().at(rotation_site(model, n));
      return dofs.sums == nullptr && dofs.freedoms > 0 &&
             !(dofs.directions->transpose() * axis).isZero(0.0);
    });
    found.push_back({first.name, *turns, spring_share * system.stiffness_scale(), axis});
  }
  return found;
}

}  // namespace statejump::truss::detail
