// SPDX-License-Identifier: GPL-3.0-or-later
#include "statejump/joint_loop/rigid_loop.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <stdexcept>

#include "linkage/umbrella.hpp"
#include "statejump/failure.hpp"

namespace statejump::joint_loop {
namespace {

using linkage::alpha;
using linkage::frame;
using linkage::heating;
using linkage::umbrella;

/// Umbrella whose torsion spring is stress-free 0.05 rad above the ideal flare angle, so it always
/// loads the joint.
linkage::Linkage biased(double mu, double bias = 0.05) {
  linkage::Linkage model = umbrella();
  model.law.friction = kernel::laws::friction_law(mu > 0.0 ? "mindlin" : "none");
  model.law.friction_parameters.friction_coefficient = mu;
  model.torsion_stiffness = 1.0;
  model.torsion_free_angle = umbrella().free_angle() + bias;
  return model;
}

// Angles of order 1 have rounding errors of about 1e-16. φ amplifies them by R/c = 50.
constexpr double angle_rounding = 1e-14;

TEST(RigidLoop, PointsAreEquilibria) {
  const linkage::Linkage model = biased(0.3);
  for (const JointPoint& point : rigid_loop(model, heating()).points) {
    const double growth = 1.0 + alpha * point.temperature_change;
    EXPECT_NEAR(point.bearing_centre.norm(), 0.05 * growth, 1e-16);
    EXPECT_NEAR((point.journal_centre - Eigen::Vector2d(frame, 0.0)).norm(), 0.1 * growth, 1e-16);
    EXPECT_NEAR(point.eccentricity.norm(), 1e-4, 1e-16);
    EXPECT_LE(std::abs(point.contact_angle), std::atan(0.3));
    // Moments of both links about their pins balance, with a force (f, 0) at the bearing's contact
    // point.
    const double height =
        point.bearing_centre.y() + model.bearing_radius * point.eccentricity.y() / 1e-4;
    const double f = point.spring_moment / height;
    EXPECT_GT(f * point.eccentricity.x(), 0.0);  // the force pushes, along n
  }
}

TEST(RigidLoop, EnoughFrictionRollsAndLeavesNoJump) {
  const linkage::Linkage model = biased(0.6);
  const RigidLoop loop = rigid_loop(model, heating());
  const double arc = rolling_arc(model, loop.points.front());
  double largest = 0.0;
  for (const JointPoint& point : loop.points) {
    EXPECT_EQ(point.motion, JointMotion::roll);
    // The arc s is a difference of terms of 1e-2 m, and φ is accurate to rounding.
    EXPECT_NEAR(rolling_arc(model, point), arc, 2e-17);
    // Arcs on journal (5 mm) and bearing (5.1 mm) since the start, from the rotation of the normal
    // n.
    const JointPoint& start = loop.points.front();
    const double turn = point.contact_angle - start.contact_angle;
    EXPECT_NEAR(0.005 * (turn - (point.theta4 - start.theta4)),
                0.0051 * (turn - (point.theta2 - start.theta2)), 2e-17);
    largest = std::max(largest, std::abs(point.contact_angle));
  }
  EXPECT_GT(largest, 0.1);
  EXPECT_LT(largest, std::atan(0.6));
  EXPECT_NEAR(loop.theta2_jump(), 0.0, angle_rounding);
  EXPECT_NEAR(loop.theta4_jump(), 0.0, angle_rounding);
  EXPECT_FALSE(loop.separated);
}

TEST(RigidLoop, WithoutFrictionThereIsNoJump) {
  const RigidLoop loop = rigid_loop(biased(0.0), heating());
  for (const JointPoint& point : loop.points) EXPECT_EQ(point.contact_angle, 0.0);
  EXPECT_EQ(loop.theta2_jump(), 0.0);
  EXPECT_EQ(loop.theta4_jump(), 0.0);
}

TEST(RigidLoop, SlipLeavesAJumpThatIsIndependentOfSampling) {
  const linkage::Linkage model = biased(0.15);
  const RigidLoop loop = rigid_loop(model, heating());
  for (const JointPoint& event : loop.events) {
    std::printf("%-10s %10.6f K  phi %9.6f\n", to_string(event.motion), event.temperature_change,
                event.contact_angle);
  }
  std::printf("jump theta2 %.9g theta4 %.9g rad\n", loop.theta2_jump(), loop.theta4_jump());
  ASSERT_EQ(loop.events.size(), 5u);  // roll, slip; at the corner roll, slip; end
  // At the onset of slip, |φ| = atan μ, the arc is still that of the start.
  const JointPoint& onset = loop.events[1];
  EXPECT_EQ(onset.motion, JointMotion::slip);
  EXPECT_EQ(std::abs(onset.contact_angle), std::atan(0.15));
  EXPECT_NEAR(rolling_arc(model, onset), rolling_arc(model, loop.points.front()), 2e-17);
  EXPECT_EQ(loop.events[2].temperature_change, 100.0);
  // The cycle ends in slip in the opposite direction, so its end point does not depend on the
  // history.
  const JointPoint end = joint_point(model, 0.0, -1, -onset.contact_angle);
  EXPECT_EQ(loop.theta2_jump(), end.theta2 - loop.points.front().theta2);
  EXPECT_GT(std::abs(loop.theta2_jump()), 1e-6);
  const RigidLoop coarse = rigid_loop(model, heating(), 0.0, 1);
  EXPECT_EQ(coarse.theta2_jump(), loop.theta2_jump());
  EXPECT_NEAR(coarse.events[1].temperature_change, onset.temperature_change, 1e-11);
}

TEST(RigidLoop, SeparatesAtItsClosedForm) {
  // Contact keeps |w| = a + c. Without contact the spring determines |w|, which shrinks on cooling.
  // The contact force vanishes where both are equal.
  const double bias = 4e-3;
  const linkage::Linkage model = biased(0.0, bias);
  const RigidLoop loop = rigid_loop(model, heating(1.0, -100.0));
  ASSERT_TRUE(loop.separated);
  const double cosine = std::cos(model.free_angle());
  const double free_frame = std::sqrt(0.05 * 0.05 + 0.1 * 0.1 - 2 * 0.05 * 0.1 * cosine);
  const double expected = ((frame + 1e-4) / free_frame - 1.0) / alpha;
  ASSERT_LT(expected, 0.0);
  // A rounding error of 1e-16 in 1 + α ΔT corresponds to 1e-11 K.
  EXPECT_NEAR(loop.points.back().temperature_change, expected, 1e-10);
  EXPECT_EQ(loop.events.back().motion, JointMotion::separated);
}

TEST(RigidLoop, RefusesWhatIsUndetermined) {
  EXPECT_THROW(rigid_loop(umbrella(), heating()), std::invalid_argument);
  EXPECT_THROW(rigid_loop(biased(0.1, 0.0), heating()), UnloadedJoint);
  EXPECT_THROW(rigid_loop(biased(0.1), heating(), 0.2), std::invalid_argument);
}

}  // namespace
}  // namespace statejump::joint_loop
