// SPDX-License-Identifier: GPL-3.0-or-later
#include "dyadic_step_size.hpp"

#include <algorithm>
#include <cmath>

namespace statejump::truss::detail {

DyadicStepSize::DyadicStepSize(int level, int most_halvings)
    : most_(most_halvings), level_(std::min(level, most_halvings)) {}

double DyadicStepSize::to() const {
  return std::ldexp(static_cast<double>(at_ + step()), -most_);
}

double DyadicStepSize::length() const {
  return std::ldexp(1.0, -level_);
}

void DyadicStepSize::accept(bool longer) {
  at_ += step();
  if (longer && level_ > 0 && at_ % (2 * step()) == 0) --level_;
}

void DyadicStepSize::shorten(int halvings) {
  level_ = std::min(level_ + halvings, most_);
}

}  // namespace statejump::truss::detail
