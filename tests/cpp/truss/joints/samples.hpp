// SPDX-License-Identifier: GPL-3.0-or-later
// For each joint type a sample for the tests that every type must pass. A new type adds its own.
#pragma once

#include <type_traits>
#include <vector>

#include "../parts.hpp"

namespace statejump::truss::testing {

/// Truss with one joint that is close to contact in the reference configuration.
struct JointSample {
  Model model;
  std::vector<JointStatus> statuses;  ///< Statuses of the type in which the contact is closed.
  /// Displacement of the last node that closes the contact [m].
  Eigen::Vector3d touching = Eigen::Vector3d::Zero();
};

/// Two links, AB and CD, where B and D coincide.
inline JointSample two_links(Joint joint) {
  JointSample made;
  made.model.programs = {triangle(80.0)};
  made.model.nodes = {node("A", {0.0, 0.0, 0.0}, 3), node("B", {0.1, 0.02, 0.01}, 3),
                      node("C", {0.2, -0.03, 0.05}, 3), node("D", {0.1, 0.02, 0.01}, 3)};
  made.model.links = {{"AB", 0, 1, 1e4, 0.1, 2e-5, 0, 1.0}, {"CD", 2, 3, 1e4, 0.12, 1e-5, 0, 0.5}};
  made.model.joints = {std::move(joint)};
  made.statuses = {JointStatus::stick, JointStatus::slip_plus, JointStatus::slip_minus};
  return made;
}

inline JointSample sample(std::type_identity<Slider>) {
  Slider one;
  one.name = std::string("joint");
  one.first = 3;
  one.second = 1;
  one.axis = Eigen::Vector3d(1.0, 2.0, 2.0) / 3.0;
  one.friction_force = 20.0;
  one.clearance_minus = one.clearance_plus = 1e-3;
  JointSample made = two_links(one);
  made.statuses.push_back(JointStatus::stop_plus);
  made.statuses.push_back(JointStatus::stop_minus);
  return made;
}

inline JointSample sample(std::type_identity<ClearanceRevolute>) {
  ClearanceRevolute one;
  one.name = std::string("joint");
  one.journal_node = 3;
  one.bearing_node = 1;
  one.journal_link = 1;
  one.bearing_link = 0;
  one.journal_radius = 5e-3;
  one.radial_clearance = 1e-4;
  one.friction_coefficient = 0.2;
  one.hertz_stiffness = 2.6e10;
  one.mindlin_stiffness = 3.2e10;
  JointSample made = two_links(one);
  made.touching = {1.01e-4, 0.0, 0.0};
  return made;
}

template <class Type>
void set_law(HingeLaw<Type>& one) {
  one.deadband = 1e-3;
  one.stiffness = 0.3;
  one.friction_moment = 0.2;
  one.preload_moment = -0.1;
  one.axis = Eigen::Vector3d(1.0, 2.0, 9.0).normalized();
}

inline JointSample sample(std::type_identity<LatchHinge>) {
  LatchHinge one;
  one.name = std::string("joint");
  one.first_link = 0;
  one.second_link = 1;
  set_law(one);
  return two_links(one);
}

inline JointSample sample(std::type_identity<IwanJoint>) {
  IwanJoint one;
  one.name = std::string("joint");
  one.first = 3;
  one.second = 1;
  one.axis = Eigen::Vector3d(2.0, -1.0, 2.0) / 3.0;
  one.tangent_stiffness = 2e7;
  one.slip_force = 120.0;
  one.exponent = -0.4;
  one.stiffness_ratio = 0.7;
  one.elements = 5;
  return two_links(one);
}

inline JointSample sample(std::type_identity<BallJoint>) {
  BallJoint one;
  one.name = std::string("joint");
  one.ball_node = 3;
  one.socket_node = 1;
  one.ball_link = 1;
  one.socket_link = 0;
  one.ball_radius = 5e-3;
  one.radial_clearance = 1e-4;
  one.friction_coefficient = 0.05;
  one.hertz_stiffness = 2.6e10;
  one.mindlin_stiffness = 3.2e10;
  JointSample made = two_links(one);
  made.touching = {0.8e-4, 0.6e-4, 0.2e-4};
  return made;
}

inline JointSample sample(std::type_identity<RigidArm>) {
  RigidArm one;
  one.name = std::string("joint");
  one.master = 0;
  one.node = 2;
  JointSample made = two_links(one);
  made.statuses = {JointStatus::stick};
  measure_rotations(made.model);
  return made;
}

inline JointSample sample(std::type_identity<Hinge>) {
  Hinge one;
  one.name = std::string("joint");
  one.first = 1;
  one.second = 3;
  set_law(one);
  return two_links(one);
}

inline JointSample sample(std::type_identity<Pad>) {
  Pad one;
  one.name = std::string("joint");
  one.first = 3;
  one.second = 1;
  one.normal = Eigen::Vector3d(2.0, -1.0, 2.0) / 3.0;
  one.clearance = 1e-4;
  one.normal_stiffness = 1e6;
  one.tangential_stiffness = 8e5;
  one.friction_coefficient = 0.3;
  JointSample made = two_links(one);
  made.statuses = {JointStatus::stick, JointStatus::slip_plus};
  made.touching = -1.01e-4 * one.normal;
  return made;
}

}  // namespace statejump::truss::testing
