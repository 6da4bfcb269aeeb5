// SPDX-License-Identifier: GPL-3.0-or-later
#include "statejump/truss/path.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>

#include "condense.hpp"
#include "hermite.hpp"
#include "newton.hpp"
#include "statejump/failure.hpp"

namespace statejump::truss {

using detail::Ahead;
using detail::Cubic;
using detail::FoundModes;
using detail::index;
using detail::Newton;
using detail::SolveEnd;
using detail::SolveReport;
using detail::Statuses;
using detail::StepStart;
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

FailureJoint named(const Model& model, int joint) {
  const Joint& one = model.joints[index(joint)];
  return {kind_of(one), name_of(one)};
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

/// How a step ended: with the state moved on, or back at its start.
enum class StepEnd : unsigned char { done, event_inside, not_converged, stopped };

/// Both ends of a step that has converged.
struct Ends {
  double from_time;
  double to_time;
  const StepStart& start;
  const Statuses& statuses;  ///< At its end.
  const VectorXd& from;
  const VectorXd& to;
  const VectorXd& from_rate;
  const VectorXd& to_rate;
  const VectorXd& from_slide_rate;
  const VectorXd& to_slide_rate;
  const VectorXd& slips;
};

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
  /// Share of the last step that was tried after which its first event comes; 1: unknown.
  double event_share = 1.0;
  /// Rates of the unknowns at `time`; empty where they are not known.
  VectorXd rate;
  /// How fast every joint that slips slides at `time` [m/s].
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
    for (const int joint : report.joints) fields.joints.push_back(named(model, joint));
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
  [[noreturn]] void refuse_undetermined(FailureKind kind, FoundModes found) const;
  void refuse_buckled(double when) const;
  StepEnd step_to(double target, double tolerance);
  bool slide_at_stake(int joint, JointStatus before, double target,
                      const detail::Rounding& rounding) const;
  double first_turn(const Ends& ends) const;
  double turn_of_slip(int joint, const Ends& ends, const detail::Rounding& rounding) const;
  double turn_of_stick(int joint, const Ends& ends, const detail::Rounding& rounding) const;

  /// What the type of a joint says.
  template <class Ask>
  auto joint(int i, Ask&& ask) const {
    return std::visit(ask, model.joints[index(i)]);
  }
};

/// Relaxes the drawn shape at ΔT = 0; see solve().
void Walker::start() {
  origin.statuses = system.all_stick();
  z = VectorXd::Zero(system.unknowns());
  if (FoundModes modes = detail::mechanism(system, z, 0.0, origin.statuses, JointModel::pins)) {
    fail_modes(failure_at(FailureKind::held_mechanism, model, 0.0), std::move(modes));
  }
  const StepStart begin = system.begin(z, 0.0, origin.statuses, 1.0);
  const SolveReport report =
      newton.solve(0.0, begin, JointModel::pins, 1.0, options.most_iterations, z, origin.statuses);
  note(report);
  if (report.end == SolveEnd::stopped) {
    path.complete = false;
    return;
  }
  if (report.end != SolveEnd::converged) {
    fail(report, JointModel::pins, 0.0, "no equilibrium of the drawn shape");
  }
  refuse_buckled(0.0);
  open_clearances();
}

/// Throws if the state is unstable whatever the joints do.
void Walker::refuse_buckled(double when) const {
  if (FoundModes modes = detail::buckling(system, z, when, origin.statuses)) {
    fail_modes(failure_at(FailureKind::buckled, model, when), std::move(modes));
  }
}

/// Refuses a start at which joints that do not touch leave a motion free, named by the first of
/// them that it moves.
void Walker::refuse_undetermined(FailureKind kind, FoundModes found) const {
  FailureFields fields = failure_at(kind, model, 0.0);
  const auto moves = [&](int i) {
    const Trial at = system.trial(i, z, 0.0, origin, JointModel::pins, 1.0);
    for (const FailureMode& mode : found.modes) {
      for (const ModeNode& moved : mode) {
        for (const int node : {at.frame.nodes[0], at.frame.nodes[1]}) {
          if (node >= 0 && model.nodes[index(node)].name == moved.node) return true;
        }
      }
    }
    return false;
  };
  int named_one = -1;
  for (int i = 0; i < static_cast<int>(model.joints.size()); ++i) {
    if (origin.statuses[index(i)] != JointStatus::open) continue;
    if (named_one < 0) named_one = i;
    if (!moves(i)) continue;
    named_one = i;
    break;
  }
  fields.joints.push_back(named(model, named_one));
  fail_modes(std::move(fields), std::move(found));
}

void Walker::open_clearances() {
  std::vector<int> with_play;
  for (int i = 0; i < static_cast<int>(model.joints.size()); ++i) {
    if (joint(i, [](const auto& one) { return one.has_play(); })) with_play.push_back(i);
  }
  if (with_play.empty()) return;
  // Below this a pin force is rounding of what the stiffest part would carry.
  const double rounding = 1e-14 * system.stiffness_scale() * system.size();
  const auto seat = [&](int i, const VectorXd& at, double opened, double next) {
    const Trial trial = system.trial(i, at, 0.0, origin, JointModel::pins, opened);
    return joint(i, [&](const auto& one) { return one.seat(trial, opened, next, rounding); });
  };
  const auto opens = [&](int i) { return origin.statuses[index(i)] == JointStatus::open; };
  origin = system.begin(z, 0.0, origin.statuses, 1.0);
  // The journal touches where its pin force pushes. One that nothing pushes stays in the middle, if
  // something else than its contact holds it there.
  for (const int i : with_play) {
    const bool touches = seat(i, z, 0.0, 1.0).touches;
    origin.statuses[index(i)] = touches ? JointStatus::slip_plus : JointStatus::open;
  }
  if (std::any_of(with_play.begin(), with_play.end(), opens)) {
    FoundModes modes = detail::mechanism(system, z, 0.0, origin.statuses, JointModel::pins);
    if (modes) refuse_undetermined(FailureKind::unloaded_joint, std::move(modes));
  }
  // The clearances open little by little, each time from the last equilibrium, because the links
  // turn as they open.
  double opened = 0.0;
  double share = 0.125;
  while (opened < 1.0) {
    const double next = std::min(1.0, opened + share);
    VectorXd trial = z;
    Statuses trial_statuses = origin.statuses;
    for (const int i : with_play) {
      if (!opens(i)) system.apply(i, seat(i, z, opened, next), trial);
    }
    const StepStart begin = system.begin(trial, 0.0, trial_statuses, next);
    const SolveReport report = newton.solve(0.0, begin, JointModel::frictionless, next,
                                            options.most_iterations, trial, trial_statuses);
    note(report);
    if (report.end == SolveEnd::stopped) {
      path.complete = false;
      return;
    }
    if (report.end == SolveEnd::converged) {
      z = trial;
      origin.statuses = trial_statuses;
      opened = next;
      continue;
    }
    share *= 0.5;
    if (share < 1e-4) {
      // Contacts that the last try took away may be what it fails for.
      origin.statuses = trial_statuses;
      if (std::any_of(with_play.begin(), with_play.end(), opens)) {
        FoundModes modes =
            detail::mechanism(system, z, 0.0, origin.statuses, JointModel::frictionless);
        if (modes) refuse_undetermined(FailureKind::no_contact, std::move(modes));
      }
      fail(report, JointModel::frictionless, 0.0, "no equilibrium in contact at the start");
    }
  }
  for (const int i : with_play) {
    if (!opens(i)) origin.statuses[index(i)] = joint(i, [](const auto& one) { return one.rest(); });
  }
  if (std::none_of(with_play.begin(), with_play.end(), opens)) return;
  FoundModes modes = detail::mechanism(system, z, 0.0, origin.statuses, JointModel::friction);
  if (modes) refuse_undetermined(FailureKind::no_contact, std::move(modes));
  refuse_buckled(0.0);
}

/// Whether a joint that stopped sliding before `target` may have slid by more than rounding until
/// it did: slides of a step are lost when it ends in a stick. One that comes to rest smoothly
/// slides so little at last that no shorter step would tell.
bool Walker::slide_at_stake(int i, JointStatus before, double target,
                            const detail::Rounding& rounding) const {
  if (before == JointStatus::open) return true;
  double least = 1e3 * system.slide_rounding(i, z, time, origin, rounding);
  if (!options.locate_events) {
    least += options.event_tolerance * joint(i, [](const auto& one) { return one.least_slide(); });
  }
  return std::abs(slide_rate[i]) * (target - time) > least;
}

/// Share of a step after which the first joint turns round within it: one that slips the other way
/// for a while, or one that leaves its branch and comes back. 1: none does. The unknowns and the
/// slides are cubics through both ends of the step and their rates.
double Walker::first_turn(const Ends& ends) const {
  double first = 1.0;
  const detail::Rounding rounding = system.rounding(ends.to);
  for (int i = 0; i < static_cast<int>(model.joints.size()); ++i) {
    const JointStatus status = ends.statuses[index(i)];
    if (is_slip(status)) {
      first = std::min(first, turn_of_slip(i, ends, rounding));
    } else if (status == ends.start.statuses[index(i)]) {
      first = std::min(first, turn_of_stick(i, ends, rounding));
    }
  }
  return first;
}

double Walker::turn_of_slip(int i, const Ends& ends, const detail::Rounding& by) const {
  const JointStatus status = ends.statuses[index(i)];
  const bool matters =
      joint(i, [&](const auto& one) { return one.remembers_when(status, JointStatus::stick); });
  if (!matters) return 1.0;
  const double step = ends.to_time - ends.from_time;
  const double sense = status == JointStatus::slip_plus ? 1.0 : -1.0;
  const bool slipped = ends.start.statuses[index(i)] == status;
  const Cubic slide{0.0, sense * ends.slips[i],
                    slipped ? std::max(0.0, sense * step * ends.from_slide_rate[i]) : 0.0,
                    sense * step * ends.to_slide_rate[i]};
  const double rounding = system.slide_rounding(i, ends.to, ends.to_time, ends.start, by);
  if (slide.last_rate < -rounding) return slipped ? slide.turn(1.0) : 0.5;
  const auto slowest = slide.slowest();
  if (slipped && slowest && slide.rate(*slowest) < -rounding) return slide.turn(*slowest);
  return 1.0;
}

double Walker::turn_of_stick(int i, const Ends& ends, const detail::Rounding& rounding) const {
  const JointStatus status = ends.statuses[index(i)];
  const double step = ends.to_time - ends.from_time;
  const Trial first =
      system.trial(i, ends.from, ends.from_time, ends.start, JointModel::friction, 1.0);
  const Trial last = system.trial(i, ends.to, ends.to_time, ends.start, JointModel::friction, 1.0);
  const Trial first_rate =
      system.trial(i, ends.from_rate, ends.from_time, ends.start, JointModel::friction, 1.0);
  const Trial last_rate =
      system.trial(i, ends.to_rate, ends.to_time, ends.start, JointModel::friction, 1.0);
  const auto leaves = [&](double share) {
    Trial at = last;
    at.length_rounding = rounding.length;
    at.force_rounding = rounding.force;
    const JointFrame& frame = last.frame;
    if (frame.program >= 0) {
      at.temperature_change = model.temperature_change(frame.program, frame.temperature_fraction,
                                                       ends.from_time + share * step);
    }
    for (std::size_t k = 0; k < most_joint_nodes; ++k) {
      for (Eigen::Index x = 0; x < 3; ++x) {
        at.moved[k][x] = Cubic{first.moved[k][x], last.moved[k][x], step * first_rate.moved[k][x],
                               step * last_rate.moved[k][x]}
                             .at(share);
      }
    }
    for (std::size_t k = 0; k < most_joint_forces; ++k) {
      at.force[k] = Cubic{first.force[k], last.force[k], step * first_rate.force[k],
                          step * last_rate.force[k]}
                        .at(share);
    }
    return joint(i, [&](const auto& one) { return one.decide(at, status); }) != status;
  };
  // What goes to and fro is farthest where its rate is 0.
  double found = 1.0;
  const auto ask = [&](double from, double to, double from_rate, double to_rate) {
    if (!(from_rate * to_rate < 0.0)) return;
    const double sense = from_rate > 0.0 ? step : -step;
    const double share =
        Cubic{0.0, (from_rate > 0.0 ? 1.0 : -1.0) * (to - from), sense * from_rate, sense * to_rate}
            .turn(1.0);
    if (share < found && leaves(share)) found = share;
  };
  for (std::size_t k = 0; k < most_joint_forces; ++k) {
    ask(first.force[k], last.force[k], first_rate.force[k], last_rate.force[k]);
  }
  for (int k = 0; k < 3; ++k) {
    const Eigen::Vector3d along = last.frame.axes.col(k);
    const auto apart = [&](const Trial& of) { return along.dot(of.moved[0] - of.moved[1]); };
    ask(apart(first), apart(last), apart(first_rate), apart(last_rate));
  }
  return found;
}

/// One step, if it is converged and exact or no longer than `tolerance`; else nothing happens.
StepEnd Walker::step_to(double target, double tolerance) {
  // The sum time + tolerance is rounded.
  const bool is_short = target - time <= 1.5 * tolerance;
  VectorXd trial = z;
  Statuses trial_statuses = origin.statuses;
  const StepStart& begin = origin;
  // The first change ahead: passed where it need not be located, or no location is asked.
  const Ahead ahead{time, tolerance / (target - time), options.locate_events};
  const SolveReport report =
      newton.solve(target, begin, JointModel::friction, 1.0, options.most_iterations, trial,
                   trial_statuses, is_short ? std::optional<Ahead>() : ahead);
  event_share = report.first_change;
  if (report.end == SolveEnd::event_ahead) {
    ++path.solves;
    return StepEnd::event_inside;
  }
  if (report.end == SolveEnd::stopped) return StepEnd::stopped;
  if (report.end != SolveEnd::converged) {
    ++path.solves;
    if (!is_short) return StepEnd::not_converged;
    origin.statuses = trial_statuses;
    fail(report, JointModel::friction, target, "no equilibrium");
  }
  std::vector<Event> events;
  std::vector<FailureJoint> opened;
  const detail::Rounding rounding = system.rounding(z);
  const int joints = static_cast<int>(model.joints.size());
  for (int i = 0; i < joints; ++i) {
    const JointStatus before = origin.statuses[index(i)];
    const JointStatus after = trial_statuses[index(i)];
    if (before == after) continue;
    const bool remembers =
        joint(i, [&](const auto& one) { return one.remembers_when(before, after); });
    const bool matters =
        remembers ? slide_at_stake(i, before, target, rounding) : options.locate_events;
    if (!is_short && matters) {
      ++path.solves;
      return StepEnd::event_inside;
    }
    events.push_back(
        {target, target - time, model.temperature_change(0, 1.0, target), i, before, after});
    if (after == JointStatus::open) opened.push_back(named(model, i));
  }
  for (int i = 0; i < joints; ++i) {
    const Trial at = system.trial(i, trial, target, begin, JointModel::friction, 1.0);
    const JointStatus status = trial_statuses[index(i)];
    if (!joint(i, [&](const auto& one) { return one.jumps(at, status); })) continue;
    if (!is_short) {
      ++path.solves;
      return StepEnd::event_inside;
    }
    fail_joint(failure_at(FailureKind::jump_across_play, model, target), named(model, i));
  }
  if (!opened.empty()) {
    if (FoundModes modes =
            detail::mechanism(system, trial, target, trial_statuses, JointModel::friction)) {
      FailureFields fields = failure_at(FailureKind::opened_mechanism, model, target);
      fields.joints = std::move(opened);
      fail_modes(std::move(fields), std::move(modes));
    }
  }
  // The rates on this side of a corner that may be at `target`.
  std::vector<double> program_rates;
  for (const thermal::Program& program : model.programs) {
    const double near = std::min(Model::same_time * program.duration(), 0.5 * (target - time));
    program_rates.push_back(program.temperature_rate(target - near));
  }
  VectorXd rate_after;
  VectorXd slide_rate_after = VectorXd::Zero(joints);
  if (const auto found =
          newton.rate(system.heating(trial, target, begin, trial_statuses, program_rates))) {
    rate_after = *found;
    slide_rate_after =
        system.slide_rates(trial, target, begin, trial_statuses, rate_after, program_rates);
  }
  const StepStart after = system.commit(trial, target, trial_statuses, begin);
  const VectorXd slips = system.slips(trial, target, begin, after);
  const Ends ends{time, target,     begin,      trial_statuses,   z,    trial,
                  rate, rate_after, slide_rate, slide_rate_after, slips};
  if (!is_short && rate.size() > 0 && rate_after.size() > 0) {
    event_share = first_turn(ends);
    if (event_share < 1.0) {
      ++path.solves;
      return StepEnd::event_inside;
    }
  }
  note(report);
  const std::vector<double>& asked = options.problem_times;
  if (path.problems.size() < asked.size() && target >= asked[path.problems.size()]) {
    path.problems.push_back(detail::local_problem(system, trial, target, begin, trial_statuses));
  }
  const bool smooth = trial_statuses == origin.statuses && !is_short;
  system.account(z, time, trial, target, begin, after, slips, state, smooth ? rate : VectorXd(),
                 smooth ? rate_after : VectorXd());
  rate = rate_after;
  slide_rate = slide_rate_after;
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
  const double duration = model.programs.front().duration();
  double now = 0.0;
  const auto going_on = [&] { return !options.progress || options.progress(now / duration); };
  Walker walker{model, system, options, Newton(system, options.locate_events, going_on),
                {},    {},     {},      {},
                0.0,   1.0,    {},      {}};
  const auto joints = static_cast<Eigen::Index>(model.joints.size());
  walker.slide_rate = VectorXd::Zero(joints);
  walker.path.unknowns = system.unknowns();
  walker.state.joint_dissipation = VectorXd::Zero(joints);
  walker.start();
  walker.origin = system.begin(walker.z, 0.0, walker.origin.statuses, 1.0);
  system.describe(walker.z, 0.0, walker.origin, walker.state);
  walker.path.states.push_back(walker.state);
  walker.path.cycle_ends.push_back(walker.state);

  // In an increment a joint changes its status a few times, in a long chain as often as another one
  // starts to slide; many more are no path but a flicker.
  const int most_changes = 200 + 2 * static_cast<int>(joints);
  std::vector<int> changes(model.joints.size());
  const std::vector<double> times = corners(model);
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
          // While a change is being located, the next one may be near, and to pass it costs a pivot
          // for every joint that it moves. Where the one that was foreseen did not come, the
          // tangent of a long step does not tell what is near: steps grow little by little.
          const bool unchanged = counted == walker.path.events.size();
          const bool creeps = locating && (!options.locate_events || unchanged);
          stride = std::min(target - walker.time, creeps ? 8.0 * stride : convergent);
          for (; counted < walker.path.events.size(); ++counted) {
            const Event& event = walker.path.events[counted];
            if (++changes[index(event.joint)] <= most_changes) continue;
            FailureFields fields = failure_at(FailureKind::unsettled_joint, model, walker.time);
            fields.before = to_string(event.before);
            fields.after = to_string(event.after);
            fail_joint(std::move(fields), named(model, event.joint));
          }
        } else if (end == StepEnd::stopped) {
          walker.path.complete = false;
        } else {
          // Up to where the change is foreseen, and half of what it is located to before it; where
          // nothing is foreseen, to an eighth.
          const bool foreseen = end == StepEnd::event_inside && walker.event_share < 1.0;
          const double tried = goal - walker.time;
          stride = std::max(foreseen ? walker.event_share * tried - 0.5 * tolerance : 0.125 * tried,
                            tolerance);
          if (end == StepEnd::not_converged) convergent = stride;
          locating = end == StepEnd::event_inside;
        }
        now = walker.time;
        walker.path.complete = walker.path.complete && going_on();
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
