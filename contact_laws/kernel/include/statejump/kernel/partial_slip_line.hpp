// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "statejump/kernel/partial_slip.hpp"

namespace statejump::kernel {

/// Force of one partial_slip_step() along a line, with derivatives. Implicit solvers evaluate it
/// for many end points before they accept a step.
struct PartialSlipLine {
  double force = 0.0;         ///< force on body 2 along the slide [N]
  double by_slide = 0.0;      ///< derivative by the slide [N/m], from 0 (all annuli slip) to the
                              ///< stiffness (none slips)
  double by_stiffness = 0.0;  ///< derivative by 8 G* a at a fixed limit [m]
  double by_limit = 0.0;      ///< derivative by mu F_N at a fixed stiffness [-]
  double centre = 0.0;        ///< U of the innermost annulus, the last one to slip, if it stuck [m]
  double bound =
      0.0;  ///< bound of U there, the last annulus to slip, in the direction of `centre` [m]
  /// Numbers of pieces that stick, slip in plus and slip in minus direction. The law is smooth
  /// while these numbers do not change.
  int stuck = 0, plus = 0, minus = 0;
};

namespace detail {

/// End of a piece over which all functions are linear in x^2. The displacement U has one or two
/// components.
template <class Displacement>
struct SlipKnot {
  double x;
  Displacement trial;  ///< U if the annulus sticks [m]
  double bound;        ///< on |U| [m]
  double fraction;     ///< fraction of the slide during which the annulus is in contact
  double by_growth;    ///< derivative of that fraction by the stiffness of the contact's edge [m/N]

  SlipKnot towards(const SlipKnot& b, double s) const {
    const auto mix = [s](double from, double to) { return from + s * (to - from); };
    return {std::sqrt(mix(x * x, b.x * b.x)), trial + s * (b.trial - trial), mix(bound, b.bound),
            mix(fraction, b.fraction), mix(by_growth, b.by_growth)};
  }
};
using LineKnot = SlipKnot<double>;

/// Adds the integrals of all intervals between knots at the end of a step to `sum`, from the centre
/// to the edge. The function `of` returns the displacement of a memory point.
/// @return the knot at the centre
template <class Displacement, class Of, class Sum>
SlipKnot<Displacement> add_pieces(double edge, double slope, const Displacement& slide,
                                  const PartialSlipMemory& memory, Of&& of, Sum& sum) {
  using Knot = SlipKnot<Displacement>;
  const double old_edge = memory.edge();
  const auto knot = [&](double x, const Displacement& start, double fraction, double by_growth) {
    return Knot{x, start + fraction * slide, slope * (edge - x) * (edge + x), fraction, by_growth};
  };
  const Knot centre = knot(0.0, memory.size() > 0 ? of(memory[0]) : Displacement{}, 1.0, 0.0);
  Knot last = centre;
  for (int i = 1; i < memory.size(); ++i) {
    const Knot next = knot(memory[i].x, of(memory[i]), 1.0, 0.0);
    if (next.x >= edge) {
      const double fraction =
          (edge - last.x) * (edge + last.x) / ((next.x - last.x) * (next.x + last.x));
      Knot end = last.towards(next, fraction);
      end.x = edge;
      end.bound = 0.0;
      sum.add_piece(last, end);
      break;
    }
    sum.add_piece(last, next);
    last = next;
  }
  if (edge > old_edge) {
    const double grown = (edge - old_edge) * (edge + old_edge);
    sum.add_piece(last, knot(edge, Displacement{}, 0.0, 2.0 * edge / grown));
  }
  return centre;
}

/// Sums the pieces along a line.
class LineSum {
 public:
  LineSum(double edge, double slope, double slide)
      : edge_(edge), slope_(slope), slide_(slide), smallest_(1e-15 * slope * edge * edge) {}

  void add_piece(const LineKnot& a, const LineKnot& b) {
    if (!(b.x > a.x)) return;
    if (sticks(a) && sticks(b)) {
      add(a, b, 0.0);
      return;
    }
    // cut the piece where the trial displacement reaches either bound
    std::array<double, 4> cut{0.0, 1.0, 1.0, 1.0};
    std::size_t cuts = 1;
    for (const double sign : {1.0, -1.0}) {
      const double at_a = a.trial - sign * a.bound;
      const double at_b = b.trial - sign * b.bound;
      if (at_a * at_b < 0.0) cut[cuts++] = at_a / (at_a - at_b);
    }
    std::sort(cut.begin(), cut.end());
    for (std::size_t i = 0; i < cuts; ++i) {
      const LineKnot from = a.towards(b, cut[i]);
      const LineKnot to = a.towards(b, cut[i + 1]);
      const LineKnot middle = a.towards(b, 0.5 * (cut[i] + cut[i + 1]));
      add(from, to, sticks(middle) ? 0.0 : std::copysign(1.0, middle.trial));
    }
  }

  void finish(PartialSlipLine& line) const {
    line.force = force_;
    line.stuck = stuck_;
    line.plus = plus_;
    line.minus = minus_;
    line.by_slide = by_slide_;
    line.by_limit = by_slope_ * 1.5 / (edge_ * edge_ * edge_);
    line.by_stiffness = by_edge_ - 3.0 * slope_ / edge_ * by_slope_;
  }

 private:
  bool sticks(const LineKnot& k) const { return std::abs(k.trial) <= k.bound + smallest_; }

  /// @param sense slip direction of the piece, +1 or -1, or 0 if it sticks
  void add(const LineKnot& a, const LineKnot& b, double sense) {
    const ProductWeights w(a.x, b.x);
    const auto integral = [&](double at_a, double at_b) {
      return (w.weight_aa + w.weight_ab) * at_a + (w.weight_bb + w.weight_ab) * at_b;
    };
    if (sense == 0.0) {
      ++stuck_;
      force_ += integral(a.trial, b.trial);
      by_slide_ += integral(a.fraction, b.fraction);
      by_edge_ += slide_ * integral(a.by_growth, b.by_growth);
      return;
    }
    ++(sense > 0.0 ? plus_ : minus_);
    const double slips = sense * integral(a.bound, b.bound);
    force_ += slips;
    by_slope_ += slips / slope_;
    by_edge_ += sense * slope_ * 2.0 * edge_ * (b.x - a.x);
  }

  double edge_, slope_, slide_, smallest_;
  double force_ = 0.0, by_slide_ = 0.0, by_slope_ = 0.0, by_edge_ = 0.0;
  int stuck_ = 0, plus_ = 0, minus_ = 0;
};

}  // namespace detail

/// Force and derivatives at the end of a step along one direction. The force equals that of
/// partial_slip_step() up to rounding and merged points. An annulus that just reaches its bound
/// counts as sticking in the derivatives. A contact that neither grows nor shrinks has the
/// derivatives of a shrinking one.
///
/// Derivation. T = integral of U dx over the annuli. U = start + slide where an annulus sticks, and
/// U is the bound 3/2 limit/k^3 (k^2 - x^2) where it slips. U is continuous and 0 at the edge, so
/// the derivative of T contains only dU, no boundary terms. If the contact grows from an edge e, a
/// new annulus x takes part in the fraction (k^2 - x^2)/(k^2 - e^2) of the slide.
///
/// @param stiffness 8 G* a at the end of the step [N/m]; <= 0 means no contact, all results are 0
/// @param limit mu F_N at the end of the step [N]; <= 0 gives zeros
/// @param slide slide of body 1 relative to body 2 in the step, along the first tangent [m]
/// @param memory memory at the start of the step; displacements perpendicular to the slide are
///     ignored
inline PartialSlipLine partial_slip_line(double stiffness, double limit, double slide,
                                         const PartialSlipMemory& memory) {
  PartialSlipLine line;
  if (!(stiffness > 0.0 && limit > 0.0)) return line;
  const double slope = 1.5 * limit / (stiffness * stiffness * stiffness);
  detail::LineSum sum(stiffness, slope, slide);
  const detail::LineKnot centre = detail::add_pieces(
      stiffness, slope, slide, memory,
      [](const PartialSlipMemory::Point& point) { return point.u.a; }, sum);
  line.centre = centre.trial;
  line.bound = centre.bound;
  sum.finish(line);
  return line;
}

}  // namespace statejump::kernel
