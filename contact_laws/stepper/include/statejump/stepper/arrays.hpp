// SPDX-License-Identifier: GPL-3.0-or-later
// Element types of the arrays of a scene.
#pragma once

#include <array>
#include <cstddef>
#include <variant>
#include <vector>

#include "statejump/stepper/body.hpp"
#include "statejump/stepper/contact.hpp"
#include "statejump/stepper/link.hpp"
#include "statejump/stepper/prismatic.hpp"

namespace statejump::stepper {

/// Thermal strain shared by all bodies that currently have this strain and are heated by the same
/// engines.
struct Strain {
  double strain = 0;  ///< [-]
  double rate = 0;    ///< rate over the last step [1/s]
};

/// Sets each thermal strain to the expansion coefficient times the temperature change, like a
/// ThermalExpansionEngine.
struct Heater {
  struct Target {
    std::size_t strain;  ///< index of the strain in Scene::strains
    double expansion;    ///< [1/K]
  };
  std::size_t program;  ///< index in Scene::programs
  std::vector<Target> targets;
};

enum class Joint : unsigned char { revolute, ball, plane, outer_balls, bore };

/// Pair of bodies that touch or may touch.
struct Contact {
  int body_1, body_2;
  double length_1, length_2;       ///< two radii; for a plane, pad radius and face distance [m]
  std::size_t strain_1, strain_2;  ///< indices in Scene::strains
  Vector3 face_normal = Vector3::Zero();  ///< for a plane: normal in the axes of body 2
  Joint joint;
  std::size_t bore = 0;  ///< for a meshed bore: index of its data in Scene::bores
  bool real = false;     ///< has geometry and physics
  bool renewed = false;  ///< its physics was created after the arrays were filled
  long made = -1;        ///< number of the step in which it became real; -1: not yet
  bool rotates = true;   ///< one of the two bodies rotates or can rotate
  bool tilted = false;   ///< only if neither body rotates: axes tilted by more than allowed
  Vector3 axis = Vector3::Zero();  ///< only if neither body rotates: axis of body 2
  ContactGeometry geometry;
  ContactPhysics physics;
  double stable_stiffness = 0;  ///< stable_stiffness() of the physics [N/m]
};

/// A link with the index of its program and with constants that are computed before the first step.
struct LinkEntry {
  Link link;
  std::size_t program;            ///< index in Scene::programs
  double inverse_mass = 0;        ///< 1/m1 + 1/m2 [1/kg]
  double damping = 0;             ///< damping_coefficient() [N s/m]
  double softening = 0;           ///< previous_softening() [N]
  Span span{Vector3::Zero(), 0};  ///< of this step
};

struct TorsionEntry {
  Torsion spring;
  std::array<int, 2> first, second;  ///< root and tip of the two links
};

struct Guide {
  int body;
  Vector3 normal;
};

/// Links of one engine. If a link rotates its tip, the engine sums the forces of all bodies before
/// it adds forces.
struct Links {
  std::vector<LinkEntry> links;
  bool needs_moments = false;
};

/// Stages that add forces after the contact forces, one per engine, in the order of the engines.
using Stage =
    std::variant<Links, std::vector<TorsionEntry>, std::vector<Prismatic>, std::vector<Guide>>;

/// Cumulative energies [J].
struct Energies {
  double joint_friction = 0, joint_damping = 0, joint_thermal_work = 0;
  double link_damping = 0, pin_damping = 0, link_thermal_work = 0;
  double torsion_friction = 0;
  double prismatic_friction = 0, prismatic_damping = 0;
  double beam_damping = 0, beam_thermal_work = 0;
  double numerical_damping = 0, gravity_work = 0;
};

/// Elastic energies stored in the scene at one step [J].
struct StoredEnergies {
  double joint = 0, link = 0, torsion = 0, prismatic = 0, beam = 0;
};

/// Bodies on which an object acts.
inline std::array<int, 2> bodies_of(const Contact& one) {
  return {one.body_1, one.body_2};
}
inline std::array<int, 2> bodies_of(const LinkEntry& one) {
  return {one.link.id1, one.link.id2};
}
inline std::array<int, 4> bodies_of(const TorsionEntry& one) {
  return {one.first[0], one.first[1], one.second[0], one.second[1]};
}
inline std::array<int, 2> bodies_of(const Prismatic& one) {
  return {one.id1, one.id2};
}
inline std::array<int, 1> bodies_of(const Guide& one) {
  return {one.body};
}

/// Entries of a stage.
inline const std::vector<LinkEntry>& entries(const Links& stage) {
  return stage.links;
}
template <class Entry>
const std::vector<Entry>& entries(const std::vector<Entry>& stage) {
  return stage;
}

inline Vector3 axis_of(const Quaternion& q) {
  // Local z axis in the world frame: orientation * (0, 0, 1) without products with zero. Adding +0
  // removes a negative zero, so the axis has the same bits after any rotation about z.
  return {2 * (q.x() * q.z() + q.w() * q.y()) + 0.0, 2 * (q.y() * q.z() - q.w() * q.x()) + 0.0,
          1 - 2 * (q.x() * q.x() + q.y() * q.y())};
}

}  // namespace statejump::stepper
