// SPDX-License-Identifier: GPL-3.0-or-later
#include "numerics/change_between.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <numbers>

namespace statejump::numerics {
namespace {

TEST(ChangeBetween, EndsAtNeighboursOnBothSidesOfTheChange) {
  const auto beyond = [](double x) { return x * x >= 2.0; };
  const Change up = change_between(0.0, 2.0, beyond);
  EXPECT_FALSE(beyond(up.before));
  EXPECT_TRUE(beyond(up.after));
  EXPECT_EQ(std::nextafter(up.before, 2.0), up.after);
  EXPECT_NEAR(up.after, std::numbers::sqrt2, 2.3e-16);
  // In descending direction the other end is the far one.
  const Change down = change_between(2.0, 0.0, [&](double x) { return !beyond(x); });
  EXPECT_EQ(down.before, up.after);
  EXPECT_EQ(down.after, up.before);
}

TEST(ChangeBetween, StopsAtTheTolerance) {
  int asked = 0;
  const auto beyond = [&asked](double x) {
    ++asked;
    return x >= 0.3;
  };
  const Change found = change_between(0.0, 1.0, beyond, 0x1p-10);
  EXPECT_EQ(asked, 10);  // no evaluation at the ends
  EXPECT_EQ(found.after - found.before, 0x1p-10);
  EXPECT_LT(found.before, 0.3);
  EXPECT_GE(found.after, 0.3);
}

TEST(ChangeBetween, IsAtTheEndOfAnEmptyIntervalAndRefusesNone) {
  const auto never = [](double) { return false; };
  EXPECT_EQ(change_between(3.0, 3.0, never).after, 3.0);
  EXPECT_EQ(change_between(0.0, 1.0, never).after, 1.0);
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(change_between(0.0, nan, never), std::logic_error);
  EXPECT_THROW(change_between(-std::numeric_limits<double>::infinity(), 0.0, never),
               std::logic_error);
}

}  // namespace
}  // namespace statejump::numerics
