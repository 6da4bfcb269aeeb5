// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <ostream>
#include <string>
#include <utility>

#include "statejump/kernel/require.hpp"

namespace statejump::testing {

/// An argument that is out of range: its name, its value and the part of a model that it belongs
/// to.
struct Argument {
  Argument(std::string key, double number, std::string part = "")
      : name(std::move(key)), value(number), item(std::move(part)) {}
  Argument(std::string key, std::string given) : name(std::move(key)), text(std::move(given)) {}
  explicit Argument(const kernel::OutOfRange& refused)
      : name(refused.name()),
        value(refused.number()),
        text(refused.is_number() ? "" : refused.value()),
        item(refused.item()),
        range(refused.range()) {}

  /// Compares values to 9 digits; NaN equals NaN. The range is printed but not compared.
  bool operator==(const Argument& other) const {
    const bool same = value == other.value || (std::isnan(value) && std::isnan(other.value)) ||
                      std::abs(value - other.value) <= 1e-9 * std::abs(value);
    return name == other.name && same && text == other.text && item == other.item;
  }

  bool operator!=(const Argument& other) const { return !(*this == other); }

  std::string name;
  double value = 0;
  std::string text = {};
  std::string item = {};
  std::string range = {};
};

inline std::ostream& operator<<(std::ostream& out, const Argument& argument) {
  if (!argument.item.empty()) out << argument.item << ": ";
  out << argument.name << " = ";
  if (argument.text.empty()) {
    out << argument.value;
  } else {
    out << '\'' << argument.text << '\'';
  }
  return out << ", " << argument.range;
}

/// Nothing was refused.
inline const Argument no_argument{"", 0.0};

/// The argument that `call` refuses with an OutOfRange.
template <class Call>
Argument refused_argument(Call&& call) {
  try {
    call();
  } catch (const kernel::OutOfRange& refused) {
    return Argument(refused);
  }
  return no_argument;
}

}  // namespace statejump::testing
