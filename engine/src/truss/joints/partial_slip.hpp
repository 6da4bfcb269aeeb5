// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "statejump/kernel/partial_slip_line.hpp"
#include "statejump/truss/joints/interface.hpp"

namespace statejump::truss::detail {

/// How many numbers a joint keeps of a contact that slides in one direction: slope of the bound,
/// force of merged points, number of points, and their x and U.
constexpr int partial_slip_history = 3 + 2 * kernel::PartialSlipMemory::capacity;

inline kernel::PartialSlipMemory read_partial_slip(const double* numbers) {
  const auto count = static_cast<std::size_t>(numbers[2]);
  std::vector<kernel::Vector3> points;
  points.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    points.emplace_back(numbers[3 + 2 * i], numbers[4 + 2 * i], 0.0);
  }
  return {std::move(points), numbers[0], numbers[1], {}};
}

inline void write_partial_slip(const kernel::PartialSlipMemory& memory, double* numbers) {
  std::fill_n(numbers, partial_slip_history, 0.0);
  numbers[0] = memory.slope();
  numbers[1] = memory.merged();
  numbers[2] = memory.size();
  for (int i = 0; i < memory.size(); ++i) {
    numbers[3 + 2 * i] = memory[i].x;
    numbers[4 + 2 * i] = memory[i].u.a;
  }
}

/// A contact under its limit on which nothing has slid.
inline kernel::PartialSlipMemory pressed(double stiffness, double limit) {
  kernel::PartialSlipMemory memory;
  kernel::partial_slip_step(stiffness, limit, {0.0, 0.0}, memory);
  return memory;
}

/// Tells apart the pieces of a law that is smooth on each.
inline std::size_t piece_of(const kernel::PartialSlipLine& line) {
  return static_cast<std::size_t>(line.stuck + 1024 * (line.plus + 1024 * line.minus));
}

/// Whether a contact slides as a whole at the end of a step, and which way.
/// @param before the same at its start: one that rests where it slid still does so
/// @param rounding of the slide [m]
inline JointStatus sliding(const kernel::PartialSlipLine& line, JointStatus before,
                           double rounding) {
  const JointStatus way = line.centre > 0.0 ? JointStatus::slip_plus : JointStatus::slip_minus;
  const double beyond = std::abs(line.centre) - line.bound;
  return beyond >= (before == way ? -rounding : rounding) ? way : JointStatus::stick;
}

}  // namespace statejump::truss::detail
