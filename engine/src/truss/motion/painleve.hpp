// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>

#include "statejump/truss/motion.hpp"
#include "step_matrix.hpp"

namespace statejump::truss::detail {

/// Records the first step in which Coulomb's law does not allow a slide to continue (Painlevé).
///
/// While a rigid contact slides, its normal force prevents the gap from closing: p r_n = −b. A unit
/// normal force with its friction causes the opening acceleration p; −b is needed to keep the gap
/// closed. If p <= 0, the equation has no admissible solution r_n or several. The slide then ends
/// at once, by an impulse without a collision.
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
