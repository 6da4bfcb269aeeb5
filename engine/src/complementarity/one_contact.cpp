// SPDX-License-Identifier: GPL-3.0-or-later
#include "one_contact.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace statejump::complementarity {

namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;

/// The tangential problem in the eigenvector basis of S.
struct Sliding {
  Vector2d stiffness;  ///< Eigenvalues of S.
  Vector2d load;       ///< b
  Vector2d coupling;   ///< W_nt
  double normal_load;
  double normal_stiffness;
  double mu;

  Vector2d tangential(double lambda) const {
    return -(load.array() / (stiffness.array() + lambda)).matrix();
  }
  double normal(const Vector2d& tangential) const {
    return -(normal_load + coupling.dot(tangential)) / normal_stiffness;
  }
  /// |r_t| - mu r_n and its derivative.
  std::pair<double, double> excess(double lambda) const {
    const Vector2d r = tangential(lambda);
    const Vector2d rate = -(r.array() / (stiffness.array() + lambda)).matrix();
    const double size = r.norm();
    const double size_rate = size > 0.0 ? r.dot(rate) / size : 0.0;
    return {size - mu * normal(r), size_rate + mu * coupling.dot(rate) / normal_stiffness};
  }
};

/// Finds the root lambda > 0 of f by Newton's method inside a shrinking bracket.
double slip_rate(const Sliding& sliding) {
  double low = 0.0;
  double high = std::max(sliding.stiffness.maxCoeff(), sliding.normal_stiffness);
  while (sliding.excess(high).first > 0.0 && std::isfinite(high)) {
    low = high;
    high *= 8.0;
  }
  double lambda = low > 0.0 ? std::sqrt(low * high) : 0.5 * high;
  // Bisection alone would need about 1100 halvings; Newton's method needs five iterations.
  for (int k = 0; k < 200 && low < high; ++k) {
    const auto [value, rate] = sliding.excess(lambda);
    if (value == 0.0) break;
    (value > 0.0 ? low : high) = lambda;
    double next = lambda - value / rate;
    if (!(next > low && next < high)) next = low > 0.0 ? std::sqrt(low * high) : 0.25 * high;
    if (std::abs(next - lambda) <= 4e-16 * lambda) break;
    lambda = next;
  }
  return lambda;
}

}  // namespace

bool solve_one_contact(const BlockMatrix& w, const Block& q, double mu, double least, Block& r) {
  if (!(w(0, 0) > least)) return false;
  r.setZero();
  if (q[0] >= 0.0) return true;
  if (mu == 0.0) {
    r[0] = -q[0] / w(0, 0);
    return true;
  }
  const Vector2d coupling = w.row(0).tail<2>();
  const Matrix2d s = w.bottomRightCorner<2, 2>() - coupling * coupling.transpose() / w(0, 0);
  const Vector2d load = q.tail<2>() - coupling * (q[0] / w(0, 0));

  const double half = 0.5 * (s(0, 0) - s(1, 1));
  const double mean = 0.5 * (s(0, 0) + s(1, 1));
  const double radius = std::hypot(half, s(0, 1));
  const double angle = 0.5 * std::atan2(s(0, 1), half);
  Matrix2d axes;
  axes << std::cos(angle), -std::sin(angle), std::sin(angle), std::cos(angle);
  // The stiffness in the sliding direction is not negative. If W is rank-deficient, rounding could
  // make it so.
  const Vector2d stiffness = Vector2d(mean + radius, mean - radius).cwiseMax(0.0);
  const Sliding sliding{
      stiffness, axes.transpose() * load, axes.transpose() * coupling, q[0], w(0, 0), mu};

  if (load.norm() == 0.0) {
    r[0] = sliding.normal(Vector2d::Zero());
    return true;
  }
  if (stiffness.minCoeff() > 1e-15 * w.diagonal().maxCoeff()) {
    const Vector2d stuck = sliding.tangential(0.0);
    const double normal = sliding.normal(stuck);
    if (stuck.norm() <= mu * normal) {
      r << normal, axes * stuck;
      return true;
    }
  }
  const Vector2d slid = sliding.tangential(slip_rate(sliding));
  r[0] = std::max(0.0, sliding.normal(slid));
  // Exactly on the edge of the cone.
  const double size = slid.norm();
  if (size > 0.0) r.tail<2>() = axes * slid * (mu * r[0] / size);
  return true;
}

}  // namespace statejump::complementarity
