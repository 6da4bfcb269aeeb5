// SPDX-License-Identifier: GPL-3.0-or-later
#include "../parts.hpp"
#include "gradients.hpp"

namespace statejump::truss {
namespace {

using testing::node;

TEST(LatchHinge, GradientsAreThoseOfItsForces) {
  Model model;
  thermal::Program program;
  program.period = 1.0;
  model.programs = {program};
  model.nodes = {node("A", {0.0, 0.0, 0.0}, 3), node("B", {0.1, 0.02, 0.01}, 3),
                 node("C", {0.15, 0.09, -0.02}, 3)};
  model.links = {{"AB", 0, 1, 1e2, 0.1, 0.0, 0, 1.0}, {"BC", 1, 2, 1e2, 0.1, 0.0, 0, 1.0}};
  LatchHinge hinge;
  hinge.name = "H";
  hinge.axis = Eigen::Vector3d(1.0, 2.0, 9.0).normalized();
  hinge.stiffness = 0.3;
  hinge.friction_moment = 0.2;
  hinge.preload_moment = -0.1;
  for (const int second : {-1, 1}) {
    // Deadbands wider and narrower than the rotation of the links, which is about 1e-3.
    for (const double deadband : {0.0, 1e-6, 0.1}) {
      hinge.second_link = second;
      hinge.friction_stiffness = deadband == 0.0 ? 0.7 : std::numeric_limits<double>::infinity();
      hinge.deadband = deadband;
      model.joints = {hinge};
      const detail::System system(model);
      Eigen::VectorXd z = Eigen::VectorXd::LinSpaced(system.unknowns(), 1e-5, 3e-4);
      z[4] = -2e-4;
      z[9] = 1.5;
      Eigen::VectorXd before = z;
      before[1] += 1e-5;
      check_gradients(model, z, before,
                      {JointStatus::stick, JointStatus::slip_plus, JointStatus::slip_minus}, 1e-8,
                      1e-4);
    }
  }
}

TEST(LatchHinge, EdgesOfItsPlayAreDistancesOfTheEndOfItsLink) {
  Model model;
  model.programs = {testing::triangle(100.0)};
  model.nodes = {node("A", 0.0, 0.0, 0), node("B", 0.4, 0.0, 2)};
  model.links = {{"AB", 0, 1, 1e2, 0.4, 0.0, 0, 1.0}};
  LatchHinge hinge;
  hinge.name = "H";
  hinge.stiffness = 0.3;
  hinge.deadband = 0.02;
  model.joints = {hinge};
  const detail::System system(model);
  const double turned = 0.03;
  Eigen::VectorXd z = Eigen::VectorXd::Zero(system.unknowns());
  const detail::StepStart start = system.begin(z, 0.0, system.all_stick(), 1.0);
  z.head<2>() << 0.4 * (std::cos(turned) - 1.0), 0.4 * std::sin(turned);
  const Eigen::VectorXd beyond = system.beyond_edges(z, 0.1, start);
  ASSERT_EQ(beyond.size(), 2);
  EXPECT_NEAR(beyond[0], 0.4 * (turned - 0.02), 1e-15);
  EXPECT_NEAR(beyond[1], 0.4 * (turned + 0.02), 1e-15);
}

}  // namespace
}  // namespace statejump::truss
