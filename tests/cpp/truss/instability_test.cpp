// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "parts.hpp"
#include "statejump/failure.hpp"

namespace statejump::truss {
namespace {

using Eigen::Vector3d;
using testing::node;
using testing::triangle;

constexpr double rigidity = 1e6;

/// Prestressed flat arch beyond its limit point; friction holds its apex.
Model arch() {
  Model model;
  model.programs = {triangle(100.0)};
  Node apex = node("apex", 0.0, 0.01, 1);
  apex.free_directions =
      (Eigen::Matrix3d() << Vector3d::UnitY(), Vector3d::UnitX(), Vector3d::UnitZ()).finished();
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

/// Arch whose loaded apex pushes one foot outwards against friction and a spring.
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

/// Temperature change at which the sliding foot has moved by x.
double footed_at(double stiffness, double x) {
  const double thrust = 110.0 + stiffness * x;
  const double half_span = 1.0 + 0.5 * x;
  const double height = 10.0 * half_span / thrust;
  const double free = std::hypot(half_span, height) / (1.0 - std::hypot(thrust, 10.0) / rigidity);
  return (free / std::hypot(1.0, 0.1) - 1.0) / 1e-3;
}

/// Expects that solve() fails at temperature `change`, for several increments, with and without
/// event location.
/// @param coarsest fewest increments per branch for the runs without event location
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
  // Slip starts where 2 E A (l_T − L)/l_T · y/L = f.
  const double drawn = std::hypot(1.0, 0.01);
  const double share = 10.0 / (2.0 * rigidity * 0.01 / drawn);
  const double free = 1.0 / (1.0 - share);
  // Events are located to 1e-9 of a branch of 100 K.
  expect_end(arch(), (free / (1.0 + 2e-4) - 1.0) / 2e-5, 2e-7);
  expect_end(footed(0.0), footed_at(0.0, 0.0), 2e-7);
}

/// Several independent arches.
Model arches(int count) {
  Model model = arch();
  for (int i = 1; i < count; ++i) {
    const Model one = arch();
    const int first = static_cast<int>(model.nodes.size());
    for (Node node : one.nodes) {
      node.position.z() = i;
      model.nodes.push_back(node);
    }
    for (Bar link : one.links) {
      link.first += first;
      link.second += first;
      model.links.push_back(link);
    }
    Slider slider = std::get<Slider>(one.joints[0]);
    slider.first += first;
    slider.name = "S" + std::to_string(i);
    model.joints.push_back(slider);
  }
  return model;
}

TEST(Instability, ManyThatSlipUnstablyAtTheSameInstantAreAllNamed) {
  for (const int count : {2, 12}) {
    for (const bool locate : {true, false}) {
      Options options;
      options.locate_events = locate;
      try {
        solve(arches(count), options);
        ADD_FAILURE() << count;
      } catch (const Failure& failed) {
        EXPECT_EQ(failed.fields().kind, FailureKind::no_continuation) << failed.what();
        EXPECT_EQ(failed.fields().joints.size(), static_cast<std::size_t>(count)) << failed.what();
      }
    }
  }
}

TEST(Instability, OneOfManyThatSlipAtTheSameInstantIsNamedIfItAloneDoesSoUnstably) {
  constexpr int count = 12;
  Model model = arches(count);
  // Springs stabilize all slips except that of the first arch.
  for (int i = 1; i < count; ++i) {
    Node sky = node("sky", 0.0, 1.01, 0);
    sky.position.z() = i;
    model.nodes.push_back(sky);
    model.springs.push_back(
        {"tie", 3 * i + 1, static_cast<int>(model.nodes.size()) - 1, 2000.0, 1.0, false});
  }
  try {
    solve(model);
    ADD_FAILURE();
  } catch (const Failure& failed) {
    EXPECT_EQ(failed.fields().kind, FailureKind::no_continuation) << failed.what();
    ASSERT_EQ(failed.fields().joints.size(), 1u) << failed.what();
    EXPECT_EQ(failed.fields().joints[0].name, "S");
  }
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
  // Slip starts 0.9 K before it becomes unstable. Without event location, an increment longer than
  // that skips both.
  expect_end(footed(stiffness), footed_at(stiffness, inner), 1e-6, 50);
}

TEST(Instability, AStrutThatStaysStraightBeyondItsBucklingLoadIsRefused) {
  // Two collinear bars are compressed by heating. Their common pin buckles sideways when 2 P / L
  // reaches the lateral spring's stiffness, 2400 N/m at 100 K. No lateral force acts on the pin.
  const auto strut = [](double stiffness) {
    Model model;
    model.programs = {triangle(100.0)};
    model.nodes = {node("left", -1.0, 0.0, 0), node("pin", 0.0, 0.0, 2), node("right", 1.0, 0.0, 0),
                   node("sky", 0.0, 1.0, 0)};
    for (int i = 0; i < 2; ++i) {
      model.links.push_back({"bar", i, i + 1, 6e5, 1.0, 2e-5, 0, 1.0});
    }
    model.springs = {{"guide", 1, 3, stiffness, 1.0, false}};
    return model;
  };
  EXPECT_TRUE(solve(strut(2600.0)).complete);
  try {
    solve(strut(2200.0));
    ADD_FAILURE();
  } catch (const Failure& failed) {
    EXPECT_EQ(failed.fields().kind, FailureKind::buckled) << failed.what();
    EXPECT_EQ(failed.fields().time, 0.5);  // the check runs when the temperature reverses
    ASSERT_FALSE(failed.fields().modes.empty());
    EXPECT_EQ(failed.fields().modes[0][0].node, "pin");
  }
}

/// Arch with one dof and without joints. Under its load it snaps through when its bars have become
/// too short.
Model loaded_arch() {
  Model model;
  model.programs = {triangle(-20.0)};
  Node apex = node("apex", 0.0, 0.1, 1);
  apex.free_directions =
      (Eigen::Matrix3d() << Vector3d::UnitY(), Vector3d::UnitX(), Vector3d::UnitZ()).finished();
  apex.load = {0.0, -100.0, 0.0};
  model.nodes = {node("left", -1.0, 0.0, 0), apex, node("right", 1.0, 0.0, 0)};
  for (int i = 0; i < 2; ++i) {
    model.links.push_back({"bar", i, i + 1, rigidity, std::hypot(1.0, 0.1), 2e-4, 0, 1.0});
  }
  return model;
}

TEST(Instability, ALimitPointWithoutSlipEndsThePathThere) {
  // Equilibrium: 2 E A (1 − l/l_T) y/l = P with l² = 1 + y². As the apex descends, l_T(y) passes a
  // minimum. For shorter bars there is no equilibrium.
  double shortest = std::numeric_limits<double>::infinity();
  for (double height = 0.1; height > 0.02; height -= 1e-6) {
    const double length = std::hypot(1.0, height);
    shortest = std::min(shortest, length / (1.0 - 100.0 * length / (2.0 * rigidity * height)));
  }
  const double change = (shortest / std::hypot(1.0, 0.1) - 1.0) / 2e-4;
  ASSERT_LT(change, -5.0);
  ASSERT_GT(change, -20.0);
  for (const int increments : {1, 7, 50, 333}) {
    Options options;
    options.increments_per_branch = increments;
    try {
      const Path path = solve(loaded_arch(), options);
      ADD_FAILURE() << increments << " " << path.states.back().displacement.col(1).transpose();
    } catch (const Failure& failed) {
      EXPECT_EQ(failed.fields().kind, FailureKind::no_continuation) << failed.what();
      EXPECT_NEAR(*failed.fields().temperature_change, change, 1e-6) << increments;
    }
  }
}

}  // namespace
}  // namespace statejump::truss
