// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

#include "statejump/kernel/partial_slip_memory.hpp"

namespace statejump::kernel::detail {

/// Quantities of one annulus in a step. Displacements are components along its slip direction.
struct SlipAnnulus {
  double start;          ///< U before the step [m]
  double slide;          ///< of the two bodies while the annulus is in contact [m]
  double before, after;  ///< bounds on U at first contact and at the end of the step [m]

  double change() const { return after - before; }
  double stick() const { return std::max(0.0, before - start); }  ///< slide until slip
  double speed() const { return slide - change(); }  ///< rate at which U approaches the bound
  double slip() const { return std::max(0.0, start + slide - after); }
  /// Loss per unit of x: the slip times the mean of the bound during slip.
  double loss() const {
    const double sticks = stick();
    const double met = sticks > 0.0 ? before + change() * std::min(1.0, sticks / speed()) : before;
    return 0.5 * (met + after) * slip();
  }
};

/// Three-point Gauss rule on [0, 1], exact for polynomials of degree five.
inline constexpr std::array<double, 3> gauss_point{0.1127016653792583, 0.5, 0.8872983346207417};
inline constexpr std::array<double, 3> gauss_weight{5.0 / 18.0, 8.0 / 18.0, 5.0 / 18.0};

/// Loss [J] of a piece that slips in one direction. Between its ends, the members of SlipAnnulus
/// are linear in x^2. So the loss is a polynomial and the Gauss rule is exact, unless annuli stick
/// until they reach a moving bound.
inline double loss(double xa, const SlipAnnulus& a, double xb, const SlipAnnulus& b) {
  const bool moves = a.change() != 0.0 || b.change() != 0.0;
  if (!moves || (a.stick() == 0.0 && b.stick() == 0.0)) {
    const ProductWeights w(xa, xb);
    const double mean_a = 0.5 * (a.before + a.after);
    const double mean_b = 0.5 * (b.before + b.after);
    return w.weight_aa * mean_a * a.slip() + w.weight_bb * mean_b * b.slip() +
           w.weight_ab * (mean_a * b.slip() + mean_b * a.slip());
  }
  const double scale = 1.0 / (xb + xa);
  double sum = 0.0;
  for (std::size_t g = 0; g < 3; ++g) {
    const double step = gauss_point[g] * (xb - xa);
    const double s = gauss_point[g] * (2.0 * xa + step) * scale;
    const SlipAnnulus annulus{a.start + s * (b.start - a.start), a.slide + s * (b.slide - a.slide),
                              a.before + s * (b.before - a.before),
                              a.after + s * (b.after - a.after)};
    sum += gauss_weight[g] * annulus.loss();
  }
  return sum * (xb - xa);
}

}  // namespace statejump::kernel::detail
