// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "statejump/stepper/link.hpp"

namespace statejump::stepper {

/// Returns whether a time step is at most stable_step(). The condition dt <= 4 m / (c + sqrt(c^2 +
/// 4 m k)) is equivalent to (k dt + 2 c) dt <= 4 m, which needs no roots and quotients. Near the
/// limit, where rounding matters, stable_step() itself decides.
/// @param inverse_mass 1/m1 + 1/m2 [1/kg], > 0; @param time_step [s]
inline bool is_stable(const LinkStep& step, double inverse_mass, double time_step) {
  const double almost_4 = 4 - 1e-6, mobility_time = time_step * inverse_mass;
  const bool surely = (step.stiffness * time_step + 2 * step.damping) * mobility_time <= almost_4 &&
                      2 * step.damping_across * mobility_time <= almost_4;
  return surely || time_step <= stable_step(step, inverse_mass);
}

}  // namespace statejump::stepper
