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

/// Memory of a contact with partial slip: the elastic displacement U of its annuli, piecewise
/// linear in x^2; see partial_slip_step().
///
/// In a sticking contact nearly all annuli move equally. So the first points may form a
/// ShiftedPrefix, whose common shift, force and energy are stored separately while the stored
/// values of its points stay unchanged. A step then needs no pass over these points.
class PartialSlipMemory {
 public:
  struct Point {
    double x;   ///< 8 G* r [N/m], r the radius of the annulus
    Tangent u;  ///< elastic displacement of that annulus [m]
  };
  /// Data of the first points while they only move by a common shift.
  struct ShiftedPrefix {
    int count = 0;           ///< number of points; 0: none, the other members are not used
    Tangent shift{};         ///< displacement common to all points since they were stored [m]
    Tangent force{};         ///< integral of U over x between them, with the stored U [N]
    double squares = 0.0;    ///< integral of U^2 over x, with the stored U [J]
    double at_centre = 0.0;  ///< upper bound of the stored |U|, linear in x^2: value at x = 0 [m]
    double at_last = 0.0;    ///< value of that upper bound at the last point of the prefix [m]
  };
  /// Largest number of points. A path of straight parts with nested reversals needs two points per
  /// reversal. Chords approximate a smooth curve under growing load, see merged().
  static constexpr int capacity = 48;

  PartialSlipMemory() = default;
  /// Restores a memory from points(), slope(), merged() and prefix().
  PartialSlipMemory(std::vector<Vector3>&& points, double slope, double merged,
                    const ShiftedPrefix& prefix)
      : points_(std::move(points)), slope_(slope), merged_(merged), prefix_(prefix) {}

  int size() const { return static_cast<int>(points_.size()); }  ///< 0: no contact, or a new one
  Point operator[](int i) const {
    const Vector3& point = points_[static_cast<std::size_t>(i)];
    const Tangent u{point[1], point[2]};
    return {point[0], i < prefix_.count ? u + prefix_.shift : u};
  }
  /// Stiffness 8 G* a [N/m] of the contact at its last step; 0 without contact.
  double edge() const { return points_.empty() ? 0.0 : points_.back()[0]; }
  /// Slope of the bound on |U| with respect to x^2 [m^3/N^2].
  double slope() const { return slope_; }
  /// Sum of the absolute force changes [N] due to merged points since the contact began. It is an
  /// upper bound of the force error.
  double merged() const { return merged_; }
  const ShiftedPrefix& prefix() const { return prefix_; }
  /// Returns whether steps compute energies, which takes a third of their time.
  bool tracks_energy() const { return tracks_energy_; }
  void set_tracks_energy(bool tracks_energy) { tracks_energy_ = tracks_energy; }
  /// Each point holds x [N/m] and both components of U [m]. Points of the prefix do not include its
  /// shift.
  const std::vector<Vector3>& points() const { return points_; }
  /// Moves the points out; the memory is then empty.
  std::vector<Vector3> take_points() {
    prefix_.count = 0;
    return std::exchange(points_, {});
  }

  void clear() { begin(0.0, 0.0); }
  /// Removes all points and starts again.
  void begin(double slope, double merged) {
    points_.clear();
    slope_ = slope;
    merged_ = merged;
    prefix_.count = 0;
  }
  void push(const Point& point) { points_.emplace_back(point.x, point.u.a, point.u.b); }
  void append(const Point* points, int count) {
    const std::size_t first = points_.size();
    points_.resize(first + static_cast<std::size_t>(count));
    for (std::size_t j = first; j < points_.size(); ++j, ++points) {
      points_[j] = {points->x, points->u.a, points->u.b};
    }
  }
  /// Keeps the first `count` points, displaced by a slide [m], and removes the others.
  /// @param count at least the number of points in the prefix
  void keep(int count, const Tangent& slide, double slope, double merged) {
    if (prefix_.count > 0) prefix_.shift = prefix_.shift + slide;
    move(prefix_.count, count, slide);
    points_.resize(static_cast<std::size_t>(count));
    slope_ = slope;
    merged_ = merged;
  }

  /// Returns whether all points of the prefix stay within a bound after a slide. The bound is
  /// linear in x^2; its values at x = 0 and at the last point of the prefix are given [m].
  bool prefix_fits(const Tangent& slide, double at_centre, double at_last) const {
    const double room = std::min(at_centre - prefix_.at_centre, at_last - prefix_.at_last);
    return prefix_.count > 0 && room >= 0.0 && (prefix_.shift + slide).squared() <= room * room;
  }
  /// Adds the shift to the points of the prefix and empties the prefix.
  void flush_prefix() {
    move(0, prefix_.count, prefix_.shift);
    prefix_.count = 0;
  }
  /// Makes the first `count` points the prefix, which must be empty.
  /// @param at_centre, at_last upper bound of |U|, linear in x^2, at the centre and the last point
  ///     [m]
  void set_prefix(int count, double at_centre, double at_last);

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
  ShiftedPrefix prefix_;
  bool tracks_energy_ = true;
};

/// Result of one step of the contact with partial slip.
struct PartialSlipResponse {
  Tangent force;       ///< on body 2, along the slide that causes it [N]
  double elastic;      ///< energy of the tangential traction [J], >= 0
  double dissipation;  ///< friction loss of this step [J], >= 0
  bool slipping;       ///< no annulus sticks
};

namespace detail {

/// Weights for the integral over x of f g from xa to xb, where f and g are linear in x^2.
struct ProductWeights {
  double weight_aa, weight_ab, weight_bb;  ///< for f_a g_a; for f_a g_b and f_b g_a; for f_b g_b
  ProductWeights(double xa, double xb) {
    const double d = xb - xa;
    const double q = d / (xb + xa);
    const double p = 1.0 - q;
    weight_bb = d * (p * p / 3.0 + 0.5 * p * q + 0.2 * q * q);
    weight_ab = d * (0.5 * p + q / 3.0) - weight_bb;
    weight_aa = d * q / 3.0 + weight_bb;
  }
};

/// Effect of removing a memory point b between its neighbours a and c.
struct PointRemoval {
  double squared_offset;  ///< squared distance of the point from the chord a c [m^2]
  double x_a, x_b, x_c;   ///< of the point b and its neighbours [N/m]

  /// Change of force [N]: the offset times the mean base of the triangle over x. The mean uses the
  /// weights of the two pieces at b.
  double force() const {
    const double base = (x_b - x_a) * (2.0 * x_b + x_a) / (3.0 * (x_b + x_a)) +
                        (x_c - x_b) * (2.0 * x_c + x_b) / (3.0 * (x_c + x_b));
    return std::sqrt(squared_offset) * std::abs(base);
  }
  /// Returns whether force() exceeds a limit >= 0. It rarely evaluates force(), because the base is
  /// at least half the distance between the neighbours.
  bool exceeds(double limit) const {
    const double half = 0.5 * (1.0 - 1e-12) * (x_c - x_a);
    return squared_offset * (half * half) > limit * limit || force() > limit;
  }
};

/// Effect of removing the point b between a and c.
inline PointRemoval point_removal(const PartialSlipMemory::Point& a,
                                  const PartialSlipMemory::Point& b,
                                  const PartialSlipMemory::Point& c) {
  const double fraction = (b.x - a.x) * (b.x + a.x) / ((c.x - a.x) * (c.x + a.x));
  const Tangent off = b.u - (a.u + fraction * (c.u - a.u));
  return {off.squared(), a.x, b.x, c.x};
}

/// Integrals of U [N] and of U^2 [J] over x, summed over the pieces.
struct SlipSums {
  Tangent force{};
  double squares = 0.0;

  /// On a piece, U = U_a + theta (U_b - U_a), where theta from 0 to 1 is linear in x^2. The
  /// integrals of theta and theta^2 over dx follow from ProductWeights: d (1/2 - q/6) and d (1/3 -
  /// q/6 + q^2/30).
  /// @tparam both whether the squares are computed as well
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

/// Integrals over all points of a memory.
template <bool both>
SlipSums sums_of(const PartialSlipMemory& memory) {
  SlipSums sums;
  int first = 0;
  const PartialSlipMemory::ShiftedPrefix& prefix = memory.prefix();
  if (prefix.count > 0) {
    first = prefix.count - 1;
    const double width = memory[first].x - memory[0].x;
    sums.force = prefix.force + width * prefix.shift;
    sums.squares =
        prefix.squares + 2.0 * prefix.shift.dot(prefix.force) + width * prefix.shift.squared();
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

/// Force and energy of a memory after a step, together with the given loss.
inline PartialSlipResponse response_of(const PartialSlipMemory& memory, double loss,
                                       bool slipping) {
  if (!memory.tracks_energy()) return {sums_of<false>(memory).force, 0.0, 0.0, slipping};
  const SlipSums sums = sums_of<true>(memory);
  return {sums.force, elastic(sums), loss, slipping};
}

}  // namespace detail

inline void PartialSlipMemory::set_prefix(int count, double at_centre, double at_last) {
  detail::SlipSums sums;
  for (int i = 0; i + 1 < count; ++i) sums.add<true>((*this)[i], (*this)[i + 1]);
  prefix_ = {count, {}, sums.force, sums.squares, at_centre, at_last};
}

/// Energy [J] of the tangential traction of a memory.
inline double elastic_energy(const PartialSlipMemory& memory) {
  return detail::elastic(detail::sums_of<true>(memory));
}

}  // namespace statejump::kernel
