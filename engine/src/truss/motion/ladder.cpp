// SPDX-License-Identifier: GPL-3.0-or-later
#include "ladder.hpp"

#include <algorithm>
#include <cmath>

namespace statejump::truss::detail {

Ladder::Ladder(int level, int most_halvings)
    : most_(most_halvings), level_(std::min(level, most_halvings)) {}

double Ladder::to() const {
  return std::ldexp(static_cast<double>(at_ + step()), -most_);
}

double Ladder::length() const {
  return std::ldexp(1.0, -level_);
}

void Ladder::accept(bool longer) {
  at_ += step();
  if (longer && level_ > 0 && at_ % (2 * step()) == 0) --level_;
}

void Ladder::shorten(int halvings) {
  level_ = std::min(level_ + halvings, most_);
}

}  // namespace statejump::truss::detail
