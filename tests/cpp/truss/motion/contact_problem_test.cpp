// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include "truss/motion/contact_problem.hpp"

namespace statejump::truss::detail {
namespace {

/// Two uncoupled contacts with W_nn = 4 and 0.25, in units of velocity over impulse.
complementarity::Problem two_contacts(const Eigen::Vector4d& velocity) {
  return {2, Eigen::MatrixXd(Eigen::Vector4d(4.0, 4.0, 0.25, 0.25).asDiagonal()), velocity,
          Eigen::Vector2d(0.5, 0.5)};
}

TEST(ContactProblem, WorstContactIsTheOneThatLacksMostOfAVelocity) {
  // Arguments: impulses, velocities without impulses. Comments: violations as velocities.
  const auto worst = [](const Eigen::Vector4d& impulses, const Eigen::Vector4d& velocity) {
    return worst_contact(two_contacts(velocity), impulses);
  };
  const Eigen::Vector4d none = Eigen::Vector4d::Zero();
  // Both approach without an impulse: by 1 and 2.
  EXPECT_EQ(worst(none, {-1.0, 0.0, -2.0, 0.0}), 1);
  // Both contacts separate but have pressing impulses. Their violations W r are 4 times 0.3 and
  // 0.25 times 2.
  EXPECT_EQ(worst({0.3, 0.0, 2.0, 0.0}, {9.0, 0.0, 9.0, 0.0}), 0);
  // Tensile impulses: 4 times 0.3 and 0.25 times 8.
  EXPECT_EQ(worst({-0.3, 0.0, -8.0, 0.0}, {3.0, 0.0, 9.0, 0.0}), 1);
  // Normal impulses 1 and 4 are in equilibrium. Friction exceeds its bound by 0.2 and 4, i.e. by
  // velocities of 0.8 and 1.
  EXPECT_EQ(worst({1.0, 0.7, 4.0, 6.0}, {-4.0, -9.0, -1.0, -9.0}), 1);
  // Friction is zero although the contacts slide at 1 and 0.9 and friction could stop both.
  EXPECT_EQ(worst({10.0, 0.0, 100.0, 0.0}, {-40.0, 1.0, -25.0, 0.9}), 0);
  EXPECT_EQ(worst({10.0, 0.0, 100.0, 0.0}, {-40.0, 0.8, -25.0, -0.9}), 1);
  // Violations of the normal law and of friction add up: 1 + 1 at the first contact, 1.5 at the
  // second.
  EXPECT_EQ(worst({10.0, 0.0, 0.0, 0.0}, {-39.0, 1.0, -1.5, 0.0}), 0);
}

TEST(ContactProblem, WithoutContactsNoneIsTheWorst) {
  EXPECT_EQ(worst_contact({2, Eigen::MatrixXd(0, 0), {}, {}}, {}), -1);
}

}  // namespace
}  // namespace statejump::truss::detail
