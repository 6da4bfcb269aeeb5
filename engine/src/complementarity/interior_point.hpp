// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <utility>
#include <vector>

#include "block_system.hpp"
#include "scaled_problem.hpp"

namespace statejump::complementarity {

/// Path-following interior point on De Saxcé's form of Coulomb's law.
///
/// Each contact has a diagonal D = (1/(c mu), 1/c), c = max(1, 1/mu). Then x = D^-1 r and z = D û
/// both lie in Lorentz' cone x_n >= |x_t|. The equation û = u + mu |u_t| n becomes z = D (W r + q)
/// + |z_t| e_n. The method takes Newton steps on this equation and on x∘z = sigma e (Jordan
/// product), with the derivative of the friction term. In the scaling of Nesterov and Todd, P x =
/// P^-1 z, they are
///
///    (D W D + A P^2) dx = A P v + (residual of z),   A = I - e_n (z_t/|z_t|)^T,
///
/// with v from the centring and Mehrotra's (1992) second-order term.
///
/// Without the friction term |z_t| e_n the problem is convex and the method polynomial. With this
/// term convergence is not proved, only observed (Acary, Armand, Nguyen, Shpakovych 2023). If the
/// steps become short, some steps use A = I: the friction term lags by one step, so each of these
/// steps belongs to a convex problem (the fixed point of Acary and Cadoux 2013). The gap x.z then
/// decreases only as fast as the residual, which keeps the pairs off the boundary. Contacts without
/// friction have one component, x_n = r_n.
class InteriorPoint {
 public:
  /// Starts far from the boundary.
  explicit InteriorPoint(const ScaledProblem& problem);

  /// Takes one predictor-corrector step with one factorisation.
  /// @return length of the step, at most 1; 0 if the method has ended
  double advance();
  Eigen::VectorXd reactions() const;

 private:
  struct Scaling;
  /// Contact in the variables of the cone.
  struct Cone {
    int size;  ///< Number of unknowns: one without friction.
    Block d;   ///< Diagonal D.
    Block x;
    Block z;
  };
  struct Direction {
    std::vector<Block> dx;
    std::vector<Block> dz;
  };
  /// The equations linearised at the current pairs.
  struct Linearised {
    std::vector<Scaling> scalings;
    std::vector<BlockMatrix> a;    ///< A, with the friction term unless it lags.
    std::vector<Block> residuals;  ///< Of z.
    std::vector<Block> squares;    ///< lambda∘lambda
    double gap;                    ///< Mean of x.z.
    double reaction_squares;       ///< Sum of |x|^2.
    double residual_squares;       ///< Sum of |residual|^2.
  };

  Linearised linearised(bool lagged) const;
  BlockSystem factored(const std::vector<Scaling>& scalings,
                       const std::vector<BlockMatrix>& a) const;
  /// Computes the direction (dx, dz) for given Jordan products x∘z + dx∘z + x∘dz. Returns false if
  /// the equations are singular.
  bool solve(const BlockSystem& system, const std::vector<Scaling>& scalings,
             const std::vector<BlockMatrix>& a, const std::vector<Block>& residuals,
             const std::vector<Block>& targets, Direction& direction) const;
  double longest_step(const Direction& direction) const;
  /// Mean of x.z after the longest step in a direction.
  double gap_after_predictor(const Direction& direction) const;
  /// Makes a step and updates the number of lagged steps.
  void move(const Direction& direction, double step, bool lagged);

  const ScaledProblem& problem_;
  std::vector<Cone> cones_;
  int lag_ = 0;         ///< Remaining steps with lagged friction.
  int lag_length_ = 0;  ///< Their number when it was last set.
};

}  // namespace statejump::complementarity
