// SPDX-License-Identifier: GPL-3.0-or-later
// Batches of four contacts give the same bits as contacts stepped one by one. Scene::run(1) makes
// its single step without batches, so n such runs are the reference for run(n). tests/yade compares
// single steps with YADE's own loop.
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>

#include "bits.hpp"
#include "scenes.hpp"

namespace statejump::stepper {
namespace {

/// Counts of cases that occur in a scene, to prove that a test covers them.
struct Seen {
  long began = 0, ended = 0, slipped = 0, stuck = 0;
};

Seen make_one_by_one(Scene& scene, long steps, const Scene::CreatePhysics& make) {
  Seen seen;
  for (long i = 0; i < steps; ++i) {
    std::vector<bool> before;
    for (const Contact& each : scene.contacts) before.push_back(each.real);
    EXPECT_EQ(scene.run(1, make), 1);
    for (std::size_t k = 0; k < before.size(); ++k) {
      const Contact& now = scene.contacts[k];
      if (now.real && !before[k]) ++seen.began;
      if (!now.real && before[k]) ++seen.ended;
      if (now.real) ++(now.physics.slipping ? seen.slipped : seen.stuck);
    }
  }
  return seen;
}

/// Compares single steps and runs, with and without AVX2 instructions.
Seen expect_same_bits(Scene scene, long steps, const Scene::CreatePhysics& make = scenes::maker()) {
  scene.prepare();
  Scene one_by_one = scene;
  const Seen seen = make_one_by_one(one_by_one, steps, make);
  for (const bool wide : {false, true}) {
    if (wide && !has_avx2()) continue;
    SCOPED_TRACE(wide ? "AVX2" : "without AVX2");
    Scene batched = scene;
    batched.uses_avx2 = wide;
    EXPECT_EQ(batched.run(steps, make), steps);
    bits::expect_same(batched, one_by_one);
  }
  return seen;
}

/// Journals that bounce in their bearings, or balls in their sockets.
Scene rattling(Joint joint, std::size_t joints) {
  Scene scene = scenes::crowd(joints);
  scene.newton.damping = 0;
  std::mt19937 random(5);
  std::uniform_real_distribution<double> from(-1, 1);
  for (Contact& each : scene.contacts) {
    each.joint = joint;
    Body& inner = scene.bodies[static_cast<std::size_t>(each.body_1)];
    const Body& outer = scene.bodies[static_cast<std::size_t>(each.body_2)];
    const double z = joint == Joint::ball ? 1 : 0;
    inner.blocked = joint == Joint::ball ? all_rotations : scenes::planar;
    inner.motion.position =
        outer.motion.position + 0.5 * scenes::clearance * Vector3(from(random), from(random), 0);
    inner.motion.velocity = Vector3(from(random), from(random), z * from(random));
    inner.permanent_force = 50 * Vector3(from(random), from(random), z * from(random));
  }
  return scene;
}

Scene::CreatePhysics damped() {
  return [](std::size_t place) {
    ContactPhysics made = scenes::physics(scenes::mass);
    // Some without damping, some without friction.
    made.normalDampingRatio = 0.02 * static_cast<double>(place % 3);
    made.tangentialDampingRatio = 0.05 * static_cast<double>(place % 2);
    if (place % 5 == 4) made.tangensOfFrictionAngle = 0;
    return std::optional<ContactPhysics>(made);
  };
}

TEST(Batches, ContactsThatStickKeepTheirBits) {
  Scene scene = scenes::crowd(13, 0.4);
  const Seen seen = expect_same_bits(scene, 1000);
  EXPECT_GT(seen.stuck, 10'000);
}

TEST(Batches, ContactsThatBeginSlipAndEndKeepTheirBits) {
  for (const Joint joint : {Joint::revolute, Joint::ball}) {
    for (const bool energy : {false, true}) {
      SCOPED_TRACE(std::string(joint == Joint::ball ? "ball" : "revolute") +
                   (energy ? " with energies" : ""));
      Scene scene = rattling(joint, 11);
      scene.tracks_energy = energy;
      const Seen seen = expect_same_bits(scene, 2000, damped());
      EXPECT_GT(seen.began, 50);
      EXPECT_GT(seen.ended, 50);
      EXPECT_GT(seen.slipped, 100);
      EXPECT_GT(seen.stuck, 100);
    }
  }
}

TEST(Batches, BlocksWithLinksKeepTheirBits) {
  for (const bool energy : {false, true}) {
    Scene scene = scenes::chain(10);
    scene.tracks_energy = energy;
    scene.bodies[5].motion.velocity = Vector3(0.02, 0.1, 0);
    const Seen seen = expect_same_bits(scene, 2000, damped());
    EXPECT_GT(seen.slipped, 0);
    EXPECT_GT(seen.ended, 0);
  }
}

TEST(Batches, DampedMotionUnderGravityKeepsItsBits) {
  for (const bool damps_gravity : {false, true}) {
    Scene scene = rattling(Joint::ball, 9);
    scene.newton = {0.2, Vector3(1, -9.81, 2), damps_gravity};
    for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
      Body& each = scene.bodies[i];
      each.damped = i % 4 != 1;
      if (i % 6 == 2) {  // a bearing that moves freely, and one with prescribed motion
        each.blocked = i % 12 == 2 ? scenes::planar : all_dofs;
        each.motion.velocity = Vector3(0.01, 0, -0.0);
      }
    }
    expect_same_bits(scene, 500, damped());
  }
}

TEST(Batches, TheSceneOfARibKeepsItsBits) {
  expect_same_bits(scenes::rib(), 500, scenes::maker(1 / (3 / 0.5 + 3 / 1.0)));
}

TEST(Batches, TheRunEndsWhereABodyLeavesItsBound) {
  Scene scene = rattling(Joint::revolute, 6);
  Body& body = scene.bodies[3];
  body.bounded = true;
  body.bound_position = body.motion.position;
  body.bound_reach = 1e-5;
  scene.prepare();
  Scene one_by_one = scene;
  long alone = 0;
  while (one_by_one.run(1, damped()) == 1) ++alone;
  EXPECT_GT(alone, 3);
  EXPECT_EQ(scene.run(1000, damped()), alone);
}

}  // namespace
}  // namespace statejump::stepper
