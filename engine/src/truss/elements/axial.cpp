// SPDX-License-Identifier: GPL-3.0-or-later
#include "axial.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "statejump/kernel/require.hpp"

namespace statejump::truss::detail {

void check_length(const char* kind, const std::string& name, const Model& model, int first,
                  int second) {
  const double length = drawn_length(model, first, second);
  if (length > 0.0) return;
  throw kernel::OutOfRange(std::string(kind) + " '" + name + "'", "length", length,
                           "> 0 m: its nodes are at different places");
}

void check_expansion(const char* kind, const std::string& name, double thermal_expansion,
                     double fraction, const TemperatureRange& range) {
  const double per_kelvin = thermal_expansion * fraction;
  const double strain = std::min(per_kelvin * range.lowest, per_kelvin * range.highest);
  if (std::isfinite(strain) && strain > -1) return;
  throw kernel::OutOfRange(std::string(kind) + " '" + name + "'", "thermal_expansion",
                           thermal_expansion, "finite and such that a length is left [1/K]");
}

}  // namespace statejump::truss::detail
