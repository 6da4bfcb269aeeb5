// SPDX-License-Identifier: GPL-3.0-or-later
// Tips that rotate with their links in the plane: the rotation itself, and steps in which the
// integrator defers its own rotation of the tip.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <variant>

#include "../kernel/support.hpp"
#include "bits.hpp"
#include "scenes.hpp"
#include "statejump/stepper/link.hpp"

namespace statejump::stepper {
namespace {

Quaternion about_z(double angle) {
  return Quaternion(std::cos(angle / 2), 0, 0, std::sin(angle / 2));
}

// Allowed rounding: quotient, root and both components are rounded a few times; directions are unit
// vectors to 2^-53.
constexpr double rounding = 8 * 0x1p-53;

TEST(Link, TheTurnInThePlaneIsThatOfTheAngle) {
  kernel::testing::Random random;
  const double pi = kernel::testing::pi;
  for (int i = 0; i < 2000; ++i) {
    const double start = random.uniform(-pi, pi);
    // The angles cover all decades of small angles, both sides of a quarter turn, and a half turn.
    const double small = std::pow(10.0, random.uniform(-15, 0)) * (i % 2 == 0 ? 1 : -1);
    const double ends[] = {small, pi / 2 + small, pi + small, 0, pi};
    const double angle = ends[i % 5];
    const Vector3 from(std::cos(start), std::sin(start), 0);
    const Vector3 to(std::cos(start + angle), std::sin(start + angle), 0);
    const Quaternion near = about_z(angle + random.uniform(-1, 1));
    const Quaternion turn = rotation_in_plane(from, to, near);
    EXPECT_NEAR(turn.norm(), 1, rounding);
    EXPECT_EQ(turn.x(), 0);
    EXPECT_EQ(turn.y(), 0);
    EXPECT_GT(turn.dot(near), 0) << angle;
    EXPECT_LE((turn * from - to).norm(), rounding) << angle;
  }
}

// Compares one run of the rib with single steps, in which the rotation of a tip is never deferred.
void expect_same_bits(const std::function<void(Scene&)>& change, bool may_wait) {
  Scene whole = scenes::rib();
  change(whole);
  whole.prepare();
  Scene single = whole;
  const auto make = scenes::maker(1 / (3 / 0.5 + 3 / 1.0));
  int waiting = 0;
  for (const Body& body : whole.bodies) waiting += body.rotation_deferrable;
  EXPECT_EQ(waiting, may_wait ? 2 : 0);
  for (const long steps : {2L, 3L, 60L}) {
    ASSERT_EQ(whole.run(steps, make), steps);
    for (long i = 0; i < steps; ++i) ASSERT_EQ(single.run(1, make), 1);
    bits::expect_same(whole, single);
  }
}

Body& tip(Scene& scene, std::size_t place) {
  const Link& link = std::get<Links>(scene.stages.front()).links[place].link;
  return scene.bodies[static_cast<std::size_t>(link.id2)];
}

TEST(Link, ATurnThatWaitsChangesNoBit) {
  expect_same_bits([](Scene&) {}, true);
}

TEST(Link, ATurnThatWaitedIsMadeUpForWhereItsLinkLeavesThePlane) {
  // A force along z acts on the tip. It still rotates about z in its first step and leaves the
  // plane in the second.
  expect_same_bits(
      [](Scene& scene) {
        tip(scene, 0).blocked &= ~4U;
        tip(scene, 0).permanent_force[2] = 1e-3;
        for (const std::size_t i : {0, 1}) tip(scene, i).motion.velocity = {4e-4, -3e-4, 0};
      },
      true);
}

TEST(Link, ATurnThatIsTooLongDoesNotWait) {
  expect_same_bits([](Scene& scene) { scene.time_step = 1e-5; }, true);
  Body body;
  body.rotation_deferrable = true;
  body.motion.angular_velocity = Vector3(0, 0, 99);
  EXPECT_TRUE(can_defer_rotation(body, 1e-3));
  EXPECT_FALSE(can_defer_rotation(body, 2e-3));
  body.motion.angular_velocity[0] = 1e-9;
  EXPECT_FALSE(can_defer_rotation(body, 1e-3));
}

TEST(Link, ATurnDoesNotWaitWhereAFaceTurnsWithTheTip) {
  const auto add_face = [](Scene& scene) {
    Contact contact = scene.contacts.front();
    contact.joint = Joint::plane;
    contact.face_normal = Vector3::UnitX();
    contact.length_2 = 1;  // no contact
    scene.contacts.push_back(contact);
  };
  expect_same_bits(add_face, false);
}

}  // namespace
}  // namespace statejump::stepper
