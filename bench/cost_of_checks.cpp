// SPDX-License-Identifier: GPL-3.0-or-later
// Steps of joints held by links, for cost_of_checks.py: JOINTS and STEPS from the command line.
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <optional>

#include "statejump/stepper/scene.hpp"

namespace {

using namespace statejump::stepper;

constexpr double radius = 5e-3, clearance = 1e-4, mass = 0.01;  // m, m, kg

int add_body(Scene& scene, const Vector3& place, unsigned blocked) {
  Body body;
  body.motion.position = place;
  body.blocked = blocked;
  body.mass = mass;
  body.inverse_mass = blocked == everything ? 0 : 1 / mass;
  scene.bodies.push_back(body);
  return static_cast<int>(scene.bodies.size()) - 1;
}

// Each journal is pressed into its bearing while a link pulls it; both parts and the link heat up.
Scene scene_of(int joints) {
  Scene scene;
  scene.time_step = 1e-6;
  scene.newton.damping = 0.2;
  scene.largest_tilt = 1e-3;
  statejump::thermal::Program rising;
  rising.shape = statejump::thermal::Shape::triangle;
  rising.temperature_change_max = 10;
  rising.period = 10;
  scene.programs = {rising};
  scene.strains.resize(2);
  scene.heaters = {{0, {{0, 23.75e-6}, {1, 22e-6}}}};
  Links links;
  for (int i = 0; i < joints; ++i) {
    const Vector3 direction(std::cos(i), std::sin(i), 0), place(i, 0, 0);
    Contact contact{};
    contact.body_2 = add_body(scene, place, everything);
    contact.body_1 = add_body(scene, place + clearance * direction, 4 | all_rotations);
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

std::optional<ContactPhysics> aluminium(std::size_t) {
  ContactPhysics made;
  made.effectiveYoungModulus = 38.5e9;
  made.effectiveShearModulus = 7.9e9;
  made.tangensOfFrictionAngle = 0.3;
  made.effectiveMass = mass;
  return made;
}

}  // namespace

int main(int count, char** words) {
  if (count != 3) return 2;
  Scene scene = scene_of(std::atoi(words[1]));
  const long steps = std::atol(words[2]);
  const bool whole = scene.run(steps, aluminium) == steps;
  std::printf("%.17g\n", scene.bodies[1].motion.position[0]);  // the same with and without checks
  return whole && scene.is_sound() ? 0 : 1;
}
