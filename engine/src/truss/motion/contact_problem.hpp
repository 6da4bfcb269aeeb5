// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "statejump/complementarity/solve.hpp"
#include "step_matrix.hpp"

namespace statejump::truss::detail {

/// Solves a step as a frictional contact problem. It is used if StatusSearch does not find the
/// statuses.
///
/// Newton's method solves the equations of the bodies. At an iterate, v_free are the velocities
/// without impulses, and the velocities of the contacts are u = W r + Hᵀ v_free with the Delassus
/// matrix W = Hᵀ A⁻¹ H. Signorini's condition and Coulomb's law on u and r form a complementarity
/// problem, and its solvers need no statuses. Elastic contacts add their compliances to W. A is
/// factored once, at the middle of the step.
class ContactProblem {
 public:
  /// @pre The arguments outlive this object.
  ContactProblem(StepForces& forces, StepMatrix& matrix, const MotionOptions& options)
      : forces_(forces), matrix_(matrix), options_(options) {}

  /// Solves the step.
  /// @throws Failure if no solution is found
  void solve(TimeStep& step, StepContacts& contacts);

  long iterations() const { return iterations_; }
  double largest_merit() const { return largest_merit_; }

 private:
  /// Solves the contact problem of an iterate.
  /// @param free velocities of the bodies without impulses
  void solve_contacts(const TimeStep& step, const VectorXd& free, bool first,
                      StepContacts& contacts);

  StepForces& forces_;
  StepMatrix& matrix_;
  const MotionOptions& options_;
  long iterations_ = 0;
  double largest_merit_ = 0.0;
};

/// Contact of a planar problem that violates its law most; −1 without contacts. The violation is
/// the impulse error times W_nn [m/s].
Eigen::Index worst_contact(const complementarity::Problem& problem, const VectorXd& impulses);

}  // namespace statejump::truss::detail
