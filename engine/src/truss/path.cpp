// SPDX-License-Identifier: GPL-3.0-or-later
#include "statejump/truss/path.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "newton.hpp"
#include "parts.hpp"
#include "statejump/failure.hpp"

namespace statejump::truss {

using detail::FoundModes;
using detail::index;
using detail::JointModel;
using detail::Newton;
using detail::SolveEnd;
using detail::SolveReport;
using detail::Statuses;
using detail::StepStart;
using detail::System;
using Eigen::Vector2d;
using Eigen::VectorXd;

const char* to_string(JointStatus status) {
  switch (status) {
    case JointStatus::stick:
      return "stick";
    case JointStatus::slip_plus:
      return "slip_plus";
    case JointStatus::slip_minus:
      return "slip_minus";
    case JointStatus::stop_plus:
      return "stop_plus";
    case JointStatus::stop_minus:
      return "stop_minus";
    case JointStatus::open:
      return "open";
  }
  return "unknown";
}

namespace {

/// @param joint sliders before revolutes
FailureJoint named(const Model& model, int joint) {
  const int sliders = static_cast<int>(model.sliders.size());
  if (joint < sliders) return {"slider", model.sliders[index(joint)].name};
  return {"revolute", model.revolutes[index(joint - sliders)].name};
}

/// Fields of a failure at an instant.
FailureFields failure_at(FailureKind kind, const Model& model, double time) {
  FailureFields fields{kind};
  fields.time = time;
  fields.temperature_change = model.temperature_change(0, 1.0, time);
  return fields;
}

[[noreturn]] void fail_modes(FailureFields fields, FoundModes found) {
  fields.modes = std::move(found.modes);
  fields.mode_count = found.count;
  fields.more_modes = found.more;
  throw Failure(std::move(fields));
}

[[noreturn]] void fail_joint(FailureFields fields, FailureJoint joint) {
  fields.joints.push_back(std::move(joint));
  throw Failure(std::move(fields));
}

/// Largest angle [rad] by which a contact may move around its bearing in one step; more within a
/// located instant is a jump.
constexpr double most_turned = 0.5;

/// How a step ended: with the state moved on, or back at its start.
enum class StepEnd : unsigned char { done, event_inside, not_converged };

/// Equilibrium being followed.
struct Walker {
  const Model& model;
  const System& system;
  const Options& options;
  Newton newton;
  Path path;
  VectorXd z;
  StepStart origin;  ///< The state as the start of the next step.
  State state;
  double time = 0.0;
  /// How fast every joint slid in the last step, sliders before revolutes [m/s].
  VectorXd slide_rate;

  [[noreturn]] void fail(const SolveReport& report, JointModel joints, double when,
                         const char* sought) const {
    if (FoundModes modes = detail::mechanism(system, z, when, origin.statuses, joints)) {
      fail_modes(failure_at(FailureKind::mechanism, model, when), std::move(modes));
    }
    refuse_buckled(when);
    const FailureKind kind =
        report.end == SolveEnd::singular ? FailureKind::singular : FailureKind::not_converged;
    FailureFields fields = failure_at(kind, model, when);
    fields.sought = sought;
    if (report.joint >= 0) fields.joints.push_back(named(model, report.joint));
    throw Failure(std::move(fields));
  }

  void note(const SolveReport& report) {
    ++path.solves;
    path.largest_force_residual = std::max(path.largest_force_residual, report.force_residual);
    path.largest_closure_residual =
        std::max(path.largest_closure_residual, report.closure_residual);
  }

  void start();
  void open_clearances();
  void refuse_buckled(double when) const;
  StepEnd step_to(double target, double tolerance);
  bool state_depends_on(int joint, JointStatus before, JointStatus after) const;
  bool slide_at_stake(int joint, JointStatus before, double target, double rounding) const;
};

/// Relaxes the drawn shape at ΔT = 0; see solve().
void Walker::start() {
  origin.statuses = system.all_stick();
  z = VectorXd::Zero(system.unknowns());
  if (FoundModes modes = detail::mechanism(system, z, 0.0, origin.statuses, JointModel::pins)) {
    fail_modes(failure_at(FailureKind::held_mechanism, model, 0.0), std::move(modes));
  }
  const StepStart begin = system.step_start(z, origin.statuses);
  const SolveReport report =
      newton.solve(0.0, begin, JointModel::pins, 1.0, options.most_iterations, z, origin.statuses);
  note(report);
  if (report.end != SolveEnd::converged) {
    fail(report, JointModel::pins, 0.0, "no equilibrium of the drawn shape");
  }
  refuse_buckled(0.0);
  if (!model.revolutes.empty()) open_clearances();
}

/// Throws if the state is unstable whatever the joints do.
void Walker::refuse_buckled(double when) const {
  if (FoundModes modes = detail::buckling(system, z, when)) {
    fail_modes(failure_at(FailureKind::buckled, model, when), std::move(modes));
  }
}

void Walker::open_clearances() {
  // Below this a pin force is rounding of what the stiffest part would carry.
  const double rounding = 1e-14 * system.stiffness_scale() * system.size();
  for (int i = 0; i < static_cast<int>(model.revolutes.size()); ++i) {
    if (!(system.revolute_force(i, z).norm() > rounding)) {
      fail_joint(failure_at(FailureKind::unloaded_joint, model, 0.0),
                 {"revolute", model.revolutes[index(i)].name});
    }
  }
  // The journal touches where its pin force pushes; the clearances open little by little, each time
  // from the last equilibrium, because the links turn as they open.
  double opened = 0.0;
  double share = 0.125;
  origin.statuses.revolutes.assign(model.revolutes.size(), JointStatus::slip_plus);
  while (opened < 1.0) {
    const double next = std::min(1.0, opened + share);
    VectorXd trial = z;
    Statuses trial_statuses = origin.statuses;
    const StepStart last = system.step_start(z, origin.statuses);
    for (int i = 0; i < static_cast<int>(model.revolutes.size()); ++i) {
      const Vector2d force = system.revolute_force(i, z);
      const Vector2d eccentricity = last.eccentricity.col(i);
      const Vector2d normal = opened == 0.0 ? Vector2d(force / force.norm())
                                            : Vector2d(eccentricity / eccentricity.norm());
      system.move_journal(i, (next - opened) * model.revolutes[index(i)].radial_clearance * normal,
                          trial);
      if (opened == 0.0) system.set_revolute_force(i, {force.norm(), 0.0}, trial);
    }
    const StepStart begin = system.step_start(trial, trial_statuses);
    const SolveReport report = newton.solve(0.0, begin, JointModel::frictionless, next,
                                            options.most_iterations, trial, trial_statuses);
    note(report);
    if (report.end == SolveEnd::converged) {
      z = trial;
      origin.statuses = trial_statuses;
      opened = next;
      continue;
    }
    share *= 0.5;
    if (share < 1e-4) {
      fail(report, JointModel::frictionless, 0.0, "no equilibrium in contact at the start");
    }
  }
  for (std::size_t i = 0; i < model.revolutes.size(); ++i) {
    if (origin.statuses.revolutes[i] == JointStatus::open) {
      fail_joint(failure_at(FailureKind::no_contact, model, 0.0),
                 {"revolute", model.revolutes[i].name});
    }
    if (model.revolutes[i].friction_coefficient > 0.0) {
      origin.statuses.revolutes[i] = JointStatus::stick;
    }
  }
}

/// Whether the state after a change depends on where in the step it happened.
bool Walker::state_depends_on(int joint, JointStatus before, JointStatus after) const {
  const int sliders = static_cast<int>(model.sliders.size());
  const auto is_slip = [](JointStatus s) {
    return s == JointStatus::slip_plus || s == JointStatus::slip_minus;
  };
  if (joint < sliders) {
    if (model.sliders[index(joint)].friction_force == 0.0) return false;
    return is_slip(before) && (after == JointStatus::stick || is_slip(after));
  }
  if (model.revolutes[index(joint - sliders)].friction_coefficient == 0.0) return false;
  if (before == JointStatus::open) return true;
  return is_slip(before) && (after == JointStatus::stick || is_slip(after));
}

/// Whether a joint that stopped sliding before `target` may have slid by more than rounding until
/// it did: slides of a step are lost when it ends in a stick. One that comes to rest smoothly
/// slides so little at last that no shorter step would tell.
/// @param rounding of a displacement [m]
bool Walker::slide_at_stake(int joint, JointStatus before, double target, double rounding) const {
  if (before == JointStatus::open) return true;
  const int sliders = static_cast<int>(model.sliders.size());
  double least = 1e3 * system.slide_rounding(joint, z, rounding);
  if (joint >= sliders && !options.locate_events) {
    least += options.event_tolerance * model.revolutes[index(joint - sliders)].radial_clearance;
  }
  return slide_rate[joint] * (target - time) > least;
}

/// One step, if it is converged and exact or no longer than `tolerance`; else nothing happens.
StepEnd Walker::step_to(double target, double tolerance) {
  // The sum time + tolerance is rounded.
  const bool is_short = target - time <= 1.5 * tolerance;
  VectorXd trial = z;
  Statuses trial_statuses = origin.statuses;
  const StepStart& begin = origin;
  const SolveReport report = newton.solve(target, begin, JointModel::friction, 1.0,
                                          options.most_iterations, trial, trial_statuses);
  if (report.end != SolveEnd::converged) {
    ++path.solves;
    if (!is_short) return StepEnd::not_converged;
    origin.statuses = trial_statuses;
    fail(report, JointModel::friction, target, "no equilibrium");
  }
  const int sliders = static_cast<int>(model.sliders.size());
  std::vector<Event> events;
  const double rounding = system.length_rounding(z);
  const auto compare = [&](int joint, JointStatus before, JointStatus after) {
    if (before == after) return true;
    const bool matters = state_depends_on(joint, before, after)
                             ? slide_at_stake(joint, before, target, rounding)
                             : options.locate_events;
    if (!is_short && matters) return false;
    const bool is_revolute = joint >= sliders;
    events.push_back({target, target - time, model.temperature_change(0, 1.0, target), is_revolute,
                      is_revolute ? joint - sliders : joint, before, after});
    return true;
  };
  for (int i = 0; i < sliders; ++i) {
    if (!compare(i, origin.statuses.sliders[index(i)], trial_statuses.sliders[index(i)])) {
      ++path.solves;
      return StepEnd::event_inside;
    }
  }
  for (int i = 0; i < static_cast<int>(model.revolutes.size()); ++i) {
    if (!compare(sliders + i, origin.statuses.revolutes[index(i)],
                 trial_statuses.revolutes[index(i)])) {
      ++path.solves;
      return StepEnd::event_inside;
    }
  }
  std::vector<FailureJoint> opened;
  for (int i = 0; i < static_cast<int>(model.revolutes.size()); ++i) {
    const JointStatus before = origin.statuses.revolutes[index(i)];
    const JointStatus after = trial_statuses.revolutes[index(i)];
    if (before != JointStatus::open && after == JointStatus::open) {
      opened.push_back({"revolute", model.revolutes[index(i)].name});
    }
    if (before == JointStatus::open || after == JointStatus::open) continue;
    const double turned = system.revolute_geometry(i, trial, target, begin, 1.0).turned;
    if (std::abs(turned) <= most_turned) continue;
    if (!is_short) {
      ++path.solves;
      return StepEnd::event_inside;
    }
    fail_joint(failure_at(FailureKind::jump_across_play, model, target),
               {"revolute", model.revolutes[index(i)].name});
  }
  if (!opened.empty()) {
    if (FoundModes modes =
            detail::mechanism(system, trial, target, trial_statuses, JointModel::friction)) {
      FailureFields fields = failure_at(FailureKind::opened_mechanism, model, target);
      fields.joints = std::move(opened);
      fail_modes(std::move(fields), std::move(modes));
    }
  }
  note(report);
  const StepStart after = system.step_start(trial, trial_statuses, &begin);
  const VectorXd slips = system.slips(trial, target, begin, after);
  system.account(z, time, trial, target, begin, after, slips, state);
  slide_rate = slips.cwiseAbs() / (target - time);
  z = trial;
  origin = after;
  time = target;
  system.describe(z, time, origin, state);
  path.events.insert(path.events.end(), events.begin(), events.end());
  if (!events.empty() && options.locate_events && !options.cycle_ends_only) {
    path.states.push_back(state);
  }
  return StepEnd::done;
}

/// Corners of all programs [s]. Those closer than Model::same_time of the duration are one: 3 times
/// 0.1 s are not 0.3 s to the last bit, nor 8 times 0.15 s 4 times 0.3 s.
std::vector<double> corners(const Model& model) {
  // The first program's own times go before those of others, so that its cycles end exactly; the
  // very last is where every program has ended.
  std::vector<double> own{0.0};
  std::set<double> others;
  for (std::size_t i = 0; i < model.programs.size(); ++i) {
    for (const auto& branch : thermal::monotone_branches(model.programs[i])) {
      if (i == 0) {
        own.push_back(branch.end_time);
      } else {
        others.insert(branch.end_time);
      }
    }
  }
  const double near = truss::Model::same_time * own.back();
  std::vector<double> times = own;
  for (const double time : others) {
    const auto after = std::lower_bound(times.begin(), times.end(), time);
    if (after == times.end()) {
      if (time - times.back() > near) {
        times.push_back(time);
      } else {
        times.back() = time;
      }
    } else if (*after - time > near && time - *std::prev(after) > near) {
      times.insert(after, time);
    }
  }
  return times;
}

}  // namespace

Path solve(const Model& model, const Options& options) {
  model.validate();
  kernel::require(options.increments_per_branch >= 1, "increments_per_branch",
                  options.increments_per_branch, ">= 1");
  kernel::require(options.event_tolerance > 0.0 && options.event_tolerance <= 1.0,
                  "event_tolerance", options.event_tolerance, "above 0 and at most 1");
  kernel::require(options.most_iterations >= 2, "most_iterations", options.most_iterations, ">= 2");
  const System system(model);
  Walker walker{model, system, options, Newton(system), {}, {}, {}, {}, 0.0, {}};
  walker.slide_rate =
      VectorXd::Zero(static_cast<Eigen::Index>(model.sliders.size() + model.revolutes.size()));
  walker.path.unknowns = system.unknowns();
  walker.state.slider_dissipation = VectorXd::Zero(static_cast<Eigen::Index>(model.sliders.size()));
  walker.state.revolute_dissipation =
      VectorXd::Zero(static_cast<Eigen::Index>(model.revolutes.size()));
  walker.start();
  walker.origin = system.step_start(walker.z, walker.origin.statuses);
  system.describe(walker.z, 0.0, walker.origin, walker.state);
  walker.path.states.push_back(walker.state);
  walker.path.cycle_ends.push_back(walker.state);

  const int sliders = static_cast<int>(model.sliders.size());
  // In an increment a joint changes its status a few times, in a long chain as often as another one
  // starts to slide; many more are no path but a flicker.
  const std::size_t joints = model.sliders.size() + model.revolutes.size();
  const int most_changes = 200 + 2 * static_cast<int>(joints);
  std::vector<int> changes(joints);
  const std::vector<double> times = corners(model);
  const double duration = model.programs.front().duration();
  int cycle = 1;
  for (std::size_t b = 0; b + 1 < times.size() && walker.path.complete; ++b) {
    const double length = times[b + 1] - times[b];
    const double tolerance = options.event_tolerance * length;
    double convergent = length;  // longest step that Newton is trusted with
    for (int k = 0; k <= options.increments_per_branch; ++k) {
      // k = 0: the short first step, within which slips turn into sticks after the corner.
      const double target = k == 0 ? times[b] + tolerance
                            : k == options.increments_per_branch
                                ? times[b + 1]
                                : times[b] + length * k / options.increments_per_branch;
      std::size_t counted = walker.path.events.size();
      std::fill(changes.begin(), changes.end(), 0);
      double stride = std::min(target - walker.time, convergent);
      bool locating = false;
      while (walker.time < target && walker.path.complete) {
        const double goal =
            std::max(std::nextafter(walker.time, target), std::min(target, walker.time + stride));
        const double shortest = std::nextafter(walker.time, target) - walker.time;
        const StepEnd end = walker.step_to(goal, std::max(tolerance, shortest));
        if (end == StepEnd::done) {
          convergent = std::max(2.0 * convergent, tolerance);
          // While a change is being located, the next one may be near.
          stride = std::min(target - walker.time, locating ? 8.0 * stride : convergent);
          for (; counted < walker.path.events.size(); ++counted) {
            const Event& event = walker.path.events[counted];
            const int joint = event.joint + (event.is_revolute ? sliders : 0);
            if (++changes[index(joint)] <= most_changes) continue;
            FailureFields fields = failure_at(FailureKind::unsettled_joint, model, walker.time);
            fields.before = to_string(event.before);
            fields.after = to_string(event.after);
            fail_joint(std::move(fields), named(model, joint));
          }
        } else {
          stride = std::max(0.125 * (goal - walker.time), tolerance);
          if (end == StepEnd::not_converged) convergent = stride;
          locating = end == StepEnd::event_inside;
        }
        walker.path.complete = !options.progress || options.progress(walker.time / duration);
      }
      if (!walker.path.complete) break;
      if (k > 0 && !options.cycle_ends_only) walker.path.states.push_back(walker.state);
    }
    if (walker.path.complete) walker.refuse_buckled(walker.time);
    if (walker.path.complete && times[b + 1] >= cycle * model.programs.front().period) {
      walker.path.cycle_ends.push_back(walker.state);
      ++cycle;
    }
  }
  walker.path.factorizations = walker.newton.factorizations();
  if (options.cycle_ends_only) walker.path.states = walker.path.cycle_ends;
  return std::move(walker.path);
}

}  // namespace statejump::truss
