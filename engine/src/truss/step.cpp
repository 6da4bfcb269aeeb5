// SPDX-License-Identifier: GPL-3.0-or-later
#include "path_follower.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "condense.hpp"
#include "status_enumeration.hpp"

namespace statejump::truss::detail {

namespace {

/// One step may use this fraction of the energy error that is still allowed for events.
constexpr double share_of_an_event = 0.02;
/// Number of steps after an energy error until a longer step is attempted. Failed attempts then add
/// at most a tenth to the cost.
constexpr int most_held_steps = 10;

}  // namespace

/// Whether a joint that stopped sliding before `target` may have slid by more than rounding before
/// it stopped. This slide is lost if the joint sticks at the end of the step. If a joint comes to
/// rest smoothly, the lost slide is too small to justify a shorter step.
bool PathFollower::slide_at_stake(int i, JointStatus before, double target,
                                  const Rounding& rounding) const {
  if (before == JointStatus::open) return true;
  double least = 10.0 * system.slide_rounding(i, z, time, origin, rounding);
  if (!options.locate_events) {
    least += options.event_tolerance * joint(i, [](const auto& one) { return one.least_slide(); });
  }
  return std::abs(slide_rate[i]) * (target - time) > least;
}

/// Fraction of the step to `to`, interpolated linearly, at which a stiffness first jumps; 1: none
/// jumps.
double PathFollower::first_edge(double target, const VectorXd& to, const StepStart& begin,
                                const Rounding& rounding) const {
  const VectorXd before = system.beyond_edges(z, time, origin);
  const VectorXd after = system.beyond_edges(to, target, begin);
  double share = 1.0;
  for (Eigen::Index i = 0; i < before.size(); ++i) {
    if (!(before[i] * after[i] < 0.0)) continue;
    if (std::min(std::abs(before[i]), std::abs(after[i])) <= rounding.length) continue;
    share = std::min(share, before[i] / (before[i] - after[i]));
  }
  return share;
}

/// Whether the energy balance of a step is accurate enough. If a shorter step did not halve the
/// error, it is rounding, and the step is accepted. Half of the allowed error is distributed over
/// time. Each step may use a small fraction of the other half, so that single events do not need
/// short steps. Work absorbed by dashpots of slack joints is no error.
/// Without temperature changes the error is rounding, and the work has no scale.
bool PathFollower::balances(const State& next, const VectorXd& to, double step, double taken) {
  const double duration = model.programs.front().duration();
  const double heat = next.joint_dissipation.sum();
  const double work = next.thermal_work - state.thermal_work;
  const double unbalanced = work - (next.elastic_energy - state.elastic_energy) -
                            (next.load_potential - state.load_potential) -
                            (heat - state.joint_dissipation.sum());
  // Dashpot forces jump to zero at the start of a step. The trapezoidal rule for the bars thus
  // assigns to the dashpots at most their mean force in this and the previous step times the
  // motion.
  const double by_dashpots = 0.5 * (taken + std::sqrt(taken * slack_work));
  const double gained = std::min(0.0, unbalanced) + std::max(0.0, unbalanced - by_dashpots);
  largest_work = std::max(largest_work, std::abs(next.thermal_work));
  // At the start of a path its largest work is extrapolated.
  const double scale = std::max(largest_work, std::abs(work) * duration / step);
  const double half = 0.5 * options.energy_tolerance * scale;
  const double lost = std::abs(gained);
  const double stored = std::abs(next.elastic_energy) + std::abs(next.load_potential) + heat;
  // Rounding error of the energies, plus the work that the rounding errors of forces do in this
  // step.
  double rounding =
      4.0 * std::numeric_limits<double>::epsilon() * (stored + std::abs(next.thermal_work)) +
      system.force_rounding(to) * length_of(to - z, system.displacements()) *
          std::sqrt(static_cast<double>(element_count(model)));
  // If parts expand freely, all work is rounding, or an error caused by the replacement of the path
  // by chords.
  if (stored < lost) rounding += system.force_rounding(to) * system.reach(to);
  const double by_time = half * step / duration;
  const double by_event = share_of_an_event * std::max(0.0, half - std::abs(energy_gained));
  const double allowed = std::max(by_time, by_event) + rounding;
  // The error of work and heat is of fourth order in the step length, or higher.
  const double longer = step * std::sqrt(std::sqrt(0.5 * allowed / std::max(lost, rounding)));
  const bool is_smooth = !system.slips_smoothly() && !system.has_kinks();
  const bool heats = std::any_of(
      model.programs.begin(), model.programs.end(), [&](const thermal::Program& program) {
        return program.temperature_change(time) != program.temperature_change(time + step);
      });
  const bool controlled = options.locate_events && is_smooth && !passes_changes && heats;
  if (controlled && step > shortest_balanced && lost > allowed && lost < 0.5 * refused_loss) {
    refused_loss = lost;
    steps_to_hold = most_held_steps;
    balanced_step = std::max(std::clamp(longer, 0.1 * step, 0.7 * step), shortest_balanced);
    return false;
  }
  refused_loss = std::numeric_limits<double>::infinity();
  steps_to_hold = std::max(0, steps_to_hold - 1);
  if (controlled && steps_to_hold == 0) balanced_step = std::max(1.1 * balanced_step, longer);
  energy_gained += gained;
  slack_work = taken;
  return true;
}

/// Attempts one step. The step is committed if it converges, and either contains no event or is not
/// longer than `tolerance`. Otherwise the state is unchanged.
StepEnd PathFollower::step_to(double target, double tolerance) {
  slip_is_unstable = false;
  // The sum time + tolerance is rounded.
  const bool is_short = target - time <= 1.5 * tolerance;
  // A joint that opens may leave a mechanism. Only a short step can detect this, so short steps
  // have dashpots.
  origin.slack_stiffness = is_short || is_slack ? system.slack_stiffness(slack_level) : 0.0;
  origin.is_loose = is_loose;
  VectorXd trial = z;
  Statuses trial_statuses =
      is_short && !changed_at_start.empty() ? changed_at_start : origin.statuses;
  const StepStart& begin = origin;
  // For event detection, the solve ends at the first status change, or passes it if changes are not
  // to be located.
  std::optional<EventSearch> search;
  if (!is_short) {
    search = EventSearch{time, tolerance / (target - time), options.locate_events && locates,
                         rate.size() == 0 ? z : VectorXd(z + (target - time) * rate)};
  }
  SolveReport report = newton.solve(target, begin, JointModel::friction, 1.0,
                                    options.most_iterations, trial, trial_statuses, search);
  search.reset();  // frees a vector of all unknowns
  const bool hinted = is_short && !std::exchange(changed_at_start, {}).empty();
  if (hinted && report.end != SolveEnd::stopped) {
    looks_at_start = report.end == SolveEnd::converged && trial_statuses != origin.statuses;
    if (report.end != SolveEnd::converged) return step_to(target, tolerance);
  }
  event_share = report.first_change;
  if (report.end == SolveEnd::event_ahead) {
    ++path.solves;
    return StepEnd::event_inside;
  }
  if (is_short) {
    try {
      report = continue_from_event(target, trial, trial_statuses, report);
    } catch (const Failure&) {
      // There may be a unique continuation from the present statuses.
      if (!hinted) throw;
      looks_at_start = false;
      return step_to(target, tolerance);
    }
  }
  if (report.end == SolveEnd::converged && options.locate_events) {
    report = slide_on(target, is_short, trial, trial_statuses, std::move(report));
  }
  if (report.end == SolveEnd::stopped) return StepEnd::stopped;
  if (report.end != SolveEnd::converged) {
    ++path.solves;
    if (!is_short) {
      // Without dashpots a failed step with slack elements has no meaning.
      const bool is_free =
          any_open(trial_statuses) || any_open(origin.statuses) || report.end == SolveEnd::singular;
      if (!is_free || is_slack) return StepEnd::not_converged;
      is_slack = true;
      return step_to(target, tolerance);
    }
    system.settle(trial, target, begin, trial_statuses);
    origin.statuses = trial_statuses;
    fail(report, JointModel::friction, target, "no equilibrium");
  }
  const Rounding rounding = system.rounding(z);
  slip_is_unstable = !is_short && passes_instability(trial_statuses);
  if (slip_is_unstable) {
    ++path.solves;
    // Slack elements under compression are bounded by their play.
    if (stiffen_slack(trial_statuses)) return step_to(target, tolerance);
    return StepEnd::event_inside;
  }
  if (!is_short && options.locate_events && locates) {
    event_share = first_edge(target, trial, begin, rounding);
    if (event_share < 1.0) {
      ++path.solves;
      return StepEnd::event_inside;
    }
  }
  // If a joint was predicted to slip but has another status at the end of the step, it has slid in
  // between.
  const auto slid_between = [&](const std::pair<int, JointStatus>& left) {
    return is_slip(left.second) && left.second != trial_statuses[index(left.first)] &&
           system.remembers_when(left.first, left.second, trial_statuses[index(left.first)]);
  };
  if (!is_short && locates && report.leaving && slid_between(*report.leaving)) {
    ++path.solves;
    return StepEnd::event_inside;
  }
  const double idle_force = system.idle_force(trial, target, begin, trial_statuses);
  const auto is_idle = [&](int i) { return system.is_idle(i, z, trial, idle_force); };
  // Whether the time at which a joint changes its status within the step affects the state.
  const auto matters = [&](int i) {
    const JointStatus before = origin.statuses[index(i)];
    const JointStatus after = trial_statuses[index(i)];
    if (before == after || !system.is_event(i, before, after) || is_idle(i)) return false;
    return system.remembers_when(i, before, after) ? slide_at_stake(i, before, target, rounding)
                                                   : options.locate_events;
  };
  if (!is_short && locates && system.first_joint(matters) >= 0) {
    // If a contact closes, its status at the end of the step does not show with which status it
    // closes.
    const int closes = system.first_joint([&](int i) {
      return origin.statuses[index(i)] == JointStatus::open &&
             trial_statuses[index(i)] != JointStatus::open;
    });
    if (options.locate_events && looks_at_start && closes < 0 && !report.leaving) {
      // All changes seem to occur at the start. Their statuses are stored, because rounding hides
      // them in a short step.
      changed_at_start = trial_statuses;
      event_share = 0.0;
    }
    expects_at_start = report.leaves_at_start && looks_at_start && is_loose;
    if (expects_at_start) event_share = 0.0;
    ++path.solves;
    return StepEnd::event_inside;
  }
  // Joints whose changes would be located if they did not repeat. Much shorter steps than an
  // increment resolve them.
  std::vector<int> passed;
  if (options.locate_events && !locates && target - time > shortest_balanced) {
    for (int i = 0; i < static_cast<int>(model.joints.size()); ++i) {
      if (matters(i)) passed.push_back(i);
    }
  }
  std::vector<Event> events;
  std::set<int> idle;
  bool opened = false;
  const int joints = static_cast<int>(model.joints.size());
  for (int i = 0; i < joints; ++i) {
    const JointStatus before = origin.statuses[index(i)];
    const JointStatus after = trial_statuses[index(i)];
    if (before == after) continue;
    if (!system.is_event(i, before, after)) continue;
    events.push_back(
        {target, target - time, model.temperature_change(0, 1.0, target), i, before, after});
    opened = opened || after == JointStatus::open;
    if (is_idle(i)) idle.insert(i);
  }
  const int jumps = system.first_joint([&, moved = system.displacements(trial)](int i) {
    const Trial at = system.trial(i, trial, moved, target, begin, JointModel::friction, 1.0);
    const JointStatus status = trial_statuses[index(i)];
    return !is_idle(i) && joint(i, [&](const auto& one) { return one.jumps(at, status); });
  });
  if (jumps >= 0) {
    if (is_short) {
      fail_joint(failure_at(FailureKind::jump_across_play, model, target), named(model, jumps));
    }
    ++path.solves;
    return StepEnd::event_inside;
  }
  // Events of partial slip are not located. The start and end of full sliding are reported for the
  // step in which they are found.
  const Statuses decided = trial_statuses;
  system.settle(trial, target, begin, trial_statuses);
  for (int i = 0; i < joints; ++i) {
    const JointStatus status = trial_statuses[index(i)];
    if (status == decided[index(i)]) continue;
    events.push_back({target, target - time, model.temperature_change(0, 1.0, target), i,
                      decided[index(i)], status});
  }
  const std::vector<double> program_rates = program_rates_before(target);
  VectorXd rate_after;
  VectorXd slide_rate_after = VectorXd::Zero(joints);
  // On a smooth part of the path, a good guess of the rates is that of the parabola through both
  // ends.
  const bool follows = !is_short && rate.size() > 0 && trial_statuses == origin.statuses;
  const VectorXd guess =
      follows ? VectorXd(2.0 / (target - time) * (trial - z) - rate) : VectorXd();
  if (const auto found =
          newton.rate(system.heating(trial, target, begin, trial_statuses, program_rates), guess)) {
    rate_after = *found;
    slide_rate_after =
        system.slide_rates(trial, target, begin, trial_statuses, rate_after, program_rates);
  }
  StepStart after = system.commit(trial, target, trial_statuses, begin);
  const VectorXd slips = system.slips(trial, target, begin, after);
  const Ends ends{time, target,     begin,      trial_statuses,   z,    trial,
                  rate, rate_after, slide_rate, slide_rate_after, slips};
  // The cubics are valid only if at most one joint changes its status. Without event location, a
  // step may contain many changes.
  const bool told = options.locate_events || events.size() <= 1;
  if (!is_short && told && rate.size() > 0 && rate_after.size() > 0) {
    event_share = locates ? first_turn(ends) : 1.0;
    const bool follows_rates = event_share == 1.0 && follows_its_rates(ends);
    if (!follows_rates) {
      ++path.solves;
      if (event_share < 1.0 || is_slack || !any_open(origin.statuses)) return StepEnd::event_inside;
      // An element that dashpots held until now is nearly free.
      is_slack = true;
      return step_to(target, tolerance);
    }
  }
  const bool smooth = trial_statuses == origin.statuses && !is_short;
  const Way way{z, time, trial, target, smooth ? &rate : nullptr, smooth ? &rate_after : nullptr};
  const std::optional<System::Halves> halves = system.halves_of(way, begin, trial_statuses);
  system.note_slides(way, halves, begin, after);
  if (halves && begin.last_step == 0.0 && !after.lost.isZero(0.0)) {
    // The first step of a smooth part had no predicted quadrature error. It is repeated with the
    // error found.
    ++path.solves;
    origin.lost = after.lost;
    origin.last_step = way.step();
    return step_to(target, tolerance);
  }
  State next = state;
  system.account(way, halves, begin, after, slips, next);
  system.describe(trial, target, after, next);
  if (!balances(next, trial, way.step(), system.slack_work(trial, target, begin, trial_statuses))) {
    ++path.solves;
    return StepEnd::imprecise;
  }
  note(report);
  // The order of several changes is unknown.
  if (passed.size() > 1 && noted.count(NoteKind::not_located) == 0) {
    note(NoteKind::not_located, target, passed);
  }
  if (opened || is_slack) {
    is_slack =
        (!opened && trial_statuses == origin.statuses) || note_slack(target, trial, trial_statuses);
  }
  // Dashpots soften as soon as steps allow.
  slack_level = is_slack ? std::max(softest_level, slack_level - softer) : 0.0;
  if (slack_level == 0.0) after.damps_contact = false;
  note_not_unique(target);
  const std::vector<double>& asked = options.problem_times;
  if (path.problems.size() < asked.size() && target >= asked[path.problems.size()]) {
    path.problems.push_back(local_problem(system, trial, target, begin, trial_statuses));
  }
  changed_at_start.clear();
  idle_changes = std::move(idle);
  const bool is_confirmed = !std::exchange(expects_at_start, false) || !events.empty();
  looks_at_start = (looks_at_start && is_confirmed) || events.size() > idle_changes.size();
  if (record != nullptr) {
    const MemoryWriter writer = std::exchange(first_writer, MemoryWriter::commit);
    const bool is_first = writer != MemoryWriter::commit;
    record->steps.push_back({.writer = writer,
                             .written_at = is_first ? z : VectorXd(),
                             .written_with = is_first ? begin.statuses : Statuses(),
                             .start = begin,
                             .time = target,
                             .z = trial,
                             .statuses = trial_statuses,
                             .is_short = is_short});
  }
  state = std::move(next);
  rate = rate_after;
  slide_rate = slide_rate_after;
  z = trial;
  origin = std::move(after);
  is_loose = is_loose && is_slack;
  time = target;
  path.events.insert(path.events.end(), events.begin(), events.end());
  if (!events.empty() && options.locate_events && !options.cycle_ends_only) {
    path.states.push_back(state);
  }
  return StepEnd::done;
}

/// Takes a step. Without a solution, dashpots of slack or opening joints are stiffened; finally a
/// snap is followed.
/// @param until time of the next corner of the programs, before which a snap must end [s]
StepEnd PathFollower::step_with_slack(double target, double until, double tolerance) {
  const Statuses before = origin.statuses;
  for (;;) {
    try {
      return step_to(target, tolerance);
    } catch (const Failure&) {
      const Statuses reached = std::exchange(origin.statuses, before);
      if (flickers && damp()) continue;
      if (stiffen_slack(before) || stiffen_slack(reached)) continue;
      if (follow_snap(until, tolerance)) return StepEnd::done;
      if (damp()) continue;
      throw;
    }
  }
}

}  // namespace statejump::truss::detail
