// SPDX-License-Identifier: GPL-3.0-or-later
// Start of a path: stuck in the reference configuration, or in the frictionless equilibrium.
#include <gtest/gtest.h>

#include <stdexcept>
#include <string>

#include "parts.hpp"
#include "statejump/truss/path.hpp"

namespace statejump::truss {
namespace {

constexpr double f = 30.0;
constexpr double k = 70e9 * 9e-6 / 0.5;
constexpr double k_p = 1e5;
constexpr double P = 20.0;

/// Bar of Table 1 with a parallel spring that pulls the block back with the force `pull`.
Model pulled_bar(double pull = P) {
  Model model = testing::sliding_bar();
  model.springs = {{"P", 0, 1, k_p, 0.5 - pull / k_p, false}};
  return model;
}

Path path_of(const Model& model, StartFriction start) {
  Options options;
  options.start_friction = start;
  return solve(model, options);
}

double along(const State& state) {
  return state.displacement(0, 1);
}

double jump(const Path& path) {
  return along(path.states.back()) - along(path.states.front());
}

/// Newton's tolerances at both ends of the cycle: 1e-13 of 1.2 mm for closures; 1e-12 of 200 N,
/// over k 1.6e-16 m, for forces.
constexpr double close = 2.0 * (1.2e-16 + 1.6e-16);

TEST(StartChoice, BarStartsStuckOrWithoutFriction) {
  const Path stuck = path_of(pulled_bar(), StartFriction::stuck);
  EXPECT_NEAR(along(stuck.states.front()), 0.0, close);
  EXPECT_NEAR(jump(stuck), (f - P) / (k + k_p), close);
  const Path settled = path_of(pulled_bar(), StartFriction::frictionless);
  EXPECT_NEAR(along(settled.states.front()), -P / (k + k_p), close);
  EXPECT_NEAR(output(pulled_bar(), settled.states.front(), 0, "slider_force_N")[0], 0.0, 1e-12 * P);
  EXPECT_NEAR(jump(settled), f / (k + k_p), close);
}

TEST(StartChoice, PullBeyondFrictionSlidesAtTheStart) {
  const Path stuck = path_of(pulled_bar(3.0 * f), StartFriction::stuck);
  EXPECT_NEAR(along(stuck.states.front()), -2.0 * f / (k + k_p), close);
  EXPECT_NEAR(jump(stuck), 0.0, close);
}

TEST(StartChoice, WithoutLoadBothAreTheDrawnShape) {
  for (const StartFriction start : {StartFriction::stuck, StartFriction::frictionless}) {
    const Path path = path_of(testing::sliding_bar(), start);
    EXPECT_EQ(along(path.states.front()), 0.0);
    EXPECT_NEAR(jump(path), f / k, close);
  }
}

TEST(StartChoice, ContactsThatGiveBeginWithoutForce) {
  // The contact springs are undeformed when friction begins, also at a stop.
  for (const int partial_slip : {0, 1}) {
    for (const double clearance : {1e-5, 1.0}) {
      Model model = pulled_bar();
      auto& slider = std::get<Slider>(model.joints[0]);
      slider.tangential_stiffness = 1e8;
      slider.partial_slip = partial_slip;
      slider.clearance_minus = clearance;
      model.programs = {testing::triangle(1e-6)};
      const Path path = path_of(model, StartFriction::frictionless);
      const State& begin = path.states.front();
      const double free = -P / (k + k_p);
      EXPECT_NEAR(along(begin), std::max(free, -clearance), close);
      // At the clearance, the stop carries the part of P that bar and spring do not carry.
      const double pushed = clearance < -free ? -P + (k + k_p) * clearance : 0.0;
      EXPECT_NEAR(output(model, begin, 0, "slider_force_N")[0], pushed, 1e-10);
      // There is no elastic recovery. Heating by 1e-6 K expands the bar by 1.2e-11 m.
      EXPECT_NEAR(along(path.states[1]), along(begin), 1.2e-11);
    }
  }
}

TEST(StartChoice, IwanJointBeginsUnbent) {
  Model model = pulled_bar();
  IwanJoint joint;
  joint.name = std::string("J");
  joint.first = 1;
  joint.tangent_stiffness = 1e8;
  joint.slip_force = f;
  joint.exponent = -0.4;
  joint.stiffness_ratio = 0.7;
  model.joints = {joint};
  model.programs = {testing::triangle(1e-6)};
  const Path path = path_of(model, StartFriction::frictionless);
  EXPECT_NEAR(along(path.states.front()), -P / (k + k_p), close);
  EXPECT_NEAR(output(model, path.states.front(), 0, "iwan_force_N")[0], 0.0, 1e-10);
  EXPECT_NEAR(along(path.states[1]), along(path.states.front()), 1.2e-11);
}

TEST(StartChoice, WhatFrictionAloneHoldsHasNoStartWithoutIt) {
  Model model = testing::sliding_bar();
  model.nodes.push_back(testing::node("C", 1.0, 0.0, 1));
  model.nodes.back().load = {10.0, 0.0, 0.0};
  Slider other;
  other.name = std::string("other");
  other.first = 2;
  other.friction_force = f;
  model.joints.push_back(other);
  EXPECT_NO_THROW(path_of(model, StartFriction::stuck));
  EXPECT_THROW(path_of(model, StartFriction::frictionless), std::runtime_error);
}

}  // namespace
}  // namespace statejump::truss
