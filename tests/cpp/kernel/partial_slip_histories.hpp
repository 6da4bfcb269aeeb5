// SPDX-License-Identifier: GPL-3.0-or-later
// Contacts with partial slip after a random history.
#pragma once

#include <cmath>

#include "statejump/kernel/partial_slip.hpp"
#include "support.hpp"

namespace statejump::kernel::testing {

/// Factors in the tangential stiffness and the normal force of a sphere on a plane.
inline constexpr double shear_root = 8.0 * 7.9e9 * 0.1, hertz_root = 4.0 / 3.0 * 38.5e9 * 0.1,
                        mu = 0.3;
inline double stiffness(double depth) {
  return shear_root * std::sqrt(depth);
}
inline double limit(double depth) {
  return mu * hertz_root * depth * std::sqrt(depth);
}
inline double gross(double depth) {
  return 1.5 * limit(depth) / stiffness(depth);
}

/// Memory of a contact after `steps` random steps, including loss and return of contact.
/// @param way converts a signed slide [m] into a vector in the tangent plane
template <class Way>
PartialSlipMemory random_history(Random& random, int steps, Way&& way) {
  PartialSlipMemory memory;
  double depth = 1e-6;
  for (int i = 0; i < steps; ++i) {
    const bool lost = random.uniform(0.0, 1.0) < 0.05;
    if (random.uniform(0.0, 1.0) < 0.6) depth = random.uniform(0.3e-6, 2e-6);
    const double slide = random.uniform(-1.0, 1.0) * random.uniform(0.0, 1.5) * gross(1e-6);
    partial_slip_step(lost ? 0.0 : stiffness(depth), limit(depth), way(slide), memory);
  }
  return memory;
}

inline PartialSlipMemory random_history(Random& random, int steps) {
  return random_history(random, steps, [](double slide) { return Tangent{slide, 0.0}; });
}

}  // namespace statejump::kernel::testing
