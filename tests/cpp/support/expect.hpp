// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <stdexcept>
#include <string>

namespace statejump::testing {

/// 1e-12 of the expected value: the documented accuracy of closed forms.
inline double close(double expected) {
  return 1e-12 * std::abs(expected);
}

/// Message of the std::invalid_argument that `call` throws; empty if it throws nothing.
template <class Call>
std::string refusal(Call&& call) {
  try {
    call();
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return {};
}

}  // namespace statejump::testing
