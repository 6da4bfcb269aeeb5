// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>

namespace statejump::numerics {

// Contact of two round parts in the reduced models, as powers of the depth δ [m]. The kernel of the
// DEM computes the same contact from the contact radius; both are written separately, so that their
// comparison tests them.

/// Hertz's stiffness K = 4/3 E* √R [N/m^1.5].
/// @param modulus E* [Pa]; @param root √R [m^0.5]
inline double hertz_stiffness(double modulus, double root) {
  return 4.0 / 3.0 * modulus * root;
}
/// Mindlin's tangential stiffness over √δ, 8 G* √R [N/m^1.5]. @param modulus G* [Pa]
inline double mindlin_stiffness_per_root(double modulus, double root) {
  return 8.0 * modulus * root;
}

/// Hertz's force F = K δ^1.5 [N]. A negative depth gives the mirrored tension, which only serves
/// root finding: it shows that contact was lost.
/// @param stiffness K [N/m^1.5]
inline double hertz_force(double stiffness, double depth) {
  return stiffness * depth * std::sqrt(std::abs(depth));
}
/// dF/dδ [N/m].
inline double hertz_slope(double stiffness, double depth) {
  return 1.5 * stiffness * std::sqrt(std::abs(depth));
}
/// Depth under a force [m].
inline double hertz_depth(double stiffness, double force) {
  return std::pow(force / stiffness, 2.0 / 3.0);
}
/// Mindlin's tangential stiffness k_t [N/m]. @param stiffness 8 G* √R [N/m^1.5]
inline double mindlin_stiffness(double stiffness, double depth) {
  return stiffness * std::sqrt(std::abs(depth));
}

}  // namespace statejump::numerics
