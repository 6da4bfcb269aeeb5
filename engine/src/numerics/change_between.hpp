// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <boost/math/tools/roots.hpp>
#include <cmath>
#include <cstdint>
#include <stdexcept>

namespace statejump::numerics {

/// Interval in which a condition changes: the last point found false, and the first found true.
struct Change {
  double before;
  double after;
};

/// Sixty halvings reduce an interval to this fraction, below the rounding of quantities measured
/// over it.
constexpr double fine = 0x1p-60;

/// Bisects between `before`, where a condition is false, and `after`, where it is true. It ends
/// when both points are neighbouring numbers, or at most `tolerance` apart. `after` may be smaller
/// than `before`. Uses Boost.Math's bisection with at most 200 halvings; they suffice for every
/// root that is larger than 1e-60 of the interval.
/// @param holds condition(x); not evaluated at the ends
/// @param tolerance in the unit of `before` and `after`; 0: ends at neighbouring numbers
/// @throws std::logic_error if `before` or `after` is not finite
template <class Condition>
Change change_between(double before, double after, Condition&& holds, double tolerance = 0.0) {
  if (before == after) return {before, after};
  if (!(std::isfinite(before) && std::isfinite(after))) {
    throw std::logic_error("no interval in which a condition could change");
  }
  const auto side = [&](double x) {
    const bool beyond = x == after || (x != before && holds(x));
    return beyond ? 1.0 : -1.0;
  };
  std::uintmax_t most = 203;  // three of them at the ends
  const auto found = boost::math::tools::bisect(
      side, std::min(before, after), std::max(before, after),
      [tolerance](double a, double b) { return std::abs(b - a) <= tolerance; }, most);
  return before < after ? Change{found.first, found.second} : Change{found.second, found.first};
}

}  // namespace statejump::numerics
