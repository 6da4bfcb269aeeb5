// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "path_follower.hpp"
#include "status_enumeration.hpp"

namespace statejump::truss::detail {

namespace {

/// Joints that a failure names, of those that slide unstably the fastest.
constexpr std::size_t most_named = 3;
/// Share of the truss' size below which a jump is not told from what Newton's method leaves of its
/// equations: the mean, in decades, of rounding and the size itself.
const double jump_share = std::sqrt(std::numeric_limits<double>::epsilon());
/// Along its tangent a path is past a limit point as far away as the step is long after twice the
/// tangent's step, if it turns there like a parabola; where it turns less, a little later.
constexpr double tangent_steps[] = {1.0, 2.0, 4.0};

}  // namespace

/// Whether a joint slips. Where none does, an index below zero is buckling, which corners of the
/// programs look for.
bool PathFollower::any_slips(const Statuses& statuses) const {
  return system.slips_smoothly() || std::any_of(statuses.begin(), statuses.end(), is_slip);
}

void PathFollower::fail_continuation(FailureKind kind, double when, std::vector<int> joints) const {
  if (joints.empty()) {
    for (int i = 0; i < static_cast<int>(model.joints.size()); ++i) {
      if (slide_rate[i] != 0.0) joints.push_back(i);
    }
    std::stable_sort(joints.begin(), joints.end(), [&](int a, int b) {
      return std::abs(slide_rate[a]) > std::abs(slide_rate[b]);
    });
    if (joints.size() > most_named) joints.resize(most_named);
  }
  FailureFields fields = failure_at(kind, model, when);
  for (const int one : joints) fields.joints.push_back(named(model, one));
  throw Failure(std::move(fields));
}

/// Decides a step within which something happens and which is as short as they get.
/// @param first how the solve over it ended, @param to, statuses where
/// @returns how it ended at last, with `to` and `statuses`
/// @throws Failure if the path ends or parts there
SolveReport PathFollower::continue_from_event(double target, VectorXd& to, Statuses& statuses,
                                              SolveReport first) {
  if (first.end == SolveEnd::stopped) return first;
  const bool converged = first.end == SolveEnd::converged;
  // Dashpots in all contacts decide where a step leads.
  if (converged && (statuses == origin.statuses || origin.damps_contact)) {
    if (any_slips(statuses) && newton.stability_index() < 0) {
      fail_continuation(FailureKind::no_continuation, target, {});
    }
    return first;
  }
  // Rates of a law that slips smoothly depend on the way: no set of branches is linear there.
  if (system.slips_smoothly()) {
    if (converged && newton.stability_index() < 0) {
      fail_continuation(FailureKind::no_continuation, target, {});
    }
    return first;
  }
  const RateAnswer answer =
      rates.solve(z, target, origin, converged ? statuses : Statuses(), first.joints);
  const bool undecided =
      answer.count == Continuation::none || answer.count == Continuation::several;
  // A contact that opens may leave a mechanism or jump across its play: the step itself says so.
  if (undecided && answer.opens) return first;
  if (undecided && !answer.singular.empty()) {
    refuse_mechanism(target, answer.singular, JointModel::friction);
  }
  // Constraints that depend on each other spoil the signs of all sets, not a solution that is near.
  const double moved = converged ? length_of(to - z, system.displacements())
                                 : std::numeric_limits<double>::infinity();
  const bool near = moved <= jump_share * system.size();
  // Where a program turns smoothly nothing moves by more than two solutions are undecided by, and
  // no way parts from others.
  const bool rests = moved <= 2.0 * system.rounding(z).length;
  const bool is_solution =
      answer.count == Continuation::several ? rests : answer.count == Continuation::none && near;
  if (is_solution && newton.stability_index() >= 0) return first;
  if (answer.count == Continuation::none) {
    fail_continuation(FailureKind::no_continuation, target, answer.joints);
  }
  if (answer.count == Continuation::several) {
    fail_continuation(FailureKind::several_continuations, target, answer.joints);
  }
  if (!converged && answer.count == Continuation::one) {
    note(first);
    to = z;
    statuses = answer.statuses;
    SolveReport second = newton.solve(target, origin, JointModel::friction, 1.0,
                                      options.most_iterations, to, statuses);
    if (second.end == SolveEnd::stopped) return second;
    if (second.end != SolveEnd::converged) {
      for (const double steps : tangent_steps) {
        const VectorXd there = z + steps * answer.step;
        const Assembly& at = rates.equations(there, target, origin, answer.statuses);
        if (newton.stability_index(at, answer.statuses) < 0) {
          fail_continuation(FailureKind::no_continuation, target, {});
        }
      }
      return second;
    }
    first = second;
  }
  if (first.end == SolveEnd::converged && any_slips(statuses) && newton.stability_index() < 0) {
    fail_continuation(FailureKind::no_continuation, target, answer.joints);
  }
  return first;
}

/// Rates of the programs on this side of a corner that may be at `target` [K/s].
std::vector<double> PathFollower::program_rates_before(double target) const {
  std::vector<double> rates_before;
  for (const thermal::Program& program : model.programs) {
    const double near = std::min(Model::same_time * program.duration(), 0.5 * (target - time));
    rates_before.push_back(program.temperature_rate(target - near));
  }
  return rates_before;
}

/// Lets joints slide on that were found to stop, where their rates say so. Slides of a short step
/// may be lost in what Newton's method leaves of the equations, which a slender truss is moved
/// farther by: then their signs say nothing.
/// @param to, statuses where a step has converged, and where it does in the end
/// @param first how it ended
SolveReport PathFollower::slide_on(double target, bool is_short, VectorXd& to, Statuses& statuses,
                                   SolveReport first) {
  std::vector<int> stopped;
  for (int i = 0; i < static_cast<int>(statuses.size()); ++i) {
    const JointStatus before = origin.statuses[index(i)];
    if (statuses[index(i)] != JointStatus::stick || !is_slip(before)) continue;
    if (system.remembers_when(i, before, JointStatus::stick)) stopped.push_back(i);
  }
  if (stopped.empty()) return first;
  const Rounding rounding = system.rounding(z);
  Statuses sliding = statuses;
  for (const int i : stopped) {
    const JointStatus before = origin.statuses[index(i)];
    // The step is to be divided.
    if (!is_short && slide_at_stake(i, before, target, rounding)) return first;
    sliding[index(i)] = before;
  }
  const std::vector<double> heating = program_rates_before(target);
  const auto rates_then = rates.rates_on(sliding, to, target, origin, heating);
  if (!rates_then) return first;
  const VectorXd slides = system.slide_rates(to, target, origin, sliding, *rates_then, heating);
  for (const int i : stopped) {
    const double sense = sliding[index(i)] == JointStatus::slip_plus ? 1.0 : -1.0;
    if (!(sense * slides[i] > 0.0)) return first;
  }
  note(first);
  const auto solve_on = [&](Statuses& branches) {
    return newton.solve(target, origin, JointModel::friction, 1.0, options.most_iterations, to,
                        branches, {}, true);
  };
  const VectorXd found = to;
  SolveReport second = solve_on(sliding);
  if (second.end == SolveEnd::converged || second.end == SolveEnd::stopped) {
    statuses = std::move(sliding);
    return second;
  }
  to = found;
  return solve_on(statuses);
}

/// Whether a step that has converged passes an instability by slip: what slips at its end is
/// unstable there, or would be at its start.
bool PathFollower::passes_instability(const Statuses& statuses) {
  if (!any_slips(statuses)) return false;
  if (newton.stability_index() < 0) return true;
  if (statuses == origin.statuses) return false;
  return newton.stability_index(rates.equations(z, time, origin, statuses), statuses) < 0;
}

/// Whether the rates at the ends of a step without events explain where it leads. A path that jumps
/// from a limit point to another equilibrium goes farther; a step that is bent as much as that is
/// too long to tell.
bool PathFollower::follows_its_rates(const Ends& ends) const {
  if (ends.start.statuses != ends.statuses) return true;
  const Eigen::Index n = system.displacements();
  const double half = 0.5 * (ends.to_time - ends.from_time);
  const auto before = half * ends.from_rate.head(n);
  const auto after = half * ends.to_rate.head(n);
  const double apart =
      (ends.to.head(n) - ends.from.head(n) - before - after).lpNorm<Eigen::Infinity>();
  // What dashpots hold comes to rest at its own pace.
  const double slack =
      ends.start.slack_stiffness > 0.0
          ? lever * system.dashpot_force(ends.to, ends.to_time, ends.start, ends.statuses) /
                ends.start.slack_stiffness
          : 0.0;
  return apart <= std::max(before.lpNorm<Eigen::Infinity>(), after.lpNorm<Eigen::Infinity>()) +
                      slack + jump_share * system.size();
}

}  // namespace statejump::truss::detail
