// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <sstream>

#include "truss_newton.hpp"
#include "truss_parts.hpp"

namespace statejump::detail {

namespace {

/// Modes softer than this share of the stiffest part count as free: rounding of the stiffness is
/// 1e-16, the softest mode of a ring of 100 000 bays 1e-12.
constexpr double free_share = 1e-13;
constexpr int most_modes = 6;

/// "node 'B' (x), node 'C' (y)": the nodes that move most in a mode.
std::string movers(const TrussSystem& system, const VectorXd& mode) {
  const TrussModel& model = system.model();
  std::vector<std::pair<double, int>> nodes;
  for (int n = 0; n < static_cast<int>(model.nodes.size()); ++n) {
    nodes.emplace_back(system.displacement(n, mode).norm(), n);
  }
  std::stable_sort(nodes.begin(), nodes.end(),
                   [](const auto& a, const auto& b) { return a.first > b.first; });
  std::ostringstream text;
  for (std::size_t k = 0; k < std::min<std::size_t>(3, nodes.size()); ++k) {
    if (nodes[k].first < 0.1 * nodes[0].first) break;
    const Vector3d moved = system.displacement(nodes[k].second, mode);
    Eigen::Index along = 0;
    moved.cwiseAbs().maxCoeff(&along);
    text << (k == 0 ? "" : ", ") << "node '" << model.nodes[index(nodes[k].second)].name
         << "' mostly along "
         << "xyz"[along];
  }
  return text.str();
}

}  // namespace

std::string mechanism(const TrussSystem& system, const VectorXd& z, double time,
                      const Statuses& statuses, JointModel joints) {
  const int n = system.displacements();
  if (n == 0) return "";
  Eigen::SparseMatrix<double> shifted = system.joined_stiffness(z, time, statuses, joints);
  const double scale = system.stiffness_scale();
  Eigen::SparseMatrix<double> identity(n, n);
  identity.setIdentity();
  shifted += 0.05 * free_share * scale * identity;
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factors(shifted);
  if (factors.info() != Eigen::Success) return "";
  // Inverse iteration on a block: free modes outgrow all others by 20 and more in a round.
  const int count = std::min(most_modes, n);
  Eigen::MatrixXd block(n, count);
  for (int j = 0; j < count; ++j) {
    for (int i = 0; i < n; ++i) block(i, j) = std::sin(1.0 + 1.7 * i * (j + 1) + j);
  }
  for (int round = 0; round < 5; ++round) {
    block = factors.solve(block).eval();
    const Eigen::HouseholderQR<Eigen::MatrixXd> qr(block);
    block = qr.householderQ() * Eigen::MatrixXd::Identity(n, count);
  }
  const Eigen::MatrixXd projected = block.transpose() * (shifted * block);
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> modes(projected);
  std::ostringstream text;
  int free = 0;
  for (int j = 0; j < count; ++j) {
    if (modes.eigenvalues()[j] > free_share * scale) break;
    VectorXd mode = VectorXd::Zero(system.unknowns());
    mode.head(n) = block * modes.eigenvectors().col(j);
    text << (free++ == 0 ? "" : "; ") << movers(system, mode);
  }
  if (free == 0) return "";
  return std::to_string(free) + (free == most_modes ? " or more" : "") + " free mode" +
         (free == 1 ? "" : "s") + ": " + text.str();
}

}  // namespace statejump::detail
