// SPDX-License-Identifier: GPL-3.0-or-later
#include "interior_point.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "block_system.hpp"

namespace statejump::complementarity {

namespace {

/// A step covers at most this fraction of the distance to the boundary of the cone.
constexpr double boundary_fraction = 0.995;
/// Smallest fraction of the current gap that a corrector aims at.
constexpr double least_centring = 1e-3;
/// A shorter step indicates contacts far from the central path.
constexpr double short_step = 0.1;
/// After a short step, the centring step aims at this fraction of the current gap.
constexpr double centring_after_short_step = 0.5;
/// Number of steps with lagged friction after the first short step. The number doubles after each
/// further short step.
constexpr int first_lag = 5;
/// A lagged step reduces the gap only if for every contact its velocity residual times its reaction
/// is below this multiple of the gap.
constexpr double residual_per_gap = 10.0;

/// Determinant of Lorentz' cone, without cancellation of squares.
double determinant(const Block& x) {
  const double size = x.tail<2>().norm();
  return (x[0] - size) * (x[0] + size);
}

/// Returns x. If rounding put x on the boundary of the cone, x_n is increased by a few roundings.
Block kept_inside(Block x) {
  constexpr double roundings = 8.0 * std::numeric_limits<double>::epsilon();
  x[0] = std::max(x[0], x.tail<2>().norm() * (1.0 + roundings));
  return x;
}

/// Jordan product.
Block product(const Block& x, const Block& y) {
  Block result = x[0] * y + y[0] * x;
  result[0] = x.dot(y);
  return result;
}

/// The y with x∘y = right.
Block quotient(const Block& right, const Block& x) {
  Block result;
  const double along = x.tail<2>().dot(right.tail<2>());
  result[0] = (x[0] * right[0] - along) / determinant(x);
  result.tail<2>() = (right.tail<2>() - result[0] * x.tail<2>()) / x[0];
  return result;
}

/// Largest step length for which x + step dx is in the cone, but not more than `most`.
double step_to_boundary(const Block& x, const Block& dx, double most) {
  double step = most;
  if (dx[0] < 0.0) step = std::min(step, -x[0] / dx[0]);
  // Determinant along the direction: det(x + s dx) = c + 2 b s + a s^2 with c > 0.
  const double a = dx[0] * dx[0] - dx.tail<2>().squaredNorm();
  const double b = x[0] * dx[0] - x.tail<2>().dot(dx.tail<2>());
  const double c = determinant(x);
  const double discriminant = b * b - a * c;
  if (discriminant >= 0.0) {
    // Smallest positive root, in the form without cancellation.
    const double root = std::sqrt(discriminant);
    const double far = -b - (b >= 0.0 ? root : -root);
    for (const double s : {far != 0.0 ? c / far : -1.0, a != 0.0 ? far / a : -1.0}) {
      if (s > 0.0) step = std::min(step, s);
    }
  }
  return step;
}

}  // namespace

/// Scaling P of Nesterov and Todd for a pair (x, z): P x = P^-1 z = lambda.
struct InteriorPoint::Scaling {
  Scaling(const Block& x, const Block& z) {
    const double dx = std::sqrt(determinant(x));
    const double dz = std::sqrt(determinant(z));
    Block mirrored = x / dx;
    mirrored.tail<2>() *= -1.0;
    const double gamma = std::sqrt(0.5 * (1.0 + (x / dx).dot(z / dz)));
    Block w = (z / dz + mirrored) / (2.0 * gamma);
    const double eta = std::sqrt(dz / dx);
    p = BlockMatrix::Identity();
    p.bottomRightCorner<2, 2>() += w.tail<2>() * w.tail<2>().transpose() / (1.0 + w[0]);
    p.row(0) = w.transpose();
    p.col(0) = w;
    p *= eta;
    square = 2.0 * w * w.transpose();
    square(0, 0) -= 1.0;
    for (Eigen::Index k = 1; k < 3; ++k) square(k, k) += 1.0;
    square *= eta * eta;
    lambda = p * x;
  }
  BlockMatrix p;
  BlockMatrix square;
  Block lambda;
};

InteriorPoint::InteriorPoint(const ScaledProblem& problem) : problem_(problem) {
  for (Eigen::Index i = 0; i < problem.contacts(); ++i) {
    const double mu = problem.mu()[i];
    Cone cone;
    cone.size = mu > 0.0 ? problem.dimension() : 1;
    cone.d = Block::Constant(mu > 0.0 && mu < 1.0 ? mu : 1.0);
    cone.d[0] = mu > 1.0 ? 1.0 / mu : 1.0;
    cone.x = Block::Zero();
    cone.x[0] = 1.0;
    cone.z = cone.x;
    cones_.push_back(cone);
  }
}

Eigen::VectorXd InteriorPoint::reactions() const {
  Eigen::VectorXd r = Eigen::VectorXd::Zero(problem_.q().size());
  for (std::size_t i = 0; i < cones_.size(); ++i) {
    set_block(r, static_cast<Eigen::Index>(i), problem_.dimension(),
              cones_[i].d.cwiseProduct(cones_[i].x));
  }
  return r;
}

InteriorPoint::Linearised InteriorPoint::linearised(bool lagged) const {
  const std::size_t count = cones_.size();
  const Eigen::VectorXd u = problem_.times(reactions()) + problem_.q();
  Linearised at{{},
                std::vector<BlockMatrix>(count),
                std::vector<Block>(count),
                std::vector<Block>(count),
                0.0,
                0.0,
                0.0};
  for (std::size_t i = 0; i < count; ++i) {
    const Cone& cone = cones_[i];
    at.scalings.emplace_back(cone.x, cone.z);
    at.squares[i] = product(at.scalings[i].lambda, at.scalings[i].lambda);
    at.gap += cone.x.dot(cone.z);
    const double slip = cone.z.tail<2>().norm();
    Block& residual = at.residuals[i];
    residual = cone.z -
               cone.d.cwiseProduct(block_of(u, static_cast<Eigen::Index>(i), problem_.dimension()));
    residual.tail(3 - cone.size).setZero();
    residual[0] -= slip;
    at.reaction_squares += cone.x.squaredNorm();
    at.residual_squares += residual.squaredNorm();
    at.a[i] = BlockMatrix::Identity();
    if (slip > 0.0 && !lagged) at.a[i].row(0).tail<2>() -= cone.z.tail<2>() / slip;
  }
  at.gap /= static_cast<double>(count);
  return at;
}

double InteriorPoint::advance() {
  const std::size_t count = cones_.size();
  const bool lagged = lag_ > 0;
  const Linearised at = linearised(lagged);
  const BlockSystem system = factored(at.scalings, at.a);
  const auto solve_for = [&](const std::vector<Block>& targets, Direction& direction) {
    return solve(system, at.scalings, at.a, at.residuals, targets, direction);
  };

  // Predictor: direction to the boundary.
  std::vector<Block> targets(count);
  for (std::size_t i = 0; i < count; ++i) targets[i] = -at.squares[i];
  Direction direction;
  if (!solve_for(targets, direction)) return 0.0;

  // Corrector: the shorter the predictor step, the more centring.
  const double ratio = std::clamp(gap_after_predictor(direction) / at.gap, 0.0, 1.0);
  double sigma = std::max(ratio * ratio * ratio, least_centring);
  // The gap limits the progress of lagged friction.
  const double size = std::sqrt(at.reaction_squares / static_cast<double>(count));
  const double error = std::sqrt(at.residual_squares / static_cast<double>(count));
  if (lagged && error * size > residual_per_gap * at.gap) sigma = 1.0;
  for (std::size_t i = 0; i < count; ++i) {
    const Block scaled_dx = at.scalings[i].p * direction.dx[i];
    // The scaled direction of z is P^-1 dz = v - P dx; in the predictor v = -lambda.
    targets[i] -= product(scaled_dx, -at.scalings[i].lambda - scaled_dx);
    targets[i][0] += sigma * at.gap;
  }
  if (!solve_for(targets, direction)) return 0.0;
  double step = std::min(1.0, boundary_fraction * longest_step(direction));
  if (step < short_step) {
    // Some contacts are too close to the cone's boundary: recentre without second-order terms.
    for (std::size_t i = 0; i < count; ++i) {
      targets[i] = -at.squares[i];
      targets[i][0] += centring_after_short_step * at.gap;
    }
    Direction centring;
    if (!solve_for(targets, centring)) return 0.0;
    const double other = std::min(1.0, boundary_fraction * longest_step(centring));
    if (other > step) {
      step = other;
      direction = std::move(centring);
    }
  }
  move(direction, step, lagged);
  return step;
}

double InteriorPoint::gap_after_predictor(const Direction& direction) const {
  const double affine = std::min(1.0, longest_step(direction));
  double gap = 0.0;
  for (std::size_t i = 0; i < cones_.size(); ++i) {
    gap += (cones_[i].x + affine * direction.dx[i]).dot(cones_[i].z + affine * direction.dz[i]);
  }
  return gap / static_cast<double>(cones_.size());
}

void InteriorPoint::move(const Direction& direction, double step, bool lagged) {
  for (std::size_t i = 0; i < cones_.size(); ++i) {
    cones_[i].x = kept_inside(cones_[i].x + step * direction.dx[i]);
    cones_[i].z = kept_inside(cones_[i].z + step * direction.dz[i]);
  }
  if (lagged) {
    --lag_;
  } else if (step < short_step) {
    lag_length_ = lag_length_ == 0 ? first_lag : 2 * lag_length_;
    lag_ = lag_length_;
  }
}

BlockSystem InteriorPoint::factored(const std::vector<Scaling>& scalings,
                                    const std::vector<BlockMatrix>& a) const {
  BlockRows rows;
  for (std::size_t i = 0; i < cones_.size(); ++i) {
    const Cone& cone = cones_[i];
    BlockMatrix left = BlockMatrix::Zero();
    left.diagonal().head(cone.size) = cone.d.head(cone.size);
    rows.contacts.push_back(static_cast<Eigen::Index>(i));
    rows.a.push_back(left);
    rows.b.emplace_back(a[i] * scalings[i].square * cone.d.cwiseInverse().asDiagonal());
  }
  return BlockSystem(problem_, rows);
}

bool InteriorPoint::solve(const BlockSystem& system, const std::vector<Scaling>& scalings,
                          const std::vector<BlockMatrix>& a, const std::vector<Block>& residuals,
                          const std::vector<Block>& targets, Direction& direction) const {
  const std::size_t count = cones_.size();
  std::vector<Block> v(count);
  std::vector<Block> right(count);
  for (std::size_t i = 0; i < count; ++i) {
    v[i] = quotient(targets[i], scalings[i].lambda);
    right[i] = a[i] * (scalings[i].p * v[i]) + residuals[i];
  }
  const std::optional<Eigen::VectorXd> dr = system.solve(right);
  if (!dr) return false;
  direction.dx.resize(count);
  direction.dz.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    direction.dx[i] = block_of(*dr, static_cast<Eigen::Index>(i), problem_.dimension())
                          .cwiseQuotient(cones_[i].d);
    direction.dz[i] = scalings[i].p * v[i] - scalings[i].square * direction.dx[i];
  }
  return true;
}

double InteriorPoint::longest_step(const Direction& direction) const {
  double step = 1.0 / boundary_fraction;
  for (std::size_t i = 0; i < cones_.size(); ++i) {
    step = std::min(step, step_to_boundary(cones_[i].x, direction.dx[i], step));
    step = std::min(step, step_to_boundary(cones_[i].z, direction.dz[i], step));
  }
  return step;
}

}  // namespace statejump::complementarity
