// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "statejump/linkage/model.hpp"

namespace statejump::linkage {

inline constexpr double frame = 0.120;
inline constexpr double alpha = 23.75e-6;

/// Umbrella of Tables 2 and 3 of the paper, with the link cross-section of its Table 1.
inline Linkage umbrella(double clearance = 1e-4) {
  Linkage model;
  model.frame_length = frame;
  model.link_ab = {0.050, 0.5, 70e9, 9e-6, alpha, 0.3};
  model.link_bc = {0.100, 1.0, 70e9, 9e-6, alpha, 0.3};
  model.journal_radius = 0.005;
  model.bearing_radius = 0.005 + clearance;
  return model;
}

/// Temperature change 0 → 100 K → 0 within `duration` [s].
inline thermal::Program heating(double duration = 1.0, double peak = 100.0) {
  thermal::Program program;
  program.shape = thermal::Shape::triangle;
  program.temperature_change_max = peak;
  program.period = duration;
  return program;
}

}  // namespace statejump::linkage
