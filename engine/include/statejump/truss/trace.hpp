// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <limits>

#include "statejump/truss/joints/interface.hpp"

namespace statejump::truss {

/// Decision of Newton's method after it has evaluated the equations in an iteration.
enum class Decision : unsigned char {
  step,           ///< Took a full step on the present set of statuses.
  halved_step,    ///< The step before was too long: went back and took a half of it.
  status_change,  ///< Joints changed their status.
  restart,        ///< Went back to the start of the solve, with new factors.
  converged,      ///< Ended the solve: all residuals are below their tolerances.
  event_ahead,    ///< Ended the solve: a joint changes its status within the step.
  singular,       ///< Ended the solve: the equations are singular.
  not_converged,  ///< Ended the solve without a solution.
  stopped         ///< Ended the solve: the caller stopped it.
};

/// "step", …: the enumerator's name.
const char* to_string(Decision decision);
const char* to_string(JointModel joints);

/// One iteration of Newton's method on a path.
struct TraceRecord {
  int branch = 0;     ///< Monotone branch of the temperature programs, from 1; 0: the start.
  int increment = 0;  ///< Within the branch; 0: the short first step.
  long step = 0;      ///< Step of the path, tried or done, from 1; 0: the start.
  long solve = 0;     ///< Newton solve of the path, from 1. A step may need several.
  JointModel joints = JointModel::friction;
  double opening = 1.0;             ///< Fraction of the clearances that is open [-].
  double time = 0.0;                ///< Time of the equilibrium that the solve seeks [s].
  double temperature_change = 0.0;  ///< ΔT of the first program there [K].
  int iteration = 0;                ///< Within the solve, from 1.
  double node_residual = 0.0;       ///< Of the balance of forces at nodes [N].
  double closure_residual = 0.0;    ///< Of closed or sticking joints [m].
  double joint_residual = 0.0;      ///< Of the forces of slipping or open joints [N].
  /// Largest displacement of the step [m]; NaN: no step was taken.
  double step_length = std::numeric_limits<double>::quiet_NaN();
  int status_changes = 0;   ///< Joints that changed their status.
  int changed_joint = -1;   ///< The first of them; -1: none.
  long factorizations = 0;  ///< Made in this iteration; 0: by old factors, or no step.
  Decision decision = Decision::step;
  const char* step_end = "";  ///< How the step of the path ended, in its last iteration.
};

using TraceSink = std::function<void(const TraceRecord&)>;

}  // namespace statejump::truss
