// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>
#include <string>

#include "statejump/truss_path.hpp"
#include "truss_newton.hpp"
#include "truss_system.hpp"

namespace statejump {
namespace {

using detail::JointModel;
using detail::Statuses;
using detail::TrussSystem;
using Eigen::VectorXd;

kernel::ThermalProgram triangle(double largest) {
  kernel::ThermalProgram program;
  program.shape = kernel::ThermalShape::triangle;
  program.temperature_change_max = largest;
  program.period = 1.0;
  return program;
}

TrussNode node(const std::string& name, double x, double y, int freedoms) {
  TrussNode made;
  made.name = name;
  made.position = {x, y, 0.0};
  made.freedoms = freedoms;
  return made;
}

/// Bar on a block that slides on the ground.
TrussModel bar() {
  TrussModel model;
  model.programs = {triangle(100.0)};
  model.nodes = {node("A", 0, 0, 0), node("B", 0.5, 0, 1)};
  model.links = {{"AB", 0, 1, 70e9 * 9e-6, 0.5, 23.4e-6, 0, 1.0}};
  TrussSlider slider;
  slider.name = "S";
  slider.first = 1;
  slider.friction_force = 30.0;
  model.sliders = {slider};
  return model;
}

/// Rib of two bars with a clearance joint, a torsion spring and a cable, at rest in no special
/// shape.
TrussModel rib() {
  TrussModel model;
  model.programs = {triangle(100.0)};
  model.nodes = {node("A", 0, 0, 0), node("C", 0.12, 0, 0), node("B", 0.02875, 0.0409, 2),
                 node("J", 0.02875, 0.0409, 2)};
  model.nodes[2].load = {1.0, -2.0, 0.0};
  model.links = {{"AB", 0, 2, 6.3e5, 0.05, 23.75e-6, 0, 1.0},
                 {"CJ", 1, 3, 6.3e5, 0.1, 23.75e-6, 0, 0.5}};
  model.springs = {{"tie", 1, 2, 1e3, 0.09, true}};
  model.torsion_springs = {{"flare", 0, 1, 1.0, 0.05, Eigen::Vector3d::UnitZ()}};
  ClearanceRevolute joint;
  joint.name = "joint";
  joint.bearing_node = 2;
  joint.journal_node = 3;
  joint.bearing_link = 0;
  joint.journal_link = 1;
  joint.journal_radius = 5e-3;
  joint.radial_clearance = 1e-4;
  joint.friction_coefficient = 0.15;
  joint.hertz_stiffness = 2.6e10;
  model.revolutes = {joint};
  return model;
}

std::string message(const TrussModel& model) {
  try {
    truss_path(model);
  } catch (const std::exception& error) {
    return error.what();
  }
  return "";
}

TEST(Truss, BarJumpsByFrictionOverStiffness) {
  const TrussPath path = truss_path(bar());
  const double jump = path.cycle_ends.back().displacement(0, 1);
  EXPECT_NEAR(jump, 30.0 * 0.5 / (70e9 * 9e-6), 1e-12 * jump);
  EXPECT_TRUE(path.complete);
}

TEST(Truss, SliderBetweenTwoNodesHoldsAcrossItsAxis) {
  // The same bar, its block on a carrier that a second bar holds upright: a load across the axis
  // goes into the carrier.
  TrussModel model = bar();
  model.nodes[1].freedoms = 2;
  model.nodes.push_back(node("D", 0.5, 0, 2));
  model.nodes.push_back(node("E", 0.5, -1, 0));
  model.nodes.push_back(node("F", 1.5, 0, 0));
  model.links.push_back({"ED", 3, 2, 6.3e5, 1.0, 0.0, 0, 1.0});
  model.links.push_back({"FD", 4, 2, 6.3e9, 1.0, 0.0, 0, 1.0});
  model.nodes[1].load = {0.0, -63.0, 0.0};
  model.sliders[0].second = 2;
  const TrussPath path = truss_path(model);
  const TrussState& end = path.states.back();
  EXPECT_NEAR(end.axial_force[1], 63.0, 0.05);  // 0.05: the bars tilt by 1e-4
  EXPECT_NEAR(end.displacement(1, 1), end.displacement(1, 2), 1e-15);
  EXPECT_NEAR(std::abs(end.slider_force[0]), 30.0, 1e-9);
}

TEST(Truss, JacobianIsTheDerivativeOfTheResidual) {
  const TrussModel model = rib();
  const TrussSystem system(model);
  VectorXd z = VectorXd::LinSpaced(system.unknowns(), 1e-5, 6e-5);
  z[2] += 9e-5;  // in contact
  z[4] = 5.0;    // normal force, friction
  z[5] = 0.4;
  VectorXd before = z;
  before[0] -= 3e-6;
  before[3] += 2e-6;
  Statuses statuses;
  Eigen::SparseMatrix<double> jacobian = system.pattern();
  VectorXd plus(system.unknowns());
  VectorXd minus(system.unknowns());
  for (const JointStatus status :
       {JointStatus::stick, JointStatus::slip_plus, JointStatus::slip_minus, JointStatus::open}) {
    statuses.revolutes = {status};
    const auto start = system.step_start(before, statuses);
    for (const JointModel joints : {JointModel::pins, JointModel::friction}) {
      system.evaluate(z, 0.3, start, statuses, joints, 1.0, plus, jacobian);
      const Eigen::MatrixXd exact(jacobian);
      Eigen::SparseMatrix<double> scratch = jacobian;
      for (int j = 0; j < system.unknowns(); ++j) {
        // Central differences: error of second order in the step, 1e-3 of the play or of a force,
        // and rounding of the stiffest bar.
        const double step = j < system.displacements() ? 1e-8 : 1e-4;
        VectorXd moved = z;
        moved[j] += step;
        system.evaluate(moved, 0.3, start, statuses, joints, 1.0, plus, scratch);
        moved[j] -= 2 * step;
        system.evaluate(moved, 0.3, start, statuses, joints, 1.0, minus, scratch);
        const VectorXd difference = (plus - minus) / (2 * step);
        for (int i = 0; i < system.unknowns(); ++i) {
          // Left out are the derivatives of the lever arms by the depth: half of friction over the
          // shorter link, 0.2 N/0.05 m, and in the line of friction half of what the links turned,
          // 1e-4. Elsewhere 1e-6 is rounding.
          const double scale = std::max(std::abs(exact(i, j)), std::abs(difference[i]));
          const double left_out = i < 4 && j < 4 ? 5.0 : i == 5 ? 1e-4 : 1e-6;
          EXPECT_NEAR(exact(i, j), difference[i], 2e-5 * scale + left_out)
              << to_string(status) << " row " << i << " column " << j;
        }
      }
    }
  }
}

TEST(Truss, RibFollowsItsPathAndClosesItsBalance) {
  const TrussPath path = truss_path(rib());
  EXPECT_LT(path.largest_force_residual, 1e-11);
  for (const TrussState& state : path.states) {
    EXPECT_LE(std::abs(state.friction_force[0]), 0.15 * state.normal_force[0] + 1e-9);
    EXPECT_GT(state.normal_force[0], 0.0);
  }
}

TEST(Truss, ItemsOutOfRangeAreNamed) {
  TrussModel model = bar();
  model.links[0].axial_stiffness = -1.0;
  EXPECT_EQ(message(model), "link 'AB': axial_stiffness = -1, allowed is finite, > 0 N");
  model = bar();
  model.sliders[0].first = 7;
  EXPECT_NE(message(model).find("slider 'S': first node = 7"), std::string::npos);
  model = bar();
  model.links[0].thermal_expansion = -0.02;
  EXPECT_NE(message(model).find("link 'AB': thermal_expansion"), std::string::npos);
  model = rib();
  model.revolutes[0].journal_link = 0;
  EXPECT_NE(message(model).find("revolute 'joint': journal link"), std::string::npos);
  model = rib();
  model.revolutes[0].bearing_thermal_expansion = -1e-3;
  EXPECT_NE(message(model).find("clearance at the program's worst temperature"), std::string::npos);
}

TEST(Truss, MechanismIsNamed) {
  TrussModel model = rib();
  model.nodes[0].freedoms = 2;
  model.springs.clear();
  EXPECT_NE(message(model).find("mechanism even with every joint held"), std::string::npos);
}

}  // namespace
}  // namespace statejump
