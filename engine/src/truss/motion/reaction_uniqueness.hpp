// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <vector>

#include "statejump/truss/motion.hpp"
#include "step_matrix.hpp"

namespace statejump::truss::detail {

/// Records the first step whose reactions are not unique.
///
/// For statuses with a regular system, reactions are unique. A contact that neither pushes nor
/// opens, or has its friction at the limit and does not slide, satisfies a second status. The check
/// therefore uses the admissible statuses with the most constraints. If their system is singular, a
/// null vector of the constrained rows of W names the joints that share a reaction.
class ReactionUniqueness {
 public:
  ReactionUniqueness(const StepForces& forces, StepMatrix& matrix)
      : forces_(forces), matrix_(matrix) {}

  void check(const TimeStep& step, const StepContacts& contacts);
  const std::optional<Undetermined>& found() const { return found_; }

 private:
  /// Statuses at the end of a step, with a constraint wherever an inequality is satisfied as an
  /// equation.
  ContactStatuses held_statuses(const TimeStep& step, const StepContacts& contacts) const;

  const StepForces& forces_;
  StepMatrix& matrix_;
  std::optional<Undetermined> found_;
  ContactStatuses checked_;  ///< Statuses of the last check.
  std::vector<int> active_;  ///< Numbers of their contacts.
};

}  // namespace statejump::truss::detail
