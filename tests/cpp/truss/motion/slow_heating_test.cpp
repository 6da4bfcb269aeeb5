// SPDX-License-Identifier: GPL-3.0-or-later
// Joints whose friction sticks as springs, in slowly heated motion, compared with the quasi-static
// path, which has its own equations for them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "../joints/heated_bar.hpp"
#include "scenes.hpp"
#include "statejump/truss/path.hpp"

namespace statejump::truss {
namespace {

using namespace scenes;

/// A lever on a latch hinge. A heated strut lifts the lever through the play of the hinge.
Model lever(double seconds) {
  Model model;
  model.programs = {lasting(seconds, 100.0)};
  model.nodes = {node("A", 0, 0, 0), node("B", 0.5, 0, 2), node("C", 0.5, -0.4, 0)};
  model.links = {{"AB", 0, 1, 7e5, 0.5, 0.0, 0, 1.0}, {"CB", 2, 1, 7e5, 0.4, 2e-5, 0, 1.0}};
  LatchHinge hinge;
  hinge.name = "latch";
  hinge.first_link = 0;
  hinge.deadband = 5e-4;
  hinge.stiffness = 200.0;
  hinge.friction_moment = 3.0;
  hinge.friction_stiffness = 1e5;
  model.joints = {hinge};
  return model;
}

/// A bar against a bolted joint (Iwan).
Model bolted(double seconds) {
  IwanJoint joint;
  joint.name = "bolts";
  joint.first = 1;
  joint.tangent_stiffness = 2e7;
  joint.slip_force = 120.0;
  joint.exponent = -0.4;
  joint.stiffness_ratio = 0.7;
  joint.elements = 10;
  Model model = testing::heated_bar(joint, 100.0, 1);
  model.programs = {lasting(seconds, 100.0)};
  return model;
}

struct Apart {
  double displacement;  ///< of node 1 at the end, relative to its jump [-]
  double heat;          ///< relative to the heat of the path [-]
};

/// Differences between motion and quasi-static path at the end of a cycle. Each link has 0.1 kg and
/// half its critical damping.
Apart apart(const Model& model) {
  const auto links = static_cast<Eigen::Index>(model.links.size());
  Inertia inertia{Eigen::VectorXd::Constant(links, 0.1), {}, Eigen::VectorXd(links), {}, {}};
  for (Eigen::Index i = 0; i < links; ++i) {
    const Bar& link = model.links[static_cast<std::size_t>(i)];
    inertia.link_damping[i] = std::sqrt(link.axial_stiffness * link.stress_free_length * 0.1 / 3.0);
  }
  MotionOptions options;
  options.steps = options.sample_every = 20000;
  const State moved = simulate(model, inertia, options).states.back();
  const State rested = solve(model).states.back();
  const double jump = rested.displacement.col(1).norm();
  return {(moved.displacement.col(1) - rested.displacement.col(1)).norm() / jump,
          std::abs(moved.joint_dissipation.sum() / rested.joint_dissipation.sum() - 1.0)};
}

TEST(MotionSlowHeating, LatchHingesAndBoltedJointsFollowTheirPath) {
  for (const auto& model : {lever, bolted}) {
    const Apart fast = apart(model(0.1));
    const Apart slow = apart(model(1.0));
    SCOPED_TRACE(slow.displacement);
    EXPECT_LT(slow.displacement, 1e-3);
    EXPECT_LT(slow.heat, 1e-3);
    EXPECT_LT(slow.displacement, 0.2 * fast.displacement);
  }
}

}  // namespace
}  // namespace statejump::truss
