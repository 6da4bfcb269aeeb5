// SPDX-License-Identifier: GPL-3.0-or-later
// Range checks of attributes. The error names class, attribute, value and allowed range.
#pragma once

#include <cmath>
#include <sstream>
#include <string>

#include "refusal.hpp"
#include "statejump/kernel/laws/law_info.hpp"
#include "statejump/stepper/checks.hpp"

namespace statejump::dem {

[[noreturn]] inline void refuse(const char* class_name, const char* attribute, double value,
                                const char* allowed) {
  std::ostringstream text;
  text.precision(17);
  text << value;
  refuse({"not_allowed", std::string(class_name) + "." + attribute, text.str(), allowed});
}

[[noreturn]] inline void refuse(const char* class_name, const char* attribute,
                                const std::string& value, const std::string& allowed) {
  refuse({"not_allowed", std::string(class_name) + "." + attribute, "'" + value + "'", allowed});
}

// @param unit with brackets, for example "[m]"
inline void require(stepper::ValueRange allowed, const char* class_name, const char* attribute,
                    double value, const std::string& unit) {
  if (stepper::allows(allowed, value)) return;
  refuse(class_name, attribute, value, (std::string(range_text(allowed)) + " " + unit).c_str());
}

inline void require_positive(const char* class_name, const char* attribute, double value,
                             const char* unit) {
  require(stepper::ValueRange::positive, class_name, attribute, value, unit);
}

inline void require_not_negative(const char* class_name, const char* attribute, double value,
                                 const char* unit) {
  require(stepper::ValueRange::not_negative, class_name, attribute, value, unit);
}

// Checks numbers that a script sets. It always accepts 0, which means that a number is not yet set.
template <class Object, std::size_t size>
void require_settable(const char* class_name, const stepper::Quantities<Object, size>& quantities,
                      const Object& object) {
  for (const stepper::Quantity<Object>& each : quantities) {
    const bool positive = each.allowed == stepper::ValueRange::positive;
    require(positive ? stepper::ValueRange::not_negative : each.allowed, class_name, each.name,
            object.*each.value, std::string("[") + each.unit + "]");
  }
}

// Text of a range, for example "above 0 [m/s]", "0 or above [m/s]" or "in (0, 1] [-]".
inline std::string allowed_range(const kernel::laws::LawParameter& parameter) {
  std::ostringstream text;
  const char* excluded = parameter.low_excluded ? "above " : "";
  if (std::isinf(parameter.high)) {
    text << excluded << parameter.low << (parameter.low_excluded ? "" : " or above");
  } else {
    text << "in " << (parameter.low_excluded ? "(" : "[") << parameter.low << ", " << parameter.high
         << "]";
  }
  text << " [" << parameter.unit << "]";
  return text.str();
}

inline void require_allowed(const char* class_name, const char* attribute, double value,
                            const kernel::laws::LawParameter& parameter) {
  if (!parameter.allows(value)) {
    refuse(class_name, attribute, value, allowed_range(parameter).c_str());
  }
}

template <class Vector>
void require_unit(const char* class_name, const char* attribute, const Vector& value) {
  if (!(std::abs(value.norm() - 1) <= 1e-9)) {
    refuse(class_name, attribute, value.norm(), "of length 1 [-]");
  }
}

}  // namespace statejump::dem
