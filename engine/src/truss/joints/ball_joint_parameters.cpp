// SPDX-License-Identifier: GPL-3.0-or-later
// Parameters of a ball joint, and its position in the truss.
#include <Eigen/Eigenvalues>

#include "statejump/kernel/require.hpp"
#include "statejump/truss/joints/ball_joint.hpp"

#include <cmath>
#include "statejump/truss/model.hpp"
#include "truss/joints/ball_contact.hpp"
#include "truss/joints/relative_rotation.hpp"
#include "truss/parts.hpp"

namespace statejump::truss {

using detail::index;
using Eigen::Matrix3d;

std::span<const Parameter<BallJoint>> BallJoint::parameters() {
  using B = BallJoint;
  static const Parameter<B> table[] = {
      {"ball_node", "ball node", "-", Allowed::node, "the case's nodes", &B::ball_node},
      {"socket_node", "socket node", "-", Allowed::node, "the case's nodes", &B::socket_node},
      {"ball_link", "ball link", "-", Allowed::link_or_none, "the case's links", &B::ball_link},
      {"socket_link", "socket link", "-", Allowed::link_or_none, "the case's links",
       &B::socket_link},
      {"ball_turns", "ball turns with its node", "-", Allowed::flag, "the case", &B::ball_turns},
      {"socket_turns", "socket turns with its node", "-", Allowed::flag, "the case",
       &B::socket_turns},
      {"program", "program", "-", Allowed::program, "the case", &B::program},
      {"temperature_fraction", "temperature_fraction", "-", Allowed::finite, "the case",
       &B::temperature_fraction},
      {"ball_radius_m", "ball_radius", "m", Allowed::positive, "the case", &B::ball_radius},
      {"radial_clearance_m", "radial_clearance", "m", Allowed::positive, "the case",
       &B::radial_clearance},
      {"ball_thermal_expansion_per_K", "ball_thermal_expansion", "1/K", Allowed::finite, "the case",
       &B::ball_thermal_expansion},
      {"socket_thermal_expansion_per_K", "socket_thermal_expansion", "1/K", Allowed::finite,
       "the case", &B::socket_thermal_expansion},
      {"friction_coefficient", "friction_coefficient", "-", Allowed::not_negative, "the case",
       &B::friction_coefficient},
      {"hertz_stiffness_N_per_m15", "hertz_stiffness", "N/m^1.5", Allowed::positive_or_infinite,
       "Hertz: 4/3 E* sqrt(R)", &B::hertz_stiffness},
      {"mindlin_stiffness_N_per_m15", "mindlin_stiffness", "N/m^1.5", Allowed::positive_or_infinite,
       "Mindlin: 8 G* sqrt(R)", &B::mindlin_stiffness},
      {"partial_slip", "partial_slip", "-", Allowed::flag, "the case", &B::partial_slip},
  };
  return table;
}

std::span<const Output> BallJoint::outputs() {
  // Ball minus socket centre; normal force; friction on the ball.
  static const Output table[] = {
      {"ball_eccentricity_m", 3}, {"ball_normal_force_N", 1}, {"ball_friction_force_N", 3}};
  return table;
}

void BallJoint::validate(const Model& model) const {
  const auto check = [this](bool holds, const char* field, double value, const char* range) {
    if (!holds) throw kernel::OutOfRange("ball_joint '" + name + "'", field, value, range);
  };
  check(ball_node != socket_node, "socket node", socket_node, "another than the ball's");
  const auto check_link = [&](int link, int node, const char* field) {
    if (link == -1) return;
    const Bar& part = model.links[index(link)];
    check(part.first == node || part.second == node, field, link,
          "a link that ends at the joint's node");
  };
  check_link(ball_link, ball_node, "ball link");
  check_link(socket_link, socket_node, "socket link");
  check(!ball_turns || ball_link < 0, "ball_turns", ball_turns, "0 with a link");
  check(!socket_turns || socket_link < 0, "socket_turns", socket_turns, "0 with a link");
  check(std::isfinite(hertz_stiffness) || std::isinf(mindlin_stiffness), "mindlin_stiffness",
        mindlin_stiffness, "infinite, because hertz_stiffness is");
  check(!partial_slip || std::isfinite(mindlin_stiffness), "partial_slip", partial_slip,
        "0 where the contact is rigid");
  check(!partial_slip || friction_coefficient > 0.0, "partial_slip", partial_slip,
        "0 without friction");
  const double least =
      radial_clearance + model.lowest_strain(program, clearance_growth() * temperature_fraction);
  check(least > 0, "clearance at the program's worst temperature", least, "> 0 m");
}

JointFrame BallJoint::frame(const Model& model) const {
  JointFrame frame;
  frame.nodes = {ball_node, socket_node, -1, -1};
  detail::turn_part(model, detail::ball_far, ball_link, ball_turns, ball_node, frame);
  detail::turn_part(model, detail::socket_far, socket_link, socket_turns, socket_node, frame);
  frame.node_count = 4;
  frame.forces = 3;
  frame.program = program;
  frame.temperature_fraction = temperature_fraction;
  // If supports prevent a relative motion along a direction, this direction becomes one of the
  // axes. Pins have no row along it.
  Matrix3d free = Matrix3d::Zero();
  for (const int node : {ball_node, socket_node}) {
    const Node& part = model.nodes[index(node)];
    for (int k = 0; k < part.freedoms; ++k) {
      free += part.free_directions.col(k) * part.free_directions.col(k).transpose();
    }
  }
  const Eigen::SelfAdjointEigenSolver<Matrix3d> modes(free);
  if (modes.eigenvalues()[0] < 0.5) frame.axes = modes.eigenvectors();
  if (frame.axes.determinant() < 0.0) frame.axes.col(0) *= -1.0;
  for (int k = 0; k < 3; ++k) {
    frame.holds[index(k)] = detail::moves_along(model.nodes[index(ball_node)], frame.axes.col(k)) ||
                            detail::moves_along(model.nodes[index(socket_node)], frame.axes.col(k));
  }
  return frame;
}

}  // namespace statejump::truss
