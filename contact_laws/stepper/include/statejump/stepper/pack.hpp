// SPDX-License-Identifier: GPL-3.0-or-later
// Four numbers in one vector operation. Each lane gets the bits of scalar arithmetic, because sum,
// product, quotient and square root are correctly rounded in any width. The vector types are
// compiler extensions, so one source serves every processor. An operation is one instruction with
// AVX2 and two without.
//
// All functions with these types are inlined into callers compiled for one processor, so no vector
// is passed in a register. Sources that include this header are compiled with -Wno-psabi.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>

#include "statejump/kernel/arithmetic.hpp"
#include "statejump/kernel/vector.hpp"

namespace statejump::stepper {

constexpr std::size_t lanes = 4;
// The alignment is explicit, because without AVX the compiler aligns these vectors to half of their
// size only.
using Pack [[gnu::vector_size(lanes * sizeof(double)), gnu::aligned(lanes * sizeof(double))]] =
    double;
/// Lanes are 0 (false) or -1 (true).
using Mask
    [[gnu::vector_size(lanes * sizeof(std::int64_t)), gnu::aligned(lanes * sizeof(std::int64_t))]] =
        std::int64_t;

/// Returns whether the processor has AVX2. False for all processors other than x86-64.
inline bool has_avx2() {
#ifdef __x86_64__
  return __builtin_cpu_supports("avx2") != 0;
#else
  return false;
#endif
}

/// One vector in each lane.
struct Pack3 {
  Pack x, y, z;
};

[[gnu::always_inline]] inline void put(Pack3& to, std::size_t lane, const kernel::Vector3& from) {
  to.x[lane] = from[0];
  to.y[lane] = from[1];
  to.z[lane] = from[2];
}
[[gnu::always_inline]] inline kernel::Vector3 get(const Pack3& from, std::size_t lane) {
  return {from.x[lane], from.y[lane], from.z[lane]};
}

[[gnu::always_inline]] inline Pack3 gather(const kernel::Vector3& a, const kernel::Vector3& b,
                                           const kernel::Vector3& c, const kernel::Vector3& d) {
  return {Pack{a[0], b[0], c[0], d[0]}, Pack{a[1], b[1], c[1], d[1]}, Pack{a[2], b[2], c[2], d[2]}};
}

[[gnu::always_inline]] inline Pack3 operator+(const Pack3& a, const Pack3& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
[[gnu::always_inline]] inline Pack3 operator-(const Pack3& a, const Pack3& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
[[gnu::always_inline]] inline Pack3 operator*(const Pack3& a, const Pack& b) {
  return {a.x * b, a.y * b, a.z * b};
}
[[gnu::always_inline]] inline Pack3 operator*(const Pack3& a, double b) {
  return {a.x * b, a.y * b, a.z * b};
}
/// Adds products in the order of Eigen's sum of three numbers, for equal bits.
[[gnu::always_inline]] inline Pack dot(const Pack3& a, const Pack3& b) {
  return a.x * b.x + (a.y * b.y + a.z * b.z);
}
[[gnu::always_inline]] inline Pack3 cross(const Pack3& a, const Pack3& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
[[gnu::always_inline]] inline Pack3 select(const Mask& which, const Pack3& a, const Pack3& b) {
  return {which ? a.x : b.x, which ? a.y : b.y, which ? a.z : b.z};
}

[[gnu::always_inline]] inline Pack root(const Pack& a) {
  return Pack{std::sqrt(a[0]), std::sqrt(a[1]), std::sqrt(a[2]), std::sqrt(a[3])};
}
[[gnu::always_inline]] inline Pack absolute(const Pack& a) {
  return Pack{std::abs(a[0]), std::abs(a[1]), std::abs(a[2]), std::abs(a[3])};
}
/// std::max(a, b)
[[gnu::always_inline]] inline Pack larger(const Pack& a, const Pack& b) {
  return a < b ? b : a;
}
[[gnu::always_inline]] inline Pack not_negative(const Pack& a) {
  return larger(Pack{}, a);
}

[[gnu::always_inline]] inline bool any(const Mask& mask) {
  return (mask[0] | mask[1] | mask[2] | mask[3]) != 0;
}

/// Arithmetic of the kernel's formulas for four contacts at once; see kernel::Single.
struct Lanes {
  using Number = Pack;
  using Vector = Pack3;
  using Mask = stepper::Mask;

  [[gnu::always_inline]] static Vector zero() { return Pack3{}; }
  [[gnu::always_inline]] static Number dot(const Vector& a, const Vector& b) {
    return stepper::dot(a, b);
  }
  [[gnu::always_inline]] static Number squared(const Vector& a) { return stepper::dot(a, a); }
  [[gnu::always_inline]] static Vector cross(const Vector& a, const Vector& b) {
    return stepper::cross(a, b);
  }
  [[gnu::always_inline]] static Number root(const Number& a) { return stepper::root(a); }
  [[gnu::always_inline]] static Number absolute(const Number& a) { return stepper::absolute(a); }
  [[gnu::always_inline]] static Number larger(const Number& a, const Number& b) {
    return stepper::larger(a, b);
  }
  [[gnu::always_inline]] static Vector select(const Mask& which, const Vector& a, const Vector& b) {
    return stepper::select(which, a, b);
  }
  [[gnu::always_inline]] static Mask negate(const Mask& mask) { return ~mask; }
  [[gnu::always_inline]] static bool may_skip(const Mask&) { return false; }
  [[gnu::always_inline]] static bool any(const Mask& mask) { return stepper::any(mask); }
};

}  // namespace statejump::stepper
