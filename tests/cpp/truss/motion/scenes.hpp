// SPDX-License-Identifier: GPL-3.0-or-later
// Parts of trusses in motion that several tests share.
#pragma once

#include "../parts.hpp"
#include "statejump/truss/motion.hpp"

namespace statejump::truss::scenes {

using testing::node;

inline thermal::Program lasting(double seconds, double largest = 0.0) {
  return testing::triangle(largest, seconds);
}

inline MotionStart at_rest(const Model& model) {
  const auto nodes = static_cast<Eigen::Index>(model.nodes.size());
  return {Eigen::Matrix3Xd::Zero(3, nodes), Eigen::Matrix3Xd::Zero(3, nodes)};
}

/// Energy that came in less what is stored and what became heat, since the start [J].
inline double residue(const Motion& motion) {
  const auto sum = [](const State& state, const MovingState& moving) {
    return state.thermal_work - state.load_potential - state.elastic_energy -
           moving.kinetic_energy - state.joint_dissipation.sum() - moving.damping_dissipation -
           moving.impact_dissipation;
  };
  return sum(motion.states.back(), motion.moving.back()) -
         sum(motion.states.front(), motion.moving.front());
}

/// A journal that falls within its bearing, both rigid.
inline Model falling_journal() {
  Model model;
  model.programs = {lasting(0.1)};
  model.nodes = {node("bearing", 0, 0, 0), node("journal", 0, 0, 2)};
  model.nodes[1].load = {0.0, -9.81, 0.0};
  ClearanceRevolute joint;
  joint.name = "joint";
  joint.bearing_node = 0;
  joint.journal_node = 1;
  joint.journal_radius = 5e-3;
  joint.radial_clearance = 1e-3;
  model.joints = {joint};
  return model;
}

}  // namespace statejump::truss::scenes
