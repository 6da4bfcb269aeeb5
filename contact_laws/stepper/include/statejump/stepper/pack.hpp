// SPDX-License-Identifier: GPL-3.0-or-later
// Four numbers that are computed with at once. Each lane gets the bits that a double would get:
// sum, product, quotient and square root are rounded correctly in any width. Vectors are the
// compiler's, so that one source serves every processor: with AVX2 an operation is one instruction,
// without it two.
//
// All functions here, and those that take or return what is defined here, are part of their
// callers, each of which is compiled for one processor: no vector is handed over in a register, and
// sources that use this are compiled with -Wno-psabi.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>

#include "statejump/kernel/vector.hpp"

namespace statejump::stepper {

constexpr std::size_t lanes = 4;
// Aligned in so many words: without AVX the compiler would give them to half of their size only.
using Pack [[gnu::vector_size(lanes * sizeof(double)), gnu::aligned(lanes * sizeof(double))]] =
    double;
/// Each 0 or -1.
using Mask
    [[gnu::vector_size(lanes * sizeof(std::int64_t)), gnu::aligned(lanes * sizeof(std::int64_t))]] =
        std::int64_t;

/// Whether the processor has instructions for them; other families than x86 are not asked.
inline bool has_avx2() {
#ifdef __x86_64__
  return __builtin_cpu_supports("avx2") != 0;
#else
  return false;
#endif
}

/// Vectors, one in each lane.
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
/// In the order in which Eigen adds three numbers.
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

}  // namespace statejump::stepper
