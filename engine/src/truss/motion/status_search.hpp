// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "status_solver.hpp"

namespace statejump::truss::detail {

/// Finds the statuses of the active contacts of a step, from those of the step before.
///
/// A solve on statuses costs Newton's method, so find_active_set() changes all violated contacts
/// until a block leads to statuses that were tried. Most steps change the status of one contact,
/// and the second solve succeeds. Where slip spreads, each solve of the whole truss would show the
/// next contact only. Therefore pivots in the neighbourhood of the violated contacts guess the
/// statuses first (NeighbourhoodPivots).
class StatusSearch {
 public:
  StatusSearch(StepForces& forces, StepMatrix& matrix)
      : forces_(forces), matrix_(matrix), solver_(forces, matrix) {}

  /// False if single pivots repeat earlier statuses, or a solve does not converge. The step is then
  /// invalid.
  bool find(TimeStep& step, StepContacts& contacts);

 private:
  StepForces& forces_;
  StepMatrix& matrix_;
  StatusSolver solver_;
};

}  // namespace statejump::truss::detail
