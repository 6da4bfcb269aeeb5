// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "ladder.hpp"
#include "statejump/failure.hpp"
#include "statejump/kernel/require.hpp"
#include "statejump/truss/motion.hpp"
#include "stepper.hpp"

namespace statejump::truss {

namespace {

using detail::index;
using Eigen::VectorXd;

/// Share of the duration below which times do not tell the length of a step to 1e-6, from which
/// factors are known to be of the same length.
constexpr double shortest = 1e6 * std::numeric_limits<double>::epsilon();
/// Halvings between two samples because branches of many contacts were not found at once, down to a
/// thousandth of a step. Forces that hold each other have no branches to be found, however short.
constexpr int most_unsettled = 10;

/// State in which the quasi-static path begins; empty if the caller ended the search for it.
std::optional<State> equilibrium(const Model& model, const MotionOptions& options) {
  Options statics;
  bool ended = false;
  // The path itself is not asked for: it ends after its first short step.
  statics.progress = [&](double share) {
    ended = options.progress && !options.progress(0.0);
    return !ended && share <= 0.0;
  };
  Path path = solve(model, statics);
  if (ended) return {};
  return std::move(path.states.front());
}

void check(const Model& model, const MotionOptions& options) {
  model.validate();
  kernel::require(options.steps >= 1, "steps", static_cast<double>(options.steps), ">= 1");
  kernel::require(options.sample_every >= 1, "sample_every",
                  static_cast<double>(options.sample_every), ">= 1");
  kernel::require(options.theta >= 0.5 && options.theta <= 1.0, "theta", options.theta, "0.5 to 1");
  kernel::require(options.restitution >= 0.0 && options.restitution <= 1.0, "restitution",
                  options.restitution, "0 to 1");
  kernel::require(options.displacement_tolerance >= 0.0, "displacement_tolerance",
                  options.displacement_tolerance, ">= 0 m");
  kernel::require(options.displacement_tolerance == 0.0 || options.watched_node < 0, "watched_node",
                  options.watched_node, "-1 where steps are not equal");
  kernel::require(options.most_iterations >= 1, "most_iterations", options.most_iterations, ">= 1");
  const auto nodes = static_cast<Eigen::Index>(model.nodes.size());
  kernel::require(options.watched_node >= -1 && options.watched_node < nodes, "watched_node",
                  options.watched_node, "a node, or -1");
  if (!options.start) return;
  for (const auto* of_nodes : {&options.start->displacement, &options.start->velocity}) {
    kernel::require(of_nodes->cols() == nodes, "nodes of the start",
                    static_cast<double>(of_nodes->cols()), "as many as the truss has");
  }
}

/// What an attempted step is off by [m]; infinite where it has no solution that is found.
double attempt(detail::Stepper& stepper, double to, bool give_up, bool is_last) {
  constexpr double unknown = std::numeric_limits<double>::infinity();
  try {
    return stepper.attempt(to, give_up).value_or(unknown);
  } catch (const Failure&) {
    if (is_last) throw;
    return unknown;
  }
}

}  // namespace

Motion simulate(const Model& model, const Inertia& inertia, const MotionOptions& options) {
  check(model, options);
  const detail::System system(model);
  const detail::Bodies bodies(system, inertia);
  detail::Stepper stepper(system, bodies, options);
  Motion motion;
  motion.unknowns = system.displacements();
  const double duration = model.programs.front().duration();
  motion.time_step = duration / static_cast<double>(options.steps);
  if (options.start) {
    stepper.begin(bodies.free_part(options.start->displacement),
                  bodies.free_part(options.start->velocity), nullptr);
  } else {
    const std::optional<State> start = equilibrium(model, options);
    if (!start) {
      motion.complete = false;
      return motion;
    }
    stepper.begin(bodies.free_part(start->displacement), VectorXd::Zero(system.displacements()),
                  &*start);
  }
  const auto sample = [&] {
    State state;
    stepper.describe(state);
    motion.states.push_back(std::move(state));
    motion.moving.push_back({bodies.of_nodes(stepper.velocity()), stepper.kinetic_energy(),
                             stepper.account().damping, stepper.account().impact,
                             stepper.account().drives, stepper.drive_moment()});
  };
  if (options.watched_node >= 0) motion.watched_velocity.resize(3, options.steps + 1);
  const auto watch = [&](long step) {
    if (options.watched_node < 0) return;
    motion.watched_velocity.col(step) =
        system.displacement(options.watched_node, stepper.velocity());
  };
  sample();
  watch(0);
  // From the whole: a sum of steps would not end at the end.
  const auto time_of = [&](double steps) {
    return duration * (steps / static_cast<double>(options.steps));
  };
  const auto go_on = [&](double steps) {
    const double share = steps / static_cast<double>(options.steps);
    motion.complete = !options.progress || options.progress(share) || share == 1.0;
    return motion.complete;
  };
  const auto noted = [&](double length, const auto& take) {
    detail::Statuses before;
    before = stepper.statuses();  // a copy: the step changes them
    const auto heat = [&] { return stepper.account().friction.sum() + stepper.account().impact; };
    const double heat_before = heat();
    take();
    ++motion.steps;
    for (std::size_t i = 0; i < before.size(); ++i) {
      const JointStatus after = stepper.statuses()[i];
      if (before[i] == after) continue;
      const double time = stepper.time();
      motion.events.push_back({time, length, model.temperature_change(0, 1.0, time),
                               static_cast<int>(i), before[i], after});
      motion.event_heat.push_back(heat() - heat_before);
    }
  };
  if (options.displacement_tolerance > 0.0) {
    motion.time_step = duration;
    int level = 0;
    for (long k = 0; k < options.steps && motion.complete; k += options.sample_every) {
      const long span = std::min(options.sample_every, options.steps - k);
      const double length = time_of(static_cast<double>(span));
      const int most = std::max(static_cast<int>(std::log2(length / (shortest * duration))), 0);
      detail::Ladder ladder(level, most);
      int unsettled = 0;
      while (!ladder.done()) {
        const auto place = [&](double share) {
          return static_cast<double>(k) + share * static_cast<double>(span);
        };
        const bool give_up = unsettled < most_unsettled && !ladder.is_shortest();
        const double off =
            attempt(stepper, time_of(place(ladder.to())), give_up, ladder.is_shortest());
        if (!std::isfinite(off)) ++unsettled;
        const bool too_far = off > options.displacement_tolerance;
        if (too_far && !ladder.is_shortest()) {
          ++motion.rejected_steps;
          // A force that turns up in a step puts it off by its square, a jump of the velocity by
          // its first power: then there is another try.
          const double halvings = 0.5 * std::log2(off / options.displacement_tolerance);
          ladder.shorten(std::isfinite(off) ? std::max(static_cast<int>(std::ceil(halvings)), 1)
                                            : 1);
          continue;
        }
        if (too_far) ++motion.inexact_steps;
        const double step = length * ladder.length();
        noted(step, [&] { stepper.accept(); });
        motion.time_step = std::min(motion.time_step, step);
        const double to = place(ladder.to());
        // Of second order: a step of twice the length is eight times as far off.
        ladder.accept(8.0 * off <= options.displacement_tolerance);
        if (!ladder.done() && !go_on(to)) break;
      }
      if (!motion.complete) break;
      level = ladder.level();
      sample();
      go_on(static_cast<double>(k + span));
    }
  } else {
    for (long k = 1; k <= options.steps; ++k) {
      noted(motion.time_step, [&] { stepper.advance(time_of(static_cast<double>(k))); });
      watch(k);
      if (k == options.steps || k % options.sample_every == 0) sample();
      if (!go_on(static_cast<double>(k))) break;
    }
  }
  motion.iterations = stepper.iterations();
  motion.factorizations = stepper.factorizations();
  motion.largest_contact_merit = stepper.largest_merit();
  motion.undetermined = stepper.undetermined();
  motion.jammed = stepper.jammed();
  motion.negative_dissipation = stepper.account().negative;
  return motion;
}

}  // namespace statejump::truss
