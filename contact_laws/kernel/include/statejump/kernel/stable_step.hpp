// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <limits>

namespace statejump::kernel {

/// Largest stable time step [s] of the leapfrog (velocity Verlet) scheme for one spring–dashpot
/// oscillator, with the damping force computed from the velocity of the last half step, as in YADE:
///
///    dt = 4 m / (c + sqrt(c^2 + 4 m k)).
///
/// The step multiplies (v, x) by a matrix of determinant 1 - c dt/m and trace 2 - c dt/m - k
/// dt^2/m. Both eigenvalues stay inside the unit circle while k dt^2 + 2 c dt < 4 m. Without
/// damping this is omega dt < 2, dt = 2 sqrt(m/k); with damping alone dt = 2 m/c. To resolve the
/// oscillation, use 0.1 to 0.3 of this step.
/// @param mass m [kg], > 0. The relative motion of two bodies has the mass m1 m2/(m1 + m2). If the
///     bodies can rotate, their tangential motion has the smaller mass 1/(1/m + arm_1^2/I1 +
///     arm_2^2/I2).
/// @param stiffness_sum k [N/m], >= 0, sum of all springs that act on this motion
/// @param damping_sum c [N s/m], >= 0, sum of all dashpots that act on this motion
/// @return largest stable step [s]; +infinity without springs and dashpots, NaN if an argument is
///     NaN
inline double critical_time_step(double mass, double stiffness_sum, double damping_sum = 0.0) {
  const double rate =
      damping_sum + std::sqrt(damping_sum * damping_sum + 4.0 * mass * stiffness_sum);
  return rate <= 0.0 ? std::numeric_limits<double>::infinity() : 4.0 * mass / rate;
}

}  // namespace statejump::kernel
