// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>

#include "step_matrix.hpp"

namespace statejump::truss::detail {

/// Newton's method for a step with given statuses of the active contacts.
///
/// With given statuses the laws of all contacts are equations. Together with the momentum balance
/// they form one sparse system (StepMatrix). In most steps the statuses of the previous step remain
/// valid, and a few corrections with its factors converge without a new factorisation. If they do
/// not converge, the matrix is factored at the beginning of the step. With partial slip, tangents
/// change with the iterate, so the matrix is factored in every iteration. If these iterations do
/// not converge either, a line search reduces the residual.
class StatusSolver {
 public:
  StatusSolver(StepForces& forces, StepMatrix& matrix) : forces_(forces), matrix_(matrix) {}

  /// Solves the step with the given status of every active contact. Returns false if the iteration
  /// does not converge.
  /// @param is_near true: the iteration starts at the present iterate; false: at the end of the
  /// last step
  bool solve(const ContactStatuses& statuses, TimeStep& step, StepContacts& contacts, bool is_near);

 private:
  /// Factors that Newton's method uses. `kept`: those of an earlier step. `once`: those at the
  /// beginning of this step. `anew`: new factors at every iterate. `downhill`: as `anew`, with a
  /// line search.
  enum class Tangents : unsigned char { kept, once, anew, downhill };
  /// Newton's method. Returns the number of iterations; empty without convergence.
  std::optional<int> iterate(StatusFactors& on, TimeStep& step, StepContacts& contacts,
                             Tangents tangents);
  /// Residual of the equations at an iterate [N s].
  struct Residual {
    VectorXd right;
    VectorXd momentum;  ///< Residual of the momentum balance without impulses.
    VectorXd held;      ///< Impulses of the velocity constraints; empty without constraints.
    /// Whether constraints, and contacts that are not elastic, satisfy their laws.
    bool on_laws = false;
  };
  Residual residual(const StatusFactors& on, TimeStep& step, const StepContacts& contacts,
                    double drift);

  StepForces& forces_;
  StepMatrix& matrix_;
};

}  // namespace statejump::truss::detail
