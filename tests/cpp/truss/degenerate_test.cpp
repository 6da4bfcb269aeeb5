// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "parts.hpp"
#include "statejump/failure.hpp"

namespace statejump::truss {
namespace {

using Eigen::Vector3d;
using testing::triangle;

/// Heats to a temperature, holds it, continues heating, cools.
thermal::Program held(double at, double largest) {
  thermal::Program program;
  program.shape = thermal::Shape::table;
  program.table_times = {0.0, 0.2, 0.4, 0.6, 1.0};
  program.table_temperature_changes = {0.0, at, at, largest, 0.0};
  return program;
}

double slide(const Model& model, const State& state, int joint = 0) {
  return output(model, state, joint, "slide_m")[0];
}

constexpr double rigidity = 6.3e5;
constexpr double length = 0.5;
constexpr double expansion = 23.4e-6;
constexpr double friction = 30.0;

/// Bar on a block that slides on the ground.
Model bar(thermal::Program program) {
  Model model;
  model.programs = {std::move(program)};
  Node fixed;
  fixed.name = "A";
  fixed.freedoms = 0;
  Node block;
  block.name = "B";
  block.position = {length, 0.0, 0.0};
  block.freedoms = 1;
  model.nodes = {fixed, block};
  model.links = {{"AB", 0, 1, rigidity, length, expansion, 0, 1.0}};
  Slider slider;
  slider.name = "S";
  slider.first = 1;
  slider.friction_force = friction;
  model.joints = {slider};
  return model;
}

/// Slide [m] of the bar's block while it slips in direction s: x_T − s f l_T/(E A).
double sliding(double change, double sense) {
  const double free = length * (1.0 + expansion * change);
  return length * expansion * change - sense * friction * free / rigidity;
}

/// Wheel: spokes from a free hub to blocks on radial rails, with tyre bars between the blocks.
Model wheel(int blocks) {
  Model model;
  model.programs = {triangle(100.0)};
  Node hub;
  hub.name = "hub";
  hub.freedoms = 2;
  model.nodes = {hub};
  for (int i = 0; i < blocks; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / blocks;
    const Vector3d radial(std::cos(angle), std::sin(angle), 0.0);
    Node block;
    block.name = std::string("block").append(std::to_string(i));
    block.position = radial;
    block.freedoms = 1;
    block.free_directions =
        (Eigen::Matrix3d() << radial, Vector3d::UnitZ().cross(radial), Vector3d::UnitZ())
            .finished();
    model.nodes.push_back(block);
    model.links.push_back({block.name, 0, i + 1, rigidity, 1.0, expansion, 0, 1.0});
    Slider slider;
    slider.name = block.name;
    slider.first = i + 1;
    slider.axis = radial;
    slider.friction_force = friction;
    model.joints.push_back(slider);
  }
  for (int i = 0; i < blocks && blocks > 2; ++i) {
    const int next = (i + 1) % blocks;
    const double side =
        (model.nodes[std::size_t(next) + 1].position - model.nodes[std::size_t(i) + 1].position)
            .norm();
    model.springs.push_back({"tyre", i + 1, next + 1, 1e5 * side, side, false});
  }
  if (blocks == 2) {
    // Two collinear spokes do not constrain their hub laterally. If both blocks slide, they do not
    // constrain it axially.
    model.nodes[0].freedoms = 1;
    Node wall;
    wall.name = "wall";
    wall.position = {-3.0, 0.0, 0.0};
    wall.freedoms = 0;
    model.nodes.push_back(wall);
    model.springs.push_back({"tie", 3, 0, 1e5, 3.0, false});
  }
  return model;
}

class Wheel : public ::testing::TestWithParam<int> {};

TEST_P(Wheel, BlocksThatSlipAtTheSameInstantDoSoTogether) {
  const int blocks = GetParam();
  const Model model = wheel(blocks);
  const Path path = solve(model);
  // By symmetry the hub does not move and all blocks behave equally. They slip on heating, then
  // stick and slip on cooling.
  ASSERT_EQ(path.events.size(), 3u * std::size_t(blocks));
  for (int i = 0; i < blocks; ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      const Event& event = path.events[k * std::size_t(blocks) + std::size_t(i)];
      EXPECT_EQ(event.time, path.events[k * std::size_t(blocks)].time);
      EXPECT_EQ(event.after, std::vector({JointStatus::slip_plus, JointStatus::stick,
                                          JointStatus::slip_minus})[k]);
    }
  }
  // The tyre bars, of stiffness k L0, have the same relative elongation as the radius. They press
  // on each block with k x (2 sin(π/n))² L0. The force of the spoke is E A/l (x_T − x).
  const double turn = 2.0 * std::sin(std::numbers::pi / blocks);
  const double tyre = blocks > 2 ? 1e5 * turn * turn * turn : 0.0;
  const double jump = friction / (rigidity + tyre);
  for (int i = 0; i < blocks; ++i) {
    EXPECT_NEAR(slide(model, path.states.back(), i), jump, 1e-10 * jump) << i;
  }
  EXPECT_LT(path.states.back().displacement.col(0).norm(), 1e-15);
  // Five or fifty blocks need as many solves as one.
  EXPECT_LT(path.solves, 200);
}

INSTANTIATE_TEST_SUITE_P(Degenerate, Wheel, ::testing::Values(2, 5, 50));

TEST(Degenerate, BlocksThatSlipAtTheSameInstantAndLeaveAMechanismAreAnError) {
  Model model = wheel(2);
  model.springs.clear();
  try {
    solve(model);
    FAIL();
  } catch (const Failure& failed) {
    EXPECT_EQ(failed.fields().kind, FailureKind::friction_exhausted);
    EXPECT_EQ(failed.fields().joints.size(), 2u);
    // The blocks slip when E A α ΔT = f (1 + α ΔT).
    EXPECT_NEAR(*failed.fields().temperature_change, friction / (rigidity - friction) / expansion,
                1e-6);
  }
}

TEST(Degenerate, SlipThatStopsAtACornerGoesOnAtTheNextOne) {
  for (const bool locate : {true, false}) {
    for (const int increments : {1, 3, 50}) {
      const Model model = bar(held(50.0, 100.0));
      Options options;
      options.locate_events = locate;
      options.increments_per_branch = increments;
      const Path path = solve(model, options);
      for (const State& state : path.states) {
        if (state.time > 0.2 && state.time <= 0.4) {
          EXPECT_NEAR(slide(model, state), sliding(50.0, 1.0), 1e-15) << state.time;
        } else if (state.time > 0.4 && state.time <= 0.6) {
          EXPECT_NEAR(slide(model, state), sliding(state.temperature_change, 1.0), 1e-15)
              << state.time;
        }
      }
      EXPECT_NEAR(slide(model, path.states.back()), sliding(0.0, -1.0), 1e-15);
      // During the hold nothing slides, so the heat is that of the slides on heating and on
      // cooling.
      const double way = sliding(100.0, 1.0) + (sliding(100.0, 1.0) - sliding(0.0, -1.0));
      EXPECT_NEAR(path.states.back().joint_dissipation.sum(), friction * way,
                  1e-12 * friction * way);
    }
  }
}

TEST(Degenerate, StopThatIsReachedAsTheTemperatureTurns) {
  const double farthest = sliding(100.0, 1.0);
  // The block reaches its stop at the reversal, or misses it by rounding, by the event tolerance or
  // by 1 nm.
  for (const double early : {0.0, 1e-16, -1e-16, 1e-15, -1e-15, 1e-12, -1e-12, 1e-9, -1e-9}) {
    for (const bool locate : {true, false}) {
      Model model = bar(triangle(100.0));
      std::get<Slider>(model.joints[0]).clearance_plus = farthest - early;
      Options options;
      options.locate_events = locate;
      const Path path = solve(model, options);
      double reached = 0.0;
      for (const State& state : path.states) reached = std::max(reached, slide(model, state));
      EXPECT_NEAR(reached, farthest - std::max(0.0, early), 1e-15) << early;
      EXPECT_NEAR(slide(model, path.states.back()), sliding(0.0, -1.0), 1e-15) << early;
      EXPECT_LE(path.events.size(), 5u) << early;
    }
  }
}

TEST(Degenerate, WithoutFrictionNothingIsLeftBehind) {
  for (const double clearance : {std::numeric_limits<double>::infinity(), 5e-4}) {
    for (const bool locate : {true, false}) {
      Model model = bar(triangle(100.0));
      Slider& slider = std::get<Slider>(model.joints[0]);
      slider.friction_force = 0.0;
      slider.clearance_plus = clearance;
      Options options;
      options.locate_events = locate;
      const Path path = solve(model, options);
      for (const State& state : path.states) {
        const double free = length * expansion * state.temperature_change;
        EXPECT_NEAR(slide(model, state), std::min(free, clearance), 1e-15);
      }
      EXPECT_EQ(path.states.back().joint_dissipation.sum(), 0.0);
    }
  }
}

TEST(Degenerate, FrictionThatHoldsEverythingLeavesNoEvent) {
  for (Model model : {bar(triangle(100.0)), wheel(5)}) {
    for (Joint& joint : model.joints) std::get<Slider>(joint).friction_force = 1e9;
    const Path path = solve(model);
    EXPECT_TRUE(path.events.empty());
    for (const State& state : path.states) {
      EXPECT_LT(state.displacement.colwise().norm().maxCoeff(), 1e-15);
    }
  }
}

TEST(Degenerate, ClearanceNearlyZeroHoldsAsNone) {
  for (const double clearance : {0.0, 1e-300, 1e-18, 1e-15, 1e-12, 1e-9}) {
    for (const bool locate : {true, false}) {
      Model model = bar(triangle(100.0));
      Slider& slider = std::get<Slider>(model.joints[0]);
      slider.clearance_minus = slider.clearance_plus = clearance;
      Options options;
      options.locate_events = locate;
      const Path path = solve(model, options);
      for (const State& state : path.states) {
        EXPECT_LE(std::abs(slide(model, state)), clearance + 1e-18) << clearance;
      }
      // On cooling the block sticks at its stop: friction can carry the bar's force.
      EXPECT_NEAR(slide(model, path.states.back()), clearance, 1e-18) << clearance;
      EXPECT_LE(path.events.size(), 6u) << clearance;
    }
  }
}

}  // namespace
}  // namespace statejump::truss
