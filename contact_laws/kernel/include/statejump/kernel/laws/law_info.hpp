// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <string>

#include "statejump/kernel/require.hpp"

namespace statejump::kernel::laws {

/// Properties of a law besides its numbers. Code that depends on such a property reads the traits,
/// never the name or type of the law.
enum class Trait : unsigned {
  /// a body under a load can remain at rest on a contact with this law
  holds_static_load = 1U << 0,
  /// no force at all
  frictionless = 1U << 1,
  /// receives the slide of the step and keeps a history; without this trait, a function of the
  /// velocity
  has_memory = 1U << 2,
  /// needs the axis of a bearing, so it is not available in a socket or on a flat face
  needs_axis = 1U << 3,
  /// accepts a negative bearing radius (a bulging wall): uses signed curvature
  accepts_bulging_wall = 1U << 4,
  /// Hertz's point contact F = 4/3 E* sqrt(R) delta^1.5. Its curvature is 1/R = 1/R1 - 1/R2 if
  /// accepts_bulging_wall is set, otherwise 1/R = 1/R1 + 1/R2.
  point_contact = 1U << 5,
  /// valid only under a normal law that is a point_contact
  needs_point_contact = 1U << 6,
};

/// A set of traits.
struct Traits {
  unsigned bits = 0;
  constexpr Traits() = default;
  constexpr Traits(Trait trait) : bits(static_cast<unsigned>(trait)) {}
  constexpr bool has(Trait trait) const { return (bits & static_cast<unsigned>(trait)) != 0; }
  friend constexpr Traits operator|(Traits a, Traits b) {
    a.bits |= b.bits;
    return a;
  }
};
constexpr Traits operator|(Trait a, Trait b) {
  return Traits(a) | Traits(b);
}

/// A parameter of a law. All checks and listings use its range and default.
struct LawParameter {
  const char* name;  ///< name of the field in the parameter struct
  const char* unit;  ///< "-" for a ratio
  double low;        ///< smallest value
  double high;       ///< largest value; itself allowed if finite
  bool low_excluded;
  double default_value;
  const char* meaning;
  const char* source;

  /// Whether the value lies in the range; false for NaN.
  constexpr bool allows(double value) const {
    const bool above = low_excluded ? value > low : value >= low;
    return above && (value < high || (value == high && high < infinity));
  }
  /// Range with its unit, e.g. "(0, inf) m/s" or "[0, inf)".
  std::string range() const {
    char text[80];
    std::snprintf(text, sizeof text, "%s%g, %g%s", low_excluded ? "(" : "[", low, high,
                  std::isinf(high) ? ")" : "]");
    const std::string of = unit;
    return of == "-" ? text : text + (" " + of);
  }
  static constexpr double infinity = std::numeric_limits<double>::infinity();
};

/// Checks a parameter. Call it whenever it is set.
/// @throws std::invalid_argument that names the parameter, its value and its range
inline void check(const LawParameter& parameter, double value) {
  if (parameter.allows(value)) return;
  require(false, parameter.name, value, parameter.range().c_str());
}

/// Description of a law, as data.
struct LawInfo {
  const char* name;     ///< name in case files
  const char* formula;  ///< plain text
  const char* source;   ///< publication and equation
  const char* range;    ///< range of validity; values outside are an error
  Traits traits;
  std::array<const LawParameter*, 4>
      parameters;  ///< the parameters that this law reads; unused entries are null

  constexpr bool has(Trait trait) const { return traits.has(trait); }
};

}  // namespace statejump::kernel::laws
