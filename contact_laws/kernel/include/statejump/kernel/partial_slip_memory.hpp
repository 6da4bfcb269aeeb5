// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

namespace statejump::kernel {

/// A vector in the tangent plane of a contact.
struct Tangent {
  double a, b;
  friend Tangent operator+(const Tangent& l, const Tangent& r) { return {l.a + r.a, l.b + r.b}; }
  friend Tangent operator-(const Tangent& l, const Tangent& r) { return {l.a - r.a, l.b - r.b}; }
  friend Tangent operator*(double s, const Tangent& v) { return {s * v.a, s * v.b}; }
  double dot(const Tangent& v) const { return a * v.a + b * v.b; }
  double squared() const { return a * a + b * b; }
  double norm() const { return std::sqrt(squared()); }
};

/// What a contact with partial slip remembers: the elastic displacement U of its rings, as a line
/// of straight pieces over x^2; see partial_slip_step(). Copying it costs what it holds. A step
/// looks at every point and changes few: coordinates lie in rows of their own, so that several
/// points are looked at in one instruction.
class PartialSlipMemory {
 public:
  struct Point {
    double x;   ///< 8 G* r [N/m], r the radius of the ring
    Tangent u;  ///< elastic displacement of that ring [m]
  };
  /// Points at most. A path of straight parts under few nested reversals needs two for each; a
  /// smooth curve under growing load is approximated by chords, see merged().
  static constexpr int capacity = 48;
  using Coordinates = std::array<double, static_cast<std::size_t>(capacity)>;

  PartialSlipMemory() {}  // NOLINT(modernize-use-equals-default): the points stay as they are
  PartialSlipMemory(const PartialSlipMemory& other) { *this = other; }
  PartialSlipMemory& operator=(const PartialSlipMemory& other) {
    fill(other.size_, other.slope_, other.merged_, [&](int i) { return other[i]; });
    return *this;
  }

  int size() const { return size_; }  ///< 0: no contact, or a new one
  Point operator[](int i) const {
    const auto j = static_cast<std::size_t>(i);
    return {x_[j], {a_[j], b_[j]}};
  }
  /// Stiffness 8 G* a [N/m] of the contact that left this memory; 0: none.
  double edge() const { return size_ > 0 ? (*this)[size_ - 1].x : 0.0; }
  /// Of the bound on |U| over x^2 [m^3/N^2].
  double slope() const { return slope_; }
  /// Sum of the changes of force by points that were merged since the contact began, each with its
  /// sign lost [N]: a bound on the error of the force.
  double merged() const { return merged_; }
  /// Of all points: x [N/m] and both components of U [m].
  const double* x() const { return x_.data(); }
  const double* a() const { return a_.data(); }
  const double* b() const { return b_.data(); }

  void clear() { begin(0.0, 0.0); }
  /// Starts over with values that memory() of another contact gave.
  void begin(double slope, double merged) { keep(0, {}, slope, merged); }
  void push(const Point& point) {
    const auto j = static_cast<std::size_t>(size_++);
    x_[j] = point.x;
    a_[j] = point.u.a;
    b_[j] = point.u.b;
  }
  /// Starts over with points point_at(0), point_at(1), ... @param count at most the capacity
  template <class PointAt>
  void fill(int count, double slope, double merged, const PointAt& point_at) {
    begin(slope, merged);
    for (int i = 0; i < count; ++i) {
      const auto j = static_cast<std::size_t>(i);
      const Point point = point_at(i);
      x_[j] = point.x;
      a_[j] = point.u.a;
      b_[j] = point.u.b;
    }
    size_ = count;
  }
  /// Keeps the first points, their rings moved by a slide [m], and forgets the others.
  void keep(int count, const Tangent& slide, double slope, double merged) {
    for (std::size_t j = 0; j < static_cast<std::size_t>(count); ++j) {
      a_[j] += slide.a;
      b_[j] += slide.b;
    }
    size_ = count;
    slope_ = slope;
    merged_ = merged;
  }

 private:
  int size_ = 0;
  double slope_ = 0.0;
  double merged_ = 0.0;
  Coordinates x_, a_, b_;
};

/// What one step of the contact with partial slip answers.
struct PartialSlipResponse {
  Tangent force;       ///< of the contact, positive along the slide that causes it [N]
  double elastic;      ///< energy of the tangential traction [J], >= 0
  double dissipation;  ///< friction loss of this step [J], >= 0
  bool slipping;       ///< no ring sticks
};

namespace detail {

/// Integrals over dx of products of two functions that are straight over x^2, from xa to xb.
struct Piece {
  double both_at_a, one_each, both_at_b;  ///< weights of f_a g_a, f_a g_b and f_b g_a, f_b g_b
  Piece(double xa, double xb) {
    const double d = xb - xa;
    const double q = d / (xb + xa);
    const double p = 1.0 - q;
    both_at_b = d * (p * p / 3.0 + 0.5 * p * q + 0.2 * q * q);
    one_each = d * (0.5 * p + q / 3.0) - both_at_b;
    both_at_a = d * q / 3.0 + both_at_b;
  }
};

/// Change of the force when the point b between a and c is left out [N].
inline double left_out(const PartialSlipMemory::Point& a, const PartialSlipMemory::Point& b,
                       const PartialSlipMemory::Point& c) {
  const double share = (b.x - a.x) * (b.x + a.x) / ((c.x - a.x) * (c.x + a.x));
  const Tangent off = b.u - (a.u + share * (c.u - a.u));
  // the triangle's height times the mean of its base over x: weights of the two pieces at b
  const double base = (b.x - a.x) * (2.0 * b.x + a.x) / (3.0 * (b.x + a.x)) +
                      (c.x - b.x) * (2.0 * c.x + b.x) / (3.0 * (c.x + b.x));
  return off.norm() * std::abs(base);
}

/// Force and energy that a memory holds, with what the step adds. With theta from 0 to 1, straight
/// over x^2, a piece is U_a + theta (U_b - U_a); the integrals of theta and theta^2 over dx are
/// those of Piece, d (1/2 - q/6) and d (1/3 - q/6 + q^2/30). Values of all pieces first, then their
/// sums, so that a compiler takes several at once.
inline PartialSlipResponse answer(const PartialSlipMemory& memory, double loss, bool slipping) {
  const std::size_t pieces = memory.size() > 0 ? static_cast<std::size_t>(memory.size()) - 1 : 0;
  const double* const x = memory.x();
  const double* const a = memory.a();
  const double* const b = memory.b();
  constexpr std::size_t lanes = 4;
  PartialSlipMemory::Coordinates force_a, force_b, squares;
  for (std::size_t i = 0; i < pieces; ++i) {
    const double d = x[i + 1] - x[i];
    const double q = d / (x[i + 1] + x[i]);
    const double sixth = q * (1.0 / 6.0);
    const double first = d * (0.5 - sixth);
    const double second = d * ((1.0 / 3.0) - sixth + q * q * (1.0 / 30.0));
    const double rise_a = a[i + 1] - a[i];
    const double rise_b = b[i + 1] - b[i];
    force_a[i] = a[i] * d + rise_a * first;
    force_b[i] = b[i] * d + rise_b * first;
    squares[i] = (a[i] * a[i] + b[i] * b[i]) * d + (a[i] * rise_a + b[i] * rise_b) * (2.0 * first) +
                 (rise_a * rise_a + rise_b * rise_b) * second;
  }
  const auto sum = [&](const PartialSlipMemory::Coordinates& values) {
    std::array<double, lanes> part{};
    std::size_t i = 0;
    for (; i + lanes <= pieces; i += lanes) {
      for (std::size_t l = 0; l < lanes; ++l) part[l] += values[i + l];
    }
    for (; i < pieces; ++i) part[0] += values[i];
    return (part[0] + part[1]) + (part[2] + part[3]);
  };
  return {{sum(force_a), sum(force_b)}, 0.5 * sum(squares), loss, slipping};
}

}  // namespace detail

/// Energy [J] of the tangential traction that a memory holds.
inline double elastic_energy(const PartialSlipMemory& memory) {
  return detail::answer(memory, 0.0, false).elastic;
}

}  // namespace statejump::kernel
