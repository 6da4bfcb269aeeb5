// SPDX-License-Identifier: GPL-3.0-or-later
// Extrapolated differences: accuracy, and the choice between first steps.
#include "differences.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace statejump::truss::detail {
namespace {

using Eigen::VectorXd;

TEST(Differences, OfALinearFunctionAreExactAfterTwoPairs) {
  int calls = 0;
  const Difference found = difference(
      [&](double x) {
        ++calls;
        return VectorXd::Constant(1, 3.0 * x);
      },
      0.5);
  EXPECT_EQ(found.value[0], 3.0);
  EXPECT_EQ(calls, 4);
}

TEST(Differences, OfASmoothFunctionReachRounding) {
  const VectorXd found = derivative(
      [](double x) {
        VectorXd made(2);
        made << std::exp(x), std::sin(3.0 * x);
        return made;
      },
      {0.1});
  // The difference of two numbers near 1 is rounded to 2e-16, over steps down to 1e-2.
  EXPECT_NEAR(found[0], 1.0, 1e-12);
  EXPECT_NEAR(found[1], 3.0, 1e-12);
}

TEST(Differences, DoNotCrossAKinkWithASmallerStep) {
  // A kink at 1e-4, beyond which the slope is 5.
  const auto bent = [](double x) {
    return VectorXd::Constant(1, x < 1e-4 ? 2.0 * x : 2e-4 + 5.0 * (x - 1e-4));
  };
  EXPECT_NEAR(derivative(bent, {1.0, 1e-5})[0], 2.0, 1e-12);
}

}  // namespace
}  // namespace statejump::truss::detail
