// SPDX-License-Identifier: GPL-3.0-or-later
// What the arrays of a scene are made of.
#pragma once

#include <array>
#include <cstddef>
#include <variant>
#include <vector>

#include "statejump/stepper/contact.hpp"
#include "statejump/stepper/link.hpp"
#include "statejump/stepper/motion.hpp"
#include "statejump/stepper/prismatic.hpp"

namespace statejump::stepper {

/// Thermal strain that parts share: all that have it now and that the same engines set.
struct Strain {
  double strain = 0;  ///< [-]
  double rate = 0;    ///< of the last step [1/s]
};

/// Sets strains to expansion times temperature change; a ThermalExpansionEngine.
struct Heater {
  struct Target {
    std::size_t strain;  ///< place in Scene::strains
    double expansion;    ///< [1/K]
  };
  std::size_t program;  ///< place in Scene::programs
  std::vector<Target> targets;
};

enum class Joint : unsigned char { revolute, ball, plane, outer_balls, bore };

/// Two bodies that touch or may touch.
struct Contact {
  int body_1, body_2;
  double length_1, length_2;              ///< radii, or pad and distance of the face [m]
  std::size_t strain_1, strain_2;         ///< places in Scene::strains
  Vector3 face_normal = Vector3::Zero();  ///< in the axes of body 2; of a plane
  Joint joint;
  std::size_t bore = 0;  ///< of a meshed bore: place in Scene::bores, which has the rest
  bool real = false;     ///< it has geometry and physics
  bool renewed = false;  ///< since the arrays were filled
  long made = -1;        ///< step in which it became real
  bool turns = true;     ///< one of the two bodies turns, or may
  bool tilted =
      false;  ///< where none does: whether the axes are further from parallel than allowed
  Vector3 axis = Vector3::Zero();  ///< where none does: of body 2
  ContactGeometry geometry;
  ContactPhysics physics;
  double plain_stiffness = 0;  ///< plain_stiffness() of the physics [N/m]
};

/// A link, with its program and what is known of it before the first step.
struct LinkPlace {
  Link link;
  std::size_t program;            ///< place in Scene::programs
  double inverse_mass = 0;        ///< 1/m1 + 1/m2 [1/kg]
  double damping = 0;             ///< damping_coefficient() [N s/m]
  double softening = 0;           ///< previous_softening() [N]
  Span span{Vector3::Zero(), 0};  ///< of this step
};

struct TorsionPlace {
  Torsion spring;
  std::array<int, 2> first, second;  ///< root and tip of the two links
};

struct Guide {
  int body;
  Vector3 normal;
};

/// Links of one engine. Where any of them turns its tip, the engine sums up the forces of all
/// bodies before it adds its own.
struct Links {
  std::vector<LinkPlace> places;
  bool needs_moments = false;
};

/// What adds forces after the contacts, in the order of the engines.
using Stage =
    std::variant<Links, std::vector<TorsionPlace>, std::vector<Prismatic>, std::vector<Guide>>;

/// Energies that grow from step to step [J].
struct Energies {
  double joint_friction = 0, joint_damping = 0, joint_thermal_work = 0;
  double link_damping = 0, pin_damping = 0, link_thermal_work = 0;
  double torsion_friction = 0;
  double prismatic_friction = 0, prismatic_damping = 0;
  double numerical_damping = 0, gravity_work = 0;
};

/// Energies that are stored now, of one step [J].
struct StoredEnergies {
  double joint = 0, link = 0, torsion = 0, prismatic = 0;
};

/// Bodies that feel what is in a scene.
inline std::array<int, 2> bodies_of(const Contact& one) {
  return {one.body_1, one.body_2};
}
inline std::array<int, 2> bodies_of(const LinkPlace& one) {
  return {one.link.id1, one.link.id2};
}
inline std::array<int, 4> bodies_of(const TorsionPlace& one) {
  return {one.first[0], one.first[1], one.second[0], one.second[1]};
}
inline std::array<int, 2> bodies_of(const Prismatic& one) {
  return {one.id1, one.id2};
}
inline std::array<int, 1> bodies_of(const Guide& one) {
  return {one.body};
}

/// What a stage holds.
inline const std::vector<LinkPlace>& entries(const Links& stage) {
  return stage.places;
}
template <class Entry>
const std::vector<Entry>& entries(const std::vector<Entry>& stage) {
  return stage;
}

inline Vector3 axis_of(const Quaternion& q) {
  // Local z axis in the world: orientation * (0, 0, 1) without the products with zero. A sum with
  // +0 has no sign of its own: after any turn about z the axis has the same bits.
  return {2 * (q.x() * q.z() + q.w() * q.y()) + 0.0, 2 * (q.y() * q.z() - q.w() * q.x()) + 0.0,
          1 - 2 * (q.x() * q.x() + q.y() * q.y())};
}

}  // namespace statejump::stepper
