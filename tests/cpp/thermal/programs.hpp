// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <utility>
#include <vector>

#include "statejump/thermal/program.hpp"

namespace statejump::thermal {

inline Program cycle(Shape shape = Shape::half_sine, int cycles = 1, double period = 1.0) {
  Program program;
  program.shape = shape;
  program.temperature_change_max = 100.0;
  program.period = period;
  program.cycles = cycles;
  return program;
}

inline Program table(std::vector<double> times, std::vector<double> changes) {
  Program program;
  program.shape = Shape::table;
  program.period = times.back();
  program.table_times = std::move(times);
  program.table_temperature_changes = std::move(changes);
  return program;
}

}  // namespace statejump::thermal
