// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <string>

#include "statejump/failure.hpp"
#include "statejump/kernel/require.hpp"
#include "statejump/truss/motion.hpp"
#include "stepper.hpp"

namespace statejump::truss {

namespace {

using detail::index;
using Eigen::VectorXd;

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
  const auto watch = [&](long step) {
    if (options.watched_node < 0) return;
    motion.watched_velocity.col(step) =
        system.displacement(options.watched_node, stepper.velocity());
  };
  if (options.watched_node >= 0) motion.watched_velocity.resize(3, options.steps + 1);
  sample();
  watch(0);
  const auto heat = [&] { return stepper.account().friction.sum() + stepper.account().impact; };
  for (long k = 1; k <= options.steps; ++k) {
    const detail::Statuses before = stepper.statuses();
    const double heat_before = heat();
    // From the whole: a sum of steps would not end at the end.
    const double time = duration * (static_cast<double>(k) / static_cast<double>(options.steps));
    stepper.advance(time);
    watch(k);
    for (std::size_t i = 0; i < before.size(); ++i) {
      const JointStatus after = stepper.statuses()[i];
      if (before[i] == after) continue;
      motion.events.push_back({time, motion.time_step, model.temperature_change(0, 1.0, time),
                               static_cast<int>(i), before[i], after});
      motion.event_heat.push_back(heat() - heat_before);
    }
    const bool last = k == options.steps;
    if (last || k % options.sample_every == 0) sample();
    if (options.progress &&
        !options.progress(static_cast<double>(k) / static_cast<double>(options.steps)) && !last) {
      motion.complete = false;
      break;
    }
  }
  motion.iterations = stepper.iterations();
  motion.factorizations = stepper.factorizations();
  motion.largest_contact_merit = stepper.largest_merit();
  motion.undetermined = stepper.undetermined();
  motion.negative_dissipation = stepper.account().negative;
  return motion;
}

}  // namespace statejump::truss
