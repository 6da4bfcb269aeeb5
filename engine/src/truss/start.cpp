// SPDX-License-Identifier: GPL-3.0-or-later
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
  rates.order_like(newton.factor());
  refuse_buckled(0.0);
  open_clearances();
}

/// Throws if the truss has free modes with its joints as the statuses say.
void Walker::refuse_mechanism(double when, const Statuses& statuses, JointModel joints) const {
  if (FoundModes modes = mechanism(system, z, when, statuses, joints)) {
    fail_modes(failure_at(FailureKind::mechanism, model, when), std::move(modes));
  }
}

/// Throws if the state is unstable whatever the joints do.
void Walker::refuse_buckled(double when) {
  // It takes as much memory as the factors of rates do.
  rates.release();
  if (FoundModes modes = buckling(system, z, when, origin.statuses)) {
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
    FoundModes modes = mechanism(system, z, 0.0, origin.statuses, JointModel::pins);
    if (modes) refuse_undetermined(FailureKind::unloaded_joint, std::move(modes));
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
      share *= 2.0;
      continue;
    }
    share *= 0.5;
    if (share < 1e-4) {
      // Contacts that the last try took away may be what it fails for.
      origin.statuses = trial_statuses;
      if (std::any_of(with_play.begin(), with_play.end(), opens)) {
        FoundModes modes = mechanism(system, z, 0.0, origin.statuses, JointModel::frictionless);
        if (modes) refuse_undetermined(FailureKind::no_contact, std::move(modes));
      }
      fail(report, JointModel::frictionless, 0.0, "no equilibrium in contact at the start");
    }
  }
  for (const int i : with_play) {
    if (!opens(i)) origin.statuses[index(i)] = joint(i, [](const auto& one) { return one.rest(); });
  }
  if (std::none_of(with_play.begin(), with_play.end(), opens)) return;
  FoundModes modes = mechanism(system, z, 0.0, origin.statuses, JointModel::friction);
  if (modes) refuse_undetermined(FailureKind::no_contact, std::move(modes));
  refuse_buckled(0.0);
}

}  // namespace statejump::truss::detail
