// SPDX-License-Identifier: GPL-3.0-or-later
// Models of trusses in motion for several tests.
#pragma once

#include <algorithm>
#include <boost/numeric/odeint.hpp>
#include <cmath>
#include <utility>
#include <vector>

#include "../parts.hpp"
#include "statejump/truss/motion.hpp"

namespace statejump::truss::scenes {

using testing::node;

inline thermal::Program lasting(double seconds, double largest = 0.0) {
  return testing::triangle(largest, seconds);
}

inline Inertia masses(Eigen::VectorXd of_nodes) {
  Inertia inertia;
  inertia.node_mass = std::move(of_nodes);
  return inertia;
}

inline MotionStart at_rest(const Model& model) {
  const auto nodes = static_cast<Eigen::Index>(model.nodes.size());
  return {Eigen::Matrix3Xd::Zero(3, nodes), Eigen::Matrix3Xd::Zero(3, nodes)};
}

/// Energy supplied minus energy stored and dissipated, since the start [J].
inline double residue(const Motion& motion) {
  const auto sum = [](const State& state, const MovingState& moving) {
    return state.thermal_work - state.load_potential - state.elastic_energy -
           moving.kinetic_energy - state.joint_dissipation.sum() - moving.damping_dissipation -
           moving.impact_dissipation;
  };
  return sum(motion.states.back(), motion.moving.back()) -
         sum(motion.states.front(), motion.moving.front());
}

/// A block on the ground, with a tangential contact spring of 1e6 N/m.
/// @param bound friction limit [N]
inline Model block(double bound, double seconds) {
  Model model;
  model.programs = {lasting(seconds)};
  model.nodes = {node("A", 0, 0, 1)};
  Slider slider;
  slider.name = "S";
  slider.first = 0;
  slider.friction_force = bound;
  slider.tangential_stiffness = 1e6;
  model.joints = {slider};
  return model;
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

/// Reference for falling_journal(): position below the bearing's centre and speed, integrated to
/// 1e-12 with F = max(0, K δ^1.5 + c δ'), c = 2 ζ √(m k), k = 1.5 K √δ. @param gravity [m/s²]
/// @param hertz K [N/m^1.5] @param mass [kg] @param y initial position and speed
inline std::vector<double> fallen(double seconds, double gravity, double zeta, double hertz,
                                  double mass, std::vector<double> y) {
  const auto rates = [&](const std::vector<double>& at, std::vector<double>& rate, double) {
    const double depth = std::max(at[0] - 1e-3, 0.0);
    const double dashpot = 2.0 * zeta * std::sqrt(mass * 1.5 * hertz * std::sqrt(depth));
    const double force = hertz * std::pow(depth, 1.5) + dashpot * at[1];
    rate[0] = at[1];
    rate[1] = gravity - (depth > 0.0 ? std::max(force, 0.0) : 0.0) / mass;
  };
  namespace odeint = boost::numeric::odeint;
  // Short intervals: free fall allows steps of any length, so a long step could skip the contact.
  const int pieces = 2000;
  for (int i = 0; i < pieces; ++i) {
    odeint::integrate_adaptive(
        odeint::make_controlled(1e-14, 1e-14, odeint::runge_kutta_dopri5<std::vector<double>>()),
        rates, y, 0.0, seconds / pieces, 0.1 * seconds / pieces);
  }
  return y;
}

}  // namespace statejump::truss::scenes
