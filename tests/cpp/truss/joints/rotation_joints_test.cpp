// SPDX-License-Identifier: GPL-3.0-or-later
// Joints that rotate nodes: rigid arms and hinges of beams.
#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "../parts.hpp"
#include "gradients.hpp"

namespace statejump::truss {
namespace {

using Eigen::Vector3d;
using testing::node;
using testing::triangle;

Beam beam(const std::string& name, int first, int second, const Model& model) {
  Beam made;
  made.name = name;
  made.first = first;
  made.second = second;
  made.axial_stiffness = 70e9 * 2e-4;
  made.torsional_stiffness = 80.0;
  made.bending_stiffness_y = 70e9 * 0.01 * std::pow(0.02, 3) / 12.0;
  made.bending_stiffness_z = 70e9 * 0.02 * std::pow(0.01, 3) / 12.0;
  made.thermal_expansion = 23e-6;
  const Vector3d along = model.nodes[static_cast<std::size_t>(second)].position -
                         model.nodes[static_cast<std::size_t>(first)].position;
  made.stress_free_length = along.norm();
  made.axis_y = Vector3d(0.3, -0.2, 0.9).cross(along).normalized();
  return made;
}

/// Two beams AB and CD, of which B and C are at one position.
Model two_beams() {
  Model model;
  model.programs = {triangle(10.0)};
  model.nodes = {node("A", {0.0, 0.0, 0.0}, 0), node("B", {0.1, 0.02, 0.01}, 3),
                 node("C", {0.1, 0.02, 0.01}, 3), node("D", {0.15, 0.09, -0.02}, 3)};
  model.nodes[0].rotations = 0;
  model.beams = {beam("AB", 0, 1, model), beam("CD", 2, 3, model)};
  for (Beam& one : model.beams) {
    one.axial_stiffness = 100.0;
    one.torsional_stiffness = one.bending_stiffness_y = one.bending_stiffness_z = 0.3;
  }
  return model;
}

}  // namespace

// At rotations of up to 0.3 rad, so that the tilts and the frame of the axis count.
TEST(Hinge, GradientsAreThoseOfItsForces) {
  Model model = two_beams();
  Hinge hinge;
  hinge.name = "H";
  hinge.first = 1;
  hinge.second = 2;
  hinge.axis = Vector3d(1.0, 2.0, 9.0).normalized();
  hinge.stiffness = 0.3;
  hinge.friction_moment = 0.2;
  hinge.preload_moment = -0.1;
  for (const double deadband : {0.0, 1e-6, 3.0}) {
    hinge.friction_stiffness = deadband == 0.0 ? 0.7 : std::numeric_limits<double>::infinity();
    hinge.deadband = deadband;
    model.joints = {hinge};
    measure_rotations(model);
    const detail::System system(model);
    EXPECT_EQ(system.displacements(), 3 * 2 + 3 * 3);
    Eigen::VectorXd z = Eigen::VectorXd::LinSpaced(system.unknowns(), -2e-2, 3e-2);
    z.tail<3>() << 1.5, -0.7, 0.4;
    Eigen::VectorXd before = z;
    before[1] += 1e-5;
    check_gradients(model, z, before,
                    {JointStatus::stick, JointStatus::slip_plus, JointStatus::slip_minus}, 1e-6,
                    1e-4);
  }
}

TEST(RigidArm, GradientsAreThoseOfItsForces) {
  Model model = two_beams();
  RigidArm arm;
  arm.name = "R";
  arm.master = 1;
  arm.node = 3;
  for (const bool holds_rotations : {false, true}) {
    arm.holds_rotation_x = arm.holds_rotation_y = arm.holds_rotation_z = holds_rotations;
    arm.holds_y = holds_rotations;
    model.joints = {arm};
    measure_rotations(model);
    const detail::System system(model);
    const int forces = holds_rotations ? 3 : 2;
    EXPECT_EQ(system.unknowns(), 3 * 3 + 3 * (holds_rotations ? 2 : 3) + forces);
    Eigen::VectorXd z = Eigen::VectorXd::LinSpaced(system.unknowns(), -2e-2, 3e-2);
    z.tail<2>() << 1.5, -0.7;
    check_gradients(model, z, z, {JointStatus::stick}, 1e-6, 1e-4);
  }
}

// Clamp - 1 m - hinge - 1 m - guided clamp, with a gradient over the section in one cycle. The
// hinge opens by φ with the moment M = K φ + M_c, the free rotation being 2 κ L. Rotations are
// compatible if 2 κ L = φ + 2 M L/(E I). Cooling reverses friction: the same equation without κ
// and with −M_c, if friction slips back, leaves φ = 2 M_c L/(E I)/(K 2 L/(E I) + 1).
TEST(Hinge, ResidualAngleOfABeamThatAGradientBends) {
  Model model;
  model.programs = {triangle(20.0)};
  model.nodes = {node("A", 0.0, 0.0, 0), node("B", 1.0, 0.0, 2), node("C", 1.0, 0.0, 2),
                 node("D", 2.0, 0.0, 0)};
  Eigen::Matrix3d about_z;
  about_z << 0, 1, 0, 0, 0, 1, 1, 0, 0;
  for (Node& one : model.nodes) {
    one.rotation_directions = about_z;
    one.rotations = 1;
  }
  model.nodes[0].rotations = model.nodes[3].rotations = 0;
  // Guided along x and y.
  model.nodes[3].freedoms = 2;
  model.beams = {beam("AB", 0, 1, model), beam("CD", 2, 3, model)};
  for (Beam& one : model.beams) {
    one.axis_y = Vector3d::UnitY();
    one.gradient_y = 1.0 / 0.01;
    one.temperature_fraction = 0.0;
  }
  Hinge hinge;
  hinge.name = "H";
  hinge.first = 1;
  hinge.second = 2;
  hinge.stiffness = 40.0;
  hinge.friction_moment = 1.0;
  model.joints = {hinge};
  measure_rotations(model);
  Options options;
  options.increments_per_branch = 4;
  const Path path = solve(model, options);
  const double residual = output(model, path.states.back(), 0, "beam_hinge_rotation_rad")[0];
  EXPECT_NEAR(std::abs(residual), 0.0101694915254, 1e-9);
}

// A load on a bar that is rigid: the node at its end moves on a circle, and the master carries
// force and moment.
TEST(RigidArm, EndOfAnArmMovesOnACircle) {
  Model model;
  model.programs = {triangle(1e-6)};
  model.nodes = {node("A", 0.0, 0.0, 0), node("B", 1.0, 0.0, 2), node("C", 1.0, 0.5, 2)};
  Eigen::Matrix3d about_z;
  about_z << 0, 1, 0, 0, 0, 1, 1, 0, 0;
  for (Node& one : model.nodes) {
    one.rotation_directions = about_z;
    one.rotations = 1;
  }
  model.nodes[0].rotations = 0;
  model.beams = {beam("AB", 0, 1, model)};
  model.beams[0].axis_y = Vector3d::UnitY();
  model.nodes[2].load = {-20.0, 0.0, 0.0};
  RigidArm arm;
  arm.name = "R";
  arm.master = 1;
  arm.node = 2;
  model.joints = {arm};
  measure_rotations(model);
  const Path path = solve(model);
  const State& state = path.states.back();
  const double turned = state.rotation(2, 1);
  EXPECT_GT(turned, 0.05);
  EXPECT_NEAR(state.rotation(2, 2), turned, 1e-15);
  const Vector3d across = state.displacement.col(2) - state.displacement.col(1);
  EXPECT_NEAR(across.x(), -0.5 * std::sin(turned), 1e-13);
  EXPECT_NEAR(across.y(), 0.5 * (std::cos(turned) - 1.0), 1e-13);
  const auto forces = element_output<Beam>(model, state);
  // Moment of the load about B in the deformed state; the arm points along R e_y.
  EXPECT_NEAR(forces(11, 0), 20.0 * 0.5 * std::cos(turned), 1e-9);
  const auto pushed = output(model, state, 0, "rigid_force_N");
  EXPECT_NEAR(pushed[0], 20.0, 1e-9);
}

}  // namespace statejump::truss
