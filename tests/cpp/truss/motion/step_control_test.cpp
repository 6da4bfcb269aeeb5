// SPDX-License-Identifier: GPL-3.0-or-later
// Trusses in motion with automatic step control.
#include <gtest/gtest.h>

#include <cmath>

#include "scenes.hpp"

namespace statejump::truss {
namespace {

using Eigen::Vector2d;
using namespace scenes;

/// A swinging pendulum: mass on a rod of 1 m.
Model pendulum(double seconds) {
  Model model;
  model.programs = {lasting(seconds)};
  model.nodes = {node("A", 0, 0, 0), node("B", 1, 0, 2)};
  model.nodes[1].load = {0.0, -9.81, 0.0};
  model.links = {{"AB", 0, 1, 5e3, 1.0, 0.0, 0, 1.0}};
  return model;
}

Motion run(const Model& model, const Inertia& inertia, double tolerance, bool drawn,
           double restitution = 0.0) {
  MotionOptions options;
  options.steps = 20;
  options.displacement_tolerance = tolerance;
  options.restitution = restitution;
  if (drawn) options.start = at_rest(model);
  if (restitution > 0.0) options.start->displacement(1, 1) = -0.5e-3;
  return simulate(model, inertia, options);
}

TEST(StepControl, ErrorsFallWithTheToleranceAtSecondOrder) {
  const Model model = pendulum(1.0);
  const Inertia inertia{{}, Vector2d(0.0, 1.0), {}, {}, {}};
  MotionOptions fine;
  fine.steps = 400000;
  fine.sample_every = fine.steps;
  fine.start = at_rest(model);
  const Eigen::Vector3d exact = simulate(model, inertia, fine).states.back().displacement.col(1);
  const auto error = [&](double tolerance, long& steps) {
    const Motion motion = run(model, inertia, tolerance, true);
    steps = motion.steps;
    EXPECT_EQ(motion.states.size(), 21u);
    EXPECT_EQ(motion.inexact_steps, 0);
    return (motion.states.back().displacement.col(1) - exact).norm();
  };
  long few = 0;
  long many = 0;
  const double coarse = error(1e-6, few);
  const double close = error(1e-9, many);
  // The error of a step is proportional to h³, so a tolerance 1000 times smaller needs 10 times the
  // steps. The global error, proportional to h², then decreases by 100. Step lengths are powers of
  // two.
  EXPECT_NEAR(std::log2(static_cast<double>(many) / static_cast<double>(few)), std::log2(10.0),
              0.7);
  EXPECT_NEAR(std::log2(coarse / close), std::log2(100.0), 1.4);
  EXPECT_LT(close, 1e-5);
}

TEST(StepControl, SlowerHeatingTakesNoMoreStepsAndComesCloserToThePath) {
  // Bar of Table 1 with its block. Oscillations start when heating begins, when it reverses and
  // when the block starts to slip. They decay, and then the motion is slow.
  const double k = 70e9 * 9e-6 / 0.5;
  const double mass = 0.1;
  const auto heated = [&](double seconds) {
    const double damping = std::sqrt(k * mass / 3.0);  // half the critical damping
    return run(
        testing::sliding_bar(seconds),
        {Eigen::VectorXd::Constant(1, mass), {}, Eigen::VectorXd::Constant(1, damping), {}, {}},
        1e-10, false);
  };
  const Motion fast = heated(1.0);
  const Motion slow = heated(1000.0);
  const auto off = [&](const Motion& motion) {
    const double jump = 30.0 / k;
    return std::abs(motion.states.back().displacement(0, 1) - jump) / jump;
  };
  EXPECT_LT(slow.steps, fast.steps);
  EXPECT_LT(fast.steps, 2000);
  EXPECT_LT(off(slow), 1e-2 * off(fast));  // first order in the heating rate, down to the tolerance
  for (const Motion* one : {&fast, &slow}) {
    EXPECT_LT(std::abs(residue(*one)) / one->states.back().joint_dissipation.sum(), 1e-3);
  }
}

TEST(StepControl, JournalBouncesAtItsAnalyticTimes) {
  const Model model = falling_journal();
  const double e = 0.7;
  const Motion motion = run(model, {{}, Vector2d(0.0, 1.0), {}, {}, {}}, 1e-9, true, e);
  double speed = std::sqrt(2.0 * 9.81 * 0.5e-3);
  double time = speed / 9.81;
  const double energy = 0.5 * speed * speed;
  int impact = 0;
  for (const Event& event : motion.events) {
    if (event.before != JointStatus::open || impact == 6) continue;
    // The time of an impact has an error of up to one step, as far as the tolerance allows.
    EXPECT_NEAR(event.time, time, 1e-4 * time) << "impact " << impact;
    speed *= e;
    time += 2.0 * speed / 9.81;
    ++impact;
  }
  EXPECT_EQ(impact, 6);
  EXPECT_NEAR(motion.moving.back().impact_dissipation, energy, 1e-3 * energy);
  EXPECT_LT(motion.steps, 20000);
}

}  // namespace
}  // namespace statejump::truss
