// SPDX-License-Identifier: GPL-3.0-or-later
// Trusses with a ball joint.
#pragma once

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <string>
#include <utility>
#include <vector>

#include "../parts.hpp"

namespace statejump::truss::testing {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// Program with the given ΔT at every quarter of a second.
inline thermal::Program quarters(std::vector<double> changes) {
  thermal::Program program;
  program.shape = thermal::Shape::table;
  for (std::size_t i = 0; i < changes.size(); ++i)
    program.table_times.push_back(0.25 * static_cast<double>(i));
  program.period = program.table_times.back();
  program.table_temperature_changes = std::move(changes);
  return program;
}

inline BallJoint ball_joint(int ball_node, int ball_link, int socket_node, int socket_link) {
  BallJoint joint;
  joint.name = std::string("ball");
  joint.ball_node = ball_node;
  joint.ball_link = ball_link;
  joint.socket_node = socket_node;
  joint.socket_link = socket_link;
  joint.ball_radius = 5e-3;
  joint.radial_clearance = 1e-4;
  joint.ball_thermal_expansion = 2e-5;
  joint.socket_thermal_expansion = 1e-5;
  joint.friction_coefficient = 0.05;
  joint.hertz_stiffness = 2.6e10;
  joint.mindlin_stiffness = 3.2e10;
  return joint;
}

inline const BallJoint& joint_of(const Model& model) {
  return std::get<BallJoint>(model.joints[0]);
}

inline Vector3d friction(const Model& model, const State& state) {
  return output(model, state, 0, "ball_friction_force_N");
}

inline double normal(const Model& model, const State& state) {
  return output(model, state, 0, "ball_normal_force_N")[0];
}

/// Three bars carry a socket. The ball in it is at the tip of a fourth bar, and two springs pull
/// it. Heating rotates socket and bars about all axes.
inline Model tripod() {
  Model model;
  model.programs = {triangle(100.0), quarters({0.0, 60.0, -40.0, 30.0, 0.0})};
  model.nodes = {node("A", {0.3, 0.0, 0.0}, 0),    node("B", {-0.2, 0.25, 0.0}, 0),
                 node("C", {-0.2, -0.25, 0.0}, 0), node("top", {0.0, 0.0, 0.3}, 3),
                 node("ball", {0.0, 0.0, 0.3}, 3), node("D", {0.1, 0.1, 0.7}, 0),
                 node("E", {0.3, -0.2, 0.5}, 0),   node("F", {-0.3, 0.0, 0.6}, 0)};
  model.links = {{"A-top", 0, 3, 2e5, 0.4242, 2.4e-5, 0, 1.0},
                 {"B-top", 1, 3, 2e5, 0.4387, 2.4e-5, 1, 1.0},
                 {"C-top", 2, 3, 2e5, 0.4387, 2.4e-5, 0, -0.4},
                 {"D-ball", 5, 4, 2e5, 0.4242640687119285, 2.4e-5, 1, 0.5}};
  for (Bar& link : model.links) {
    link.stress_free_length = (model.nodes[static_cast<std::size_t>(link.second)].position -
                               model.nodes[static_cast<std::size_t>(link.first)].position)
                                  .norm();
  }
  model.springs = {{"E", 6, 4, 2e4, 0.35, false}, {"F", 7, 4, 3e4, 0.40, false}};
  model.joints = {ball_joint(4, 3, 3, 0)};
  return model;
}

/// The planar rib of the revolute tests. With a ball joint, the rib lies in a rotated plane.
inline Model rib(bool with_ball, const Matrix3d& turned) {
  Model model;
  model.programs = {triangle(150.0)};
  model.nodes = {node("A", {0, 0, 0}, 0), node("C", {0.12, 0, 0}, 0), node("B", {0.04, 0.05, 0}, 2),
                 node("J", {0.04, 0.05, 0}, 2), node("S", {0.05, 0.15, 0}, 0)};
  for (Node& one : model.nodes) {
    one.position = turned * one.position;
    one.free_directions = turned;
  }
  const auto length = [&](std::size_t a, std::size_t b) {
    return (model.nodes[a].position - model.nodes[b].position).norm();
  };
  model.links = {{"AB", 0, 2, 6e5, length(0, 2), 2.4e-5, 0, 1.0},
                 {"CJ", 1, 3, 6e5, length(1, 3), 2.4e-5, 0, -0.7}};
  model.springs = {{"S", 4, 3, 2e3, 0.05, false}};
  const BallJoint ball = ball_joint(3, 1, 2, 0);
  if (with_ball) {
    model.joints = {ball};
    return model;
  }
  ClearanceRevolute joint;
  joint.name = std::string("joint");
  joint.journal_node = ball.ball_node;
  joint.journal_link = ball.ball_link;
  joint.bearing_node = ball.socket_node;
  joint.bearing_link = ball.socket_link;
  joint.journal_radius = ball.ball_radius;
  joint.radial_clearance = ball.radial_clearance;
  joint.journal_thermal_expansion = ball.ball_thermal_expansion;
  joint.bearing_thermal_expansion = ball.socket_thermal_expansion;
  joint.friction_coefficient = ball.friction_coefficient;
  joint.hertz_stiffness = ball.hertz_stiffness;
  joint.mindlin_stiffness = ball.mindlin_stiffness;
  joint.axis = turned * Vector3d::UnitZ();
  model.joints = {joint};
  return model;
}

/// A load presses a ball into a wide socket. Two stiff rods move the ball along x, then along y, by
/// so little that the normal hardly rotates.
inline Model pushed_around_a_corner() {
  Model model;
  model.programs = {quarters({0.0, 100.0, 100.0}), quarters({0.0, 0.0, 100.0})};
  model.nodes = {node("socket", {0, 0, 0}, 0), node("ball", {0, 0, 0}, 3),
                 node("X", {-10.0, 0, 0}, 0), node("Y", {0, -10.0, 0}, 0)};
  model.nodes[1].load = {0.0, 0.0, -100.0};
  model.links = {{"X", 2, 1, 1e11, 10.0, 1e-8, 0, 1.0}, {"Y", 3, 1, 1e11, 10.0, 1e-8, 1, 0.5}};
  BallJoint joint = ball_joint(1, -1, 0, -1);
  joint.ball_radius = 1.0;
  joint.radial_clearance = 1e-3;
  joint.ball_thermal_expansion = joint.socket_thermal_expansion = 0.0;
  joint.friction_coefficient = 0.15;
  joint.hertz_stiffness = 1e11;
  joint.mindlin_stiffness = 1e10;
  model.joints = {joint};
  return model;
}

inline double relative_residue(const Path& path) {
  const State& first = path.states.front();
  const State& last = path.states.back();
  const double heat = last.joint_dissipation.sum();
  return (last.thermal_work - (last.elastic_energy - first.elastic_energy) -
          (last.load_potential - first.load_potential) - heat) /
         heat;
}

/// Expects that the rotated truss behaves like the original one.
/// @param friction_share allowed relative difference of the friction force
inline void expect_the_same_turned(const Model& model, double friction_share) {
  const Path path = solve(model);
  Model other = model;
  const Matrix3d turned =
      Eigen::AngleAxisd(2.1, Vector3d(1.0, -2.0, 0.5).normalized()).toRotationMatrix();
  for (Node& one : other.nodes) {
    one.position = turned * one.position;
    one.free_directions = turned;
  }
  const Path found = solve(other);
  ASSERT_EQ(found.events.size(), path.events.size());
  const double size = path.states.back().displacement.norm();
  EXPECT_LT(
      (turned.transpose() * found.states.back().displacement - path.states.back().displacement)
          .norm(),
      2e-10 * size);  // closure tolerance of both paths
  EXPECT_LT((turned.transpose() * friction(other, found.states.back()) -
             friction(model, path.states.back()))
                .norm(),
            friction_share * friction(model, path.states.back()).norm());
}

}  // namespace statejump::truss::testing
