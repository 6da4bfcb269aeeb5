// SPDX-License-Identifier: GPL-3.0-or-later
// Compares the fast stability check of a link, without roots, with stable_step().
#include "statejump/stepper/stable_link.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace statejump::stepper {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

TEST(Link, TheQuestionWithoutRootsDecidesAsTheStableStep) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> decade(-9, 9);
  const auto any = [&] { return std::pow(10, decade(random)); };
  for (int i = 0; i < 100'000; ++i) {
    LinkStep step{};
    step.stiffness = i % 7 == 0 ? 0 : any();
    step.damping = i % 3 == 0 ? 0 : any();
    step.damping_across = i % 5 == 0 ? 0 : any();
    const double inverse_mass = any(), stable = stable_step(step, inverse_mass);
    for (const double fraction :
         {1e-3, 1 - 1e-5, 1 - 1e-7, 1 - 3e-16, 1.0, 1 + 3e-16, 1 + 1e-7, 2.0}) {
      const double time_step = std::isfinite(stable) ? fraction * stable : fraction;
      ASSERT_EQ(is_stable(step, inverse_mass, time_step), time_step <= stable)
          << step.stiffness << ' ' << step.damping << ' ' << step.damping_across << ' ' << fraction;
    }
  }
  LinkStep step{};
  step.stiffness = nan;
  EXPECT_FALSE(is_stable(step, 1, 1e-6));
}

}  // namespace
}  // namespace statejump::stepper
