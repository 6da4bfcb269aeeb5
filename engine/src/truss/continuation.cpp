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

/// Largest number of joints that a failure names. The joints that slide fastest come first.
constexpr std::size_t most_named = 3;
/// Ratio of a displacement to the size of the truss below which a jump cannot be distinguished from
/// the error of Newton's method.
const double jump_share = std::sqrt(std::numeric_limits<double>::epsilon());
/// After a failed step, the index of the equations is checked at these multiples of the tangent
/// step. If the path reverses at a limit point like a parabola, one of them lies beyond the limit
/// point.
constexpr double tangent_steps[] = {1.0, 2.0, 4.0};

}  // namespace

/// Whether any joint slips fully or partially. If no joint slips, a negative index means buckling,
/// which is checked at the corners of the programs.
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

/// Decides how the path continues after a step of the shortest length in which an event occurs.
/// @param first how the first solve over the step ended
/// @param to, statuses unknowns and statuses from that solve
/// @returns how the last solve ended, with updated `to` and `statuses`
/// @throws Failure if the path ends here or has several continuations
SolveReport PathFollower::continue_from_event(double target, VectorXd& to, Statuses& statuses,
                                              SolveReport first) {
  if (first.end == SolveEnd::stopped) return first;
  const bool converged = first.end == SolveEnd::converged;
  // With dashpots in all contacts the step has a continuation.
  if (converged && (statuses == origin.statuses || origin.damps_contact)) {
    if (any_slips(statuses) && newton.stability_index() < 0) {
      fail_continuation(FailureKind::no_continuation, target, {});
    }
    return first;
  }
  // Rates of partial slip depend on the path, so the rate equations are not linear for fixed
  // statuses.
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
  // A contact that opens may leave a mechanism or jump across its play. The next step detects this
  // itself.
  if (undecided && answer.opens) return first;
  if (undecided && !answer.singular.empty()) {
    refuse_mechanism(target, answer.singular, JointModel::friction);
  }
  // Dependent constraints make the signs of all sets wrong. A solution near the last state is still
  // valid.
  const double moved = converged ? length_of(to - z, system.displacements())
                                 : std::numeric_limits<double>::infinity();
  const bool near = moved <= jump_share * system.size();
  // At a smooth extremum of the temperature nothing moves by more than the tolerance of a solution.
  // If several continuations exist there, they have equal displacements, and any of them is valid.
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

/// Rates of the temperature programs [K/s] just before the time `target`, which may be a corner of
/// a program.
std::vector<double> PathFollower::program_rates_before(double target) const {
  std::vector<double> rates_before;
  for (const thermal::Program& program : model.programs) {
    const double near = std::min(Model::same_time * program.duration(), 0.5 * (target - time));
    rates_before.push_back(program.temperature_rate(target - near));
  }
  return rates_before;
}

/// If the solve found that a slipping joint sticks, but its rates require that it slides, the joint
/// continues to slide. The slide of a short step may be below the error of Newton's method,
/// especially in slender trusses; its sign is then unreliable.
/// @param to, statuses converged solution; replaced by the final solution
/// @param first how the first solve ended
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
    // The caller shortens this step.
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

/// Whether slip is unstable in a converged step: at its end with the final statuses, or at its
/// start with the given statuses.
bool PathFollower::passes_instability(const Statuses& statuses) {
  if (!any_slips(statuses)) return false;
  if (newton.stability_index() < 0) return true;
  if (statuses == origin.statuses) return false;
  return newton.stability_index(rates.equations(z, time, origin, statuses), statuses) < 0;
}

/// Whether the rates at both ends of a step without events explain the displacement. If the path
/// jumps from a limit point to another equilibrium, the displacement is larger. A step with equally
/// large curvature is too long to decide.
bool PathFollower::follows_its_rates(const Ends& ends) const {
  if (ends.start.statuses != ends.statuses) return true;
  const Eigen::Index n = system.displacements();
  const double half = 0.5 * (ends.to_time - ends.from_time);
  const auto before = half * ends.from_rate.head(n);
  const auto after = half * ends.to_rate.head(n);
  const double apart =
      (ends.to.head(n) - ends.from.head(n) - before - after).lpNorm<Eigen::Infinity>();
  // Elements held by dashpots move independently of these rates.
  const double slack =
      ends.start.slack_stiffness > 0.0
          ? lever * system.dashpot_force(ends.to, ends.to_time, ends.start, ends.statuses) /
                ends.start.slack_stiffness
          : 0.0;
  return apart <= std::max(before.lpNorm<Eigen::Infinity>(), after.lpNorm<Eigen::Infinity>()) +
                      slack + jump_share * system.size();
}

}  // namespace statejump::truss::detail
