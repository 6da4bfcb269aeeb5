// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <vector>

#include "statejump/truss/motion.hpp"
#include "step_matrix.hpp"

namespace statejump::truss::detail {

/// Notes the first step whose reactions are not unique.
///
/// On statuses whose system is regular, reactions are unique. A contact that neither pushes nor
/// opens, or has its friction at the bound and does not slide, satisfies another status as well. So
/// the system is checked on the statuses with the most constraints that hold. If it is singular, a
/// kernel of the rows of W that hold names the joints that share a reaction.
class ReactionUniqueness {
 public:
  ReactionUniqueness(const StepForces& forces, StepMatrix& matrix)
      : forces_(forces), matrix_(matrix) {}

  void check(const TimeStep& step, const StepContacts& contacts);
  const std::optional<Undetermined>& found() const { return found_; }

 private:
  /// Statuses at the end of a step, where those whose inequality is an equation as well hold.
  ContactStatuses held_statuses(const TimeStep& step, const StepContacts& contacts) const;

  const StepForces& forces_;
  StepMatrix& matrix_;
  std::optional<Undetermined> found_;
  ContactStatuses checked_;  ///< Those that were checked last …
  std::vector<int> active_;  ///< … and the numbers of their contacts.
};

}  // namespace statejump::truss::detail
