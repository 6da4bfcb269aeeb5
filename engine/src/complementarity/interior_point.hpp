// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <vector>

#include "block_system.hpp"
#include "scaled_problem.hpp"

namespace statejump::complementarity {

/// Path-following interior point on De Saxcé's form of Coulomb's law.
///
/// With a diagonal D = (1/(c mu), 1/c) of each contact, c = max(1, 1/mu), x = D^-1 r and z = D û
/// lie both in Lorentz' cone x_n >= |x_t|, and û = u + mu |u_t| n reads z = D (W r + q) + |z_t|
/// e_n. The steps are Newton's on x∘z = sigma e (Jordan product) and that equation, the friction
/// term with its derivative, in the scaling of Nesterov and Todd: P x = P^-1 z, and
///
///     (D W D + A P^2) dx = A P v + (residual of z),   A = I - e_n (z_t/|z_t|)^T,
///
/// with v from the centring and Mehrotra's (1992) second-order term. Without friction's term the
/// problem is convex and the method polynomial; with it there is no theory, only practice (Acary,
/// Armand, Nguyen, Shpakovych 2023). Where the steps become short, some follow with A = I: the
/// friction term lags a step, so that each step is one of a convex problem (the fixed point of
/// Acary and Cadoux 2013), and the gap x.z is lowered only as fast as the residual follows, which
/// keeps the pairs off the boundary. Contacts without friction have one number, x_n = r_n.
class InteriorPoint {
 public:
  /// Starts far from the boundary.
  explicit InteriorPoint(const ScaledProblem& problem);

  /// One predictor-corrector step, one factorisation; its length, 1 at most and 0 at the end.
  double advance();
  Eigen::VectorXd reactions() const;

 private:
  struct Scaling;
  /// Contact in the variables of the cone.
  struct Cone {
    int size;  ///< Numbers that are sought: one without friction.
    Block d;   ///< Diagonal D.
    Block x;
    Block z;
  };
  struct Direction {
    std::vector<Block> dx;
    std::vector<Block> dz;
  };

  BlockSystem factored(const std::vector<Scaling>& scalings,
                       const std::vector<BlockMatrix>& a) const;
  /// Direction for given Jordan products x∘z + dx∘z + x∘dz; false if the equations are singular.
  bool solve(const BlockSystem& system, const std::vector<Scaling>& scalings,
             const std::vector<BlockMatrix>& a, const std::vector<Block>& residuals,
             const std::vector<Block>& aims, Direction& direction) const;
  double longest_step(const Direction& direction) const;

  const ScaledProblem& problem_;
  std::vector<Cone> cones_;
  int lag_ = 0;         ///< Steps with lagged friction that are still to come.
  int lag_length_ = 0;  ///< Their number when it was last chosen.
};

}  // namespace statejump::complementarity
