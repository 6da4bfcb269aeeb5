// SPDX-License-Identifier: GPL-3.0-or-later
// Contacts with partial slip in nonsmooth time stepping, compared with explicit steps of the
// kernel's law and with the quasi-static path; and a ball compared with a journal.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "ball_scenes.hpp"

namespace statejump::truss {
namespace {

using namespace scenes;
using Eigen::Matrix3d;
using Eigen::Vector2d;

constexpr const char* law = "mindlin_deresiewicz";

/// Sets partial slip for every joint.
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
  // The block first slips completely, then oscillates within the friction bound and dissipates in
  // every period.
  const Model model = in_part(block(100.0, 0.03));
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
  // The error is of first order, because contacts use implicit Euler.
  EXPECT_LT(apart(fine), 2e-3 * slid);
  EXPECT_NEAR(apart(coarse) / apart(fine), 4.0, 0.8);
  EXPECT_NEAR(fine.states.back().joint_dissipation[0], heat, 2e-3 * heat);
  EXPECT_LT(std::abs(residue(fine)), 1e-9 * heat);
  // The tolerance applies to each step.
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
  // The dashpot delays the motion in proportion to the heating rate.
  const double quick = apart(1.0);
  EXPECT_LT(quick, 1e-5 * still.displacement(0, 1));
  EXPECT_NEAR(apart(10.0), 0.1 * quick, 1e-3 * quick);
}

/// A rib under a fast temperature cycle. `by_sets` selects nonsmooth time stepping, otherwise
/// explicit steps.
Motion quick(const Model& model, long steps, bool by_sets) {
  MotionOptions options;
  options.steps = steps;
  options.sample_every = steps / 10;
  return by_sets ? simulate(model, rib_inertia(), options)
                 : simulate_regularised(model, rib_inertia(), law, options);
}

/// Expects nonsmooth time stepping to converge to the state `exact`.
/// @param end returns the state after a number of steps; @param coarse allowed error of 4000 steps
template <class End>
void expect_to_go_to(const State& exact, End&& end, double coarse) {
  const double off = apart(end(4000), exact);
  EXPECT_LT(off, coarse);
  EXPECT_LT(apart(end(16000), exact), 0.35 * off);
}

TEST(MotionRings, RevoluteGoesToExplicitStepsAsItsStepsFall) {
  const Model model = in_part(testing::rib(false, Matrix3d::Identity()));
  expect_to_go_to(
      quick(model, 80000, false).states.back(),
      [&](long steps) { return quick(model, steps, true).states.back(); }, 3e-4);
}

TEST(MotionRings, BallMovesAsTheJournalDoesInAPlane) {
  expect_ball_moves_as_journal(
      [](Model model) { return quick(in_part(std::move(model)), 8000, true); }, 1e-6, 1e-3);
}

TEST(MotionRings, TripodGoesToExplicitStepsAsItsStepsFall) {
  const Model model = in_part(testing::tripod());
  MotionOptions options;
  options.steps = options.sample_every = 80000;
  expect_to_go_to(
      simulate_regularised(model, tripod_inertia(), law, options).states.back(),
      [&](long steps) {
        options.steps = options.sample_every = steps;
        return simulate(model, tripod_inertia(), options).states.back();
      },
      1e-5);
}

TEST(MotionRings, ContactProblemHasTheSameLaw) {
  // Two rigid stops at the same position share their force in an indeterminate way. The active-set
  // iteration then fails, and both contacts are solved as one problem.
  Model model = in_part(block(20.0, 0.02));
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
