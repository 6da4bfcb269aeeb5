// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "newton.hpp"
#include "parts.hpp"

namespace statejump::truss::detail {

namespace {

constexpr int most_modes = 6;

/// Penalty stiffness of closed joints in the stability check, relative to the stiffest element. The
/// joints then have a hundredth of this element's compliance, and rounding remains below
/// free_share.
constexpr double stiff_joint = 100.0;

/// The nodes that move most in a mode.
FailureMode movers(const System& system, const VectorXd& mode) {
  const Model& model = system.model();
  std::vector<std::pair<double, int>> nodes;  // and their rotations
  for (int n = 0; n < static_cast<int>(system.dofs().sites()); ++n) {
    nodes.emplace_back(system.displacement(n, mode).norm(), n);
  }
  std::stable_sort(nodes.begin(), nodes.end(),
                   [](const auto& a, const auto& b) { return a.first > b.first; });
  FailureMode found;
  for (std::size_t k = 0; k < std::min<std::size_t>(3, nodes.size()); ++k) {
    if (nodes[k].first < 0.1 * nodes[0].first) break;
    const Vector3d moved = system.displacement(nodes[k].second, mode);
    Eigen::Index along = 0;
    moved.cwiseAbs().maxCoeff(&along);
    const auto site = index(nodes[k].second);
    const bool rotates = site >= model.nodes.size();
    found.push_back(
        {model.nodes[rotates ? site - model.nodes.size() : site].name, "xyz"[along], rotates});
  }
  return found;
}

using Factors = Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>>;

/// Modes of a symmetric matrix nearest to zero, and their eigenvalues.
struct Modes {
  VectorXd eigenvalues;
  Eigen::MatrixXd vectors;
};

Modes lowest_modes(const Eigen::SparseMatrix<double>& matrix, const Factors& factors, int most) {
  // Inverse iteration on a block of vectors. In each round, free modes grow at least 20 times as
  // much as all other modes.
  const Eigen::Index n = matrix.rows();
  const Eigen::Index count = std::min<Eigen::Index>(most, n);
  Eigen::MatrixXd block(n, count);
  for (int j = 0; j < count; ++j) {
    for (int i = 0; i < n; ++i) block(i, j) = std::sin(1.0 + 1.7 * i * (j + 1) + j);
  }
  for (int round = 0; round < 5; ++round) {
    block = factors.solve(block).eval();
    const Eigen::HouseholderQR<Eigen::MatrixXd> qr(block);
    block = qr.householderQ() * Eigen::MatrixXd::Identity(n, count);
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> found(
      block.transpose() * (matrix.selfadjointView<Eigen::Lower>() * block));
  return {found.eigenvalues(), block * found.eigenvectors()};
}

/// Stiffness matrix of the truss with penalty springs in its joints, see penalty_stiffness(). A
/// fraction of the stiffness of the stiffest element is added to the diagonal.
Eigen::SparseMatrix<double> shifted_stiffness(const System& system, const VectorXd& z, double time,
                                              const Statuses& statuses, JointModel joints,
                                              double held, double slack, double share) {
  Eigen::SparseMatrix<double> shifted =
      system.penalty_stiffness(z, time, statuses, joints, held, slack);
  // In place: diagonal entries exist, except for nodes without any stiffness.
  for (Eigen::Index i = 0; i < shifted.rows(); ++i) {
    shifted.coeffRef(i, i) += share * system.stiffness_scale();
  }
  return shifted;
}

/// The modes whose eigenvalues are in a range.
FoundModes modes_between(const System& system, const Modes& modes, double smallest,
                         double largest) {
  FoundModes found;
  for (Eigen::Index j = 0; j < modes.eigenvalues.size(); ++j) {
    if (!(modes.eigenvalues[j] >= smallest && modes.eigenvalues[j] <= largest)) continue;
    VectorXd mode = VectorXd::Zero(system.unknowns());
    mode.head(modes.vectors.rows()) = modes.vectors.col(j);
    found.modes.push_back(movers(system, mode));
    found.shapes.push_back(std::move(mode));
  }
  found.count = static_cast<int>(found.modes.size());
  found.more = found.count == most_modes;
  return found;
}

/// The free modes, and whether some direction has a negative stiffness.
std::pair<FoundModes, bool> free_modes(const System& system, const VectorXd& z, double time,
                                       const Statuses& statuses, JointModel joints) {
  const Eigen::SparseMatrix<double> shifted =
      shifted_stiffness(system, z, time, statuses, joints, 1.0, 0.0, 0.05 * free_share);
  const Factors factors(shifted);
  if (factors.info() != Eigen::Success) return {FoundModes{}, false};
  const double least = free_share * system.stiffness_scale();
  const bool pushed = (factors.vectorD().array() < 0.0).any();
  // One vector shows whether there is a free mode. If there is one, five rounds reduce the Rayleigh
  // quotient below ten times the largest eigenvalue that counts as free. This holds with some 1e6
  // other modes just above it, and with a hundredth of the usual start component of a free mode
  // (6e9 · 10⁻⁹ < 10).
  const Modes first = lowest_modes(shifted, factors, 1);
  if (std::abs(first.eigenvalues[0]) > 10.0 * least) return {FoundModes{}, pushed};
  return {modes_between(system, lowest_modes(shifted, factors, most_modes), -least, least), pushed};
}

}  // namespace

FoundModes mechanism(const System& system, const VectorXd& z, double time, const Statuses& statuses,
                     JointModel joints) {
  if (system.displacements() == 0) return {};
  const auto [found, pushed] = free_modes(system, z, time, statuses, joints);
  if (found || !pushed || !z.isZero()) return found;
  // Stresses in the reference configuration may give the free mode of a mechanism a stiffness.
  // Without them it is free.
  Model unstressed = system.model();
  scale_misfits(unstressed, 0.0);
  return free_modes(System(unstressed), z, time, statuses, joints).first;
}

FoundModes buckling(const System& system, const VectorXd& z, double time, const Statuses& statuses,
                    double slack) {
  if (system.displacements() == 0) return {};
  const Eigen::SparseMatrix<double> shifted = shifted_stiffness(
      system, z, time, held_but_open(statuses), JointModel::pins, stiff_joint, slack, free_share);
  const Factors factors(shifted);
  // Sylvester: as many negative pivots as negative eigenvalues.
  const Eigen::Index unstable =
      factors.info() == Eigen::Success ? (factors.vectorD().array() < 0.0).count() : 0;
  if (unstable == 0) return {};
  const double lowest = -std::numeric_limits<double>::infinity();
  FoundModes found = modes_between(system, lowest_modes(shifted, factors, most_modes), lowest, 0.0);
  found.count = static_cast<int>(unstable);
  found.more = false;
  return found;
}

}  // namespace statejump::truss::detail
