// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "status_solver.hpp"

namespace statejump::truss::detail {

/// Finds the statuses of the active contacts in a step. The search starts with the statuses of the
/// previous step.
///
/// Each solve with given statuses is expensive. find_active_set() therefore changes all violated
/// contacts at once, until statuses repeat. In most steps one contact changes its status, and the
/// second solve succeeds. If slip spreads, each solve of the whole truss would reveal only the next
/// contact. Pivots in the neighbourhood of the violated contacts therefore guess the statuses first
/// (NeighbourhoodPivots).
class StatusSearch {
 public:
  StatusSearch(StepForces& forces, StepMatrix& matrix)
      : forces_(forces), matrix_(matrix), solver_(forces, matrix) {}

  /// Finds the statuses and solves the step. Returns false, with an invalid step, if single pivots
  /// repeat earlier statuses or a solve does not converge.
  bool find(TimeStep& step, StepContacts& contacts);

 private:
  StepForces& forces_;
  StepMatrix& matrix_;
  StatusSolver solver_;
};

}  // namespace statejump::truss::detail
