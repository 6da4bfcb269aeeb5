// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "statejump/kernel/partial_slip_plane.hpp"
#include "statejump/truss/joints/interface.hpp"

namespace statejump::truss::detail {

/// Count of numbers stored for a contact with one or two sliding directions: slope of the bound,
/// force of merged points, number of points, x and U of each point.
constexpr int partial_slip_history(int directions) {
  return 3 + (1 + directions) * kernel::PartialSlipMemory::capacity;
}

inline kernel::PartialSlipMemory read_partial_slip(const double* numbers, int directions = 1) {
  const auto count = static_cast<std::size_t>(numbers[2]);
  std::vector<kernel::Vector3> points;
  points.reserve(count);
  const double* from = numbers + 3;
  for (std::size_t i = 0; i < count; ++i, from += 1 + directions) {
    points.emplace_back(from[0], from[1], directions == 2 ? from[2] : 0.0);
  }
  return {std::move(points), numbers[0], numbers[1], {}};
}

inline void write_partial_slip(const kernel::PartialSlipMemory& memory, double* numbers,
                               int directions = 1) {
  std::fill_n(numbers, partial_slip_history(directions), 0.0);
  numbers[0] = memory.slope();
  numbers[1] = memory.merged();
  numbers[2] = memory.size();
  double* to = numbers + 3;
  for (int i = 0; i < memory.size(); ++i) {
    const kernel::PartialSlipMemory::Point point = memory[i];
    *to++ = point.x;
    *to++ = point.u.a;
    if (directions == 2) *to++ = point.u.b;
  }
}

/// Memory of a contact with this limit before any slip.
inline kernel::PartialSlipMemory pressed(double stiffness, double limit) {
  kernel::PartialSlipMemory memory;
  kernel::partial_slip_step(stiffness, limit, {0.0, 0.0}, memory);
  return memory;
}

/// Index of the smooth branch of the law.
inline std::size_t piece_of(const kernel::PartialSlipLine& line) {
  return static_cast<std::size_t>(line.stuck + 1024 * (line.plus + 1024 * line.minus));
}

inline std::size_t piece_of(const kernel::PartialSlipPlane& plane) {
  return static_cast<std::size_t>(plane.stuck + 1024 * plane.slips);
}

/// Whether a contact slides as a whole at the end of a step, and in which direction.
/// @param before status at the start of the step; a contact that rests after a slide keeps it
/// @param rounding of the slide [m]
inline JointStatus sliding(const kernel::PartialSlipLine& line, JointStatus before,
                           double rounding) {
  const JointStatus way = line.centre > 0.0 ? JointStatus::slip_plus : JointStatus::slip_minus;
  const double beyond = std::abs(line.centre) - line.bound;
  return beyond >= (before == way ? -rounding : rounding) ? way : JointStatus::stick;
}
/// For a contact in a plane; slip has no sign there.
inline JointStatus sliding(const kernel::PartialSlipPlane& plane, JointStatus before,
                           double rounding) {
  const double beyond = plane.centre.norm() - plane.bound;
  return beyond >= (is_slip(before) ? -rounding : rounding) ? JointStatus::slip_plus
                                                            : JointStatus::stick;
}

}  // namespace statejump::truss::detail
