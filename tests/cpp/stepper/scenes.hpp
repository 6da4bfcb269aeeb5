// SPDX-License-Identifier: GPL-3.0-or-later
// Scenes for tests and benchmark of the stepper: bodies, contacts and links as the plugin gathers
// them.
#pragma once

#include <cmath>
#include <cstddef>
#include <optional>

#include "statejump/kernel/elastic_pair.hpp"
#include "statejump/kernel/hertz.hpp"
#include "statejump/stepper/scene.hpp"

namespace statejump::stepper::scenes {

// Data of Table 2 of Chen et al. (2021). All joints have the same load, as in
// studies/bench/pairs.py.
constexpr double young = 70e9, poisson = 0.3, friction = 0.3;                // Pa, -, -
constexpr double expansion_journal = 23.75e-6, expansion_bearing = 22e-6;    // 1/K
constexpr double radius = 5e-3, clearance = 1e-4, mass = 0.01;               // m, m, kg
constexpr double load = 10, inclination = 0.5 * friction, time_step = 1e-6;  // N, -, s
constexpr unsigned planar = 4 | all_rotations;  // free to move perpendicular to the axis

inline ContactPhysics physics(double effective_mass) {
  const kernel::ElasticPair pair = kernel::elastic_pair(young, poisson, young, poisson);
  ContactPhysics made;
  made.effectiveYoungModulus = pair.effective_young_modulus;
  made.effectiveShearModulus = pair.effective_shear_modulus;
  made.tangensOfFrictionAngle = friction;
  made.effectiveMass = effective_mass;
  return made;
}

inline Scene::CreatePhysics maker(double effective_mass = mass) {
  return [=](std::size_t) { return std::optional<ContactPhysics>(physics(effective_mass)); };
}

inline double depth(double effective_radius) {
  const double modulus =
      kernel::elastic_pair(young, poisson, young, poisson).effective_young_modulus;
  return kernel::hertz_depth(modulus, effective_radius, load);
}

inline int add_body(Scene& scene, const Vector3& place, unsigned blocked, double its_mass = mass) {
  Body body;
  body.motion.position = place;
  body.blocked = blocked;
  body.mass = its_mass;
  body.inverse_mass = blocked == all_dofs ? 0 : 1 / its_mass;
  body.inertia = Vector3::Constant(0.4 * its_mass * radius * radius);
  scene.bodies.push_back(body);
  return static_cast<int>(scene.bodies.size()) - 1;
}

/// Slowly rising temperature.
inline thermal::Program rising() {
  thermal::Program program;
  program.shape = thermal::Shape::triangle;
  program.temperature_change_max = 10;
  program.period = 10;
  return program;
}

/// Distance [m] between the centres of journal and bearing at which the contact force equals the
/// load.
inline double pressed() {
  return clearance + depth(radius * (radius + clearance) / clearance);
}

/// Independent joints, each a journal pressed into a fixed bearing; both expand. The caller calls
/// prepare().
/// @param spread range of the load directions over the joints [rad]
/// @param offset initial distance of the journals from their bearings' centres [m]
inline Scene crowd(std::size_t joints, double spread = 0, double offset = pressed()) {
  Scene scene;
  scene.time_step = time_step;
  scene.newton.damping = 0.2;
  scene.largest_tilt = 1e-3;
  scene.programs = {rising()};
  scene.strains.resize(2);
  scene.heaters = {{0, {{0, expansion_journal}, {1, expansion_bearing}}}};
  for (std::size_t i = 0; i < joints; ++i) {
    const double angle = spread * static_cast<double>(i);
    const Vector3 side(std::cos(angle), std::sin(angle), 0), across(-side[1], side[0], 0);
    const Vector3 place(0.03 * static_cast<double>(i), 0, 0);
    const int bearing = add_body(scene, place, all_dofs);
    const int journal = add_body(scene, place + offset * side, planar);
    scene.bodies.back().permanent_force = load * (side + inclination * across);
    Contact contact{};
    contact.body_1 = journal;
    contact.body_2 = bearing;
    contact.length_1 = radius;
    contact.length_2 = radius + clearance;
    contact.strain_1 = 0;
    contact.strain_2 = 1;
    contact.joint = Joint::revolute;
    contact.rotates = true;
    contact.made = -1;
    contact.axis = Vector3::Zero();
    scene.contacts.push_back(contact);
  }
  return scene;
}

/// A crowd in which a heated link connects each journal to a fixed point. The caller calls
/// prepare().
inline Scene held_crowd(std::size_t joints, double offset = pressed()) {
  Scene scene = crowd(joints, 1, offset);
  Links links;
  for (const Contact& contact : scene.contacts) {
    const Vector3 journal = scene.bodies[static_cast<std::size_t>(contact.body_1)].motion.position;
    const Vector3 bearing = scene.bodies[static_cast<std::size_t>(contact.body_2)].motion.position;
    Link link;
    link.id1 = add_body(scene, bearing - 0.5 * (journal - bearing).normalized(), all_dofs);
    link.id2 = contact.body_1;
    link.youngModulus = young;
    link.crossSectionArea = 9e-8;
    link.stressFreeLength = 0.5;
    link.thermalExpansion = expansion_journal;
    links.links.push_back({link, 0});
  }
  scene.stages = {links};
  return scene;
}

/// Blocks on floors, each connected to the next one by a heated link. The caller calls prepare().
inline Scene chain(std::size_t joints) {
  Scene scene;
  scene.time_step = time_step;
  scene.programs = {rising()};
  scene.strains.resize(1);
  constexpr double pad = 0.05, length = 0.5;
  const double sunk = depth(pad);
  Links links;
  for (std::size_t i = 0; i < joints; ++i) {
    const Vector3 place(length * static_cast<double>(i), 0, 0);
    const int floor = add_body(scene, place, all_dofs);
    const int block = add_body(scene, place - Vector3(0, sunk, 0), planar);
    scene.bodies.back().permanent_force = Vector3(0, -load, 0);
    Contact contact{};
    contact.body_1 = block;
    contact.body_2 = floor;
    contact.length_1 = contact.length_2 = pad;
    contact.joint = Joint::plane;
    contact.face_normal = -Vector3::UnitY();
    contact.made = -1;
    scene.contacts.push_back(contact);
    if (i == 0) continue;
    Link link;
    link.id1 = block - 2;
    link.id2 = block;
    link.youngModulus = young;
    link.crossSectionArea = 9e-6;
    link.stressFreeLength = length;
    link.thermalExpansion = expansion_journal;
    link.dampingRatio = 0.1;
    links.links.push_back({link, 0});
  }
  scene.stages = {links};
  return scene;
}

/// Rib of an umbrella antenna with energy tracking: two links rotate on pins, and their tips form a
/// clearance joint with named laws. The caller calls prepare().
inline Scene rib() {
  Scene scene;
  scene.time_step = 2.5e-6;
  scene.tracks_energy = true;
  scene.largest_tilt = 1e-3;
  scene.programs = {rising()};
  scene.programs.front().period = 1;
  scene.programs.front().temperature_change_max = 100;
  scene.strains.resize(2);
  scene.heaters = {{0, {{0, 0}, {1, 0}}}};
  NamedLaw law;
  law.law.friction = kernel::laws::friction_law("mindlin");
  law.law.friction_parameters = {friction, 1e-5, 1e-4};
  scene.law = law;
  const double offset = pressed();
  const Vector3 pins[2] = {{0, 0, 0}, {0.12, 0, 0}};
  const Vector3 tips[2] = {{0.03, 0.04, 0}, {0.03 + offset, 0.04, 0}};
  const double masses[2] = {0.5 / 3, 1.0 / 3};
  Links links;
  links.needs_moments = true;
  int ends[2];
  for (std::size_t i = 0; i < 2; ++i) {
    const int pin = add_body(scene, pins[i], all_dofs);
    ends[i] = add_body(scene, tips[i], planar, masses[i]);
    Link link;
    link.id1 = pin;
    link.id2 = ends[i];
    link.youngModulus = young;
    link.crossSectionArea = 9e-6;
    link.stressFreeLength = (tips[i] - pins[i]).norm();
    link.thermalExpansion = expansion_journal;
    link.dampingRatio = 0.1;
    link.pinDamping = 0.01;
    link.tipTurnsWithLink = true;
    links.links.push_back({link, 0});
  }
  scene.stages = {links};
  scene.bodies[static_cast<std::size_t>(ends[1])].permanent_force = Vector3(load, 0, 0);
  Contact contact{};
  contact.body_1 = ends[1];
  contact.body_2 = ends[0];
  contact.length_1 = radius;
  contact.length_2 = radius + clearance;
  contact.strain_2 = 1;
  contact.joint = Joint::revolute;
  contact.made = -1;
  contact.rotates = true;
  scene.contacts = {contact};
  return scene;
}

}  // namespace statejump::stepper::scenes
