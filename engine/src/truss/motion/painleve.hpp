// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>

#include "statejump/truss/motion.hpp"
#include "step_matrix.hpp"

namespace statejump::truss::detail {

/// Notes the first step in which a slide ends that Coulomb's law does not let go on (Painlevé).
///
/// While a rigid contact slides, its normal force is what keeps its gap from closing: p r_n = −b,
/// with p the acceleration at which it opens for a unit of the normal force and of the friction
/// that comes with it. Where p is not above 0 the force has no solution or is one of several, and
/// the slide ends at once, by an impulse without a collision.
class PainleveCheck {
 public:
  PainleveCheck(const StepForces& forces, StepMatrix& matrix) : forces_(forces), matrix_(matrix) {}

  void check(const TimeStep& step, const StepContacts& contacts);
  const std::optional<Undetermined>& found() const { return found_; }

 private:
  const StepForces& forces_;
  StepMatrix& matrix_;
  std::optional<Undetermined> found_;
};

}  // namespace statejump::truss::detail
