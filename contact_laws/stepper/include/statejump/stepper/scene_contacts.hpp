// SPDX-License-Identifier: GPL-3.0-or-later
// Contacts of a scene in one step: search and laws. Part of scene.hpp.
#pragma once

#include <cstddef>
#include <exception>
#include <optional>
#include <type_traits>
#include <utility>

#include "statejump/stepper/scene.hpp"

namespace statejump::stepper {

inline ContactSearch Scene::find(Contact& contact) {
  const Body& one = body(contact.body_1);
  const Body& two = body(contact.body_2);
  const Strain& strain_1 = strains[contact.strain_1];
  const Strain& strain_2 = strains[contact.strain_2];
  const ThermalLength part_1{contact.length_1, 1 + strain_1.strain, strain_1.rate};
  const ThermalLength part_2{contact.length_2, 1 + strain_2.strain, strain_2.rate};
  const auto geometry = [&](const Vector3& first_normal) -> ContactGeometry& {
    if (!contact.real) {
      contact.geometry = {};
      contact.geometry.normal = first_normal;
    }
    return contact.geometry;
  };
  switch (contact.joint) {
    case Joint::revolute: {
      const Vector3 axis = contact.rotates ? axis_of(two.orientation) : contact.axis;
      const auto tilted = [&] { return contact.rotates ? is_tilted(one, axis) : contact.tilted; };
      return find_revolute(part_1, part_2, one.motion, two.motion, axis, contact.real, time_step,
                           tilted, geometry);
    }
    case Joint::ball:
      return find_ball(part_1, part_2, one.motion, two.motion, contact.real, time_step, geometry);
    case Joint::outer_balls:
      return find_outer_balls(part_1, part_2, one.motion, two.motion, contact.real, time_step,
                              geometry);
    case Joint::bore:  // handled by step_in_bore()
    case Joint::plane:
      break;
  }
  const Vector3 normal = two.orientation * contact.face_normal;
  return find_plane(part_1, part_2, one.motion, two.motion, normal, contact.real, time_step,
                    geometry);
}

template <class Law>
bool Scene::step_contact(const Law& one, std::size_t index, const CreatePhysics& make) {
  Contact& contact = contacts[index];
  if (contact.joint == Joint::bore) return step_in_bore(index, make);
  const ContactSearch found = find(contact);
  if (found == ContactSearch::apart) return true;
  if (found != ContactSearch::contact) return false;
  if (!contact.real) {
    const std::optional<ContactPhysics> made = make(index);
    if (!made) return false;
    contact.physics = *made;
    contact.stable_stiffness = stable_stiffness(contact.physics, time_step);
    contact.real = contact.renewed = true;
    contact.made = iteration;
  }
  any_contact = true;
  // It is faster to check after the computation, because a failed step is left incomplete anyway. A
  // NaN force persists in the state, where has_finite_state() detects it after the steps.
  if constexpr (std::is_same_v<Law, HertzMindlin>) {
    const ContactPhysics& physics = contact.physics;
    contact.real = hertz_mindlin_step(contact.geometry, contact.physics, Host{*this, contact});
    return !contact.real || is_below(physics.kn, contact.stable_stiffness) || accepts(physics);
  } else {
    return step_named(one, contact, contact.geometry, contact.physics, begun, contact.real);
  }
}

// @param touches out: whether the contact touches
template <class Law>
bool Scene::step_named(const Named<Law>& named, const Contact& contact,
                       const ContactGeometry& geometry, ContactPhysics& physics,
                       FirstTouch& begun_contacts, bool& touches) {
  if (misfit(named, geometry) != Misfit::none) return false;
  if (geometry.penetrationDepth > 0 && !physics.begun) {
    begun_contacts.add(begin(geometry, physics, time, time_step));
  }
  try {
    touches = joint_law_step(named.law, geometry, physics, body(contact.body_1).motion,
                             body(contact.body_2).motion, Host{*this, contact});
  } catch (const std::exception&) {
    return false;
  }
  // A user law may return any number.
  return !touches || is_stable_stiffness(physics.kn, physics, time_step) || accepts(physics);
}

// Finds the contacts with a bore. Returns `undefined` for tilted axes and if the wall's geometry or
// the kernel throws. YADE's own loop repeats the step for every result except `apart` and
// `contact`, and reports the error.
inline BoreSearch Scene::find(const Contact& contact, Bore& bore) {
  const Body& one = body(contact.body_1);
  const Body& two = body(contact.body_2);
  const Strain& strain_1 = strains[contact.strain_1];
  const Strain& strain_2 = strains[contact.strain_2];
  const ThermalLength part{contact.length_1, 1 + strain_1.strain, strain_1.rate};
  const BoreProbe probe{bore.is_ball, part.expanded(), part.length * part.strain_rate,
                        bore.is_ball ? Vector3(Vector3::Zero()) : axis_of(one.orientation)};
  if (!bore.is_ball && tilted_in_bore(probe.axis, *bore.mesh, two.orientation, bore.largest_tilt)) {
    return BoreSearch::undefined;
  }
  const auto geometry = [&]() -> BoreGeometry& {
    if (!bore.has_geometry) {
      bore.geometry = {};
      bore.has_geometry = bore.renewed = true;
    }
    return bore.geometry;
  };
  try {
    return find_in_bore(probe, {*bore.mesh, 1 + strain_2.strain, strain_2.rate, bore.patch_angle},
                        one.motion, two.motion, two.orientation,
                        one.motion.position - two.motion.position, contact.real, time_step,
                        geometry)
        .found;
  } catch (const std::exception&) {
    return BoreSearch::undefined;
  }
}

inline bool Scene::step_in_bore(std::size_t index, const CreatePhysics& make) {
  Contact& contact = contacts[index];
  Bore& bore = bores[contact.bore];
  const BoreSearch found = find(contact, bore);
  if (found == BoreSearch::apart) return true;
  if (found != BoreSearch::contact) return false;
  if (!contact.real) {
    std::optional<ContactPhysics> made = make(index);
    if (!made) return false;
    bore.physics = {};
    static_cast<ContactPhysics&>(bore.physics) = *std::move(made);
    contact.real = contact.renewed = true;
    contact.made = iteration;
  }
  any_contact = true;
  bool valid = true;
  contact.real = bore_law_step(
      bore.geometry, bore.physics, [&](const ContactGeometry& here, ContactPhysics& physics) {
        bool touches = false;
        valid = valid && step_named(bore_law, contact, here, physics, begun_in_bores, touches);
        return touches;
      });
  if (!contact.real) {
    bore.geometry = {};
    bore.physics = {};
    bore.has_geometry = false;
  }
  return valid;
}

// Detailed check of a stored response that failed the fast check.
[[gnu::cold, gnu::noinline]] inline bool Scene::accepts(const ContactPhysics& physics) const {
  return check_response(physics.kn, physics.normalForce + physics.shearForce, physics, time_step) ==
         ResponseCheck::valid;
}

}  // namespace statejump::stepper
