// SPDX-License-Identifier: GPL-3.0-or-later
#include "statejump/failure.hpp"

#include <algorithm>
#include <cstdio>
#include <limits>
#include <sstream>

namespace statejump {

namespace {

std::string text_of(const char* format, double value) {
  char text[64];
  std::snprintf(text, sizeof text, format, value);
  return text;
}

double number_of(const FailureFields& fields, const std::string& name) {
  for (const auto& [key, value] : fields.numbers) {
    if (key == name) return value;
  }
  return std::numeric_limits<double>::quiet_NaN();
}

std::string number_named(const FailureFields& fields, const char* name) {
  return text_of("%g", number_of(fields, name));
}

/// Returns for example " at a temperature change of 12.5 K (t = 0.25 s)", or "" if the failure has
/// no instant.
std::string at_instant(const FailureFields& fields) {
  if (!fields.temperature_change) return "";
  std::ostringstream text;
  text.precision(9);
  text << " at a temperature change of " << *fields.temperature_change << " K";
  if (fields.time) text << " (t = " << *fields.time << " s)";
  return text.str();
}

/// Lists the moving nodes of each mode: "node 'B' mostly along x, node 'C' mostly along y; node …".
std::string movers(const std::vector<FailureMode>& modes) {
  std::string text;
  for (const FailureMode& mode : modes) {
    if (!text.empty()) text += "; ";
    for (std::size_t k = 0; k < mode.size(); ++k) {
      text += (k == 0 ? "node '" : ", node '") + mode[k].node +
              (mode[k].rotates ? "' mostly about " : "' mostly along ") + mode[k].along;
    }
  }
  return text;
}

std::string free_modes(const FailureFields& fields) {
  return std::to_string(fields.mode_count) + (fields.more_modes ? " or more" : "") + " free mode" +
         (fields.mode_count == 1 ? "" : "s") + ": " + movers(fields.modes);
}

std::string unstable_modes(const FailureFields& fields) {
  const std::string described = movers(fields.modes);
  return std::to_string(fields.mode_count) + " mode" + (fields.mode_count == 1 ? "" : "s") +
         " without resistance" + (described.empty() ? "" : ": " + described);
}

std::string joint(const FailureFields& fields) {
  if (fields.joints.empty()) return "a joint";
  return fields.joints.front().kind + " '" + fields.joints.front().name + "'";
}

/// A sentence names at most this many joints, else their number.
constexpr std::size_t most_named = 8;

/// "slider 'A', revolute 'B'".
std::string joints(const FailureFields& fields) {
  std::string text;
  for (std::size_t i = 0; i < std::min(most_named, fields.joints.size()); ++i) {
    const FailureJoint& one = fields.joints[i];
    text += (text.empty() ? "" : ", ") + one.kind + " '" + one.name + "'";
  }
  if (fields.joints.size() > most_named) {
    text += " and " + std::to_string(fields.joints.size() - most_named) + " more";
  }
  return text.empty() ? "a joint" : text;
}

}  // namespace

const char* to_string(FailureKind kind) {
  switch (kind) {
    case FailureKind::mechanism:
      return "mechanism";
    case FailureKind::held_mechanism:
      return "held_mechanism";
    case FailureKind::friction_exhausted:
      return "friction_exhausted";
    case FailureKind::overloaded:
      return "overloaded";
    case FailureKind::buckled:
      return "buckled";
    case FailureKind::unloaded_joint:
      return "unloaded_joint";
    case FailureKind::jump_across_play:
      return "jump_across_play";
    case FailureKind::singular:
      return "singular";
    case FailureKind::not_converged:
      return "not_converged";
    case FailureKind::no_continuation:
      return "no_continuation";
    case FailureKind::several_continuations:
      return "several_continuations";
    case FailureKind::too_many_steps:
      return "too_many_steps";
    case FailureKind::law_left_range:
      return "law_left_range";
    case FailureKind::not_finite:
      return "not_finite";
  }
  return "unknown";
}

std::string cause(const FailureFields& fields) {
  switch (fields.kind) {
    case FailureKind::mechanism:
    case FailureKind::held_mechanism:
      return free_modes(fields);
    case FailureKind::friction_exhausted:
      return "all its friction is at its bound and balances the rest exactly, " +
             free_modes(fields);
    case FailureKind::overloaded:
      return "friction is exhausted at " +
             text_of("%.3g", 100.0 * number_of(fields, "load_fraction")) + " % of them";
    case FailureKind::buckled:
      return "with every closed joint held its equilibrium is unstable, " + unstable_modes(fields);
    case FailureKind::unloaded_joint:
      return "statics does not determine its position in the play" +
             (fields.modes.empty() ? std::string() : ", " + free_modes(fields));
    case FailureKind::jump_across_play:
      return "its contact force vanishes there and statics does not determine the way to the next "
             "equilibrium";
    case FailureKind::singular:
    case FailureKind::not_converged: {
      if (!fields.numbers.empty()) {
        return "residual " + number_named(fields, "force_residual") + " of the joint force, " +
               number_named(fields, "closure_residual_m") + " m in the closure";
      }
      const char* how =
          fields.kind == FailureKind::singular ? "the stiffness is singular" : "not converged";
      return how + (fields.joints.empty()
                        ? std::string(", after all joints had settled")
                        : ", while the status of " + joint(fields) + " still changed");
    }
    case FailureKind::no_continuation:
      if (fields.joints.empty()) return "no equilibrium is near beyond it, the truss snaps through";
      return "the more " + joints(fields) + (fields.joints.size() == 1 ? " slips" : " slip") +
             ", the more the truss pushes";
    case FailureKind::several_continuations:
      return "statics does not choose between the ways in which " + joints(fields) + " may go on";
    case FailureKind::too_many_steps:
      return number_named(fields, "steps") +
             (fields.sought.empty() ? " steps since the last change of a joint, the last of "
                                    : " parts of steps so far, the last of ") +
             number_named(fields, "last_step_s") + " s";
    case FailureKind::law_left_range:
      return fields.cause;
    case FailureKind::not_finite:
      return "the state is not finite";
  }
  return "";
}

std::string remedy(const FailureFields& fields) {
  switch (fields.kind) {
    case FailureKind::unloaded_joint:
      return "load it by a spring, a cable or a force";
    case FailureKind::overloaded:
      return "raise its friction, support the structure otherwise or reduce the loads";
    case FailureKind::no_continuation:
      return "reduced --dynamic follows the jump";
    case FailureKind::not_finite:
      return "take more steps";
    default:
      return "";
  }
}

std::string sentence(const FailureFields& fields) {
  const std::string why = cause(fields);
  const std::string where = at_instant(fields);
  switch (fields.kind) {
    case FailureKind::mechanism:
      return "the truss is a mechanism" + where + ": " + why;
    case FailureKind::held_mechanism:
      return "the truss is a mechanism even with every joint held, " + why;
    case FailureKind::friction_exhausted:
      return joints(fields) +
             (fields.joints.size() == 1 ? " cannot hold" : " cannot hold together") + where + ": " +
             why;
    case FailureKind::overloaded:
      return joints(fields) + " cannot hold the loads: " + why + "; " + remedy(fields);
    case FailureKind::buckled:
      return "the truss has buckled" + where + ": " + why;
    case FailureKind::unloaded_joint:
      return joint(fields) + " carries no force at the start: " + why + "; " + remedy(fields);
    case FailureKind::jump_across_play:
      return joint(fields) + " jumps across its play" + where + ": " + why;
    case FailureKind::singular:
    case FailureKind::not_converged:
      return fields.sought + where + ": " + why;
    case FailureKind::no_continuation:
      return (fields.joints.empty() ? "the path ends at a limit point" : "slip runs away") + where +
             ": " + why + "; " + remedy(fields);
    case FailureKind::several_continuations:
      return "the path parts" + where + ": " + why;
    case FailureKind::too_many_steps:
      return (fields.sought.empty() ? "no equilibrium by longer steps" : fields.sought) + where +
             ": " + why;
    case FailureKind::law_left_range:
      return why + where;
    case FailureKind::not_finite:
      return why + ", " + remedy(fields) + where;
  }
  return "";
}

}  // namespace statejump
