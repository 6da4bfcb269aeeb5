// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <vector>

#include "linear/sparse_factor.hpp"
#include "system.hpp"

namespace statejump::truss::detail {

/// Number of continuations of a path from an event.
enum class Continuation : unsigned char { none, one, several, unexamined };

struct RateAnswer {
  Continuation count = Continuation::unexamined;
  std::vector<int> joints;  ///< Joints at a limit whose statuses were decided.
  Statuses statuses;        ///< Of all joints, if there is one continuation.
  VectorXd step;            ///< Step of the unknowns, if there is one continuation.
  bool opens = false;       ///< Whether `open` is a possible status of one of these joints.
  Statuses singular;        ///< Statuses for which the equations are singular, if any were found.
};

/// Determines the statuses that all joints at a limit have after an event.
///
/// **Problem.** A joint at a limit has several possible statuses: stick and slip at the friction
/// limit, and also open at the apex of the friction cone. Over a step so short that the equations
/// are linear, each such joint takes one of its statuses. Let S be the set of statuses that the
/// joints take. J(S) dz = −r(S) gives the step dz for S, and S is admissible if all inequalities
/// hold. All sets share the factors of one J, because J(S) differs only in the rows of these
/// joints. Each set needs one dense system with these rows (the Delassus matrix of the rates).
///
/// **Solution.** With stick and slip alone this is a linear complementarity problem. If the
/// symmetric part of its matrix is positive definite, it has exactly one solution for any
/// temperature rate [1]. If the matrix is symmetric and positive semidefinite, the displacements of
/// all its solutions are equal [1]; this is so where the constraints of joints that stick are
/// dependent, for example of two latches in one hinge. Otherwise the joints are divided into
/// uncoupled groups. For a group of up to eight joints all sets are tried. For a larger group
/// pivoting finds one solution; other solutions may exist. Solutions with equal motions count as
/// one. The index of a solution is the sign of det J(S), after the sign of every closure row is
/// reversed. Solutions with a negative index are no continuations: with any friction that grows
/// with slip rate, however small, the state moves away from such solutions.
///
/// A solution is a jump, not a continuation, if its displacement exceeds √s times the size of the
/// truss. s is the larger of two ratios in the step with unchanged statuses: displacement to the
/// size of the truss, and force change to the largest joint force.
/// [1] R. W. Cottle, J.-S. Pang, R. E. Stone, The Linear Complementarity Problem, SIAM 2009, ch. 3.
class RateProblem {
 public:
  explicit RateProblem(const System& system) : system_(&system), at_(0) {}

  /// @param z unknowns at the start of the step
  /// @param target time at the end of the step [s]
  /// @param found statuses of a converged solve over the same step; empty: no solve converged
  /// @param changing further joints at a limit, besides those that slip or change in `found`
  RateAnswer solve(const VectorXd& z, double target, const StepStart& start, const Statuses& found,
                   const std::vector<int>& changing);

  /// Rates of the unknowns at z for given statuses; empty if the equations are singular.
  /// @param program_rates rates of the temperature programs [K/s]
  std::optional<VectorXd> rates_on(const Statuses& statuses, const VectorXd& z, double time,
                                   const StepStart& start,
                                   const std::vector<double>& program_rates);

  /// Evaluates the equations at z for given statuses. The returned reference is valid until the
  /// next call.
  const Assembly& equations(const VectorXd& z, double time, const StepStart& start,
                            const Statuses& statuses);

  /// See SparseFactor::order_like().
  void order_like(const linear::SparseFactor& other) { factor_.order_like(other); }
  /// Frees the memory of equations and factors until the next call.
  void release() {
    at_ = Assembly(0);
    factor_.release();
  }

 private:
  /// Allocates the equations on first use; many trusses never need them.
  void begin() {
    if (at_.residual.size() == 0) at_ = system_->assembly();
  }

  const System* system_;
  Assembly at_;
  linear::SparseFactor factor_;
};

/// Sign of the determinant of the Jacobian after the sign of every closure row is reversed. It is
/// the same for all stable sets of statuses.
int index_of(int determinant_sign, const Assembly& at);

}  // namespace statejump::truss::detail
