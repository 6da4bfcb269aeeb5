// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "statejump/kernel/partial_slip_line.hpp"

namespace statejump::kernel {

/// Force of one partial_slip_step() in the plane, with derivatives. Implicit solvers evaluate it
/// for many end points before they accept a step.
struct PartialSlipPlane {
  Tangent force{};         ///< force on body 2 along the slide [N]
  Tangent by_slide_a{};    ///< derivative by the slide along the first tangent [N/m]; the matrix is
                           ///< symmetric
  Tangent by_slide_b{};    ///< derivative by the slide along the second tangent [N/m]
  Tangent by_stiffness{};  ///< derivative by 8 G* a at a fixed limit [m]
  Tangent by_limit{};      ///< derivative by mu F_N at a fixed stiffness [-]
  Tangent centre{};        ///< U of the innermost annulus, the last one to slip, if it stuck [m]
  double bound = 0.0;      ///< bound of |U| at the centre [m]
  int stuck = 0, slips = 0;  ///< numbers of sticking and slipping pieces: the law is smooth as long
                             ///< as they do not change
};

namespace detail {

using PlaneKnot = SlipKnot<Tangent>;

/// Sums the pieces in a plane.
class PlaneSum {
 public:
  PlaneSum(double edge, double slope, const Tangent& slide)
      : edge_(edge), slope_(slope), slide_(slide), smallest_(1e-15 * slope * edge * edge) {}

  void add_piece(const PlaneKnot& a, const PlaneKnot& b) {
    if (!(b.x > a.x)) return;
    if (sticks(a) && sticks(b)) {
      stick(a, b);
      return;
    }
    // Between a and b, |U| equals its bound where q0 + 2 q1 s + q2 s^2 = 0.
    const Tangent span = b.trial - a.trial;
    const double fall = b.bound - a.bound;
    const double q0 = a.trial.squared() - a.bound * a.bound;
    const double q1 = a.trial.dot(span) - a.bound * fall;
    const double q2 = span.squared() - fall * fall;
    const double root = std::sqrt(std::max(0.0, q1 * q1 - q0 * q2));
    const double far = -(q1 + std::copysign(root, q1));
    std::array<double, 4> cut{0.0, 1.0, 1.0, 1.0};
    std::size_t cuts = 1;
    for (const double s : {far / q2, q0 / far}) {
      if (s > 0.0 && s < 1.0) cut[cuts++] = s;
    }
    std::sort(cut.begin(), cut.end());
    for (std::size_t i = 0; i < cuts; ++i) {
      const PlaneKnot from = a.towards(b, cut[i]);
      const PlaneKnot to = a.towards(b, cut[i + 1]);
      if (!(to.x > from.x)) continue;
      if (sticks(a.towards(b, 0.5 * (cut[i] + cut[i + 1])))) {
        stick(from, to);
      } else {
        slip(from, to);
      }
    }
  }

  void finish(PartialSlipPlane& plane) const {
    plane.force = force_;
    plane.by_slide_a = {by_slide_[0], by_slide_[1]};
    plane.by_slide_b = {by_slide_[1], by_slide_[2]};
    plane.by_limit = 1.5 / (edge_ * edge_ * edge_) * by_slope_;
    plane.by_stiffness = by_edge_ - (3.0 * slope_ / edge_) * by_slope_;
    plane.stuck = stuck_;
    plane.slips = slips_;
  }

 private:
  bool sticks(const PlaneKnot& k) const {
    const double outer = k.bound + smallest_;
    return k.trial.squared() <= outer * outer;
  }

  void stick(const PlaneKnot& a, const PlaneKnot& b) {
    ++stuck_;
    const ProductWeights w(a.x, b.x);
    const double at_a = w.weight_aa + w.weight_ab;
    const double at_b = w.weight_bb + w.weight_ab;
    force_ = force_ + at_a * a.trial + at_b * b.trial;
    const double fraction = at_a * a.fraction + at_b * b.fraction;
    by_slide_[0] += fraction;
    by_slide_[2] += fraction;
    by_edge_ = by_edge_ + (at_a * a.by_growth + at_b * b.by_growth) * slide_;
  }

  /// Adds a piece that slips, whose annuli end at bound U/|U|. Gauss points in each of `parts`
  /// subintervals integrate it. The sum is continuous, and exact if the direction is constant.
  void slip(const PlaneKnot& a, const PlaneKnot& b) {
    constexpr int parts = 4;
    ++slips_;
    const double width = (b.x - a.x) / parts;
    for (int part = 0; part < parts; ++part) {
      for (std::size_t g = 0; g < 3; ++g) {
        const double moved = (part + gauss_point[g]) * width;
        const double s = moved * (2.0 * a.x + moved) / ((b.x - a.x) * (b.x + a.x));
        annulus(a.towards(b, s), gauss_weight[g] * width);
      }
    }
  }

  void annulus(const PlaneKnot& k, double weight) {
    const double size = k.trial.norm();
    const Tangent axis = (1.0 / size) * k.trial;
    force_ = force_ + (weight * k.bound) * axis;
    by_slope_ = by_slope_ + (weight * k.bound / slope_) * axis;
    by_edge_ = by_edge_ + (weight * slope_ * 2.0 * edge_) * axis;
    // A change of U perpendicular to U only rotates the force.
    const double turns = weight * k.bound / size;
    const Tangent across{-axis.b, axis.a};
    by_slide_[0] += turns * k.fraction * across.a * across.a;
    by_slide_[1] += turns * k.fraction * across.a * across.b;
    by_slide_[2] += turns * k.fraction * across.b * across.b;
    by_edge_ = by_edge_ + (turns * k.by_growth * slide_.dot(across)) * across;
  }

  double edge_, slope_;
  Tangent slide_;
  double smallest_;
  Tangent force_{}, by_slope_{}, by_edge_{};
  std::array<double, 3> by_slide_{};  // aa, ab, bb
  int stuck_ = 0, slips_ = 0;
};

}  // namespace detail

/// Force and derivatives at the end of a step in the plane. If the slip direction of a piece
/// changes, partial_slip_step() uses chords, and its force has jumps of 1e-4 of the limit. This
/// function integrates the piece instead. Along one direction it equals partial_slip_line().
/// @param stiffness, limit, memory as in partial_slip_line()
/// @param slide slide of body 1 relative to body 2 in the step [m]
inline PartialSlipPlane partial_slip_plane(double stiffness, double limit, const Tangent& slide,
                                           const PartialSlipMemory& memory) {
  PartialSlipPlane plane;
  if (!(stiffness > 0.0 && limit > 0.0)) return plane;
  const double slope = 1.5 * limit / (stiffness * stiffness * stiffness);
  detail::PlaneSum sum(stiffness, slope, slide);
  const detail::PlaneKnot centre = detail::add_pieces(
      stiffness, slope, slide, memory,
      [](const PartialSlipMemory::Point& point) { return point.u; }, sum);
  plane.centre = centre.trial;
  plane.bound = centre.bound;
  sum.finish(plane);
  return plane;
}

}  // namespace statejump::kernel
