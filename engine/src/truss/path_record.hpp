// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include "system.hpp"

namespace statejump::truss::detail {

/// How the memory of all joints at the start of a step was written.
enum class MemoryWriter : unsigned char {
  none,       ///< In the reference configuration; it does not depend on an earlier step.
  commit,     ///< By the end of the step before.
  begin,      ///< As at the start of a path, without slip.
  zero_force  ///< As `begin`, where friction starts at zero force.
};

/// A solved equilibrium of a path, with all that its residual depends on.
struct RecordedStep {
  MemoryWriter writer = MemoryWriter::none;
  /// Unknowns and statuses from which `begin` and `zero_force` write.
  VectorXd written_at = {};
  Statuses written_with = {};
  double written_opening = 1.0;

  StepStart start;
  double time = 0.0;
  VectorXd z;
  Statuses statuses;
  JointModel joints = JointModel::friction;
  double opening = 1.0;
  double load_fraction = 1.0;     ///< Of loads and misfits; below 1 only before the path.
  bool without_friction = false;  ///< Whether the joints of the start have no friction.
  bool is_short = false;          ///< Whether the step locates a change of status.
};

/// All equilibria of a path in order, for derivatives of its states.
struct PathRecord {
  Model model;  ///< With the springs that solve() added.
  std::vector<RecordedStep> steps;
  std::vector<std::size_t> cycle_ends;  ///< Steps of Path::cycle_ends.
  std::vector<double> corners;          ///< Times of the programs' corners [s].

  /// Removes the steps after the first `count`.
  void keep(std::size_t count) { steps.resize(std::min(steps.size(), count), RecordedStep{}); }
};

}  // namespace statejump::truss::detail
