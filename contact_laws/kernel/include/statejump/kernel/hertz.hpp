// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>

#include "statejump/kernel/arithmetic.hpp"
#include "statejump/kernel/require.hpp"

namespace statejump::kernel {

/// R = R1 R2 / (R2 - R1) [m] for finite radii; see internal_effective_radius().
template <class A = Single>
[[gnu::always_inline]] inline typename A::Number radius_inside(
    const typename A::Number& journal_radius, const typename A::Number& bearing_radius) {
  return journal_radius * (bearing_radius / (bearing_radius - journal_radius));
}

/// Effective radius of an internal contact, a pin in a hole: R = R1 R2 / (R2 - R1) [m].
///
/// Curvatures add with sign (Johnson 1985, eq. 4.14): the journal is convex, +1/R1, the bearing
/// concave, -1/R2. The paper's eq. (7) has R1 R2 / (R1 + R2), which holds for the external contact
/// of two balls. The concave bearing makes the contact much stiffer.
/// @param journal_radius R1 [m], > 0 and finite
/// @param bearing_radius R2 [m], > R1. +infinity is a flat wall and gives R1. A negative value is a
///        wall of radius -R2 that bulges towards the journal.
/// @throws std::invalid_argument unless R1 > 0, and R2 > R1 or R2 < 0
/// Limit: Hertz's theory needs a contact radius a = sqrt(R delta) much smaller than R1. As R2 tends
/// to R1, the contact becomes conformal and R grows without bound.
inline double internal_effective_radius(double journal_radius, double bearing_radius) {
  require(journal_radius > 0.0, "journal_radius", journal_radius, "(0, inf) m");
  require(bearing_radius > journal_radius || bearing_radius < 0.0, "bearing_radius", bearing_radius,
          "(journal_radius, inf] m or negative");
  if (std::isinf(bearing_radius)) return journal_radius;
  return radius_inside(journal_radius, bearing_radius);
}

/// Hertz stiffness K = 4/3 E* sqrt(R) [N/m^1.5], with which F = K delta^1.5 (paper eq. 6; Johnson
/// 1985, eq. 4.23).
/// @param effective_young_modulus E* [Pa], @param effective_radius R [m]
inline double hertz_stiffness(double effective_young_modulus, double effective_radius) {
  return 4.0 / 3.0 * effective_young_modulus * std::sqrt(effective_radius);
}

/// Depth delta = (F/K)^(2/3) [m] at which Hertz's point contact carries the force F.
/// @param effective_young_modulus E* [Pa], > 0, @param effective_radius R [m], > 0
/// @param force F [N], >= 0
inline double hertz_depth(double effective_young_modulus, double effective_radius, double force) {
  return std::pow(force / hertz_stiffness(effective_young_modulus, effective_radius), 2.0 / 3.0);
}

/// Elastic normal contact at one penetration depth. @tparam A arithmetic, see Single
template <class A>
struct HertzStateOf {
  typename A::Number force;           ///< F [N], >= 0, compressive
  typename A::Number stiffness;       ///< dF/d(delta) [N/m], >= 0
  typename A::Number contact_radius;  ///< a [m], >= 0
  typename A::Number elastic_energy;  ///< integral of F over delta [J], >= 0
};
using HertzState = HertzStateOf<Single>;

/// Hertz's point contact of two elastic bodies (Johnson 1985, eqs 4.22 and 4.23).
///
/// A pressure p0 sqrt(1 - r^2/a^2) on a circle of radius a indents the pair by delta = pi a p0 / (2
/// E*). It fits the undeformed gap r^2/(2R) when p0 = 2 a E* / (pi R), hence
///
///     a = sqrt(R delta)
///     F = 2/3 pi a^2 p0 = 4/3 E* sqrt(R) delta^1.5 = 4/3 E* a delta
///     dF/d(delta) = 2 E* a
///     integral of F d(delta) = 2/5 F delta
///
/// The cost is one square root and no division.
/// @param effective_young_modulus E* [Pa], > 0
/// @param effective_radius R [m], > 0, finite
/// @param penetration_depth delta [m], positive when the bodies overlap; <= 0 is a gap and gives
///        zeros (one contact) or undefined numbers (four contacts). Arguments are not checked: this
///        is the inner loop.
/// Limits: frictionless, a << R, quasi-static (no waves), no adhesion, no plasticity.
template <class A = Single>
[[gnu::always_inline]] inline HertzStateOf<A> hertz(
    const typename A::Number& effective_young_modulus, const typename A::Number& effective_radius,
    const typename A::Number& penetration_depth) {
  using Number = typename A::Number;
  if (A::may_skip(penetration_depth <= 0.0)) return {Number{}, Number{}, Number{}, Number{}};
  const Number contact_radius = A::root(effective_radius * penetration_depth);
  const Number stiffness = 2.0 * effective_young_modulus * contact_radius;
  const Number force = 2.0 / 3.0 * stiffness * penetration_depth;
  return {force, stiffness, contact_radius, 0.4 * force * penetration_depth};
}

}  // namespace statejump::kernel
