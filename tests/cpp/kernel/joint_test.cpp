// SPDX-License-Identifier: GPL-3.0-or-later
#include "statejump/kernel/joint_kinematics.hpp"

#include <cmath>
#include <limits>
#include <stdexcept>

#include "statejump/kernel/frame.hpp"
#include "statejump/kernel/stable_step.hpp"
#include "support.hpp"

namespace statejump::kernel {
namespace {

using testing::expect_vector_near;
using testing::Random;
using testing::rigid_motion;

constexpr double journal_radius = 5e-3;
constexpr double bearing_radius = 5.1e-3;

BodyMotion at(const Vector3& position, const Vector3& velocity = Vector3::Zero(),
              const Vector3& angular_velocity = Vector3::Zero()) {
  return {position, velocity, angular_velocity};
}

TEST(Revolute, DepthNormalAndOnePoint) {
  // The vector (3, 4) has length 5, so |d| = 0.11 mm and delta = 0.01 mm. The axial offset is 2 mm.
  const BodyMotion journal = at(Vector3(1.066, 2.088, 5.0) * 1e-3);
  const BodyMotion bearing = at(Vector3(1.0, 2.0, 3.0) * 1e-3);
  const RevoluteContact contact =
      revolute_contact(journal, journal_radius, bearing, bearing_radius, Vector3::UnitZ());
  // positions of a few mm are rounded to 4e-19 m
  EXPECT_NEAR(contact.eccentricity, 0.11e-3, 2e-18);
  EXPECT_NEAR(contact.penetration_depth, 0.01e-3, 4e-18);
  expect_vector_near(contact.normal, Vector3(0.6, 0.8, 0.0), 2e-14, "normal");  // 2e-18/0.11e-3
  // Both arms end at the same point, in the journal's mid-plane, half-way between the two surfaces.
  const Vector3 point = journal.position + contact.arm_1;
  expect_vector_near(bearing.position + contact.arm_2, point, 2e-18, "point");
  EXPECT_NEAR(point.z(), 5e-3, 1e-18);
  EXPECT_NEAR(contact.arm_1.norm(), journal_radius - 0.005e-3, 1e-17);
  EXPECT_NEAR((contact.arm_2 - Vector3(0, 0, 2e-3)).norm(), bearing_radius + 0.005e-3, 1e-17);
  EXPECT_NEAR(contact.effective_radius, 0.255, 1e-14 * 0.255);
  EXPECT_NEAR(revolute_penetration(journal.position, journal_radius, bearing.position,
                                   bearing_radius, Vector3::UnitZ()),
              contact.penetration_depth, 1e-19);
}

TEST(Revolute, ConcentricIsAGapWithSomeNormal) {
  Random random;
  for (int i = 0; i < 20; ++i) {
    const Vector3 axis = i < 3 ? Vector3(Vector3::Unit(i)) : random.unit();
    for (const double axial : {0.0, 1e-3}) {
      const RevoluteContact contact = revolute_contact(at(axial * axis), journal_radius,
                                                       at(Vector3::Zero()), bearing_radius, axis);
      EXPECT_NEAR(contact.penetration_depth, -1e-4, 1e-17);
      EXPECT_NEAR(contact.normal.norm(), 1.0, 4e-16);
      EXPECT_TRUE(contact.arm_1.allFinite() && contact.arm_2.allFinite());
      if (axial == 0.0) {
        EXPECT_NEAR(contact.normal.dot(axis), 0.0, 4e-16);
      }
    }
  }
}

TEST(Revolute, MaterialVelocity) {
  const RevoluteContact spinning =
      revolute_contact(at(Vector3(0.11e-3, 0, 0), Vector3::Zero(), Vector3(0, 0, 7.0)),
                       journal_radius, at(Vector3::Zero()), bearing_radius, Vector3::UnitZ());
  // omega x arm, arm = R1 - delta/2
  expect_vector_near(spinning.relative_velocity, Vector3(0, 7.0 * 4.995e-3, 0), 1e-16, "spin");
  // Rolling with fixed centres, omega_1 arm_1 = omega_2 arm_2, gives no sliding velocity.
  const RevoluteContact rolling = revolute_contact(
      at(Vector3(0.11e-3, 0, 0), Vector3::Zero(), Vector3(0, 0, 5.105)), journal_radius,
      at(Vector3::Zero(), Vector3::Zero(), Vector3(0, 0, 4.995)), bearing_radius, Vector3::UnitZ());
  expect_vector_near(rolling.relative_velocity, Vector3::Zero(), 1e-16, "rolling");
  // Approach along the normal is positive: v1 - v2.
  const RevoluteContact approach =
      revolute_contact(at(Vector3(0, 0.11e-3, 0), Vector3(0, 2.0, 0)), journal_radius,
                       at(Vector3::Zero(), Vector3(0, 0.5, 0)), bearing_radius, Vector3::UnitZ());
  EXPECT_NEAR(approach.relative_velocity.dot(approach.normal), 1.5, 1e-15);
}

// If both bodies move as one rigid body about any point, nothing slides. The test detects a missing
// arm or an arm from the wrong centre.
TEST(Joint, RigidMotionOfBothBodiesLeavesNoRelativeVelocity) {
  Random random;
  for (int i = 0; i < 100; ++i) {
    const auto moving = rigid_motion(random);
    const BodyMotion bearing = moving(random.vector(0.1));
    const BodyMotion journal = moving(bearing.position + random.vector(2e-4));
    const Vector3 axis = random.unit();
    // about ten roundings of velocities up to 5 m/s
    EXPECT_LE(revolute_contact(journal, journal_radius, bearing, bearing_radius, axis)
                  .relative_velocity.norm(),
              1e-14);
    EXPECT_LE(plane_contact(journal, 1e-3, bearing, axis, 1.1e-3).relative_velocity.norm(), 1e-14);
  }
}

// v . n is the rate of delta. A finite difference confirms it for bodies that rotate and translate.
TEST(Revolute, NormalVelocityIsTheRateOfDepth) {
  Random random;
  for (int i = 0; i < 20; ++i) {
    const Vector3 offset = Vector3(1e-4, 2e-5, 0) + random.vector(1e-5);
    const BodyMotion journal = at(offset, random.vector(0.1), Vector3(0, 0, 3));
    const BodyMotion bearing = at(Vector3::Zero(), random.vector(0.1), Vector3(0, 0, -2));
    const double h =
        1e-8;  // central difference, path 1e-9 m: error (1e-5)^2 of |v|, rounding 1e-11
    const auto depth = [&](double t) {
      return revolute_penetration(journal.position + t * journal.velocity, journal_radius,
                                  bearing.position + t * bearing.velocity, bearing_radius,
                                  Vector3::UnitZ());
    };
    const RevoluteContact contact =
        revolute_contact(journal, journal_radius, bearing, bearing_radius, Vector3::UnitZ());
    EXPECT_NEAR(contact.relative_velocity.dot(contact.normal), (depth(h) - depth(-h)) / (2 * h),
                1e-9);
  }
}

TEST(Revolute, TouchesAgreesWithDepth) {
  Random random;
  int touching = 0;
  for (int i = 0; i < 2000; ++i) {
    const Vector3 axis = random.unit();
    const Vector3 bearing = random.vector(0.1);
    const Vector3 journal = bearing + random.vector(1.5e-4);
    const bool touches = revolute_touches(journal, journal_radius, bearing, bearing_radius, axis);
    const double depth =
        revolute_penetration(journal, journal_radius, bearing, bearing_radius, axis);
    if (std::abs(depth) > 1e-18) {
      EXPECT_EQ(touches, depth > 0.0);
    }
    touching += touches;
  }
  EXPECT_GT(touching, 200);
  EXPECT_LT(touching, 1800);
}

// NaN in the input must appear in the force, where it is detected. No branch may treat NaN as an
// open, concentric, frictionless or stable case.
TEST(Kinematics, KeepsWhatIsNoNumber) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const BodyMotion body = at(Vector3::Zero());
  for (int i = 0; i < 2; ++i) {
    Vector3 position = Vector3::Zero();
    position[i] = nan;
    const BodyMotion lost = at(position);
    EXPECT_TRUE(revolute_touches(position, 5e-3, body.position, 5.1e-3, Vector3::UnitZ()));
    EXPECT_TRUE(ball_touches(position, 5e-3, body.position, 5.1e-3));
    EXPECT_TRUE(
        std::isnan(revolute_contact(lost, 5e-3, body, 5.1e-3, Vector3::UnitZ()).penetration_depth));
    EXPECT_TRUE(std::isnan(ball_contact(lost, 5e-3, body, 5.1e-3).penetration_depth));
    EXPECT_TRUE(std::isnan(transport(position, Vector3::UnitZ(), Vector3::UnitZ()).squaredNorm()));
  }
  EXPECT_TRUE(std::isnan(critical_time_step(1.0, nan)));
  EXPECT_TRUE(std::isnan(critical_time_step(1.0, 1.0, nan)));
}

TEST(Revolute, RefusesABearingThatDoesNotHoldTheJournal) {
  const BodyMotion body = at(Vector3::Zero());
  EXPECT_THROW(revolute_contact(body, 5e-3, body, 5e-3, Vector3::UnitZ()), std::invalid_argument);
  EXPECT_THROW(revolute_contact(body, 5e-3, body, 4e-3, Vector3::UnitZ()), std::invalid_argument);
  // The fast check must accept a bearing smaller than its journal, which revolute_contact()
  // reports.
  EXPECT_TRUE(revolute_touches(body.position, 5e-3, body.position, 4.9e-3, Vector3::UnitZ()));
  EXPECT_TRUE(revolute_touches(body.position, 5e-3, body.position, 5e-3, Vector3::UnitZ()));
  const double infinity = std::numeric_limits<double>::infinity();
  EXPECT_EQ(revolute_contact(body, 5e-3, body, infinity, Vector3::UnitZ()).effective_radius, 5e-3);
}

TEST(Plane, DepthPointAndVelocity) {
  // The slot centre is at x = 1, the wall 10 mm beyond it, the slider centre 8.003 mm beyond it.
  // The pad radius is 2 mm.
  const BodyMotion slot = at(Vector3(1.0, 0, 0));
  const BodyMotion slider =
      at(Vector3(1.008003, 0.001, 0), Vector3(0.2, 0.3, 0), Vector3(0, 0, 5.0));
  const PlaneContact contact = plane_contact(slider, 2e-3, slot, Vector3::UnitX(), 10e-3);
  EXPECT_NEAR(contact.penetration_depth, 3e-6, 3e-16);  // rounding of positions of 1 m: 1.1e-16 m
  EXPECT_NEAR(contact.eccentricity, 8.003e-3, 3e-16);
  EXPECT_EQ(contact.normal, Vector3(Vector3::UnitX()));
  EXPECT_EQ(contact.effective_radius, 2e-3);
  EXPECT_NEAR(contact.arm_1.x(), 2e-3 - 1.5e-6, 3e-16);
  expect_vector_near(slot.position + contact.arm_2, slider.position + contact.arm_1, 3e-16,
                     "point");
  expect_vector_near(contact.relative_velocity, Vector3(0.2, 0.3 + 5.0 * 1.9985e-3, 0), 1e-14,
                     "velocity");
  // Stop on the opposite side: normal reversed, now a gap.
  EXPECT_NEAR(plane_contact(slider, 2e-3, slot, -Vector3::UnitX(), 10e-3).penetration_depth,
              2e-3 - 18.003e-3, 3e-16);
}

TEST(Joint, ContactKinematicsCarriesEveryField) {
  const PlaneContact contact = plane_contact(at(Vector3(1e-6, 0, 0), Vector3(1, 2, 3)), 2e-3,
                                             at(Vector3::Zero()), Vector3::UnitX(), 2e-3);
  const ContactKinematics kinematics = contact_kinematics(contact, 1e-5);
  EXPECT_EQ(kinematics.normal, contact.normal);
  EXPECT_EQ(kinematics.penetration_depth, contact.penetration_depth);
  EXPECT_EQ(kinematics.effective_radius, 2e-3);
  EXPECT_EQ(kinematics.relative_velocity, Vector3(1, 2, 3));
  EXPECT_EQ(kinematics.time_step, 1e-5);
}

// Kinematics and law of a joint together: no net force, no net moment about the world's origin.
TEST(Joint, WrenchOfAJointBalances) {
  Random random;
  ContactParameters parameters;
  parameters.elastic = elastic_pair(70e9, 0.3, 70e9, 0.3);
  parameters.friction_coefficient = 0.3;
  for (int i = 0; i < 100; ++i) {
    const Vector3 axis = random.unit();
    const BodyMotion bearing = at(random.vector(0.1), random.vector(0.1), random.vector(5.0));
    const Vector3 side = perpendicular_part(random.unit(), axis).normalized();
    const BodyMotion journal =
        at(bearing.position + 1.01e-4 * side + 1e-3 * axis, random.vector(0.1), random.vector(5.0));
    const RevoluteContact contact =
        revolute_contact(journal, journal_radius, bearing, bearing_radius, axis);
    ContactHistory history;
    const Vector3 force =
        hertz_mindlin(parameters, contact_kinematics(contact, 1e-6), history).force_on_1;
    ASSERT_GT(force.norm(), 1.0);
    const Wrench wrench = contact_wrench(force, contact.arm_1, contact.arm_2);
    const Vector3 moment = journal.position.cross(wrench.force_1) + wrench.torque_1 +
                           bearing.position.cross(wrench.force_2) + wrench.torque_2;
    EXPECT_LE(moment.norm(), 1e-15 * force.norm());  // roundings of |r||F| with |r| < 0.2 m
  }
}

TEST(Joint, RotationInvariance) {
  Random random;
  for (int i = 0; i < 50; ++i) {
    const Eigen::Matrix3d q = random.rotation();
    const auto turned = [&](const BodyMotion& body) {
      return BodyMotion{q * body.position, q * body.velocity, q * body.angular_velocity};
    };
    const BodyMotion bearing = at(random.vector(1e-2), random.vector(0.1), random.vector(5.0));
    const BodyMotion journal =
        at(bearing.position + random.vector(2e-4), random.vector(0.1), random.vector(5.0));
    const Vector3 axis = random.unit();
    const RevoluteContact a =
        revolute_contact(journal, journal_radius, bearing, bearing_radius, axis);
    const RevoluteContact b = revolute_contact(turned(journal), journal_radius, turned(bearing),
                                               bearing_radius, q * axis);
    const PlaneContact c = plane_contact(journal, 2e-3, bearing, axis, 2.1e-3);
    const PlaneContact d = plane_contact(turned(journal), 2e-3, turned(bearing), q * axis, 2.1e-3);
    // positions of 1e-2 m are rounded to about 1e-17 m after a rotation
    EXPECT_NEAR(b.penetration_depth, a.penetration_depth, 1e-16);
    EXPECT_NEAR(d.penetration_depth, c.penetration_depth, 1e-16);
    expect_vector_near(b.normal, q * a.normal, 1e-16 / a.eccentricity, "normal");
    expect_vector_near(b.relative_velocity, q * a.relative_velocity, 1e-12, "velocity");
    expect_vector_near(d.relative_velocity, q * c.relative_velocity, 1e-12, "velocity");
    expect_vector_near(b.arm_1, q * a.arm_1, 1e-12 * journal_radius + 1e-18 / a.eccentricity,
                       "arm 1");
    expect_vector_near(d.arm_2, q * c.arm_2, 1e-15, "arm 2");
  }
}

// Compares transport() with Rodrigues' rotation by angle and axis.
TEST(Transport, IsTheSmallestRotation) {
  Random random;
  for (int i = 0; i < 500; ++i) {
    const Vector3 old_normal = random.unit();
    const Vector3 tangential = perpendicular_part(random.vector(50.0), old_normal);
    const Vector3 axis = perpendicular_part(random.unit(), old_normal).normalized();
    const double angle = random.uniform(-3.1, 3.1);  // up to 178 degrees
    const Eigen::Matrix3d turn = Eigen::AngleAxisd(angle, axis).toRotationMatrix();
    const Vector3 new_normal = (turn * old_normal).normalized();
    const Vector3 moved = transport(tangential, old_normal, new_normal);
    // close to 180 degrees, 1/|h| = 1/0.04 amplifies the rounding of n_new
    expect_vector_near(moved, turn * tangential, 1e-13 * tangential.norm(), "transport");
    EXPECT_NEAR(moved.norm(), tangential.norm(), 1e-15 * tangential.norm());
    EXPECT_NEAR(moved.dot(new_normal), 0.0, 1e-14 * tangential.norm());
    const double twist = random.uniform(-3.0, 3.0);
    expect_vector_near(transport(tangential, old_normal, new_normal, twist),
                       Eigen::AngleAxisd(twist, new_normal) * (turn * tangential),
                       1e-13 * tangential.norm(), "twist");
  }
}

TEST(Transport, SpecialCases) {
  const Vector3 x = Vector3::UnitX();
  const Vector3 y = Vector3::UnitY();
  EXPECT_EQ(transport(Vector3::Zero(), x, y), Vector3(Vector3::Zero()));
  EXPECT_EQ(transport(Vector3(0, 2, 3), x, x), Vector3(0, 2, 3));
  // A half turn has no unique axis. The result must be finite, in the tangent plane, with the same
  // magnitude.
  EXPECT_EQ(transport(Vector3(0, 2, 3), x, -x), Vector3(0, 2, 3));
  // A normal component is removed and the magnitude is kept. A vector along the normal becomes
  // zero.
  expect_vector_near(transport(Vector3(3, 4, 0), x, x), Vector3(0, 5, 0), 1e-14, "projected");
  EXPECT_EQ(transport(Vector3(3, 0, 0), x, x), Vector3(Vector3::Zero()));
  // Twist is right-handed about n_new.
  expect_vector_near(transport(y, x, x, 0.5 * testing::pi), Vector3::UnitZ(), 1e-15, "twist");
}

// A journal rolls around its bearing a hundred times in small steps. All normals lie in one plane
// (no holonomy), so the tangential force must return to its initial value.
TEST(Transport, DoesNotDriftOverManySteps) {
  Vector3 force(0, 3, 4);
  Vector3 normal = Vector3::UnitX();
  const int steps = 100000;
  for (int i = 1; i <= steps; ++i) {
    const double angle = 2.0 * testing::pi * 100 * i / steps;
    const Vector3 next(std::cos(angle), std::sin(angle), 0);
    force = transport(force, normal, next);
    normal = next;
  }
  // at worst one rounding, 1.1e-16 relative, per step
  EXPECT_NEAR(force.norm(), 5.0, steps * 1.1e-16 * 5.0);
  expect_vector_near(force, Vector3(0, 3, 4), 1e-10, "force");
}

}  // namespace
}  // namespace statejump::kernel
