// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdio>
#include <stdexcept>
#include <string>
#include <utility>

namespace statejump::kernel {

/// An argument out of range, with its data as fields. what() is "[item: ]name = value, allowed is
/// range".
class OutOfRange : public std::invalid_argument {
 public:
  /// @param item object that the argument belongs to, for example "slider 'J3'"; may be empty
  /// @param name name of the argument, @param value its value, @param range allowed range with unit
  OutOfRange(std::string item, std::string name, double value, std::string range)
      : OutOfRange(std::move(item), std::move(name), true, value, digits(value), std::move(range)) {
  }

  /// For an argument whose value is one of several names.
  OutOfRange(std::string name, const std::string& value, std::string range)
      : OutOfRange("", std::move(name), false, 0.0, value, std::move(range)) {}

  const std::string& item() const { return item_; }
  const std::string& name() const { return name_; }
  bool is_number() const { return is_number_; }        ///< false: the value is a text
  double number() const { return number_; }            ///< 0 for a text
  const std::string& value() const { return value_; }  ///< the text, or the number with 9 digits
  const std::string& range() const { return range_; }

 private:
  OutOfRange(std::string item, std::string name, bool is_number, double number, std::string value,
             std::string range)
      : std::invalid_argument((item.empty() ? "" : item + ": ") + name + " = " +
                              (is_number ? value : "'" + value + "'") + ", allowed is " + range),
        item_(std::move(item)),
        name_(std::move(name)),
        is_number_(is_number),
        number_(number),
        value_(std::move(value)),
        range_(std::move(range)) {}

  static std::string digits(double value) {
    char number[32];
    std::snprintf(number, sizeof number, "%.9g", value);
    return number;
  }

  std::string item_;
  std::string name_;
  bool is_number_;
  double number_;
  std::string value_;
  std::string range_;
};

/// Rejects an argument out of range.
/// @param holds whether the argument is in its range
/// @param name name of the argument, @param value its value, @param range allowed range with unit
/// @throws OutOfRange unless `holds`
inline void require(bool holds, const char* name, double value, const char* range) {
  if (!holds) throw OutOfRange("", name, value, range);
}

}  // namespace statejump::kernel
