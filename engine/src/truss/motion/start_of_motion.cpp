// SPDX-License-Identifier: GPL-3.0-or-later
#include "start_of_motion.hpp"

#include <utility>

#include "statejump/kernel/require.hpp"
#include "statejump/truss/path.hpp"

namespace statejump::truss::detail {

void check_motion(const Model& model, const MotionOptions& options) {
  model.validate();
  kernel::require(options.steps >= 1, "steps", static_cast<double>(options.steps), ">= 1");
  kernel::require(options.sample_every >= 1, "sample_every",
                  static_cast<double>(options.sample_every), ">= 1");
  const auto nodes = static_cast<Eigen::Index>(model.nodes.size());
  kernel::require(options.watched_node >= -1 && options.watched_node < nodes, "watched_node",
                  options.watched_node, "a node, or -1");
  if (!options.start) return;
  for (const auto* of_nodes : {&options.start->displacement, &options.start->velocity}) {
    kernel::require(of_nodes->cols() == nodes, "nodes of the start",
                    static_cast<double>(of_nodes->cols()), "as many as the truss has");
  }
}

std::optional<State> equilibrium(const Model& model, const MotionOptions& options) {
  Options statics;
  statics.start_friction = options.start_friction;
  bool ended = false;
  // Only the first state is needed, so the callback ends the path after its first short step.
  statics.progress = [&](double share) {
    ended = options.progress && !options.progress(0.0);
    return !ended && share <= 0.0;
  };
  Path path = solve(model, statics);
  if (ended) return {};
  return std::move(path.states.front());
}

Eigen::Matrix3Xd sites_of(const Model& model, const State& state) {
  if (state.rotation.cols() == 0) return state.displacement;
  Eigen::Matrix3Xd sites(3, state.displacement.cols() + state.rotation.cols());
  sites << state.displacement, state.rotation;
  for (std::size_t i = 0; i < model.nodes.size(); ++i) {
    sites.col(static_cast<Eigen::Index>(model.nodes.size() + i)) *= model.nodes[i].arm;
  }
  return sites;
}

Eigen::Matrix3Xd sites_of(const System& system, const Eigen::Matrix3Xd& of_nodes) {
  Eigen::Matrix3Xd sites =
      Eigen::Matrix3Xd::Zero(3, static_cast<Eigen::Index>(system.dofs().sites()));
  sites.leftCols(of_nodes.cols()) = of_nodes;
  return sites;
}

}  // namespace statejump::truss::detail
