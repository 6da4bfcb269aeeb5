// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>

namespace statejump::numerics {

/// Sets `largest` to the maximum of both arguments, or to NaN if either is NaN.
inline void raise(double& largest, double value) {
  if (!(value <= largest) && !std::isnan(largest)) largest = value;
}

}  // namespace statejump::numerics
