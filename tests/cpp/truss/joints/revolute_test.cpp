// SPDX-License-Identifier: GPL-3.0-or-later
#include <utility>

#include "../parts.hpp"
#include "gradients.hpp"

namespace statejump::truss {
namespace {

using testing::node;

/// Two bars, connected by a clearance joint with elastic contact and expanding radii.
Model rib() {
  Model model;
  thermal::Program program;
  program.temperature_change_max = 100.0;
  program.period = 1.0;
  model.programs = {program};
  model.nodes = {node("A", 0, 0, 2), node("C", 0.12, 0, 2), node("B", 0.02875, 0.0409, 2),
                 node("J", 0.02875, 0.0409, 2)};
  // Soft links have small rounding errors, which do not hide the terms of the joint.
  model.links = {{"AB", 0, 2, 1e2, 0.05, 2e-5, 0, 1.0}, {"CJ", 1, 3, 1e2, 0.1, 1e-5, 0, 0.5}};
  ClearanceRevolute joint = testing::rib_joint();
  joint.journal_thermal_expansion = 2e-5;
  joint.bearing_thermal_expansion = 1e-5;
  joint.friction_coefficient = 0.15;
  joint.hertz_stiffness = 2.6e10;
  joint.mindlin_stiffness = 3.2e10;
  model.joints = {joint};
  return model;
}

TEST(Revolute, GradientsAreThoseOfItsForces) {
  // Tests both orders of the links.
  for (const auto& [partial_slip, first] : {std::pair{0, 0}, std::pair{1, 0}, std::pair{0, 1}}) {
    Model model = rib();
    ClearanceRevolute& joint = std::get<ClearanceRevolute>(model.joints[0]);
    joint.partial_slip = partial_slip;
    if (first == 1) {
      std::swap(model.links[0], model.links[1]);
      std::swap(joint.journal_link, joint.bearing_link);
    }
    const detail::System system(model);
    Eigen::VectorXd z = Eigen::VectorXd::LinSpaced(system.unknowns(), 1e-5, 6e-5);
    z[6] += 9e-5;  // in contact
    z[8] = 5.0;    // normal force, friction [N]
    z[9] = 0.4;
    Eigen::VectorXd before = z;
    before[0] -= 3e-6;
    before[3] += 4e-6;
    before[7] += 2e-6;
    before[9] = 0.3;
    // Loading and unloading: the elastic slide has a branch for each.
    for (const double normal : {4.0, 7.0}) {
      before[8] = normal;
      check_gradients(
          model, z, before,
          {JointStatus::stick, JointStatus::slip_plus, JointStatus::slip_minus, JointStatus::open},
          1e-8, 1e-4);
    }
  }
}

TEST(Revolute, GradientsByRotationsOfNodesAreThoseOfItsForces) {
  for (const int partial_slip : {0, 1}) {
    Model model = rib();
    for (Node& one : model.nodes) one.freedoms = 3;
    ClearanceRevolute& joint = std::get<ClearanceRevolute>(model.joints[0]);
    joint.partial_slip = partial_slip;
    joint.axis = Eigen::Vector3d(0.1, -0.2, 1.0).normalized();
    testing::bend_links(model);
    joint.journal_link = joint.bearing_link = -1;
    joint.journal_turns = joint.bearing_turns = 1;
    const detail::System system(model);
    ASSERT_EQ(system.displacements(), 24);
    Eigen::VectorXd z = Eigen::VectorXd::LinSpaced(system.unknowns(), 1e-5, 6e-5);
    // Large rotations of both nodes of the joint.
    z.segment<3>(15) = Eigen::Vector3d(0.1, -0.2, 0.3) * 0.05;
    z.segment<3>(21) = Eigen::Vector3d(-0.3, 0.1, 0.2) * 0.05;
    z[18] += 9e-5;  // in contact
    z[24] = 5.0;    // normal force, friction [N]
    z[25] = 0.4;
    Eigen::VectorXd before = z;
    before[16] -= 3e-6;
    before[22] += 4e-6;
    before[18] += 2e-6;
    before[25] = 0.3;
    for (const double normal : {4.0, 7.0}) {
      before[24] = normal;
      check_gradients(
          model, z, before,
          {JointStatus::stick, JointStatus::slip_plus, JointStatus::slip_minus, JointStatus::open},
          1e-8, 1e-4);
    }
  }
}

}  // namespace
}  // namespace statejump::truss
