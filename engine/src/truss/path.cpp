// SPDX-License-Identifier: GPL-3.0-or-later
#include "statejump/truss/path.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>

#include "path_follower.hpp"
#include "spins.hpp"
#include "start_choice.hpp"
#include "statejump/truss/gradient.hpp"
#include "trace.hpp"

namespace statejump::truss {

using detail::failure_at;
using detail::index;
using detail::Newton;
using detail::PathFollower;
using detail::StepEnd;
using detail::System;
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

const char* to_string(NoteKind kind) {
  switch (kind) {
    case NoteKind::large_start:
      return "large_start";
    case NoteKind::slack:
      return "slack";
    case NoteKind::not_unique:
      return "not_unique";
    case NoteKind::snap:
      return "snap";
    case NoteKind::not_located:
      return "not_located";
    case NoteKind::free_spin:
      return "free_spin";
  }
  return "unknown";
}

Eigen::VectorXd output(const Model& model, const State& state, int joint, std::string_view key) {
  Eigen::Index at = 0;
  for (int i = 0; i <= joint; ++i) {
    for (const Output& one : outputs_of(model.joints[index(i)])) {
      if (i == joint && key == one.key) return state.joint_output.segment(at, one.width);
      at += one.width;
    }
  }
  throw std::out_of_range("the joint has no output '" + std::string(key) + "'");
}

namespace {

/// Consecutive steps that ended before a predicted change without approaching it.
constexpr int most_unconfirmed = 8;
/// Allowed number of consecutive attempts from one state whose predictions of a change do not
/// converge.
constexpr int most_foreseen = 4;
/// Largest number of located status changes of one joint per increment. After more changes, only
/// the energy balance limits the steps.
constexpr int most_located = 32;
/// Largest number of located status changes of all joints per increment while elements are slack.
/// Such elements make and lose contact repeatedly without significant forces.
constexpr int most_located_with_slack = 8;
/// While elements are slack, changes are no longer located after this many steps since the last
/// change.
constexpr int most_steps_with_slack = 256;
/// Steps after a failed one before a longer step is attempted.
constexpr int most_held = 4;
/// The predicted time to a change must decrease to this fraction with every step; otherwise the
/// change counts as unconfirmed.
constexpr double nearer = 0.95;

/// A note about the beams with spin springs.
Note spin_note(const Model& model) {
  Note made{NoteKind::free_spin, 0.0, model.temperature_change(0, 1.0, 0.0), {}};
  for (const SpinSpring& one : model.spin_springs) made.joints.push_back({"beam", one.name});
  return made;
}

}  // namespace

std::vector<double> detail::corners(const Model& model) {
  // If corners are merged, the time of the first program's corner is used, so that its cycles end
  // exactly. The last corner is the latest end of all programs.
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

namespace {

/// Follows the path; see solve().
/// @param record receives every equilibrium; null: nothing is recorded
Path follow(const Model& given, const Options& options, detail::PathRecord* record) {
  given.validate();
  Model with_springs;
  std::optional<System> built(std::in_place, given);
  if (std::vector<SpinSpring> springs = detail::spin_springs(*built); !springs.empty()) {
    with_springs = given;
    with_springs.spin_springs = std::move(springs);
    built.emplace(with_springs);
  }
  const System& system = *built;
  const Model& model = system.model();
  for (const Joint& joint : model.joints) {
    const auto* ball = std::get_if<BallJoint>(&joint);
    // Its rows are slides of the deflected contact.
    if (ball == nullptr || std::isfinite(ball->mindlin_stiffness)) continue;
    throw kernel::OutOfRange("ball_joint '" + ball->name + "'", "mindlin_stiffness",
                             ball->mindlin_stiffness, "finite but in motion");
  }
  kernel::require(options.increments_per_branch >= 1, "increments_per_branch",
                  options.increments_per_branch, ">= 1");
  kernel::require(options.event_tolerance > 0.0 && options.event_tolerance <= 1.0,
                  "event_tolerance", options.event_tolerance, "above 0 and at most 1");
  kernel::require(options.energy_tolerance > 0.0 && options.energy_tolerance <= 1.0,
                  "energy_tolerance", options.energy_tolerance, "above 0 and at most 1");
  kernel::require(options.most_iterations >= 2, "most_iterations", options.most_iterations, ">= 2");
  kernel::require(options.most_steps >= 1, "most_steps", options.most_steps, ">= 1");
  const double duration = model.programs.front().duration();
  double now = 0.0;
  const auto going_on = [&] { return !options.progress || options.progress(now / duration); };
  detail::Tracer tracer(model, options.trace);
  PathFollower follower{.model = model,
                        .system = system,
                        .options = options,
                        .newton = Newton(system, options.locate_events, going_on),
                        .rates = detail::RateProblem(system),
                        .record = record};
  if (record != nullptr) record->model = model;
  if (tracer) follower.newton.trace(&tracer);
  const auto joints = static_cast<Eigen::Index>(model.joints.size());
  follower.slide_rate = VectorXd::Zero(joints);
  follower.path.unknowns = system.unknowns();
  follower.state.joint_dissipation = VectorXd::Zero(joints);
  if (!model.spin_springs.empty()) follower.path.notes.push_back(spin_note(model));
  detail::start_as_chosen(follower);
  follower.is_slack = follower.note_slack(0.0, follower.z, follower.origin.statuses);
  system.describe(follower.z, 0.0, follower.origin, follower.state);
  if (!options.cycle_ends_only) follower.path.states.push_back(follower.state);
  std::vector<int> changes(model.joints.size());
  const std::vector<double> times = detail::corners(model);
  const auto end_cycle = [&] {
    follower.path.cycle_ends.push_back(follower.state);
    if (record != nullptr) record->cycle_ends.push_back(record->steps.size() - 1);
  };
  end_cycle();
  if (record != nullptr) record->corners = times;
  int cycle = 1;
  for (std::size_t b = 0; b + 1 < times.size() && follower.path.complete; ++b) {
    const double length = times[b + 1] - times[b];
    const double tolerance = options.event_tolerance * length;
    follower.shortest_balanced =
        length / (PathFollower::most_parts * static_cast<double>(options.increments_per_branch));
    follower.slack_level = 0;
    follower.snap_travel = 0.0;
    // longest step for which Newton's method is expected to converge [s]
    double convergent = length;
    for (int k = 0; k <= options.increments_per_branch; ++k) {
      // k = 0 is a short first step after the corner of the programs, in which slipping joints
      // start to stick.
      const double target = k == 0 ? times[b] + tolerance
                            : k == options.increments_per_branch
                                ? times[b + 1]
                                : times[b] + length * k / options.increments_per_branch;
      std::size_t counted = follower.path.events.size();
      std::fill(changes.begin(), changes.end(), 0);
      // Step length that divides the remaining increment into equal steps, each not longer than
      // balanced_step.
      const auto balanced = [&] {
        const double left = target - follower.time;
        return left / std::ceil(std::max(1.0, left / follower.balanced_step));
      };
      double stride = std::min(balanced(), convergent);
      bool locating = false;
      // Consecutive attempts from one state whose predictions of a change did not converge.
      int foreseen_from_here = 0;
      double short_by_before = 1.0;  // fraction of the last step beyond the predicted change
      int steps = 0;                 // since the last change
      // Predicted time until the next change [s], and the minimum of this time since the last
      // change.
      double ahead = length, least_ahead = length;
      bool foresaw = false;
      int unconfirmed = 0;
      int swinging = 0;  // failed steps while elements were slack
      follower.passes_changes = follower.note_many_open(follower.time);
      follower.flickers = follower.passes_changes;
      follower.locates = !follower.flickers;
      int located = 0;  // changes while elements were slack
      int held = 0;     // remaining steps before a longer one is attempted
      follower.softest_level = 0.0;
      int unstable = 0;  // steps with unstable slip since the last change
      while (follower.time < target && follower.path.complete) {
        tracer.begin_step(static_cast<int>(b) + 1, k);
        const double goal = std::max(std::nextafter(follower.time, target),
                                     std::min(target, follower.time + stride));
        const double from = follower.time;
        const double shortest = std::nextafter(from, target) - from;
        const StepEnd end =
            follower.step_with_slack(goal, times[b + 1], std::max(tolerance, shortest));
        if (end == StepEnd::done) {
          if (held == 0) convergent = std::max(2.0 * convergent, tolerance);
          held = std::max(0, held - 1);
          foreseen_from_here = 0;
          short_by_before = 1.0;
          // Steps grow gradually in two cases. While a change is located, the next change may be
          // near, and a step past it costs a pivot for every affected joint. If a predicted change
          // did not occur, the tangent of a long step is not reliable.
          const bool unchanged =
              follower.path.events.size() - counted == follower.idle_changes.size();
          const bool creeps = locating && (!options.locate_events || unchanged);
          stride = std::min(balanced(), creeps ? 8.0 * stride : convergent);
          if (foresaw) unconfirmed = ahead >= nearer * least_ahead ? unconfirmed + 1 : 0;
          if (foresaw) least_ahead = std::min(least_ahead, ahead);
          foresaw = false;
          // The counters are not reset by changes of a joint whose status alternates.
          if (!unchanged && !follower.flickers) {
            steps = unconfirmed = unstable = swinging = 0;
            least_ahead = length;
          }
          for (; counted < follower.path.events.size(); ++counted) {
            const Event& event = follower.path.events[counted];
            if (follower.idle_changes.count(event.joint) > 0) continue;
            const bool is_often = ++changes[index(event.joint)] > most_located;
            const bool are_many = follower.has_slack() && ++located > most_located_with_slack;
            follower.flickers = follower.flickers || is_often || are_many;
          }
          // Two types of changes are not located: those whose predicted time recedes with every
          // step, and those of joints whose status alternates.
          follower.locates = !follower.flickers && unconfirmed < most_unconfirmed;
        } else if (end == StepEnd::stopped) {
          follower.path.complete = false;
        } else if (end == StepEnd::imprecise) {
          stride = std::max(balanced(), tolerance);
        } else {
          // The next step ends half a tolerance before the predicted change. If predictions do not
          // converge, it covers half of the distance; without a prediction, an eighth of the failed
          // step.
          const bool foreseen = end == StepEnd::event_inside && follower.event_share < 1.0;
          const double tried = goal - from;
          // If the change is real, every attempt more than halves the part of the step beyond it.
          const double short_by = 1.0 - follower.event_share;
          foreseen_from_here = short_by > 0.5 * short_by_before ? foreseen_from_here + 1 : 0;
          short_by_before = short_by;
          const bool moves = foreseen && foreseen_from_here > most_foreseen;
          const double change_in = follower.event_share * tried;
          const double shorter = !foreseen ? 0.125 * tried
                                 : moves   ? 0.5 * change_in
                                           : change_in - 0.5 * tolerance;
          stride = std::max(shorter, tolerance);
          if (follower.slip_is_unstable && ++unstable >= most_unconfirmed) {
            unstable = 0;
            follower.follow_snap(times[b + 1], std::max(tolerance, shortest));
          }
          // Slack elements on soft dashpots oscillate. Stiffer dashpots allow longer steps.
          const bool swings = end == StepEnd::not_converged && follower.has_slack();
          if (swings && (follower.flickers || ++swinging >= most_unconfirmed) && follower.damp()) {
            swinging = 0;
            stride = std::max(stride, 0.5 * tried);
          }
          if (end == StepEnd::not_converged) {
            convergent = stride;
            held = most_held;
          }
          locating = end == StepEnd::event_inside;
          ahead = follower.event_share * tried;
          foresaw = foresaw || (locating && !follower.slip_is_unstable);
        }
        if (steps > most_steps_with_slack && follower.has_slack()) follower.flickers = true;
        if (++steps > options.most_steps) {
          FailureFields fields = failure_at(FailureKind::too_many_steps, model, follower.time);
          fields.numbers = {{"steps", options.most_steps}, {"last_step_s", goal - from}};
          throw Failure(std::move(fields));
        }
        tracer.end_step(end);
        now = follower.time;
        follower.path.complete = follower.path.complete && going_on();
      }
      if (!follower.path.complete) break;
      if (k > 0 && !options.cycle_ends_only) follower.path.states.push_back(follower.state);
    }
    if (follower.path.complete) follower.refuse_buckled(follower.time);
    if (follower.path.complete && times[b + 1] >= cycle * model.programs.front().period) {
      end_cycle();
      ++cycle;
    }
  }
  follower.path.factorizations = follower.newton.factorizations();
  if (options.cycle_ends_only) follower.path.states = follower.path.cycle_ends;
  return std::move(follower.path);
}

}  // namespace

Path solve(const Model& model, const Options& options) {
  return follow(model, options, nullptr);
}

RecordedPath solve_recorded(const Model& model, const Options& options) {
  const auto record = std::make_shared<detail::PathRecord>();
  Path path = follow(model, options, record.get());
  return {std::move(path), record};
}

}  // namespace statejump::truss
