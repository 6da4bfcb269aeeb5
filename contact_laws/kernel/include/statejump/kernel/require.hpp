// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdio>
#include <stdexcept>
#include <string>

namespace statejump::kernel {

/// Refuses an argument out of range.
/// @param holds the condition; nothing happens when it is true
/// @param name of the argument, @param value it has, @param range it may have, with its unit
/// @throws std::invalid_argument "name = value, allowed is range"
inline void require(bool holds, const char* name, double value, const char* range) {
  if (holds) return;
  char number[32];
  std::snprintf(number, sizeof number, "%.9g", value);
  throw std::invalid_argument(std::string(name) + " = " + number + ", allowed is " + range);
}

}  // namespace statejump::kernel
