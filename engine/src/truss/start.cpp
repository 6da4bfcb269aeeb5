// SPDX-License-Identifier: GPL-3.0-or-later
#include "path_follower.hpp"
#include "status_enumeration.hpp"

#include <algorithm>
#include <utility>
#include <vector>

namespace statejump::truss::detail {

namespace {

/// Smallest step of the opened fraction of the clearances.
constexpr double least_opening = 1e-4;
/// Step of the opened fraction, at first and after a difficult step.
constexpr double first_opening = 0.125;

}  // namespace

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

void fail_modes(FailureFields fields, FoundModes found) {
  fields.modes = std::move(found.modes);
  fields.mode_count = found.count;
  fields.more_modes = found.more;
  throw Failure(std::move(fields));
}

void fail_joint(FailureFields fields, FailureJoint joint) {
  fields.joints.push_back(std::move(joint));
  throw Failure(std::move(fields));
}

void PathFollower::fail(const SolveReport& report, JointModel joints, double when,
                        const char* sought) {
  refuse_mechanism(when, origin.statuses, joints);
  refuse_buckled(when);
  const FailureKind kind =
      report.end == SolveEnd::singular ? FailureKind::singular : FailureKind::not_converged;
  FailureFields fields = failure_at(kind, model, when);
  fields.sought = sought;
  for (const int joint : report.joints) fields.joints.push_back(named(model, joint));
  throw Failure(std::move(fields));
}

void PathFollower::note(const SolveReport& report) {
  ++path.solves;
  path.largest_force_residual = std::max(path.largest_force_residual, report.force_residual);
  path.largest_closure_residual = std::max(path.largest_closure_residual, report.closure_residual);
}

/// Records the present state as an equilibrium before the path.
/// @param from start of the solve that led to it
/// @param written_at, written_with where `writer` wrote the memory in `from`, unless it was written
/// by the end of the last recorded step
void PathFollower::record_start(const StepStart& from, MemoryWriter writer, JointModel joints,
                                double opening, const VectorXd& written_at,
                                const Statuses& written_with) {
  if (record == nullptr) return;
  record->steps.push_back({.writer = writer,
                           .written_at = written_at,
                           .written_with = written_with,
                           .written_opening = opening,
                           .start = from,
                           .z = z,
                           .statuses = origin.statuses,
                           .joints = joints,
                           .opening = opening});
}

/// Relaxes the reference configuration at ΔT = 0; see solve().
void PathFollower::start() {
  origin.statuses = system.all_stick();
  z = VectorXd::Zero(system.unknowns());
  if (FoundModes modes = mechanism(system, z, 0.0, origin.statuses, JointModel::pins)) {
    // A load across collinear elements stiffens them as they deflect.
    const bool is_mechanism = !are_loaded(modes.shapes) || follow_loads() ||
                              mechanism(system, z, 0.0, origin.statuses, JointModel::pins);
    if (is_mechanism) {
      fail_modes(failure_at(FailureKind::held_mechanism, model, 0.0), std::move(modes));
    }
  } else {
    const StepStart begin = system.begin(z, 0.0, origin.statuses, 1.0);
    const SolveReport report = newton.solve(0.0, begin, JointModel::pins, 1.0,
                                            options.most_iterations, z, origin.statuses);
    note(report);
    if (report.end == SolveEnd::stopped) {
      path.complete = false;
      return;
    }
    record_start(begin, MemoryWriter::none, JointModel::pins, 1.0, {}, {});
    const bool near = report.end == SolveEnd::converged && is_near(z);
    if (!near || newton.stability_index() < 0) {
      if (near) refuse_buckled(0.0);
      if (const auto stalled = follow_loads()) refuse_overload(*stalled);
    }
  }
  if (!path.complete) return;
  rates.order_like(newton.factor());
  refuse_buckled(0.0);
  note_not_unique(0.0);
  open_clearances();
  if (is_near(z)) return;
  note(NoteKind::large_start, 0.0, {}, length_of(z, system.displacements()));
}

/// Throws a failure if the truss has free modes with the given statuses. Free modes of slack
/// elements on which loads do no work are permitted.
void PathFollower::refuse_mechanism(double when, const Statuses& statuses,
                                    JointModel joints) const {
  FoundModes modes = mechanism(system, z, when, statuses, joints);
  if (!modes || (any_open(statuses) && !are_loaded(modes.shapes))) return;
  FailureFields fields = failure_at(FailureKind::mechanism, model, when);
  // If the truss is a mechanism only because joints slip, the failure is that friction is
  // exhausted.
  if (!mechanism(system, z, when, held_but_open(statuses), JointModel::pins)) {
    fields.kind = FailureKind::friction_exhausted;
    fields.joints = slipping(statuses);
  }
  fail_modes(std::move(fields), std::move(modes));
}

std::vector<FailureJoint> PathFollower::slipping(const Statuses& statuses) const {
  std::vector<FailureJoint> found;
  for (int i = 0; i < static_cast<int>(statuses.size()); ++i) {
    if (is_slip(statuses[index(i)])) found.push_back(named(model, i));
  }
  return found;
}

/// Throws a failure if the state is unstable even with all closed joints fixed.
void PathFollower::refuse_buckled(double when) {
  // Makes room: the factors of the stability check need as much memory as these.
  rates.release();
  for (;;) {
    const double slack = system.slack_stiffness(slack_level);
    FoundModes modes = buckling(system, z, when, origin.statuses, slack);
    if (!modes) return;
    // Slack elements under compression are bounded by their play.
    if (stiffen_slack(origin.statuses)) continue;
    fail_modes(failure_at(FailureKind::buckled, model, when), std::move(modes));
  }
}

/// Adds a note about those of the joints that no note of this kind has named before.
void PathFollower::note(NoteKind kind, double when, const std::vector<int>& joints, double value) {
  Note made{kind, when, model.temperature_change(0, 1.0, when), {}, value};
  std::set<int>& named_before = noted[kind];
  for (const int i : joints) {
    if (named_before.insert(i).second) made.joints.push_back(named(model, i));
  }
  if (made.joints.empty() && !joints.empty()) return;
  path.notes.push_back(std::move(made));
}

/// Adds a note about open joints if their elements are slack.
/// @returns whether elements are slack
bool PathFollower::note_slack(double when, const VectorXd& at, const Statuses& statuses) {
  std::vector<int> open;
  for (int i = 0; i < static_cast<int>(statuses.size()); ++i) {
    if (statuses[index(i)] == JointStatus::open) open.push_back(i);
  }
  is_loose = !open.empty() && mechanism(system, at, when, statuses, JointModel::friction);
  if (is_loose) note(NoteKind::slack, when, open);
  return is_loose;
}

/// Adds a note once if elements are slack and more than `most_open` joints are open. Such elements
/// make and lose contact all the time, nearly without force, so that most steps would end at such
/// changes.
/// @returns whether this is so
bool PathFollower::note_many_open(double when) {
  constexpr std::ptrdiff_t most_open = 8;
  if (!options.locate_events || !has_slack()) return false;
  if (std::count(origin.statuses.begin(), origin.statuses.end(), JointStatus::open) <= most_open) {
    return false;
  }
  if (noted.count(NoteKind::not_located) == 0) note(NoteKind::not_located, when, {});
  return true;
}

/// Raises the level of the dashpots of slack joints. Returns false if no joint is open, or if the
/// level is already the highest.
bool PathFollower::stiffen_slack(const Statuses& statuses) {
  if (!any_open(statuses) || slack_level >= System::most_slack_level) return false;
  slack_level = std::min(slack_level + 1.0, System::most_slack_level);
  is_slack = true;
  return true;
}

/// If elements are slack and steps have no solution: adds dashpots to all joints with play, or
/// stiffens them. Returns false if no element is slack or the level is highest.
bool PathFollower::damp() {
  if (!has_slack() || slack_level >= System::stiffest_level) return false;
  softest_level = slack_level + 2.0 * softer;
  slack_level = std::min(slack_level + 1.0, System::stiffest_level);
  origin.damps_contact = true;
  is_slack = true;
  return true;
}

/// Adds a note about sticking joints with dependent constraints, if any were found.
void PathFollower::note_not_unique(double when) {
  if (newton.regularisation() != Regularisation::reactions) return;
  note(NoteKind::not_unique, when, newton.dependent_joints());
}

void PathFollower::open_clearances() {
  std::vector<int> with_play;
  for (int i = 0; i < static_cast<int>(model.joints.size()); ++i) {
    if (joint(i, [](const auto& one) { return one.has_play(); })) with_play.push_back(i);
  }
  if (with_play.empty()) return;
  const VectorXd pinned_z = z;
  const Statuses pinned = origin.statuses;
  const std::size_t pinned_steps = recorded();
  SolveReport last;
  // First, journals move without friction until contact forces balance. If many lightly loaded
  // journals have no such position nearby, friction then holds them where pin forces push them.
  for (const JointModel contact : {JointModel::frictionless, JointModel::friction}) {
    z = pinned_z;
    forget_after(pinned_steps);
    origin = system.begin(z, 0.0, pinned, 1.0);
    seat(with_play, contact);
    last = open_seated(with_play, contact);
    if (last.end == SolveEnd::stopped) {
      path.complete = false;
      return;
    }
    if (last.end == SolveEnd::converged) break;
  }
  if (last.end != SolveEnd::converged) {
    fail(last, JointModel::friction, 0.0, "no equilibrium in contact at the start");
  }
  bool opens = false;
  for (const int i : with_play) {
    JointStatus& status = origin.statuses[index(i)];
    if (status == JointStatus::open) {
      opens = true;
    } else {
      status = joint(i, [](const auto& one) { return one.rest(); });
    }
  }
  if (opens) refuse_buckled(0.0);
}

/// Puts every journal into contact, in the direction of its pin force. A journal without pin force
/// starts open in the middle of its play.
void PathFollower::seat(const std::vector<int>& with_play, JointModel contact) {
  for (const int i : with_play) {
    const Trial trial = system.trial(i, z, 0.0, origin, JointModel::pins, 0.0);
    const bool touches = joint(
        i, [&](const auto& one) { return one.seat(trial, 0.0, 1.0, seat_rounding()).touches; });
    const JointStatus closed = contact == JointModel::frictionless
                                   ? JointStatus::slip_plus
                                   : joint(i, [](const auto& one) { return one.rest(); });
    origin.statuses[index(i)] = touches ? closed : JointStatus::open;
  }
}

/// Opens the clearances in steps, because links rotate while clearances open. Each step starts from
/// the last equilibrium. The step size grows while steps converge.
/// @returns how the last solve ended; if it converged, `z` and the statuses are those with fully
/// open clearances
SolveReport PathFollower::open_seated(const std::vector<int>& with_play, JointModel contact) {
  SolveReport report;
  double opened = 0.0;
  double share = first_opening;
  while (opened < 1.0) {
    const double next = std::min(1.0, opened + share);
    VectorXd trial = z;
    Statuses statuses = origin.statuses;
    seat_at(opened, next, with_play, trial);
    const VectorXd seated = record == nullptr ? VectorXd() : trial;
    StepStart begin = system.begin(trial, 0.0, statuses, next);
    begin.slack_stiffness = system.slack_stiffness(slack_level);
    report = newton.solve(0.0, begin, contact, next, options.most_iterations, trial, statuses);
    if (next < 1.0) {
      ++path.solves;  // not a state of the path
    } else {
      note(report);
    }
    if (report.end == SolveEnd::stopped) return report;
    if (report.end == SolveEnd::converged) {
      z = std::move(trial);
      std::swap(origin.statuses, statuses);
      record_start(begin, MemoryWriter::begin, contact, next, seated, statuses);
      opened = next;
      share *= 2.0;
      continue;
    }
    share *= 0.5;
    if (share >= least_opening) continue;
    share = first_opening;
    const double farther = std::min(1.0, opened + share);
    if (come_to_rest_at(farther, contact, with_play, opened)) {
      opened = farther;
      report.end = SolveEnd::converged;
      continue;
    }
    const bool stiffer = contact == JointModel::friction && stiffen_slack(statuses);
    if (!stiffer) {
      origin.statuses = std::move(statuses);
      return report;
    }
  }
  return report;
}

/// Moves journals that have no equilibrium nearby until they reach one, with partly open
/// clearances. Dashpots damp the motion.
/// @returns false if they do not come to rest; the state is then unchanged
bool PathFollower::come_to_rest_at(double opening, JointModel contact,
                                   const std::vector<int>& with_play, double opened) {
  const Statuses statuses_before = origin.statuses;
  VectorXd seated = z;
  seat_at(opened, opening, with_play, seated);
  const VectorXd before = std::exchange(z, std::move(seated));
  const std::size_t steps_before = recorded();
  const bool rests = come_to_rest(
      [&](double level) -> std::optional<double> {
        StepStart begin = system.begin(z, 0.0, origin.statuses, opening);
        begin.slack_stiffness = system.slack_stiffness(level);
        begin.damps_contact = true;
        VectorXd trial = z;
        Statuses statuses = origin.statuses;
        const SolveReport report =
            newton.solve(0.0, begin, contact, opening, options.most_iterations, trial, statuses);
        ++path.solves;
        if (report.end == SolveEnd::stopped) path.complete = false;
        if (report.end != SolveEnd::converged) return std::nullopt;
        const double moved = length_of(trial - z, system.displacements());
        std::swap(z, trial);
        std::swap(origin.statuses, statuses);
        record_start(begin, MemoryWriter::begin, contact, opening, trial, statuses);
        return moved;
      },
      0.0);
  if (rests) return true;
  z = before;
  origin.statuses = statuses_before;
  forget_after(steps_before);
  return false;
}

/// Moves journals in contact along their forces by as much as the clearances open.
void PathFollower::seat_at(double opened, double opening, const std::vector<int>& with_play,
                           VectorXd& there) const {
  for (const int i : with_play) {
    if (origin.statuses[index(i)] == JointStatus::open) continue;
    const Trial at = system.trial(i, z, 0.0, origin, JointModel::pins, opened);
    const Seat seat =
        joint(i, [&](const auto& one) { return one.seat(at, opened, opening, seat_rounding()); });
    system.apply(i, seat, there);
  }
}

}  // namespace statejump::truss::detail
