// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>

namespace statejump::numerics {

/// The larger of a number and those before it, or one that is none, which has to show.
inline void raise(double& largest, double value) {
  if (!(value <= largest) && !std::isnan(largest)) largest = value;
}

}  // namespace statejump::numerics
