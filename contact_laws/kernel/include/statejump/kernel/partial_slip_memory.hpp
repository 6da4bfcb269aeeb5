// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "statejump/kernel/vector.hpp"

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
/// of straight pieces over x^2; see partial_slip_step().
///
/// A contact that is held moves nearly all of its rings alike. So the first points may be held():
/// they stay as they were written, and what they moved by since, their force and their energy are
/// kept beside them. Points, then, are moved all at once when somebody has to look at each.
class PartialSlipMemory {
 public:
  struct Point {
    double x;   ///< 8 G* r [N/m], r the radius of the ring
    Tangent u;  ///< elastic displacement of that ring [m]
  };
  /// What is known of the first points while they only move.
  struct Held {
    int count = 0;           ///< points; 0: none, and nothing else here is read
    Tangent shift{};         ///< by which they moved since they were written [m]
    Tangent force{};         ///< integral of U over x between them, as written [N]
    double squares = 0.0;    ///< integral of U^2 over x, as written [J]
    double at_centre = 0.0;  ///< a line over x^2 that |U| as written does not exceed, at x = 0 [m]
    double at_last = 0.0;    ///< at the last of them [m]
  };
  /// Points at most. A path of straight parts under few nested reversals needs two for each; a
  /// smooth curve under growing load is approximated by chords, see merged().
  static constexpr int capacity = 48;

  PartialSlipMemory() = default;
  /// Takes up what another gave by points(), slope(), merged() and held().
  PartialSlipMemory(std::vector<Vector3>&& points, double slope, double merged, const Held& held)
      : points_(std::move(points)), slope_(slope), merged_(merged), held_(held) {}

  int size() const { return static_cast<int>(points_.size()); }  ///< 0: no contact, or a new one
  Point operator[](int i) const {
    const Vector3& point = points_[static_cast<std::size_t>(i)];
    const Tangent u{point[1], point[2]};
    return {point[0], i < held_.count ? u + held_.shift : u};
  }
  /// Stiffness 8 G* a [N/m] of the contact that left this memory; 0: none.
  double edge() const { return points_.empty() ? 0.0 : points_.back()[0]; }
  /// Of the bound on |U| over x^2 [m^3/N^2].
  double slope() const { return slope_; }
  /// Sum of the changes of force by points that were merged since the contact began, each with its
  /// sign lost [N]: a bound on the error of the force.
  double merged() const { return merged_; }
  const Held& held() const { return held_; }
  /// Whether the energies of a step are asked for, which takes a third of its time.
  bool accounts() const { return accounts_; }
  void set_accounts(bool accounts) { accounts_ = accounts; }
  /// x [N/m] and both components of U [m]; those of points that are held as they were written.
  const std::vector<Vector3>& points() const { return points_; }
  /// The same, for whoever keeps them; the memory is empty then.
  std::vector<Vector3> take_points() {
    held_.count = 0;
    return std::exchange(points_, {});
  }

  void clear() { begin(0.0, 0.0); }
  /// Starts over without points.
  void begin(double slope, double merged) {
    points_.clear();
    slope_ = slope;
    merged_ = merged;
    held_.count = 0;
  }
  void push(const Point& point) { points_.emplace_back(point.x, point.u.a, point.u.b); }
  void append(const Point* points, int count) {
    const std::size_t first = points_.size();
    points_.resize(first + static_cast<std::size_t>(count));
    for (std::size_t j = first; j < points_.size(); ++j, ++points) {
      points_[j] = {points->x, points->u.a, points->u.b};
    }
  }
  /// Keeps the first points, their rings moved by a slide [m], and forgets the others.
  /// @param count not less than are held
  void keep(int count, const Tangent& slide, double slope, double merged) {
    if (held_.count > 0) held_.shift = held_.shift + slide;
    move(held_.count, count, slide);
    points_.resize(static_cast<std::size_t>(count));
    slope_ = slope;
    merged_ = merged;
  }

  /// Whether what is held can be moved by a slide and stays below a bound that is straight over
  /// x^2: [m] at x = 0 and at the last point that is held.
  bool holds(const Tangent& slide, double at_centre, double at_last) const {
    const double room = std::min(at_centre - held_.at_centre, at_last - held_.at_last);
    return held_.count > 0 && room >= 0.0 && (held_.shift + slide).squared() <= room * room;
  }
  /// Writes what is held to where it is now: nothing is held any more.
  void release() {
    move(0, held_.count, held_.shift);
    held_.count = 0;
  }
  /// Holds the first points, none of which is held yet.
  /// @param at_centre, at_last of a line over x^2 that is not exceeded by |U| [m]
  void hold(int count, double at_centre, double at_last);

 private:
  void move(int first, int end, const Tangent& slide) {
    for (auto j = static_cast<std::size_t>(first); j < static_cast<std::size_t>(end); ++j) {
      points_[j][1] += slide.a;
      points_[j][2] += slide.b;
    }
  }

  std::vector<Vector3> points_;
  double slope_ = 0.0;
  double merged_ = 0.0;
  Held held_;
  bool accounts_ = true;
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

/// What a point says that is left out.
struct LeftOut {
  double squared_offset;  ///< of the point from the chord of its neighbours [m^2]
  double x_a, x_b, x_c;   ///< of the point b and its neighbours [N/m]

  /// Change of force [N]: the triangle's height times the mean of its base over x, weights of the
  /// two pieces at b.
  double force() const {
    const double base = (x_b - x_a) * (2.0 * x_b + x_a) / (3.0 * (x_b + x_a)) +
                        (x_c - x_b) * (2.0 * x_c + x_b) / (3.0 * (x_c + x_b));
    return std::sqrt(squared_offset) * std::abs(base);
  }
  /// Whether force() is more than a limit >= 0, mostly without it: the base is at least half the
  /// distance of the neighbours.
  bool is_more_than(double limit) const {
    const double half = 0.5 * (1.0 - 1e-12) * (x_c - x_a);
    return squared_offset * (half * half) > limit * limit || force() > limit;
  }
};

/// When the point b between a and c is left out.
inline LeftOut left_out(const PartialSlipMemory::Point& a, const PartialSlipMemory::Point& b,
                        const PartialSlipMemory::Point& c) {
  const double share = (b.x - a.x) * (b.x + a.x) / ((c.x - a.x) * (c.x + a.x));
  const Tangent off = b.u - (a.u + share * (c.u - a.u));
  return {off.squared(), a.x, b.x, c.x};
}

/// Integrals over x of U [N] and of U^2 [J], by pieces.
struct SlipSums {
  Tangent force{};
  double squares = 0.0;

  /// With theta from 0 to 1, straight over x^2, a piece is U_a + theta (U_b - U_a); the integrals
  /// of theta and theta^2 over dx are those of Piece, d (1/2 - q/6) and d (1/3 - q/6 + q^2/30).
  /// @tparam both whether squares are wanted, too
  template <bool both>
  void add(const PartialSlipMemory::Point& a, const PartialSlipMemory::Point& b) {
    const double d = b.x - a.x;
    const double q = d / (b.x + a.x);
    const double sixth = q * (1.0 / 6.0);
    const double first = d * (0.5 - sixth);
    const Tangent rise = b.u - a.u;
    force = force + d * a.u + first * rise;
    if constexpr (!both) return;
    const double second = d * ((1.0 / 3.0) - sixth + q * q * (1.0 / 30.0));
    squares += a.u.squared() * d + a.u.dot(rise) * (2.0 * first) + rise.squared() * second;
  }
};

/// Of all that a memory remembers.
template <bool both>
SlipSums sums_of(const PartialSlipMemory& memory) {
  SlipSums sums;
  int first = 0;
  const PartialSlipMemory::Held& held = memory.held();
  if (held.count > 0) {
    first = held.count - 1;
    const double width = memory[first].x - memory[0].x;
    sums.force = held.force + width * held.shift;
    sums.squares = held.squares + 2.0 * held.shift.dot(held.force) + width * held.shift.squared();
  }
  if (memory.size() == 0) return sums;
  PartialSlipMemory::Point last = memory[first];
  for (int i = first + 1; i < memory.size(); ++i) {
    const PartialSlipMemory::Point next = memory[i];
    sums.add<both>(last, next);
    last = next;
  }
  return sums;
}

inline double elastic(const SlipSums& sums) {
  return std::max(0.0, 0.5 * sums.squares);
}

/// Force and energy that a memory holds, with what the step adds.
inline PartialSlipResponse answer(const PartialSlipMemory& memory, double loss, bool slipping) {
  if (!memory.accounts()) return {sums_of<false>(memory).force, 0.0, 0.0, slipping};
  const SlipSums sums = sums_of<true>(memory);
  return {sums.force, elastic(sums), loss, slipping};
}

}  // namespace detail

inline void PartialSlipMemory::hold(int count, double at_centre, double at_last) {
  detail::SlipSums sums;
  for (int i = 0; i + 1 < count; ++i) sums.add<true>((*this)[i], (*this)[i + 1]);
  held_ = {count, {}, sums.force, sums.squares, at_centre, at_last};
}

/// Energy [J] of the tangential traction that a memory holds.
inline double elastic_energy(const PartialSlipMemory& memory) {
  return detail::elastic(detail::sums_of<true>(memory));
}

}  // namespace statejump::kernel
