// SPDX-License-Identifier: GPL-3.0-or-later
#include "statejump/spring_slider/model.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <numbers>
#include <utility>

#include "support/argument.hpp"
#include "table1.hpp"

namespace statejump::spring_slider {
namespace {

using statejump::testing::Argument;
using statejump::testing::refused_argument;

TEST(SpringSlider, StiffnessAndJumpOfTable1) {
  EXPECT_NEAR(link_stiffness(table1(), 0.0), 1.26e6, close(1.26e6));
  EXPECT_NEAR(state_jump(table1()), 30.0 / 1.26e6, close(30.0 / 1.26e6));
  SpringSlider preloaded = table1();
  preloaded.preload_stiffness = 0.74e6;
  EXPECT_NEAR(state_jump(preloaded), 1.5e-5, close(1.5e-5));
}

TEST(SpringSlider, SlidingBalancesTheForces) {
  SpringSlider model = table1();
  model.preload_stiffness = 2e5;
  for (const int sense : {-1, 1}) {
    for (const double change : {-80.0, 3.0, 150.0}) {
      const double x = sliding_displacement(model, change, sense);
      // The force is k = 1.3e6 N/m times a difference of displacements of 2e-3 m, each rounded to
      // 4e-19 m.
      EXPECT_NEAR(axial_force(model, change, x) - 2e5 * x, sense * f, 1e-11);
      EXPECT_NEAR(sliding_temperature(model, x, sense), change, 1e-12 * std::abs(change));
    }
  }
}

TEST(SpringSlider, NoTemperatureSlidesALinkThatDoesNotExpand) {
  SpringSlider model = table1();
  model.thermal_expansion = 0.0;
  EXPECT_TRUE(std::isnan(sliding_temperature(model, 0.0, 1)));
}

TEST(SpringSlider, EulerLoadOfASquareBar) {
  // Square bar of 3 x 3 mm: I = 0.003^4/12.
  const double moment = 0.003 * 0.003 * 0.003 * 0.003 / 12.0;
  const double pinned = std::numbers::pi * std::numbers::pi * 70e9 * moment / 0.25;
  EXPECT_NEAR(euler_load(table1(), EndCondition::pinned_pinned), pinned, close(pinned));
  EXPECT_NEAR(euler_load(table1(), EndCondition::clamped_clamped), 4.0 * pinned,
              close(4.0 * pinned));
  EXPECT_NEAR(euler_load(table1(), EndCondition::clamped_clamped), 74.6, 0.05);
  EXPECT_NEAR(euler_load(table1(), EndCondition::pinned_pinned, 2.0 * moment), 2.0 * pinned,
              close(2.0 * pinned));
}

TEST(SpringSlider, RefusesWhatIsOutOfRange) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  const auto check = [](double SpringSlider::*field, double value) {
    SpringSlider model = table1();
    model.*field = value;
    return refusal([&model] { model.validate(); });
  };
  // One error at a time: without stiffness, friction is not allowed either.
  for (const auto& [field, name] :
       {std::pair{&SpringSlider::young_modulus, "young_modulus"},
        std::pair{&SpringSlider::cross_section_area, "cross_section_area"},
        std::pair{&SpringSlider::stress_free_length, "stress_free_length"}}) {
    for (const double value : {0.0, -1.0, nan, infinity}) {
      EXPECT_EQ(check(field, value).rfind(name, 0), 0u) << check(field, value);
    }
  }
  for (const double value : {nan, infinity}) {
    EXPECT_NE(check(&SpringSlider::thermal_expansion, value), "");
    EXPECT_NE(check(&SpringSlider::preload_stiffness, value), "");
  }
  for (const double value : {-1.0, nan, infinity, 2.0 * EA}) {
    EXPECT_NE(check(&SpringSlider::friction_force, value), "");
  }
  for (const double value : {0.0, -1e-3, nan}) {
    EXPECT_NE(check(&SpringSlider::clearance_minus, value), "");
    EXPECT_NE(check(&SpringSlider::clearance_plus, value), "");
  }
  EXPECT_NE(check(&SpringSlider::clearance_minus, 0.6), "");
  EXPECT_NE(check(&SpringSlider::preload_stiffness, -1.0), "");
  for (const double value : {nan, infinity, EA, f - EA}) {
    EXPECT_NE(check(&SpringSlider::preload_force, value), "");
  }
  EXPECT_EQ(check(&SpringSlider::clearance_minus, infinity), "");
  EXPECT_EQ(check(&SpringSlider::clearance_plus, infinity), "");
  EXPECT_EQ(check(&SpringSlider::thermal_expansion, -1e-6), "");
  SpringSlider negative = table1();
  negative.friction_force = -1.0;
  EXPECT_EQ(refused_argument([&] { negative.validate(); }), Argument("friction_force", -1));
}

}  // namespace
}  // namespace statejump::spring_slider
