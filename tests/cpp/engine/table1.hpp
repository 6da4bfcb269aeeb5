// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "statejump/spring_slider.hpp"

namespace statejump::testing {

// Table 1 of the paper, restated as plain numbers so that the expected values do not come from the
// code under test.
inline constexpr double EA = 70e9 * 9e-6;
inline constexpr double l0 = 0.5;
inline constexpr double alpha = 23.4e-6;
inline constexpr double f = 30.0;
inline constexpr double c = 1e-3;

inline SpringSlider table1(double clearance = c) {
  SpringSlider model;
  model.young_modulus = 70e9;
  model.cross_section_area = 9e-6;
  model.stress_free_length = l0;
  model.thermal_expansion = alpha;
  model.friction_force = f;
  model.clearance_minus = clearance;
  model.clearance_plus = clearance;
  return model;
}

inline kernel::ThermalProgram cycle(kernel::ThermalShape shape = kernel::ThermalShape::half_sine,
                                    int cycles = 1, double period = 1.0) {
  kernel::ThermalProgram program;
  program.shape = shape;
  program.temperature_change_max = 100.0;
  program.period = period;
  program.cycles = cycles;
  return program;
}

inline kernel::ThermalProgram table(std::vector<double> times, std::vector<double> changes) {
  kernel::ThermalProgram program;
  program.shape = kernel::ThermalShape::table;
  program.period = times.back();
  program.table_times = std::move(times);
  program.table_temperature_changes = std::move(changes);
  return program;
}

/// 1e-12 of the expected value, what the project promises for a closed form.
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
