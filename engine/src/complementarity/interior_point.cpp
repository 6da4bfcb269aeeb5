// SPDX-License-Identifier: GPL-3.0-or-later
#include "interior_point.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "block_system.hpp"

namespace statejump::complementarity {

namespace {

/// Share of the way to the cone's boundary that a step goes.
constexpr double share_of_way = 0.995;
/// A shorter step gets nowhere.
constexpr double shortest_step = 1e-8;

/// Determinant of Lorentz' cone, without cancellation of squares.
double determinant(const Block& x) {
  const double size = x.tail<2>().norm();
  return (x[0] - size) * (x[0] + size);
}

/// Jordan product.
Block product(const Block& x, const Block& y) {
  Block result = x[0] * y + y[0] * x;
  result[0] = x.dot(y);
  return result;
}

/// y with x∘y = right.
Block quotient(const Block& right, const Block& x) {
  Block result;
  const double along = x.tail<2>().dot(right.tail<2>());
  result[0] = (x[0] * right[0] - along) / determinant(x);
  result.tail<2>() = (right.tail<2>() - result[0] * x.tail<2>()) / x[0];
  return result;
}

/// Largest step with x + step dx in the cone, at most `most`.
double step_to_boundary(const Block& x, const Block& dx, double most) {
  double step = most;
  if (dx[0] < 0.0) step = std::min(step, -x[0] / dx[0]);
  // det(x + s dx) = c + 2 b s + a s^2, c > 0.
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

/// Nesterov's and Todd's scaling of a pair: P x = P^-1 z = lambda.
struct Scaling {
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

/// Contact in the variables of the cone.
struct Cone {
  int size;  ///< Numbers that are sought: one without friction.
  Block d;   ///< Diagonal D.
  Block x;
  Block z;
};

class InteriorPoint {
 public:
  explicit InteriorPoint(const ScaledProblem& problem) : problem_(problem) {
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

  Eigen::VectorXd reactions() const {
    const int d = problem_.dimension();
    Eigen::VectorXd r = Eigen::VectorXd::Zero(problem_.q().size());
    for (std::size_t i = 0; i < cones_.size(); ++i) {
      set_block(r, static_cast<Eigen::Index>(i), d, cones_[i].d.cwiseProduct(cones_[i].x));
    }
    return r;
  }

  /// One predictor-corrector step about the velocities of the present reactions; its length.
  double advance(const Eigen::VectorXd& u, int& counted) {
    const std::size_t count = cones_.size();
    const int d = problem_.dimension();
    std::vector<Scaling> scalings;
    std::vector<Block> residuals(count);
    std::vector<BlockMatrix> a(count);
    double gap = 0.0;
    for (std::size_t i = 0; i < count; ++i) {
      const Cone& cone = cones_[i];
      scalings.emplace_back(cone.x, cone.z);
      gap += cone.x.dot(cone.z);
      const double slip = cone.z.tail<2>().norm();
      residuals[i] = cone.z - cone.d.cwiseProduct(block_of(u, static_cast<Eigen::Index>(i), d));
      residuals[i].tail(3 - cone.size).setZero();
      residuals[i][0] -= slip;
      a[i] = BlockMatrix::Identity();
      if (slip > 0.0) a[i].row(0).tail<2>() -= cone.z.tail<2>() / slip;
    }
    gap /= static_cast<double>(count);

    std::vector<Block> aims(count);
    for (std::size_t i = 0; i < count; ++i) {
      aims[i] = -product(scalings[i].lambda, scalings[i].lambda);
    }
    ++counted;
    const BlockSystem system = factored(scalings, a);
    if (!directions(system, scalings, a, residuals, aims)) return 0.0;
    const double affine = std::min(1.0, longest_step());
    double affine_gap = 0.0;
    for (std::size_t i = 0; i < count; ++i) {
      affine_gap += (cones_[i].x + affine * dx_[i]).dot(cones_[i].z + affine * dz_[i]);
    }
    affine_gap /= static_cast<double>(count);
    const double ratio = std::clamp(affine_gap / gap, 0.0, 1.0);
    const double sigma = std::max(ratio * ratio * ratio, 1e-3);
    for (std::size_t i = 0; i < count; ++i) {
      const Block scaled_dx = scalings[i].p * dx_[i];
      // P^-1 dz = v - P dx, with v of the predictor -lambda.
      const Block scaled_dz = -scalings[i].lambda - scaled_dx;
      aims[i] -= product(scaled_dx, scaled_dz);
      aims[i][0] += sigma * gap;
    }
    if (!directions(system, scalings, a, residuals, aims)) return 0.0;
    const double step = std::min(1.0, share_of_way * longest_step());
    for (std::size_t i = 0; i < count; ++i) {
      cones_[i].x += step * dx_[i];
      cones_[i].z += step * dz_[i];
    }
    return step;
  }

 private:
  BlockSystem factored(const std::vector<Scaling>& scalings,
                       const std::vector<BlockMatrix>& a) const {
    BlockRows rows;
    for (std::size_t i = 0; i < cones_.size(); ++i) {
      const Cone& cone = cones_[i];
      BlockMatrix left = BlockMatrix::Zero();
      left.diagonal().head(cone.size) = cone.d.head(cone.size);
      const BlockMatrix right = a[i] * scalings[i].square * cone.d.cwiseInverse().asDiagonal();
      rows.contacts.push_back(static_cast<Eigen::Index>(i));
      rows.a.push_back(left);
      rows.b.push_back(right);
    }
    return BlockSystem(problem_, rows);
  }

  /// dx and dz for given right-hand sides of the Jordan products.
  bool directions(const BlockSystem& system, const std::vector<Scaling>& scalings,
                  const std::vector<BlockMatrix>& a, const std::vector<Block>& residuals,
                  const std::vector<Block>& aims) {
    const std::size_t count = cones_.size();
    const int d = problem_.dimension();
    std::vector<Block> v(count);
    std::vector<Block> right(count);
    for (std::size_t i = 0; i < count; ++i) {
      v[i] = quotient(aims[i], scalings[i].lambda);
      right[i] = a[i] * (scalings[i].p * v[i]) + residuals[i];
    }
    const std::optional<Eigen::VectorXd> dr = system.solve(right);
    if (!dr) return false;
    dx_.resize(count);
    dz_.resize(count);
    for (std::size_t i = 0; i < count; ++i) {
      const Cone& cone = cones_[i];
      dx_[i] = block_of(*dr, static_cast<Eigen::Index>(i), d).cwiseQuotient(cone.d);
      dz_[i] = scalings[i].p * v[i] - scalings[i].square * dx_[i];
    }
    return true;
  }

  double longest_step() const {
    double step = 1.0 / share_of_way;
    for (std::size_t i = 0; i < cones_.size(); ++i) {
      step = std::min(step, step_to_boundary(cones_[i].x, dx_[i], step));
      step = std::min(step, step_to_boundary(cones_[i].z, dz_[i], step));
    }
    return step;
  }

  const ScaledProblem& problem_;
  std::vector<Cone> cones_;
  std::vector<Block> dx_;
  std::vector<Block> dz_;
};

}  // namespace

Iterate interior_point(const ScaledProblem& problem, int most, double tolerance, int& counted) {
  InteriorPoint path(problem);
  Iterate best(problem, path.reactions());
  Iterate now = best;
  for (int k = 0; k < most; ++k) {
    const double step = path.advance(now.u, counted);
    if (!(step > shortest_step)) break;
    now = Iterate(problem, path.reactions());
    if (!std::isfinite(now.merit)) break;
    if (now.merit < best.merit) best = now;
    if (best.merit <= tolerance) break;
  }
  return best;
}

}  // namespace statejump::complementarity
