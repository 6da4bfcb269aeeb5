// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "statejump/spring_slider/model.hpp"
#include "support/expect.hpp"
#include "thermal/programs.hpp"

namespace statejump::spring_slider {

// Table 1 of the paper, written as numbers that do not depend on the code under test.
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

using testing::close;
using testing::refusal;
using thermal::cycle;
using thermal::table;

}  // namespace statejump::spring_slider
