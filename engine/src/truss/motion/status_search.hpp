// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "status_solver.hpp"

namespace statejump::truss::detail {

/// Finds the statuses of the active contacts of a step, from those of the step before.
///
/// Block principal pivoting with single pivots as a safeguard [1]: after a solve on statuses, every
/// contact whose inequality is violated changes its status, unless these statuses have been tried;
/// then only the first of them does, until fewer are violated than ever before. Most steps change
/// the status of one contact, and the second solve succeeds. Where slip spreads, each solve of the
/// whole truss would show the next contact only; so pivots in the neighbourhood of the violated
/// contacts guess the statuses first (NeighbourhoodPivots).
///
/// [1] J. J. Júdice, F. M. Pires, Comput. Oper. Res. 21 (1994) 587-596.
class StatusSearch {
 public:
  StatusSearch(StepForces& forces, StepMatrix& matrix)
      : forces_(forces), matrix_(matrix), solver_(forces, matrix) {}

  /// False if single pivots come back to statuses that were not right, or a solve does not
  /// converge: the step is then spoilt.
  bool find(TimeStep& step, StepContacts& contacts);

 private:
  /// Statuses that are tried next, and whether the iterate is near to their solution.
  struct Guess {
    ContactStatuses statuses;
    bool is_near = false;
  };
  /// Pivots around each violated contact. @param next statuses that these request
  Guess pivot_locally(const ContactStatuses& statuses, const ContactStatuses& next,
                      const std::vector<std::size_t>& violated, TimeStep& step,
                      StepContacts& contacts);

  StepForces& forces_;
  StepMatrix& matrix_;
  StatusSolver solver_;
};

}  // namespace statejump::truss::detail
