// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>

#include "statejump/kernel/lane.hpp"
#include "statejump/kernel/vector.hpp"

namespace statejump::kernel {

/// Steps of transport(). @tparam Lane see OneLane
template <class Lane>
struct Transport {
  using Real = typename Lane::Real;
  using Mask = typename Lane::Mask;
  using Vector = typename Lane::Vector;

  /// Vector after the smallest rotation, neither projected nor rescaled.
  /// @param half h, @param half_squared |h|^2
  STATEJUMP_LANE_INLINE static Vector turned(const Vector& tangential, const Vector& n_new,
                                             const Vector& half, const Real& half_squared) {
    return tangential - half * (2.0 * Lane::dot(tangential, n_new) / half_squared);
  }

  /// Projects onto the plane of n_new and rescales to the old magnitude.
  /// @param counts lanes whose result is used
  STATEJUMP_LANE_INLINE static Vector rescaled(const Vector& turned, const Vector& n_new,
                                               const Real& magnitude_squared, const Mask& counts) {
    const Vector flat = turned - n_new * Lane::dot(turned, n_new);
    const Real ratio = Lane::dot(flat, flat) / magnitude_squared;
    const Mask vanishes = (magnitude_squared <= 0.0) | (ratio <= 1e-30);
    if (Lane::skips(vanishes)) return Lane::zero();
    // 1/sqrt(ratio) = 1 + (1 - ratio)/2 + 3/8 (1 - ratio)^2: for |1 - ratio| < 1e-8 two terms are
    // exact to rounding
    const Real excess = 1.0 - ratio;
    const Mask far = !(Lane::absolute(excess) < 1e-8);
    Real factor = 1.0 + 0.5 * excess;
    if (Lane::any(counts & far & !vanishes)) factor = far ? 1.0 / Lane::root(ratio) : factor;
    return Lane::select(vanishes, Lane::zero(), flat * factor);
  }
};

/// |h|^2 at which the smallest rotation counts as unique: |h| below 1e-8 is rounding.
constexpr double smallest_half_squared = 1e-16;

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
/// @param tangential vector in the plane of n_old, any unit. A part along n_old is projected away;
///        the magnitude is kept.
/// @param n_old, n_new unit normals
/// @param twist_angle [rad], right-handed about n_new: rotation of both bodies about their common
///        normal, mean of omega_1 . n and omega_2 . n times dt. Zero costs no trigonometry.
/// @return zero for a zero vector or one along the normal, NaN for a vector with NaN. For n_new =
///        -n_old the smallest rotation is not unique; the vector is left unchanged.
inline Vector3 transport(const Vector3& tangential, const Vector3& n_old, const Vector3& n_new,
                         double twist_angle = 0.0) {
  const double magnitude_squared = tangential.squaredNorm();
  if (magnitude_squared <= 0.0) return Vector3::Zero();
  const Vector3 half = n_old + n_new;
  const double half_squared = half.squaredNorm();
  const Vector3 untwisted = half_squared > smallest_half_squared
                                ? Transport<OneLane>::turned(tangential, n_new, half, half_squared)
                                : tangential;
  Vector3 turned = Transport<OneLane>::rescaled(untwisted, n_new, magnitude_squared, true);
  if (twist_angle != 0.0) {
    turned = std::cos(twist_angle) * turned + std::sin(twist_angle) * cross(n_new, turned);
  }
  return turned;
}

}  // namespace statejump::kernel
