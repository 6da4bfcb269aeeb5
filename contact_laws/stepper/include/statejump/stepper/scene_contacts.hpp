// SPDX-License-Identifier: GPL-3.0-or-later
// Contacts of a scene in one step: where they touch, what their laws answer. Part of scene.hpp.
#pragma once

#include <cstddef>
#include <exception>
#include <optional>
#include <type_traits>
#include <utility>

#include "statejump/stepper/scene.hpp"

namespace statejump::stepper {

inline Found Scene::find(Contact& contact) {
  const Body& one = body(contact.body_1);
  const Body& two = body(contact.body_2);
  const Strain& strain_1 = strains[contact.strain_1];
  const Strain& strain_2 = strains[contact.strain_2];
  const Part part_1{contact.length_1, 1 + strain_1.strain, strain_1.rate};
  const Part part_2{contact.length_2, 1 + strain_2.strain, strain_2.rate};
  const auto geometry = [&](const Vector3& first_normal) -> ContactGeometry& {
    if (!contact.real) {
      contact.geometry = {};
      contact.geometry.normal = first_normal;
    }
    return contact.geometry;
  };
  switch (contact.joint) {
    case Joint::revolute: {
      const Vector3 axis = contact.turns ? axis_of(two.orientation) : contact.axis;
      const auto tilted = [&] { return contact.turns ? tilt(one, axis) : contact.tilted; };
      return find_revolute(part_1, part_2, one.motion, two.motion, axis, contact.real, time_step,
                           tilted, geometry);
    }
    case Joint::ball:
      return find_ball(part_1, part_2, one.motion, two.motion, contact.real, time_step, geometry);
    case Joint::outer_balls:
      return find_outer_balls(part_1, part_2, one.motion, two.motion, contact.real, time_step,
                              geometry);
    case Joint::bore:  // step_in_bore()
    case Joint::plane:
      break;
  }
  const Vector3 normal = two.orientation * contact.face_normal;
  return find_plane(part_1, part_2, one.motion, two.motion, normal, contact.real, time_step,
                    geometry);
}

template <class Law>
bool Scene::step_contact(const Law& one, std::size_t place, const Make& make) {
  Contact& contact = contacts[place];
  if (contact.joint == Joint::bore) return step_in_bore(place, make);
  const Found found = find(contact);
  if (found == Found::apart) return true;
  if (found != Found::contact) return false;
  if (!contact.real) {
    const std::optional<ContactPhysics> made = make(place);
    if (!made) return false;
    contact.physics = *made;
    contact.plain_stiffness = plain_stiffness(contact.physics, time_step);
    contact.real = contact.renewed = true;
    contact.made = iteration;
  }
  any_contact = true;
  // Asked behind all that is computed, which is quicker; a step that cannot be made is left half
  // made anyway. A force that is no number stays none: is_sound() sees it when the steps are made.
  if constexpr (std::is_same_v<Law, HertzMindlin>) {
    const ContactPhysics& physics = contact.physics;
    contact.real = hertz_mindlin_step(contact.geometry, contact.physics, Host{*this, contact});
    return !contact.real || is_below(physics.kn, contact.plain_stiffness) || accepts(physics);
  } else {
    return step_named(one, contact, contact.geometry, contact.physics, begun, contact.real);
  }
}

// @param touches becomes whether the contact is not open
template <class Law>
bool Scene::step_named(const Named<Law>& named, const Contact& contact,
                       const ContactGeometry& geometry, ContactPhysics& physics,
                       Begun& begun_contacts, bool& touches) {
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
  // A law of one's own may answer anything.
  return !touches || is_plain_stiffness(physics.kn, physics, time_step) || accepts(physics);
}

// What the wall's geometry and the kernel throw is for the ordinary loop to tell, as all that is
// neither apart nor contact.
inline InBore Scene::find(const Contact& contact, Bore& bore) {
  const Body& one = body(contact.body_1);
  const Body& two = body(contact.body_2);
  const Strain& strain_1 = strains[contact.strain_1];
  const Strain& strain_2 = strains[contact.strain_2];
  const Part part{contact.length_1, 1 + strain_1.strain, strain_1.rate};
  const BoreProbe probe{bore.is_ball, part.expanded(), part.length * part.strain_rate,
                        bore.is_ball ? Vector3(Vector3::Zero()) : axis_of(one.orientation)};
  if (!bore.is_ball && tilted_in_bore(probe.axis, *bore.mesh, two.orientation, bore.largest_tilt)) {
    return InBore::nowhere;
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
    return InBore::nowhere;
  }
}

inline bool Scene::step_in_bore(std::size_t place, const Make& make) {
  Contact& contact = contacts[place];
  Bore& bore = bores[contact.bore];
  const InBore found = find(contact, bore);
  if (found == InBore::apart) return true;
  if (found != InBore::contact) return false;
  if (!contact.real) {
    std::optional<ContactPhysics> made = make(place);
    if (!made) return false;
    bore.physics = {};
    static_cast<ContactPhysics&>(bore.physics) = *std::move(made);
    contact.real = contact.renewed = true;
    contact.made = iteration;
  }
  any_contact = true;
  bool good = true;
  contact.real = bore_law_step(
      bore.geometry, bore.physics, [&](const ContactGeometry& here, ContactPhysics& physics) {
        bool touches = false;
        good = good && step_named(bore_law, contact, here, physics, begun_in_bores, touches);
        return touches;
      });
  if (!contact.real) {
    bore.geometry = {};
    bore.physics = {};
    bore.has_geometry = false;
  }
  return good;
}

// Whether what a contact keeps of its step is good after all.
[[gnu::cold, gnu::noinline]] inline bool Scene::accepts(const ContactPhysics& physics) const {
  return judge(physics.kn, physics.normalForce + physics.shearForce, physics, time_step) ==
         Answer::good;
}

}  // namespace statejump::stepper
