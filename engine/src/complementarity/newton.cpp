// SPDX-License-Identifier: GPL-3.0-or-later
#include "newton.hpp"

#include <algorithm>
#include <deque>
#include <limits>
#include <utility>
#include <vector>

#include "block_system.hpp"

namespace statejump::complementarity {

namespace {

/// Proximal term relative to the mean compliance. It must be larger than the errors of the factors
/// (1e-16 of the largest compliance) and smaller than every nonzero compliance.
constexpr double proximal = 1e-10;
/// A step is compared with the largest of this many merits.
constexpr std::size_t memory = 5;
/// Shortest step of the line search.
constexpr double shortest_step = 1.0 / 64.0;

/// Solves the equations linearised at an iterate. The result is empty if they are singular.
std::optional<Eigen::VectorXd> newton_target(const ScaledProblem& problem, const Iterate& at) {
  const int d = problem.dimension();
  BlockRows rows;
  std::vector<Block> right;
  for (Eigen::Index i = 0; i < problem.contacts(); ++i) {
    const BlockMatrix& w = problem.blocks()[static_cast<std::size_t>(i)];
    const Block r = block_of(at.r, i, d);
    const Block u = block_of(at.u, i, d);
    const double least = std::numeric_limits<double>::min();
    const double rho_n = 1.0 / std::max(w(0, 0), least);
    const double rho_t = 1.0 / std::max(w(1, 1), least);
    const double normal = r[0] - rho_n * u[0];
    if (!(normal > 0.0)) continue;
    const Eigen::Vector2d t = r.tail<2>() - rho_t * u.tail<2>();
    const double radius = problem.mu()[i] * normal;
    const double size = t.norm();

    BlockMatrix a = BlockMatrix::Identity();
    BlockMatrix b = BlockMatrix::Zero();
    if (size > radius || radius == 0.0) {
      const Eigen::Vector2d direction = size > 0.0 ? t / size : t;
      const double beta = size > 0.0 ? radius / size : 0.0;
      const Eigen::Matrix2d across =
          Eigen::Matrix2d::Identity() - direction * direction.transpose();
      a.bottomRightCorner<2, 2>() = beta * rho_t * across;
      b.bottomRightCorner<2, 2>() = Eigen::Matrix2d::Identity() - beta * across;
      b.bottomLeftCorner<2, 1>() = -problem.mu()[i] * direction;
    }
    right.emplace_back(a * (proximal * r - block_of(problem.q(), i, d)));
    b += proximal * a;
    rows.contacts.push_back(i);
    rows.a.push_back(a);
    rows.b.push_back(b);
  }
  return BlockSystem(problem, rows).solve(right);
}

}  // namespace

Iterate newton(const ScaledProblem& problem, Iterate from, int most, double tolerance,
               int& counted) {
  Iterate best = from;
  Iterate now = std::move(from);
  std::deque<double> merits = {now.merit};
  for (int k = 0; k < most && best.merit > tolerance; ++k) {
    ++counted;
    const std::optional<Eigen::VectorXd> target = newton_target(problem, now);
    if (!target) break;
    const double reference = *std::max_element(merits.begin(), merits.end());
    double step = 1.0;
    std::optional<Iterate> next;
    for (; step >= shortest_step; step *= 0.5) {
      Iterate trial(problem, now.r + step * (*target - now.r));
      if (trial.merit <= (1.0 - 1e-4 * step) * reference) {
        next = std::move(trial);
        break;
      }
    }
    if (!next) break;
    now = std::move(*next);
    merits.push_back(now.merit);
    if (merits.size() > memory) merits.pop_front();
    if (now.merit < best.merit) best = now;
  }
  return best;
}

}  // namespace statejump::complementarity
