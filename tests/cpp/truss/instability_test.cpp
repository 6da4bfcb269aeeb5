// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "statejump/failure.hpp"
#include "statejump/truss/path.hpp"

namespace statejump::truss {
namespace {

using Eigen::Vector3d;

constexpr double rigidity = 1e6;

thermal::Program triangle(double largest) {
  thermal::Program program;
  program.shape = thermal::Shape::triangle;
  program.temperature_change_max = largest;
  return program;
}

Node node(const char* name, double x, double y, int freedoms) {
  Node made;
  made.name = name;
  made.position = {x, y, 0.0};
  made.freedoms = freedoms;
  return made;
}

/// Flat arch under prestress, friction holds its apex: past its limit point but for that.
Model arch() {
  Model model;
  model.programs = {triangle(100.0)};
  Node apex = node("apex", 0.0, 0.01, 1);
  apex.free_directions << Vector3d::UnitY(), Vector3d::UnitX(), Vector3d::UnitZ();
  model.nodes = {node("left", -1.0, 0.0, 0), apex, node("right", 1.0, 0.0, 0)};
  const double drawn = std::hypot(1.0, 0.01);
  for (int i = 0; i < 2; ++i) {
    model.links.push_back({"bar", i, i + 1, rigidity, drawn * (1.0 + 2e-4), 2e-5, 0, 1.0});
  }
  Slider slider;
  slider.name = "S";
  slider.first = 1;
  slider.axis = Vector3d::UnitY();
  slider.friction_force = 10.0;
  model.joints = {slider};
  return model;
}

/// Arch whose loaded apex thrusts a foot outwards against friction and a spring.
Model footed(double stiffness) {
  Model model;
  model.programs = {triangle(-100.0)};
  Node apex = node("apex", 0.0, 0.1, 2);
  apex.load = {0.0, -20.0, 0.0};
  model.nodes = {node("left", -1.0, 0.0, 0), apex, node("foot", 1.0, 0.0, 1),
                 node("wall", 2.0, 0.0, 0)};
  const double drawn = std::hypot(1.0, 0.1);
  for (int i = 0; i < 2; ++i) {
    model.links.push_back({"bar", i, i + 1, rigidity, drawn, 1e-3, 0, 1.0});
  }
  Slider slider;
  slider.name = "S";
  slider.first = 2;
  slider.friction_force = 110.0;
  model.joints = {slider};
  if (stiffness > 0.0) model.springs.push_back({"spring", 2, 3, stiffness, 1.0, false});
  return model;
}

/// Temperature at which the foot has slid by x while it slides.
double footed_at(double stiffness, double x) {
  const double thrust = 110.0 + stiffness * x;
  const double half_span = 1.0 + 0.5 * x;
  const double height = 10.0 * half_span / thrust;
  const double free = std::hypot(half_span, height) / (1.0 - std::hypot(thrust, 10.0) / rigidity);
  return (free / std::hypot(1.0, 0.1) - 1.0) / 1e-3;
}

/// @param coarsest increments of a branch where events are not located
void expect_end(const Model& model, double change, double tolerance, int coarsest = 1) {
  for (const bool locate : {true, false}) {
    for (const int increments : {1, 7, 50, 333}) {
      if (!locate && increments < coarsest) continue;
      Options options;
      options.locate_events = locate;
      options.increments_per_branch = increments;
      try {
        solve(model, options);
        ADD_FAILURE() << increments << (locate ? " located" : "");
      } catch (const Failure& failed) {
        EXPECT_EQ(failed.fields().kind, FailureKind::no_continuation) << failed.what();
        ASSERT_EQ(failed.fields().joints.size(), 1u) << failed.what();
        EXPECT_EQ(failed.fields().joints[0].name, "S");
        EXPECT_NEAR(*failed.fields().temperature_change, change, tolerance) << increments;
      }
    }
  }
}

TEST(Instability, SlipThatNothingSlowsEndsThePathWhereItBegins) {
  // 2 E A (l_T − L)/l_T · y/L = f.
  const double drawn = std::hypot(1.0, 0.01);
  const double share = 10.0 / (2.0 * rigidity * 0.01 / drawn);
  const double free = 1.0 / (1.0 - share);
  // Events are located to 1e-9 of a branch of 100 K.
  expect_end(arch(), (free / (1.0 + 2e-4) - 1.0) / 2e-5, 2e-7);
  expect_end(footed(0.0), footed_at(0.0, 0.0), 2e-7);
}

TEST(Instability, SlipThatASpringSlowsGoesOn) {
  Model model = arch();
  model.nodes.push_back(node("sky", 0.0, 1.01, 0));
  model.springs.push_back({"tie", 1, 3, 2000.0, 1.0, false});
  for (const bool locate : {true, false}) {
    Options options;
    options.locate_events = locate;
    EXPECT_EQ(solve(model, options).events.size(), 3u);
  }
}

TEST(Instability, SlipThatTheTrussOvertakesEndsThePathAtTheLimitPoint) {
  constexpr double stiffness = 2e4;
  double inner = 0.0;
  double outer = 0.05;
  for (int i = 0; i < 200; ++i) {
    const double a = inner + (outer - inner) / 3.0;
    const double b = outer - (outer - inner) / 3.0;
    (footed_at(stiffness, a) > footed_at(stiffness, b) ? inner : outer) =
        footed_at(stiffness, a) > footed_at(stiffness, b) ? a : b;
  }
  ASSERT_GT(inner, 1e-3);
  ASSERT_LT(inner, 0.04);
  // Slip begins 0.9 K before it runs away; a longer increment without location steps over both.
  expect_end(footed(stiffness), footed_at(stiffness, inner), 1e-6, 50);
}

}  // namespace
}  // namespace statejump::truss
