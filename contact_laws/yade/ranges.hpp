// SPDX-License-Identifier: GPL-3.0-or-later
// Range checks of attributes: one sentence naming class, attribute, value and allowed range.
#pragma once

#include <cmath>
#include <sstream>
#include <stdexcept>
#include <string>

#include "statejump/kernel/laws/law_info.hpp"

namespace statejump::dem {

[[noreturn]] inline void refuse(const char* class_name, const char* attribute, double value,
                                const char* allowed) {
  std::ostringstream message;
  message.precision(17);
  message << class_name << "." << attribute << " = " << value << " is not allowed: must be "
          << allowed;
  throw std::invalid_argument(message.str());
}

[[noreturn]] inline void refuse(const char* class_name, const char* attribute,
                                const std::string& value, const std::string& allowed) {
  throw std::invalid_argument(std::string(class_name) + "." + attribute + " = '" + value +
                              "' is not allowed: must be " + allowed);
}

// Written so that NaN fails, too.
inline void require_positive(const char* class_name, const char* attribute, double value,
                             const char* unit) {
  if (!(value > 0 && std::isfinite(value))) {
    refuse(class_name, attribute, value, (std::string("above 0 ") + unit).c_str());
  }
}

inline void require_not_negative(const char* class_name, const char* attribute, double value,
                                 const char* unit) {
  if (!(value >= 0 && std::isfinite(value))) {
    refuse(class_name, attribute, value, (std::string("0 or above ") + unit).c_str());
  }
}

// "above 0 [m/s]", "0 or above [m/s]" or "in (0, 1] [-]".
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
