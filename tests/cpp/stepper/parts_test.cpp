// SPDX-License-Identifier: GPL-3.0-or-later
// Parts of a scene in several threads: the same bits as the whole in one.
#include "statejump/stepper/parts.hpp"

#include <gtest/gtest.h>
#include <omp.h>

#include <atomic>
#include <cmath>
#include <optional>
#include <vector>

namespace statejump::stepper {
namespace {

constexpr double radius = 5e-3, clearance = 1e-4, mass = 0.01;  // m, m, kg
constexpr int joints = 100;                                     // four parts

std::optional<ContactPhysics> aluminium() {
  ContactPhysics made;
  made.effectiveYoungModulus = 38.5e9;
  made.effectiveShearModulus = 7.9e9;
  made.tangensOfFrictionAngle = 0.3;
  made.effectiveMass = mass;
  return made;
}

int add_body(Scene& scene, const Vector3& place, unsigned blocked) {
  Body body;
  body.motion.position = place;
  body.blocked = blocked;
  body.mass = mass;
  body.inverse_mass = blocked == everything ? 0 : 1 / mass;
  body.inertia = Vector3::Constant(mass * radius * radius);
  scene.bodies.push_back(body);
  return static_cast<int>(scene.bodies.size()) - 1;
}

/// Journals that fall through their clearances, each in its own direction, while both parts expand;
/// each is held to a fixed point by a link that heats up.
Scene crowd() {
  Scene scene;
  scene.time_step = 1e-6;
  scene.largest_tilt = 1e-3;
  thermal::Program rising;
  rising.shape = thermal::Shape::triangle;
  rising.temperature_change_max = 100;
  scene.programs = {rising};
  scene.strains.resize(2);
  scene.heaters = {{0, {{0, 23.75e-6}, {1, 22e-6}}}};
  Links links;
  for (int i = 0; i < joints; ++i) {
    const Vector3 direction(std::cos(i), std::sin(i), 0), place(i, 0, 0);
    Contact contact{};
    contact.body_2 = add_body(scene, place, everything);
    contact.body_1 = add_body(scene, place + 0.9 * clearance * direction, 4 | all_rotations);
    scene.bodies.back().permanent_force = 10 * direction;
    contact.length_1 = radius;
    contact.length_2 = radius + clearance;
    contact.strain_2 = 1;
    contact.joint = Joint::revolute;
    contact.made = -1;
    scene.contacts.push_back(contact);
    Link link;
    link.id1 = add_body(scene, place - 0.5 * direction, everything);
    link.id2 = contact.body_1;
    link.youngModulus = 70e9;
    link.crossSectionArea = 9e-8;
    link.stressFreeLength = 0.5;
    link.thermalExpansion = 23.4e-6;
    links.places.push_back({link, 0});
  }
  scene.stages = {links};
  scene.prepare();
  return scene;
}

std::vector<double> numbers(const Scene& scene) {
  std::vector<double> found{scene.time, static_cast<double>(scene.iteration)};
  const auto add = [&](const Vector3& v) { found.insert(found.end(), v.data(), v.data() + 3); };
  for (const Body& body : scene.bodies) {
    add(body.motion.position);
    add(body.motion.velocity);
  }
  for (const Contact& contact : scene.contacts) {
    found.push_back(contact.real);
    add(contact.physics.normalForce);
    add(contact.physics.shearForce);
  }
  for (const LinkPlace& place : std::get<Links>(scene.stages[0]).places) {
    found.push_back(place.link.axialForce);
  }
  return found;
}

TEST(Parts, AnyNumberOfThreadsGivesTheBitsOfTheWhole) {
  constexpr long steps = 2000;
  Scene whole = crowd();
  int alone = 0;
  const auto make_alone = [&](std::size_t) { return ++alone, aluminium(); };
  ASSERT_EQ(whole.run(steps, make_alone), steps);
  const std::vector<double> expected = numbers(whole);
  ASSERT_GE(alone, joints);  // they have all touched
  const int before = omp_get_max_threads();
  for (const int threads : {1, 2, 4}) {
    omp_set_num_threads(threads);
    Scene scene = crowd();
    Parts parts(scene);
    ASSERT_EQ(parts.size(), 4U);
    std::atomic<int> made = 0;
    const auto make = [&](std::size_t) {
      made.fetch_add(1, std::memory_order_relaxed);  // orders no threads, which would hide races
      return aluminium();
    };
    ASSERT_EQ(parts.run(steps, make), steps);
    parts.collect(scene);
    EXPECT_EQ(numbers(scene), expected) << threads << " threads";
    EXPECT_EQ(made, alone);
  }
  omp_set_num_threads(before);
}

TEST(Parts, ShortestWayOfAnyPartIsTold) {
  Scene scene = crowd();
  // The last journal has no materials: its part stops where it would touch.
  Parts parts(scene);
  const auto make = [](std::size_t contact) {
    return contact + 1 == joints ? std::nullopt : aluminium();
  };
  Scene alone = crowd();
  const long expected = alone.run(2000, make);
  EXPECT_LT(expected, 2000);
  EXPECT_EQ(parts.run(2000, make), expected);
}

}  // namespace
}  // namespace statejump::stepper
