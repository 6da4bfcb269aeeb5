// SPDX-License-Identifier: GPL-3.0-or-later
// The smallest rotation, which keeps a tip aligned with its link.
#include <gtest/gtest.h>

#include <cmath>

#include "../kernel/support.hpp"
#include "statejump/stepper/link.hpp"

namespace statejump::stepper {
namespace {

TEST(Link, TheSmallestTurnTakesOneDirectionToTheOther) {
  kernel::testing::Random random;
  const double pi = kernel::testing::pi;
  for (int i = 0; i < 2000; ++i) {
    const Vector3 from = random.unit();
    const Vector3 across = from.cross(random.unit()).normalized();
    // Rotation angles from 1e-12 to pi - 1e-12, which cover all decades from either end.
    const double small = std::pow(10.0, random.uniform(-12, 0));
    const double angle = i % 2 == 0 ? small : pi - small;
    const Vector3 to = std::cos(angle) * from + std::sin(angle) * across;
    const Quaternion turn = smallest_rotation(from, to).normalized();
    // Close to a half turn, 1 + cos has an absolute error of 1e-16, which sin = pi - angle divides.
    EXPECT_LE((turn * from - to).norm(), 1e-15 * (4 + 1 / std::sin(angle)) + 1e-14) << angle;
    EXPECT_NEAR(turn.vec().dot(from), 0.0, 1e-15 * (4 + 1 / std::sin(angle))) << angle;
  }
  const Vector3 x = Vector3::UnitX();
  EXPECT_LE((smallest_rotation(x, -x).normalized() * x + x).norm(), 1e-15);
  EXPECT_EQ(smallest_rotation(x, x).normalized().coeffs(), Quaternion::Identity().coeffs());
}

}  // namespace
}  // namespace statejump::stepper
