// SPDX-License-Identifier: GPL-3.0-or-later
#include "rate_sets.hpp"
#include "walker.hpp"

#include <algorithm>
#include <vector>

namespace statejump::truss::detail {

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

void Walker::fail(const SolveReport& report, JointModel joints, double when, const char* sought) {
  refuse_mechanism(when, origin.statuses, joints);
  refuse_buckled(when);
  const FailureKind kind =
      report.end == SolveEnd::singular ? FailureKind::singular : FailureKind::not_converged;
  FailureFields fields = failure_at(kind, model, when);
  fields.sought = sought;
  for (const int joint : report.joints) fields.joints.push_back(named(model, joint));
  throw Failure(std::move(fields));
}

void Walker::note(const SolveReport& report) {
  ++path.solves;
  path.largest_force_residual = std::max(path.largest_force_residual, report.force_residual);
  path.largest_closure_residual = std::max(path.largest_closure_residual, report.closure_residual);
}

/// Relaxes the drawn shape at ΔT = 0; see solve().
void Walker::start() {
  origin.statuses = system.all_stick();
  z = VectorXd::Zero(system.unknowns());
  if (FoundModes modes = mechanism(system, z, 0.0, origin.statuses, JointModel::pins)) {
    // A load across elements in line stiffens them as they give way.
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

/// Throws if the truss has free modes with its joints as the statuses say.
void Walker::refuse_mechanism(double when, const Statuses& statuses, JointModel joints) const {
  FoundModes modes = mechanism(system, z, when, statuses, joints);
  if (!modes) return;
  FailureFields fields = failure_at(FailureKind::mechanism, model, when);
  // With its joints held it is none: their friction is at its bound everywhere.
  Statuses held = system.all_stick();
  for (std::size_t i = 0; i < held.size(); ++i) {
    if (statuses[i] == JointStatus::open) held[i] = JointStatus::open;
  }
  if (!mechanism(system, z, when, held, JointModel::pins)) {
    fields.kind = FailureKind::friction_exhausted;
    fields.joints = slipping(statuses);
  }
  fail_modes(std::move(fields), std::move(modes));
}

std::vector<FailureJoint> Walker::slipping(const Statuses& statuses) const {
  std::vector<FailureJoint> found;
  for (int i = 0; i < static_cast<int>(statuses.size()); ++i) {
    if (is_slip(statuses[index(i)])) found.push_back(named(model, i));
  }
  return found;
}

/// Throws if the state is unstable whatever the joints do.
void Walker::refuse_buckled(double when) {
  // It takes as much memory as the factors of rates do.
  rates.release();
  if (FoundModes modes = buckling(system, z, when, origin.statuses)) {
    fail_modes(failure_at(FailureKind::buckled, model, when), std::move(modes));
  }
}

/// Adds a note about those of the joints that no note of its kind has named.
void Walker::note(NoteKind kind, double when, const std::vector<int>& joints, double value) {
  Note made{kind, when, model.temperature_change(0, 1.0, when), {}, value};
  for (const int i : joints) {
    if (noted[kind].insert(i).second) made.joints.push_back(named(model, i));
  }
  if (made.joints.empty() && !joints.empty()) return;
  path.notes.push_back(std::move(made));
}

/// Notes the joints without contact whose elements nothing holds. True: there are such.
bool Walker::note_slack(double when, const VectorXd& at, const Statuses& statuses) {
  std::vector<int> open;
  for (int i = 0; i < static_cast<int>(statuses.size()); ++i) {
    if (statuses[index(i)] == JointStatus::open) open.push_back(i);
  }
  if (open.empty() || !mechanism(system, at, when, statuses, JointModel::friction)) return false;
  note(NoteKind::slack, when, open);
  return true;
}

/// Notes joints that stick and share a constraint, if the last solve met such.
void Walker::note_not_unique(double when) {
  if (newton.regularisation() != Regularisation::reactions) return;
  note(NoteKind::not_unique, when, newton.dependent_joints());
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
  // The clearances open little by little, each time from the last equilibrium, because the links
  // turn as they open; farther where that goes well.
  double opened = 0.0;
  double share = 0.125;
  while (opened < 1.0) {
    const double next = std::min(1.0, opened + share);
    VectorXd trial = z;
    Statuses trial_statuses = origin.statuses;
    for (const int i : with_play) {
      if (!opens(i)) system.apply(i, seat(i, z, opened, next), trial);
    }
    StepStart begin = system.begin(trial, 0.0, trial_statuses, next);
    begin.slack_stiffness = system.slack_stiffness();
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
      share *= 2.0;
      continue;
    }
    share *= 0.5;
    if (share < 1e-4) {
      origin.statuses = trial_statuses;
      fail(report, JointModel::frictionless, 0.0, "no equilibrium in contact at the start");
    }
  }
  for (const int i : with_play) {
    if (!opens(i)) origin.statuses[index(i)] = joint(i, [](const auto& one) { return one.rest(); });
  }
  if (std::none_of(with_play.begin(), with_play.end(), opens)) return;
  refuse_buckled(0.0);
}

}  // namespace statejump::truss::detail
