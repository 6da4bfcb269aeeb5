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

/// Decides the statuses of all joints at a limit after an event.
///
/// **Problem.** A joint at a limit has several possible statuses: at the friction limit stick and
/// slip, at the apex of the cone also open. Over a step so short that the equations are linear,
/// each such joint takes one of its statuses. J(S) dz = −r(S) gives the step dz for the set S,
/// which is admissible if all inequalities hold. All sets share the factors of one J, because only
/// the rows of these joints differ. A set costs one dense system of these rows (the Delassus matrix
/// of the rates).
///
/// **Solution.** With stick and slip alone this is a linear complementarity problem. If the
/// symmetric part of its matrix is positive definite, it has exactly one solution for any
/// temperature rate [1]. Otherwise the joints are divided into uncoupled groups. For a group of up
/// to eight joints all sets are tried. For a larger group pivoting finds one solution, and others
/// are not excluded. Solutions with equal motions count as one. The index of a solution is the sign
/// of det J(S), with the sign of every closure row reversed. Solutions with a negative index are no
/// continuations: with any friction that grows with slip rate, however small, the state moves away
/// from them.
///
/// A solution is a jump, not a continuation, if its displacement exceeds √s times the size of the
/// truss. Here s is the larger of two ratios of the step in which joints keep their statuses: its
/// displacement over the size, and its force change over the largest joint force.
/// [1] R. W. Cottle, J.-S. Pang, R. E. Stone, The Linear Complementarity Problem, SIAM 2009, ch. 3.
class RateProblem {
 public:
  explicit RateProblem(const System& system) : system_(&system), at_(0) {}

  /// @param z unknowns at the start of the step
  /// @param target its end [s]
  /// @param found statuses of a converged solve over the same step; empty: none converged
  /// @param changing joints at a limit, besides slipping joints and those that `found` changes
  RateAnswer solve(const VectorXd& z, double target, const StepStart& start, const Statuses& found,
                   const std::vector<int>& changing);

  /// Rates of the unknowns at z on given statuses; empty if the equations are singular.
  /// @param program_rates of the programs [K/s]
  std::optional<VectorXd> rates_on(const Statuses& statuses, const VectorXd& z, double time,
                                   const StepStart& start,
                                   const std::vector<double>& program_rates);

  /// Equations at z on given statuses. The reference is valid until the next call.
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

/// Sign of the determinant with the sign of every closure row reversed. It is equal for all stable
/// sets of statuses.
int index_of(int determinant_sign, const Assembly& at);

}  // namespace statejump::truss::detail
