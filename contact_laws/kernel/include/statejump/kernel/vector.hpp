// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>

namespace statejump::kernel {

/// Vector in the world frame; each use documents its unit. It is not over-aligned, so any class can
/// contain it without an aligned allocator.
using Vector3 = Eigen::Vector3d;

/// Cross product without Eigen/Geometry, which would double the compile time.
inline Vector3 cross(const Vector3& a, const Vector3& b) {
  return {a.y() * b.z() - a.z() * b.y(), a.z() * b.x() - a.x() * b.z(),
          a.x() * b.y() - a.y() * b.x()};
}

}  // namespace statejump::kernel
