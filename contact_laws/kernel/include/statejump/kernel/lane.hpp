// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cmath>

#include "statejump/kernel/vector.hpp"

namespace statejump::kernel {

/// Numbers of one contact: the operations in which the formulas of the kernel are written. A
/// stepper that computes several contacts at once has the same operations on packs of numbers.
///
///   Real, Mask, Vector     a number, a truth value, a vector
///   skips(mask)            whether a calculation that only other contacts need is left out
///   any(mask)              whether a calculation that these contacts need is made
///
/// Formulas use + - * / and comparisons of Real, and `mask ? a : b`.
struct OneLane {
  using Real = double;
  using Mask = bool;
  using Vector = Vector3;

  static bool skips(bool mask) { return mask; }
  static bool any(bool mask) { return mask; }
  static double root(double a) { return std::sqrt(a); }
  static double absolute(double a) { return std::abs(a); }
  static double not_negative(double a) { return std::max(0.0, a); }
  static double dot(const Vector3& a, const Vector3& b) { return a.dot(b); }
  static Vector3 cross(const Vector3& a, const Vector3& b) { return kernel::cross(a, b); }
  static Vector3 zero() { return Vector3::Zero(); }
  static Vector3 select(bool which, const Vector3& a, const Vector3& b) { return which ? a : b; }
};

/// Packs must not be passed in registers, whose number depends on the processor.
#define STATEJUMP_LANE_INLINE [[gnu::always_inline]] inline

}  // namespace statejump::kernel
