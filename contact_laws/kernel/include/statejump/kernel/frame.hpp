// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>

#include "statejump/kernel/arithmetic.hpp"
#include "statejump/kernel/vector.hpp"

namespace statejump::kernel {

/// Component of v perpendicular to a unit axis; same unit as v.
template <class A = Single>
[[gnu::always_inline]] inline typename A::Vector perpendicular_part(
    const typename A::Vector& v, const typename A::Vector& axis) {
  return v - axis * A::dot(v, axis);
}

/// Whether two normals are far enough from opposite ones for transport(): |n_old + n_new| > 1e-8.
/// Below, rounding determines the direction of the sum.
template <class A = Single>
[[gnu::always_inline]] inline typename A::Mask have_rotation(const typename A::Vector& n_old,
                                                             const typename A::Vector& n_new) {
  return A::squared(n_old + n_new) > 1e-16;
}

/// transport() without twist.
/// @param counts contacts whose result is used. Four contacts require have_rotation() of them.
template <class A>
[[gnu::always_inline]] inline typename A::Vector transport_untwisted(
    const typename A::Vector& tangential, const typename A::Vector& n_old,
    const typename A::Vector& n_new, const typename A::Mask& counts) {
  using Number = typename A::Number;
  using Mask = typename A::Mask;
  const Number magnitude_squared = A::squared(tangential);
  if (A::may_skip(magnitude_squared <= 0.0)) return A::zero();
  const typename A::Vector half = n_old + n_new;
  typename A::Vector turned = tangential;
  if (!A::may_skip(A::negate(have_rotation<A>(n_old, n_new)))) {
    turned = turned - half * (2.0 * A::dot(tangential, n_new) / A::squared(half));
  }
  turned = perpendicular_part<A>(turned, n_new);

  const Number ratio = A::squared(turned) / magnitude_squared;
  const Mask vanishes = (magnitude_squared <= 0.0) | (ratio <= 1e-30);
  if (A::may_skip(vanishes)) return A::zero();
  // For e = 1 - ratio, 1/sqrt(ratio) = 1 + e/2 + 3/8 e^2 + ...; if |e| < 1e-8, two terms are exact
  // to rounding
  const Number excess = 1.0 - ratio;
  const Mask near = A::absolute(excess) < 1e-8;
  Number factor = 1.0 + 0.5 * excess;
  if (A::any(counts & A::negate(near | vanishes))) factor = near ? factor : 1.0 / A::root(ratio);
  return A::select(vanishes, A::zero(), turned * factor);
}

/// Rotates a tangential vector (the history force of a contact) from the old tangent plane to the
/// new one. The rotation is the smallest that takes n_old to n_new, followed by a twist about
/// n_new.
///
/// For v in the old plane, Rodrigues' formula with w = n_old x n_new and c = n_old . n_new, v c + w
/// x v + w (w . v)/(1 + c), reduces to
///
///    v - h 2 (v . n_new) / |h|^2,   h = n_old + n_new   (|h|^2 = 2 (1 + c)).
///
/// This is exact for any angle and needs no trigonometry. It stays accurate near 180 degrees, where
/// 1 + c cancels. The result is projected onto the new plane and rescaled to the magnitude of v. A
/// force rotated over millions of steps therefore neither leaves its plane nor decays.
///
/// @param tangential vector in the plane of n_old, any unit. A component along n_old is removed,
///     but the magnitude is kept.
/// @param n_old, n_new old and new unit normal
/// @param twist_angle [rad], right-handed about n_new: common rotation of both bodies about the
///     normal, i.e. the mean of omega_1 . n and omega_2 . n, times dt. A zero angle costs no
///     trigonometry.
/// @return rotated vector; zero for a zero vector or a vector along the normal, NaN for a vector
///     with NaN. For n_new = -n_old the smallest rotation is not unique, and the vector is returned
///     unchanged.
inline Vector3 transport(const Vector3& tangential, const Vector3& n_old, const Vector3& n_new,
                         double twist_angle = 0.0) {
  Vector3 turned = transport_untwisted<Single>(tangential, n_old, n_new, true);
  if (twist_angle == 0.0 || turned.isZero(0.0)) return turned;
  return std::cos(twist_angle) * turned + std::sin(twist_angle) * cross(n_new, turned);
}

}  // namespace statejump::kernel
