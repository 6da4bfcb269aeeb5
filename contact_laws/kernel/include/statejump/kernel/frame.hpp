// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>

#include "statejump/kernel/vector.hpp"

namespace statejump::kernel {

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
  const double magnitude_squared = tangential.squaredNorm();
  if (magnitude_squared <= 0.0) return Vector3::Zero();
  const Vector3 half = n_old + n_new;
  const double half_squared = half.squaredNorm();
  const double smallest = 1e-16;  // |h| < 1e-8: rounding determines the direction of h
  Vector3 turned = tangential;
  if (half_squared > smallest) turned -= half * (2.0 * tangential.dot(n_new) / half_squared);
  turned -= turned.dot(n_new) * n_new;

  const double ratio = turned.squaredNorm() / magnitude_squared;
  if (ratio <= 1e-30) return Vector3::Zero();
  // For e = 1 - ratio, 1/sqrt(ratio) = 1 + e/2 + 3/8 e^2 + ...; if |e| < 1e-8, two terms are exact
  // to rounding
  const double excess = 1.0 - ratio;
  turned *= std::abs(excess) < 1e-8 ? 1.0 + 0.5 * excess : 1.0 / std::sqrt(ratio);
  if (twist_angle != 0.0) {
    turned = std::cos(twist_angle) * turned + std::sin(twist_angle) * cross(n_new, turned);
  }
  return turned;
}

}  // namespace statejump::kernel
