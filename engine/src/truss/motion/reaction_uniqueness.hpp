// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <vector>

#include "statejump/truss/motion.hpp"
#include "step_matrix.hpp"

namespace statejump::truss::detail {

/// Records the first step in which reactions are not unique.
///
/// If the equations of the statuses are regular, reactions are unique. A contact that neither
/// pushes nor opens, or has friction at the limit without slide, satisfies a second status. The
/// check therefore uses the admissible statuses with the most constraints. If their system is
/// singular, a null vector of the constrained rows of W names the joints that share a reaction.
class ReactionUniqueness {
 public:
  ReactionUniqueness(const StepForces& forces, StepMatrix& matrix)
      : forces_(forces), matrix_(matrix) {}

  void check(const TimeStep& step, const StepContacts& contacts);
  const std::optional<Undetermined>& found() const { return found_; }

 private:
  /// Statuses at the end of a step. A contact is constrained wherever its inequality is satisfied
  /// as an equation.
  ContactStatuses held_statuses(const TimeStep& step, const StepContacts& contacts) const;

  const StepForces& forces_;
  StepMatrix& matrix_;
  std::optional<Undetermined> found_;
  ContactStatuses checked_;  ///< Statuses of the last check.
  std::vector<int> active_;  ///< Numbers of their contacts.
};

}  // namespace statejump::truss::detail
