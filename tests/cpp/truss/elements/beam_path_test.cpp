// SPDX-License-Identifier: GPL-3.0-or-later
// Quasi-static paths of frames: closed forms, supports of rotations, friction, energy.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "../parts.hpp"

namespace statejump::truss {
namespace {

using Eigen::Vector3d;
using testing::node;
using testing::triangle;

constexpr double expansion = 1.2e-5;

Beam beam(const std::string& name, int first, int second, const Model& model, double axial,
          double bending) {
  Beam made;
  made.name = name;
  made.first = first;
  made.second = second;
  made.axial_stiffness = axial;
  made.torsional_stiffness = 0.7 * bending;
  made.bending_stiffness_y = made.bending_stiffness_z = bending;
  made.thermal_expansion = expansion;
  const Vector3d along = model.nodes[static_cast<std::size_t>(second)].position -
                         model.nodes[static_cast<std::size_t>(first)].position;
  made.stress_free_length = along.norm();
  made.axis_y = Vector3d::UnitZ().cross(along).normalized();
  return made;
}

/// Beam of 6 m in two elements with a gradient of 20 K over 0.4 m. The first node is clamped.
Model warmed_beam() {
  Model model;
  model.programs = {triangle(20.0)};
  model.nodes = {node("A", {0, 0, 0}, 0), node("B", {3, 0, 0}, 3), node("C", {6, 0, 0}, 3)};
  model.nodes[0].rotations = 0;
  for (int k = 0; k < 2; ++k) {
    model.beams.push_back(beam("beam", k, k + 1, model, 4.5e9, 6e7));
    model.beams.back().temperature_fraction = 0.0;
    model.beams.back().gradient_y = 1.0 / 0.4;
  }
  measure_rotations(model);
  return model;
}

const State& hottest(const Path& path) {
  return *std::max_element(
      path.states.begin(), path.states.end(),
      [](const State& a, const State& b) { return a.temperature_change < b.temperature_change; });
}

double energy_error(const Path& path) {
  const State& end = path.states.back();
  return end.thermal_work - (end.elastic_energy - path.states.front().elastic_energy) -
         (end.load_potential - path.states.front().load_potential) - end.joint_dissipation.sum();
}

}  // namespace

// The warm side is y > 0, so the free end moves towards −y along an arc.
TEST(BeamPath, GradientBendsACantileverToAnArc) {
  const Model model = warmed_beam();
  const Path path = solve(model);
  const State& hot = hottest(path);
  const double curvature = expansion * 20.0 / 0.4;
  EXPECT_NEAR(hot.displacement(1, 2), -(1.0 - std::cos(6.0 * curvature)) / curvature, 1e-12);
  EXPECT_NEAR(hot.rotation(2, 2), -6.0 * curvature, 1e-13);
  EXPECT_LT(path.states.back().displacement.norm(), 1e-12);
  EXPECT_LT(hot.elastic_energy, 1e-12);
}

TEST(BeamPath, ClampedEndsCarryTheMomentOfAGradient) {
  Model model = warmed_beam();
  model.nodes[2].freedoms = model.nodes[2].rotations = 0;
  const Path path = solve(model);
  const auto moment = element_output<Beam>(model, hottest(path));
  for (const int row : {5, 11}) {
    EXPECT_NEAR(moment(row, 0), 36e3, 1e-6);
    EXPECT_NEAR(moment(row, 1), 36e3, 1e-6);
  }
  const State& hot = hottest(path);
  EXPECT_NEAR(hot.thermal_work, hot.elastic_energy, 1e-10 * hot.elastic_energy);
}

TEST(BeamPath, MomentOnANodeIsPartOfTheBalance) {
  Model model = warmed_beam();
  model.programs = {triangle(1e-9)};
  model.nodes[2].moment = {0.0, 0.0, 1000.0};
  const Path path = solve(model);
  const State& loaded = path.states.back();
  EXPECT_NEAR(loaded.rotation(2, 2), 1000.0 * 6.0 / 6e7, 1e-12);
  EXPECT_NEAR(loaded.load_potential, -1000.0 * loaded.rotation(2, 2), 1e-12);
}

// A node that may rotate about one axis only: the beam twists, or does not.
TEST(BeamPath, SupportsOfRotations) {
  Model model = warmed_beam();
  model.nodes[2].moment = {500.0, 0.0, 0.0};
  const Path free = solve(model);
  EXPECT_NEAR(free.states.front().rotation(0, 2), 500.0 * 6.0 / (0.7 * 6e7), 1e-10);
  Eigen::Matrix3d directions;
  directions << 0, 0, 1, 0, 1, 0, 1, 0, 0;
  model.nodes[2].rotation_directions = directions;
  model.nodes[2].rotations = 2;
  const Path held = solve(model);
  EXPECT_EQ(held.states.front().rotation(0, 2), 0.0);
  EXPECT_NEAR(held.states.front().rotation(2, 2), 0.0, 1e-12);
}

// The rotation of the whole changes nothing.
TEST(BeamPath, DoesNotDependOnTheOrientation) {
  Model model = warmed_beam();
  model.nodes[2].load = {-2e5, 3e4, 1e4};
  model.beams[1].temperature_fraction = 3.0;
  const Eigen::Matrix3d turn = Eigen::Quaterniond(0.5, -0.3, 0.7, 0.4).normalized().matrix();
  Model turned = model;
  for (Node& one : turned.nodes) {
    one.position = turn * one.position;
    one.load = turn * one.load;
  }
  for (Beam& one : turned.beams) one.axis_y = turn * one.axis_y;
  const State here = hottest(solve(model));
  const State there = hottest(solve(turned));
  EXPECT_LT((turn * here.displacement - there.displacement).norm(), 1e-11);
  EXPECT_LT((turn * here.rotation - there.rotation).norm(), 1e-11);
  EXPECT_LT((here.element_output - there.element_output).norm(), 1e-9 * here.element_output.norm());
}

// A boom with a strut to a block that slides: friction keeps a part of the displacement.
TEST(BeamPath, SliderAtTheTipJumps) {
  Model model = warmed_beam();
  model.nodes.push_back(node("block", {6, -0.3, 0}, 1));
  Eigen::Matrix3d up;
  up << 0, 0, 1, 1, 0, 0, 0, 1, 0;
  model.nodes.back().free_directions = up;
  model.links = {{"strut", 3, 2, 1e9, 0.3, 0.0, 0, 1.0}};
  Slider slider;
  slider.name = std::string("S");
  slider.first = 3;
  slider.axis = Vector3d::UnitY();
  slider.friction_force = 2000.0;
  model.joints = {slider};
  const Path path = solve(model);
  ASSERT_FALSE(path.events.empty());
  // The block slips until the bending stiffness 3 E I/L³ holds it with the friction.
  const double jump = path.states.back().displacement(1, 2);
  const double stiffness = 3.0 * 6e7 / 216.0;
  const double arc = 10.8e-3 - 2000.0 / stiffness;
  EXPECT_NEAR(hottest(path).displacement(1, 2), -arc, 1e-5);
  EXPECT_NEAR(jump, -2000.0 / stiffness, 1e-5);
  const State& end = path.states.back();
  EXPECT_GT(end.joint_dissipation.sum(), 0.0);
  EXPECT_LT(std::abs(energy_error(path)), 1e-8 * end.joint_dissipation.sum());
}

TEST(BeamPath, NamesTheRotationsOfAMechanism) {
  Model model = warmed_beam();
  model.nodes[0].rotations = 3;
  model.nodes[2].freedoms = 0;
  const Path held = solve(model);
  ASSERT_EQ(held.notes.size(), 1u);
  EXPECT_EQ(held.notes[0].kind, NoteKind::free_spin);
  model.nodes[1].moment = Vector3d(1.0, 0.0, 0.0);  // drives the spin
  try {
    solve(model);
    FAIL();
  } catch (const Failure& failure) {
    EXPECT_EQ(failure.fields().kind, FailureKind::held_mechanism);
    ASSERT_EQ(failure.fields().modes.size(), 1u);
    const ModeNode& moved = failure.fields().modes[0][0];
    EXPECT_TRUE(moved.rotates);
    EXPECT_EQ(moved.along, 'x');
  }
}

TEST(BeamPath, RefusesTooFewBeams) {
  Model model = warmed_beam();
  for (Beam& one : model.beams) one.gradient_y *= 1500.0;
  try {
    solve(model);
    FAIL();
  } catch (const kernel::OutOfRange& refused) {
    EXPECT_EQ(refused.range(), "at most 1 rad; divide the beam into more beams");
  }
}

}  // namespace statejump::truss
