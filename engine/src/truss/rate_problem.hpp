// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <vector>

#include "linear/sparse_factor.hpp"
#include "system.hpp"

namespace statejump::truss::detail {

/// How many ways a path can go on from an event.
enum class Continuation : unsigned char { none, one, several, unexamined };

struct RateAnswer {
  Continuation count = Continuation::unexamined;
  std::vector<int> joints;  ///< At a bound: those among which was decided.
  Statuses statuses;        ///< Of all joints, where there is one way.
  VectorXd step;            ///< Of the unknowns, likewise.
  bool opens = false;       ///< Whether one of them may be open.
  Statuses singular;        ///< A set that leaves the equations singular, where one was met.
};

/// Decides at an event how the joints at a bound go on, all together.
///
/// **Problem.** Joints at a bound may be on more than one branch: at the edge of friction stick and
/// slip, at the apex of the cone also open. Over a step so short that the equations are linear, let
/// every such joint be on one of its branches; J(S) dz = −r(S) gives the motion, the joints'
/// inequalities say whether the set S is one that holds. All sets share the factors of one J: only
/// rows of these joints differ, so a set costs one dense system of as many rows (the Delassus
/// matrix of the rates).
///
/// **Answer.** With stick and slip alone it is a linear complementarity problem; where the
/// symmetric part of its matrix is positive definite, there is exactly one solution, whatever heats
/// [1]. Else joints that do not move each other are problems of their own; of up to eight joints
/// all sets are tried, of more one solution is sought by pivoting, and another is not excluded.
/// Solutions count as one where their motions agree. The sign of det
/// J(S), each closure taken as negative, is the index of a solution; friction that grows with the
/// speed of the slide, however little, drives away from one with a negative index, so that is no
/// continuation.
///
/// A motion that is not short is a jump, no continuation: one beyond the mean, in decades, of the
/// truss and of the share of it (or of its forces) by which the joints, as they are, let it move.
///
/// [1] R. W. Cottle, J.-S. Pang, R. E. Stone, The Linear Complementarity Problem, SIAM 2009, ch. 3.
class RateProblem {
 public:
  explicit RateProblem(const System& system) : system_(&system), at_(0) {}

  /// @param z unknowns at the start of the step, @param target its end
  /// @param found statuses on which a solve over the same step converged; empty if none did
  /// @param changing joints that are at a bound besides those that slip and those that `found`
  /// changes
  RateAnswer solve(const VectorXd& z, double target, const StepStart& start, const Statuses& found,
                   const std::vector<int>& changing);

  /// Rates of the unknowns at z on a set of branches; nothing where the equations are singular.
  /// @param program_rates of the programs [K/s]
  std::optional<VectorXd> rates_on(const Statuses& statuses, const VectorXd& z, double time,
                                   const StepStart& start,
                                   const std::vector<double>& program_rates);

  /// The equations at z on a set of branches, until something else is asked.
  const Assembly& equations(const VectorXd& z, double time, const StepStart& start,
                            const Statuses& statuses);

  /// See SparseFactor::order_like().
  void order_like(const linear::SparseFactor& other) { factor_.order_like(other); }
  /// Lets go of the place of the equations and of their factors, until they are asked again.
  void release() {
    at_ = Assembly(0);
    factor_.release();
  }

 private:
  /// Makes the place of the equations, which many trusses never ask for.
  void begin() {
    if (at_.residual.size() == 0) at_ = system_->assembly();
  }

  const System* system_;
  Assembly at_;
  linear::SparseFactor factor_;
};

/// Sign of a determinant with every closure taken as negative, by which all stable sets of branches
/// have the same.
int index_of(int determinant_sign, const Assembly& at);

}  // namespace statejump::truss::detail
