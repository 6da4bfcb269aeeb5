// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>

#include "step_matrix.hpp"

namespace statejump::truss::detail {

/// Newton's method for a step whose active contacts are on given statuses.
///
/// On statuses the laws of all contacts are equations, which stand beside momentum in one sparse
/// system (StepMatrix). Most steps keep the statuses of the step before: corrections with its
/// factors converge in a few iterations, and no factorization is made. If they do not converge,
/// the matrix is factored where the step begins. Contacts that slip partially have a tangent that
/// changes with the iterate, so that every iteration factors; if these do not converge either, a
/// line search goes downhill.
class StatusSolver {
 public:
  StatusSolver(StepForces& forces, StepMatrix& matrix) : forces_(forces), matrix_(matrix) {}

  /// Solves the step with every active contact on a status. False if that does not converge.
  /// @param is_near whether to begin at the iterate; else at the end of the last step
  bool solve(const ContactStatuses& statuses, TimeStep& step, StepContacts& contacts, bool is_near);

 private:
  /// The factors that Newton's method takes: of an earlier step, of where it begins, or of every
  /// iterate; the last also with a line search downhill.
  enum class Tangents : unsigned char { kept, once, anew, downhill };
  /// Newton's method; its iterations, none if it did not converge.
  std::optional<int> iterate(StatusFactors& on, TimeStep& step, StepContacts& contacts,
                             Tangents tangents);
  /// Residual of the equations at an iterate [N s].
  struct Residual {
    VectorXd right;
    VectorXd momentum;     ///< What momentum lacks without impulses.
    bool on_laws = false;  ///< Of contacts that are not elastic, and of constraints.
  };
  Residual residual(const StatusFactors& on, TimeStep& step, const StepContacts& contacts,
                    double drift);

  StepForces& forces_;
  StepMatrix& matrix_;
};

}  // namespace statejump::truss::detail
