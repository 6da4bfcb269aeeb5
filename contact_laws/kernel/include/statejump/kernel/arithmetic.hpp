// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cmath>

#include "statejump/kernel/vector.hpp"

namespace statejump::kernel {

/// Arithmetic of one contact: its numbers, and the operations that have no operator.
///
/// Formulas of the inner loop are templates over an arithmetic A, so that each formula exists once.
/// Single computes one contact; the stepper has an arithmetic of four contacts (pack.hpp). Both
/// give the same bits. A Mask is the result of a comparison. One contact evaluates one operand of
/// `mask ? a : b`; four contacts evaluate both and blend them. Statements depend on masks in two
/// ways:
///
///     if (A::may_skip(mask)) return result;        four contacts never skip; the caller blends
///     if (A::any(mask)) a = A::select(mask, b, a);  costly, and needed by few contacts
///
/// Functions of the inner loop are always inlined. Four contacts need the instructions of their
/// caller's processor, and calls cost one contact 10 % to 40 % more instructions.
struct Single {
  using Number = double;
  using Vector = Vector3;
  using Mask = bool;

  [[gnu::always_inline]] static Vector zero() { return Vector::Zero(); }
  [[gnu::always_inline]] static Number dot(const Vector& a, const Vector& b) { return a.dot(b); }
  [[gnu::always_inline]] static Number squared(const Vector& a) { return a.squaredNorm(); }
  [[gnu::always_inline]] static Vector cross(const Vector& a, const Vector& b) {
    return kernel::cross(a, b);
  }
  [[gnu::always_inline]] static Number root(Number a) { return std::sqrt(a); }
  [[gnu::always_inline]] static Number absolute(Number a) { return std::abs(a); }
  [[gnu::always_inline]] static Number larger(Number a, Number b) { return std::max(a, b); }
  // Component by component: a conditional reference would keep both vectors in memory.
  [[gnu::always_inline]] static Vector select(Mask which, const Vector& a, const Vector& b) {
    return {which ? a[0] : b[0], which ? a[1] : b[1], which ? a[2] : b[2]};
  }
  [[gnu::always_inline]] static Mask negate(Mask mask) { return !mask; }
  [[gnu::always_inline]] static bool may_skip(Mask mask) { return mask; }
  [[gnu::always_inline]] static bool any(Mask mask) { return mask; }
};

}  // namespace statejump::kernel
