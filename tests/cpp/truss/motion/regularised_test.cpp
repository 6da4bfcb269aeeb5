// SPDX-License-Identifier: GPL-3.0-or-later
// Penalty contacts of a DEM in trusses, integrated explicitly: orders of convergence, and
// comparison with nonsmooth time stepping.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <vector>

#include "ball_scenes.hpp"
#include "statejump/failure.hpp"

namespace statejump::truss {
namespace {

using namespace scenes;
using Eigen::Vector2d;

constexpr double mass = 2.0;
constexpr const char* spring = "mindlin";

MotionOptions from_rest(const Model& model, long steps) {
  MotionOptions options;
  options.steps = options.sample_every = steps;
  options.start = at_rest(model);
  return options;
}

TEST(MotionRegularised, BlockThatSticksSwingsAtFourthOrder) {
  // Free oscillation of the block on its contact spring, from an initial velocity. Friction stays
  // below its bound.
  const double omega = std::sqrt(1e6 / mass);
  const double seconds = 8.3 / omega;
  const Model model = block(1e3, seconds);
  const auto error = [&](long steps) {
    MotionOptions options = from_rest(model, steps);
    options.start->velocity(0, 0) = 0.1;
    const Motion motion =
        simulate_regularised(model, masses(Eigen::VectorXd::Constant(1, mass)), spring, options);
    EXPECT_EQ(motion.states.back().joint_status[0], JointStatus::stick);
    const double place =
        motion.states.back().displacement(0, 0) - 0.1 / omega * std::sin(omega * seconds);
    const double speed = motion.moving.back().velocity(0, 0) - 0.1 * std::cos(omega * seconds);
    return std::hypot(omega * place, speed) / 0.1;
  };
  const double coarse = error(100);
  const double fine = error(200);
  // The phase error of one step with h ω = 0.042 is (h ω)^5/120; there are 200 steps.
  EXPECT_NEAR(fine, 200.0 * std::pow(8.3 / 200.0, 5) / 120.0, 0.1 * fine);
  EXPECT_NEAR(coarse / fine, 16.0, 0.2);
}

TEST(MotionRegularised, CornersOfTheProgramKeepFourthOrder) {
  // A bar with a dashpot on a sticking block, heated and cooled. The dashpot's rate jumps at the
  // reversal, which must coincide with a boundary between steps.
  Model model = testing::sliding_bar(0.02);
  model.programs = {lasting(0.02, 100.0)};
  auto& slider = std::get<Slider>(model.joints[0]);
  slider.friction_force = 1e5;
  slider.tangential_stiffness = 1e6;
  Inertia inertia = masses(Vector2d(0.0, 0.2));
  inertia.link_damping = Eigen::VectorXd::Constant(1, 300.0);
  const auto end = [&](long steps) {
    MotionOptions options;
    options.steps = options.sample_every = steps;
    return simulate_regularised(model, inertia, spring, options).states.back().displacement(0, 1);
  };
  const double exact = end(12800);
  const double coarse = std::abs(end(400) - exact);
  const double fine = std::abs(end(800) - exact);
  std::printf("corner %g %g %g\n", exact, coarse, fine);
  EXPECT_NEAR(coarse / fine, 16.0, 2.0);
}

TEST(MotionRegularised, BlockThatSlidesGivesItsEnergyToFriction) {
  const Model model = block(30.0, 0.02);
  MotionOptions options = from_rest(model, 4000);
  options.start->velocity(0, 0) = 0.1;
  const Motion motion =
      simulate_regularised(model, masses(Eigen::VectorXd::Constant(1, mass)), spring, options);
  const State& end = motion.states.back();
  const double energy = 0.5 * mass * 0.01;
  // The block slides until its energy is converted to heat, except for 30²/2e6 J of final
  // oscillation on the spring.
  EXPECT_NEAR(end.joint_dissipation[0], energy, 1.001 * 30.0 * 30.0 / 2e6);
  EXPECT_NEAR(residue(motion), 0.0, 1e-4 * energy);
  EXPECT_NEAR(end.displacement(0, 0), energy / 30.0, 2.0 * 30.0 / 1e6);
}

TEST(MotionRegularised, JournalReboundsAsItsEquationsSay) {
  const double zeta = 0.1;
  const double hertz = 1e9;
  Model model = falling_journal();
  model.programs = {lasting(0.02)};
  model.nodes[1].load = {0.0, -9.81 * mass, 0.0};
  auto& joint = std::get<ClearanceRevolute>(model.joints[0]);
  joint.hertz_stiffness = joint.mindlin_stiffness = hertz;
  Inertia inertia = masses(Vector2d(0.0, mass));
  inertia.joint_damping = Eigen::VectorXd::Constant(1, 2.0 * zeta * std::sqrt(mass));
  const std::vector<double> exact = fallen(0.02, 9.81, zeta, hertz, mass, {0.5e-3, 0.0});
  const auto error = [&](long steps) {
    MotionOptions options = from_rest(model, steps);
    options.start->displacement(1, 1) = -0.5e-3;
    const Motion motion = simulate_regularised(model, inertia, spring, options);
    return std::hypot(-motion.states.back().displacement(1, 1) - exact[0],
                      1e-2 * (-motion.moving.back().velocity(1, 1) - exact[1]));
  };
  const double coarse = error(10000);
  const double fine = error(40000);
  // The dashpot is proportional to the fourth root of the depth, so the force nearly jumps at first
  // contact. The order lies between one, for a jump within a step, and two.
  EXPECT_LT(fine, 1e-5 * 0.5e-3);
  EXPECT_GT(coarse / fine, 4.0);
}

TEST(MotionRegularised, BallMovesAsTheJournalDoesInAPlane) {
  MotionOptions options;
  options.steps = 40000;
  options.sample_every = 4000;
  // Ball and journal have the same law, so they differ only by rounding.
  expect_ball_moves_as_journal(
      [&](const Model& model) {
        return simulate_regularised(model, rib_inertia(), spring, options);
      },
      1e-8, 1e-6);
}

TEST(MotionRegularised, MeetsTheMotionBySets) {
  // Two schemes for one law. Implicit steps have a first-order error.
  const Model model = testing::tripod();
  const Inertia inertia = tripod_inertia();
  MotionOptions options;
  options.steps = options.sample_every = 80000;
  const State exact = simulate_regularised(model, inertia, spring, options).states.back();
  const auto off = [&](long steps) {
    options.steps = options.sample_every = steps;
    return apart(simulate(model, inertia, options).states.back(), exact);
  };
  const double coarse = off(4000);
  EXPECT_LT(coarse, 1e-5);
  EXPECT_LT(off(16000), 0.25 * coarse);
}

TEST(MotionRegularised, RefusesWhatHasNoContactOfTheKernel) {
  Model model = falling_journal();
  const Inertia inertia = masses(Vector2d(0.0, mass));
  const MotionOptions options = from_rest(model, 10);
  EXPECT_THROW(simulate_regularised(model, inertia, spring, options), std::invalid_argument);
  auto& joint = std::get<ClearanceRevolute>(model.joints[0]);
  joint.hertz_stiffness = joint.mindlin_stiffness = 1e9;
  EXPECT_NO_THROW(simulate_regularised(model, inertia, spring, from_rest(model, 10000)));
  EXPECT_THROW(simulate_regularised(model, inertia, "honey", options), std::invalid_argument);
  EXPECT_THROW(simulate_regularised(model, masses(Vector2d(1.0, 0.0)), spring, options),
               std::invalid_argument);
  IwanJoint bolts;
  bolts.name = "bolts";
  bolts.first = 1;
  model.joints = {bolts};
  EXPECT_THROW(simulate_regularised(model, inertia, spring, options), std::invalid_argument);
}

TEST(MotionRegularised, StepsThatAreTooLongAreToldAndFail) {
  const Model sticks = block(1e9, 1.0);
  const MotionOptions at_once = from_rest(sticks, 10);
  const Inertia inertia = masses(Eigen::VectorXd::Constant(1, mass));
  EXPECT_EQ(simulate_regularised(sticks, inertia, spring, at_once).inexact_steps, 10);  // h ω = 71
  Model falls = falling_journal();
  auto& joint = std::get<ClearanceRevolute>(falls.joints[0]);
  joint.hertz_stiffness = joint.mindlin_stiffness = 1e9;
  EXPECT_THROW(
      simulate_regularised(falls, masses(Vector2d(0.0, mass)), spring, from_rest(falls, 10)),
      Failure);
}

}  // namespace
}  // namespace statejump::truss
