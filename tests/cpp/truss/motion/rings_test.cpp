// SPDX-License-Identifier: GPL-3.0-or-later
// Contacts that slip in part in steps by sets: against explicit steps with the kernel's own law,
// against the quasi-static path, and a ball against a journal.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "../joints/ball_models.hpp"
#include "scenes.hpp"

namespace statejump::truss {
namespace {

using namespace scenes;
using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr const char* law = "mindlin_deresiewicz";

Inertia masses(Eigen::VectorXd of_nodes) {
  Inertia inertia;
  inertia.node_mass = std::move(of_nodes);
  return inertia;
}

/// Every joint slips in part.
Model in_part(Model model) {
  for (Joint& joint : model.joints) {
    std::visit(
        [](auto& one) {
          if constexpr (requires { one.partial_slip; }) one.partial_slip = 1;
        },
        joint);
  }
  return model;
}

/// A block of 2 kg on the ground, k_t = 1e6 N/m.
Model block(double bound, double seconds) {
  Model model;
  model.programs = {lasting(seconds)};
  model.nodes = {node("A", 0, 0, 1)};
  Slider slider;
  slider.name = "S";
  slider.first = 0;
  slider.friction_force = bound;
  slider.tangential_stiffness = 1e6;
  model.joints = {slider};
  return in_part(std::move(model));
}

Motion thrown(const Model& model, long steps, double tolerance = 0.0) {
  MotionOptions options;
  options.steps = steps;
  options.sample_every = steps / 10;
  options.displacement_tolerance = tolerance;
  options.start = at_rest(model);
  options.start->velocity(0, 0) = 0.1;
  return simulate(model, masses(Eigen::VectorXd::Constant(1, 2.0)), options);
}

TEST(MotionRings, BlockSlidesAndSwingsAsInExplicitSteps) {
  // It slides as a whole at first, then swings within the bound, and loses heat in every swing.
  const Model model = block(100.0, 0.03);
  MotionOptions options;
  options.steps = options.sample_every = 40000;
  options.start = at_rest(model);
  options.start->velocity(0, 0) = 0.1;
  const Motion exact =
      simulate_regularised(model, masses(Eigen::VectorXd::Constant(1, 2.0)), law, options);
  const double slid = exact.states.back().displacement(0, 0);
  const double heat = exact.states.back().joint_dissipation[0];
  const auto apart = [&](const Motion& motion) {
    return std::abs(motion.states.back().displacement(0, 0) - slid);
  };
  const Motion coarse = thrown(model, 20000);
  const Motion fine = thrown(model, 80000);
  // Of first order: contacts are implicit Euler's.
  EXPECT_LT(apart(fine), 2e-3 * slid);
  EXPECT_NEAR(apart(coarse) / apart(fine), 4.0, 0.8);
  EXPECT_NEAR(fine.states.back().joint_dissipation[0], heat, 2e-3 * heat);
  EXPECT_LT(std::abs(residue(fine)), 1e-9 * heat);
  // A tolerance is of a step.
  const double tolerance = 1e-11;
  const Motion controlled = thrown(model, 1000, tolerance);
  EXPECT_LT(apart(controlled), tolerance * static_cast<double>(controlled.steps));
}

TEST(MotionRings, SlowlyHeatedBarIsItsPath) {
  Model model = testing::sliding_bar(1.0);
  auto& slider = std::get<Slider>(model.joints[0]);
  slider.tangential_stiffness = 1e8;
  model = in_part(std::move(model));
  const State still = solve(model, {}).states.back();
  Inertia inertia = masses(Vector2d(0.0, 0.1));
  inertia.link_damping = Eigen::VectorXd::Constant(1, 1e3);
  const auto apart = [&](double seconds) {
    model.programs[0].period = seconds;
    MotionOptions options;
    options.steps = options.sample_every = 20000;
    options.theta = 1.0;
    const State end = simulate(model, inertia, options).states.back();
    EXPECT_NEAR(end.joint_dissipation[0], still.joint_dissipation[0],
                1e-3 * still.joint_dissipation[0]);
    return std::abs(end.displacement(0, 1) - still.displacement(0, 1));
  };
  // The dashpot holds it back by the rate of heating.
  const double quick = apart(1.0);
  EXPECT_LT(quick, 1e-5 * still.displacement(0, 1));
  EXPECT_NEAR(apart(10.0), 0.1 * quick, 1e-3 * quick);
}

/// A rib under a quick temperature cycle, in explicit steps or by sets.
Motion quick(const Model& model, long steps, bool by_sets) {
  Inertia inertia = masses(Eigen::VectorXd::Constant(5, 0.05));
  inertia.joint_damping = Eigen::VectorXd::Constant(1, 2.0 * 0.1 * std::sqrt(0.025));
  inertia.pin_damping = Vector2d(1e-2, 1e-2);
  MotionOptions options;
  options.steps = steps;
  options.sample_every = steps / 10;
  return by_sets ? simulate(model, inertia, options)
                 : simulate_regularised(model, inertia, law, options);
}

TEST(MotionRings, RevoluteGoesToExplicitStepsAsItsStepsFall) {
  const Model model = in_part(testing::rib(false, Matrix3d::Identity()));
  const State exact = quick(model, 80000, false).states.back();
  const auto apart = [&](long steps) {
    const State end = quick(model, steps, true).states.back();
    return (end.displacement - exact.displacement).norm() / exact.displacement.norm();
  };
  const double coarse = apart(4000);
  const double fine = apart(16000);
  EXPECT_LT(coarse, 3e-4);
  EXPECT_LT(fine, 0.35 * coarse);
}

TEST(MotionRings, BallMovesAsTheJournalDoesInAPlane) {
  const Matrix3d turned =
      Eigen::AngleAxisd(2.1, Vector3d(1.0, -2.0, 0.5).normalized()).toRotationMatrix();
  const Motion ball = quick(in_part(testing::rib(true, turned)), 8000, true);
  const Motion journal = quick(in_part(testing::rib(false, Matrix3d::Identity())), 8000, true);
  ASSERT_EQ(ball.states.size(), journal.states.size());
  const double largest = journal.states[5].displacement.norm();
  for (std::size_t i = 0; i < ball.states.size(); ++i) {
    const Eigen::Matrix3Xd apart =
        turned.transpose() * ball.states[i].displacement - journal.states[i].displacement;
    EXPECT_LT(apart.norm(), 1e-6 * largest) << "sample " << i;
  }
  const double heat = journal.states.back().joint_dissipation[0];
  EXPECT_GT(heat, 0.0);
  EXPECT_NEAR(ball.states.back().joint_dissipation[0], heat, 1e-3 * heat);
}

TEST(MotionRings, TripodGoesToExplicitStepsAsItsStepsFall) {
  const Model model = in_part(testing::tripod());
  Inertia inertia = masses(Eigen::VectorXd::Constant(8, 0.5));
  inertia.link_damping = Eigen::VectorXd::Constant(4, 60.0);
  inertia.joint_damping = Eigen::VectorXd::Constant(1, 2.0 * 0.1 * std::sqrt(0.25));
  MotionOptions options;
  options.steps = options.sample_every = 80000;
  const State exact = simulate_regularised(model, inertia, law, options).states.back();
  const auto apart = [&](long steps) {
    options.steps = options.sample_every = steps;
    const State by_sets = simulate(model, inertia, options).states.back();
    return (by_sets.displacement - exact.displacement).norm() / exact.displacement.norm();
  };
  const double coarse = apart(4000);
  const double fine = apart(16000);
  EXPECT_LT(coarse, 1e-5);
  EXPECT_LT(fine, 0.35 * coarse);
}

TEST(MotionRings, ContactProblemHasTheSameLaw) {
  // Two rigid stops in one place share their force as they like: steps against them have no
  // branches that are found, and their contacts one problem.
  Model model = block(20.0, 0.02);
  auto& slider = std::get<Slider>(model.joints[0]);
  slider.clearance_plus = 2e-5;
  model.nodes[0].load = {15.0, 0.0, 0.0};
  const Motion one = thrown(model, 2000);
  Slider twin = slider;
  twin.name = "T";
  twin.friction_force = 0.0;
  twin.partial_slip = 0;
  twin.tangential_stiffness = std::numeric_limits<double>::infinity();
  model.joints.push_back(twin);
  const Motion both = thrown(model, 2000);
  ASSERT_TRUE(both.undetermined);
  for (std::size_t i = 0; i < one.states.size(); ++i) {
    EXPECT_NEAR(both.states[i].displacement(0, 0), one.states[i].displacement(0, 0), 1e-9);
  }
  EXPECT_NEAR(both.states.back().joint_dissipation[0], one.states.back().joint_dissipation[0],
              1e-4 * one.states.back().joint_dissipation[0]);
}

}  // namespace
}  // namespace statejump::truss
