// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

#include "statejump/kernel/partial_slip_memory.hpp"

namespace statejump::kernel::detail {

/// A ring in a step, along the direction in which it slips.
struct Ring {
  double start;          ///< U before the step [m]
  double slide;          ///< of the two bodies while the ring touches [m]
  double before, after;  ///< bounds on U when it begins to touch and when it ends [m]

  double change() const { return after - before; }
  double stick() const { return std::max(0.0, before - start); }  ///< until the bound is met
  double speed() const { return slide - change(); }               ///< towards the bound
  double slip() const { return std::max(0.0, start + slide - after); }
  /// Loss per unit of x: the mean bound while the ring slips, times its slip.
  double loss() const {
    const double sticks = stick();
    const double met = sticks > 0.0 ? before + change() * std::min(1.0, sticks / speed()) : before;
    return 0.5 * (met + after) * slip();
  }
};

/// Gauss' three points on [0, 1]: exact to the fifth power.
inline constexpr std::array<double, 3> gauss_point{0.1127016653792583, 0.5, 0.8872983346207417};
inline constexpr std::array<double, 3> gauss_weight{5.0 / 18.0, 8.0 / 18.0, 5.0 / 18.0};

/// Loss of a piece that slips in one direction. What Ring holds is straight over x^2 between its
/// ends; the loss is a polynomial unless rings that stick first meet a bound that moves.
inline double loss(double xa, const Ring& a, double xb, const Ring& b) {
  const bool moves = a.change() != 0.0 || b.change() != 0.0;
  if (!moves || (a.stick() == 0.0 && b.stick() == 0.0)) {
    const Piece w(xa, xb);
    const double mean_a = 0.5 * (a.before + a.after);
    const double mean_b = 0.5 * (b.before + b.after);
    return w.both_at_a * mean_a * a.slip() + w.both_at_b * mean_b * b.slip() +
           w.one_each * (mean_a * b.slip() + mean_b * a.slip());
  }
  const double scale = 1.0 / (xb + xa);
  double sum = 0.0;
  for (std::size_t g = 0; g < 3; ++g) {
    const double step = gauss_point[g] * (xb - xa);
    const double s = gauss_point[g] * (2.0 * xa + step) * scale;
    const Ring ring{a.start + s * (b.start - a.start), a.slide + s * (b.slide - a.slide),
                    a.before + s * (b.before - a.before), a.after + s * (b.after - a.after)};
    sum += gauss_weight[g] * ring.loss();
  }
  return sum * (xb - xa);
}

}  // namespace statejump::kernel::detail
