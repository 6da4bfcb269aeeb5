// SPDX-License-Identifier: GPL-3.0-or-later
#include <limits>
#include <stdexcept>

#include "statejump/kernel/joint_kinematics.hpp"
#include "support.hpp"

namespace statejump::kernel {
namespace {

using testing::expect_vector_near;
using testing::Random;
using testing::rigid_motion;

constexpr double ball_radius = 5e-3;
constexpr double socket_radius = 5.1e-3;

TEST(Ball, DepthNormalAndOnePoint) {
  // The vector (2, 3, 6) has length 7, so |d| = 0.14 mm and delta = 0.04 mm.
  const BodyMotion ball{Vector3(1.04, 2.06, 3.12) * 1e-3, Vector3::Zero(), Vector3::Zero()};
  const BodyMotion socket{Vector3(1.0, 2.0, 3.0) * 1e-3, Vector3::Zero(), Vector3::Zero()};
  const BallContact contact = ball_contact(ball, ball_radius, socket, socket_radius);
  // positions of a few mm are rounded to 4e-19 m
  EXPECT_NEAR(contact.eccentricity, 0.14e-3, 2e-18);
  EXPECT_NEAR(contact.penetration_depth, 0.04e-3, 4e-18);
  expect_vector_near(contact.normal, Vector3(2, 3, 6) / 7, 2e-14, "normal");
  const Vector3 point = ball.position + contact.arm_1;
  expect_vector_near(socket.position + contact.arm_2, point, 2e-18, "point");
  EXPECT_NEAR(contact.arm_1.norm(), ball_radius - 0.02e-3, 1e-17);
  EXPECT_NEAR(contact.arm_2.norm(), socket_radius + 0.02e-3, 1e-17);
  EXPECT_NEAR(contact.effective_radius, 0.255, 1e-14 * 0.255);
  EXPECT_NEAR(ball_penetration(ball.position, ball_radius, socket.position, socket_radius),
              contact.penetration_depth, 1e-19);
}

// In the plane perpendicular to the axis, a ball contact equals a journal contact.
TEST(Ball, IsTheRevoluteContactInItsPlane) {
  Random random;
  for (int i = 0; i < 200; ++i) {
    const Vector3 axis = random.unit();
    const BodyMotion socket{Vector3::Zero(), random.vector(1.0), random.vector(10.0)};
    const Vector3 offset = perpendicular_part(random.vector(2e-4), axis);
    const BodyMotion ball{offset, random.vector(1.0), random.vector(10.0)};
    const BallContact a = ball_contact(ball, ball_radius, socket, socket_radius);
    const RevoluteContact b = revolute_contact(ball, ball_radius, socket, socket_radius, axis);
    // The axial component of the offset is 0 except for rounding, 1e-16 of the offset.
    EXPECT_NEAR(a.penetration_depth, b.penetration_depth, 1e-18);
    EXPECT_EQ(a.effective_radius, b.effective_radius);
    expect_vector_near(a.normal, b.normal, 1e-15 * 2e-4 / offset.norm(), "normal");
    expect_vector_near(a.arm_2, b.arm_2, 1e-17 * 2e-4 / offset.norm(), "arm");
    expect_vector_near(a.relative_velocity, b.relative_velocity, 1e-14 * 2e-4 / offset.norm(),
                       "velocity");
  }
}

TEST(Ball, AxialOffsetClosesTheClearanceToo) {
  const BodyMotion socket{Vector3::Zero(), Vector3::Zero(), Vector3::Zero()};
  for (int i = 0; i < 3; ++i) {
    for (const double sign : {-1.0, 1.0}) {
      const Vector3 direction = sign * Vector3::Unit(i);
      const BodyMotion ball{1.01e-4 * direction, 2.0 * direction, Vector3::Zero()};
      const BallContact contact = ball_contact(ball, ball_radius, socket, socket_radius);
      EXPECT_NEAR(contact.penetration_depth, 1e-6, 1e-18);
      expect_vector_near(contact.normal, direction, 1e-15, "normal");
      EXPECT_NEAR(contact.relative_velocity.dot(contact.normal), 2.0, 1e-15);
    }
  }
}

TEST(Ball, ConcentricIsAGapWithSomeNormal) {
  const BodyMotion body{Vector3(0.3, -0.2, 0.1), Vector3::Zero(), Vector3::Zero()};
  const BallContact contact = ball_contact(body, ball_radius, body, socket_radius);
  EXPECT_NEAR(contact.penetration_depth, -1e-4, 1e-17);
  EXPECT_EQ(contact.normal.norm(), 1.0);
  EXPECT_TRUE(contact.arm_1.allFinite() && contact.arm_2.allFinite());
}

TEST(Ball, RigidMotionOfBothBodiesLeavesNoRelativeVelocity) {
  Random random;
  for (int i = 0; i < 100; ++i) {
    const auto moving = rigid_motion(random);
    const BodyMotion socket = moving(random.vector(0.1));
    const BodyMotion ball = moving(socket.position + random.vector(2e-4));
    // about ten roundings of velocities up to 5 m/s
    EXPECT_LE(ball_contact(ball, ball_radius, socket, socket_radius).relative_velocity.norm(),
              1e-14);
  }
}

TEST(Ball, TouchesAgreesWithDepth) {
  Random random;
  int touching = 0;
  for (int i = 0; i < 2000; ++i) {
    const Vector3 socket = random.vector(0.1);
    const Vector3 ball = socket + random.vector(1e-4);
    const bool touches = ball_touches(ball, ball_radius, socket, socket_radius);
    const double depth = ball_penetration(ball, ball_radius, socket, socket_radius);
    if (std::abs(depth) > 1e-18) {
      EXPECT_EQ(touches, depth > 0.0);
    }
    touching += touches;
  }
  EXPECT_GT(touching, 100);
  EXPECT_LT(touching, 1900);
}

TEST(Ball, RefusesASocketThatDoesNotHoldTheBall) {
  const BodyMotion body{Vector3::Zero(), Vector3::Zero(), Vector3::Zero()};
  EXPECT_THROW(ball_contact(body, 5e-3, body, 5e-3), std::invalid_argument);
  EXPECT_THROW(ball_contact(body, 5e-3, body, 4e-3), std::invalid_argument);
  EXPECT_TRUE(ball_touches(body.position, 5e-3, body.position, 4.9e-3));
  EXPECT_TRUE(ball_touches(body.position, 5e-3, body.position, 5e-3));
}

constexpr double other_radius = 3e-3;

TEST(OuterBalls, DepthNormalAndOnePoint) {
  // The vector (2, 3, 6) has length 7, so the centres are 7 mm apart and delta = 1 mm.
  const BodyMotion one{Vector3(1.0, 2.0, 3.0) * 1e-3, Vector3::Zero(), Vector3::Zero()};
  const BodyMotion two{Vector3(3.0, 5.0, 9.0) * 1e-3, Vector3::Zero(), Vector3::Zero()};
  const BallContact contact = outer_ball_contact(one, ball_radius, two, other_radius);
  EXPECT_NEAR(contact.penetration_depth, 1e-3, 4e-18);
  EXPECT_NEAR(contact.eccentricity, -7e-3, 2e-18);
  // depth = eccentricity - clearance, where the second ball is a socket of negative radius
  EXPECT_NEAR(contact.eccentricity + ball_radius + other_radius, contact.penetration_depth, 1e-18);
  expect_vector_near(contact.normal, Vector3(2, 3, 6) / 7, 1e-15, "from 1 into 2");
  expect_vector_near(one.position + contact.arm_1, two.position + contact.arm_2, 2e-18, "point");
  EXPECT_NEAR(contact.arm_1.norm(), ball_radius - 0.5e-3, 1e-17);
  EXPECT_NEAR(contact.arm_2.norm(), other_radius - 0.5e-3, 1e-17);
  EXPECT_NEAR(contact.effective_radius, 15e-6 / 8e-3, 1e-17);
}

TEST(OuterBalls, SeenFromTheOtherBallItIsTheSameContact) {
  Random random;
  for (int i = 0; i < 200; ++i) {
    const BodyMotion one{random.vector(0.1), random.vector(1.0), random.vector(10.0)};
    const BodyMotion two{one.position + 7.99e-3 * random.unit(), random.vector(1.0),
                         random.vector(10.0)};
    const BallContact a = outer_ball_contact(one, ball_radius, two, other_radius);
    const BallContact b = outer_ball_contact(two, other_radius, one, ball_radius);
    EXPECT_EQ(a.penetration_depth, b.penetration_depth);
    EXPECT_NEAR(a.effective_radius, b.effective_radius, 1e-18);
    // positions of 0.1 m are rounded to 1e-17 m, relative to 8 mm
    expect_vector_near(a.normal, -b.normal, 1e-15, "normal");
    expect_vector_near(a.arm_1, b.arm_2, 1e-16, "arm");
    expect_vector_near(a.relative_velocity, -b.relative_velocity, 1e-14, "velocity");
  }
}

TEST(OuterBalls, RigidMotionOfBothLeavesNoRelativeVelocity) {
  Random random;
  for (int i = 0; i < 100; ++i) {
    const auto moving = rigid_motion(random);
    const BodyMotion one = moving(random.vector(0.1));
    const BodyMotion two = moving(one.position + 7.99e-3 * random.unit());
    // about ten roundings of velocities up to 5 m/s
    EXPECT_LE(outer_ball_contact(one, ball_radius, two, other_radius).relative_velocity.norm(),
              1e-14);
  }
}

TEST(OuterBalls, TouchesAgreesWithDepth) {
  Random random;
  int touching = 0;
  for (int i = 0; i < 2000; ++i) {
    const BodyMotion one{random.vector(0.1), Vector3::Zero(), Vector3::Zero()};
    const BodyMotion two{one.position + random.vector(1e-2), Vector3::Zero(), Vector3::Zero()};
    const bool touches = outer_balls_touch(one.position, ball_radius, two.position, other_radius);
    const double depth = outer_ball_contact(one, ball_radius, two, other_radius).penetration_depth;
    if (std::abs(depth) > 1e-17) {
      EXPECT_EQ(touches, depth > 0.0);
    }
    touching += touches;
  }
  EXPECT_GT(touching, 100);
  EXPECT_LT(touching, 1900);
  const Vector3 lost = Vector3::Constant(std::numeric_limits<double>::quiet_NaN());
  EXPECT_TRUE(outer_balls_touch(lost, ball_radius, Vector3::Zero(), other_radius));
}

}  // namespace
}  // namespace statejump::kernel
