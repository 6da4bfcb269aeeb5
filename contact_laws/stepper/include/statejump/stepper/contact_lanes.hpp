// SPDX-License-Identifier: GPL-3.0-or-later
// Hertz–Mindlin contact of four contacts at once, as find_revolute(), find_ball(), find_plane() and
// hertz_mindlin_step() compute one. The formulas are those of the kernel, with the arithmetic
// Lanes. This header has the order in which they are called and the choice among their results. It
// applies if the bodies do not rotate and each contact stays open or stays in contact. Lanes with
// any other case are marked as deferred and left to those functions.
#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <vector>

#include "statejump/kernel/contact_law.hpp"
#include "statejump/kernel/frame.hpp"
#include "statejump/kernel/hertz.hpp"
#include "statejump/kernel/joint_kinematics.hpp"
#include "statejump/kernel/mindlin.hpp"
#include "statejump/stepper/arrays.hpp"
#include "statejump/stepper/contact.hpp"
#include "statejump/stepper/pack.hpp"

namespace statejump::stepper {

/// State of up to four contacts of one joint type. Unused lanes repeat the first contact.
struct ContactLanes {
  std::size_t first;  ///< index in Scene::contacts; the contacts are consecutive
  std::size_t count;
  Joint joint;
  std::array<std::size_t, lanes> body_1, body_2, strain_1, strain_2;
  std::array<bool, lanes> moves_1, moves_2;
  bool any_moves_2, damps_normal, damps_tangential;
  bool spins;  // false: no body has a spin
  Mask used, real;
  Pack length_1, length_2;  // [m]
  Pack3 axis;               // unit axis of the bearing; for a plane its normal
  Pack3 position_2, velocity_2, spin_1, spin_2;
  Pack young, shear, friction, normal_damping, tangential_damping, mass;
  Pack stable_stiffness;  // [N/m]
  // State of a real contact.
  Pack3 normal, tangential_force;  // tangential_force on body 1 [N]
  Pack stiffness;                  // tangential [N/m]
  Mask slipping;
  Pack elastic_force, elastic_energy, clearance, radius;  // of the last step

  /// Loads the state of a contact into a lane. The other members do not change between steps.
  void load(std::size_t lane, const Contact& contact) {
    const ContactPhysics& physics = contact.physics;
    real[lane] = contact.real ? -1 : 0;
    young[lane] = physics.effectiveYoungModulus;
    shear[lane] = physics.effectiveShearModulus;
    friction[lane] = physics.tangensOfFrictionAngle;
    normal_damping[lane] = physics.normalDampingRatio;
    tangential_damping[lane] = physics.tangentialDampingRatio;
    damps_normal = any(normal_damping > 0);
    damps_tangential = any(tangential_damping > 0);
    mass[lane] = physics.effectiveMass;
    stable_stiffness[lane] = contact.stable_stiffness;
    put(normal, lane, contact.geometry.normal);
    put(tangential_force, lane, -physics.shearForce);
    stiffness[lane] = physics.ks;
    slipping[lane] = physics.slipping ? -1 : 0;
    elastic_force[lane] = physics.previousElasticForce;
    elastic_energy[lane] = physics.previousElasticEnergy;
    clearance[lane] = physics.previousClearance;
    radius[lane] = physics.previousRadius;
  }

  /// Writes the state of a lane that the next scalar step needs back to its contact.
  void unload(std::size_t lane, Contact& contact) const {
    if (!contact.real) return;
    ContactPhysics& physics = contact.physics;
    contact.geometry.normal = get(normal, lane);
    physics.shearForce = -get(tangential_force, lane);
    physics.ks = stiffness[lane];
    physics.slipping = slipping[lane] != 0;
    physics.previousElasticForce = elastic_force[lane];
    physics.previousElasticEnergy = elastic_energy[lane];
    physics.previousClearance = clearance[lane];
    physics.previousRadius = radius[lane];
  }
};

/// Results of four contacts in one step.
struct LanesStep {
  Mask deferred;  ///< left to the scalar functions: the contact begins, ends or fails
  Mask touches;   ///< among the other lanes: in contact; the remaining ones are open
  Pack3 force;    ///< on body 1 [N]
  Pack friction, damping, thermal_work;  ///< as in ContactEnergy
};

/// Motion of body 1 or 2 in each lane.
struct MotionLanes {
  Pack3 position, velocity;
};

namespace detail {

/// is_below(), lane by lane.
[[gnu::always_inline]] inline Mask are_below(const Pack& stiffness, const Pack& largest) {
  return stiffness < largest;
}

/// Geometry of four contacts.
struct LanesGeometry {
  Pack3 centres;  ///< from body 2 to body 1 [m]
  Pack3 normal;
  Pack eccentricity, depth, radius;  ///< [m]
};

/// Finds the geometry of four contacts, as find_revolute(), find_ball() and find_plane() do for
/// one.
/// @param deferred on return includes contacts that begin or fail
[[gnu::always_inline]] inline LanesGeometry find_lanes(const ContactLanes& at, const Pack3& centres,
                                                       const Pack& length_1, const Pack& length_2,
                                                       Mask& deferred) {
  LanesGeometry found;
  found.centres = centres;
  if (at.joint == Joint::plane) {
    found.normal = at.axis;
    found.eccentricity = dot(centres, found.normal);
    found.depth = kernel::depth_in_plane<Lanes>(found.eccentricity, length_1, length_2);
    found.radius = length_1;
    deferred = ~at.real & ~(found.depth <= 0.0);
    return found;
  }
  Pack3 offset = centres;
  if (at.joint == Joint::revolute) offset = kernel::perpendicular_part<Lanes>(centres, at.axis);
  const Pack squared = dot(offset, offset);
  const Pack gap = length_2 - length_1;
  const Mask open = squared <= gap * gap;
  deferred = ~((length_1 > 0.0) & (length_2 > length_1) &
               (length_2 < std::numeric_limits<double>::infinity())) |
             (~at.real & ~open) | (at.real & ~(squared > std::numeric_limits<double>::min()));
  found.eccentricity = root(squared);
  found.normal = offset * (1.0 / found.eccentricity);
  found.depth = kernel::depth_inside<Lanes>(found.eccentricity, length_1, length_2);
  found.radius = kernel::radius_inside<Lanes>(length_1, length_2);
  return found;
}

/// Velocity of body 1 relative to body 2, of the material at the contact point [m/s].
[[gnu::always_inline]] inline Pack3 relative_velocity(const ContactLanes& at,
                                                      const MotionLanes& one,
                                                      const MotionLanes& two,
                                                      const LanesGeometry& geometry,
                                                      const Pack& length_1) {
  if (!at.spins) return one.velocity - two.velocity;
  const Pack3 arm_1 = kernel::arm_of_first<Lanes>(length_1, geometry.depth, geometry.normal);
  const Pack3 arm_2 = geometry.centres + arm_1;
  return kernel::material_velocity<Lanes>(one.velocity, at.spin_1, arm_1) -
         kernel::material_velocity<Lanes>(two.velocity, at.spin_2, arm_2);
}

/// Normal forces of four contacts.
struct LanesNormal {
  kernel::HertzStateOf<Lanes> elastic;
  Pack force;           ///< [N]
  Pack approach_speed;  ///< [m/s]
  Pack damping_power;   ///< [W]
};

/// Normal forces of four contacts, as by contact_step().
/// @param deferred on return includes unstable contacts
[[gnu::always_inline]] inline LanesNormal normal_lanes(const ContactLanes& at,
                                                       const LanesGeometry& geometry,
                                                       const Pack3& velocity, Mask& deferred) {
  LanesNormal normal;
  normal.elastic = kernel::hertz<Lanes>(at.young, geometry.radius, geometry.depth);
  const auto& [elastic_force, stiffness, contact_radius, energy] = normal.elastic;
  // Without overlap the root is not positive. A stable stiffness implies that both moduli are > 0.
  deferred |= at.real & ~((contact_radius > 0.0) & are_below(stiffness, at.stable_stiffness));
  normal.approach_speed = dot(velocity, geometry.normal);
  normal.force = elastic_force;
  normal.damping_power = Pack{};
  if (at.damps_normal) {
    const Pack damping = kernel::viscous_damping<Lanes>(at.normal_damping, at.mass, stiffness);
    normal.force = at.normal_damping > 0.0 ? kernel::damped_normal_force<Lanes>(
                                                 elastic_force, damping, normal.approach_speed)
                                           : elastic_force;
    normal.damping_power = (normal.force - elastic_force) * normal.approach_speed;
  }
  return normal;
}

/// Tangential forces of four contacts.
struct LanesFriction {
  Pack3 velocity;  ///< tangential [m/s]
  Pack3 force;     ///< of the spring on body 1 [N]
  Pack stiffness;  ///< k_t [N/m]
  Pack limit;      ///< mu F_N [N]
  Pack loss;       ///< of this step [J]
  Mask slipping;
};

/// Friction of four contacts, as by mindlin_step().
/// @param deferred on return includes contacts whose normal reverses
[[gnu::always_inline]] inline LanesFriction friction_lanes(const ContactLanes& at,
                                                           const Pack3& normal,
                                                           const LanesNormal& pressed,
                                                           const Pack3& velocity, double time_step,
                                                           Mask& deferred) {
  deferred |= at.real & ~kernel::have_rotation<Lanes>(at.normal, normal);
  const Pack3 old_force =
      kernel::transport_untwisted<Lanes>(at.tangential_force, at.normal, normal, at.real);
  LanesFriction friction;
  friction.stiffness = kernel::mindlin_stiffness<Lanes>(at.shear, pressed.elastic.contact_radius);
  friction.limit = at.friction * pressed.force;
  friction.velocity = velocity - normal * pressed.approach_speed;
  const Pack3 slide = friction.velocity * time_step;
  const Mask free = ~(friction.limit > 0.0);
  const auto before = kernel::spring_before<Lanes>(old_force, at.stiffness, slide);
  const auto spring = kernel::spring_step<Lanes>(friction.stiffness, friction.limit, slide,
                                                 old_force, before, at.real & ~free);
  friction.force = select(free, Pack3{}, spring.force);
  friction.slipping = spring.slipping | free;
  friction.loss = free ? not_negative(0.5 * before.released()) : spring.dissipation;
  return friction;
}

/// Tangential force of four contacts, as by contact_step().
/// @param damping_loss set to the loss of this step, if there is damping [J]
/// @return tangential force with its viscous part [N]
[[gnu::always_inline]] inline Pack3 damp_lanes(const ContactLanes& at,
                                               const LanesFriction& friction, double time_step,
                                               Pack& damping_loss) {
  const Pack3& spring = friction.force;
  if (!at.damps_tangential) return spring;
  const Mask damped = (at.tangential_damping > 0.0) & ~friction.slipping;
  const Pack damping =
      kernel::viscous_damping<Lanes>(at.tangential_damping, at.mass, friction.stiffness);
  Pack3 sum = spring;
  const Pack power = kernel::add_tangential_damping<Lanes>(damping, friction.limit,
                                                           friction.velocity, damped, sum);
  damping_loss = damped ? power * time_step : 0.0;
  return select(damped, sum, spring);
}

/// As account(); updates the stored energy state of touching lanes.
/// @param damping_loss of the tangential forces in this step [J]
[[gnu::always_inline]] inline void account_lanes(ContactLanes& at, const LanesGeometry& geometry,
                                                 const LanesNormal& normal,
                                                 const LanesFriction& friction,
                                                 const Pack& damping_loss, double time_step,
                                                 LanesStep& step) {
  step.friction = friction.loss;
  step.damping = normal.damping_power * time_step + damping_loss;
  const auto& [elastic_force, stiffness, contact_radius, energy] = normal.elastic;
  const Pack clearance = geometry.eccentricity - geometry.depth;
  const Pack work =
      work_of_clearance<Lanes>(elastic_force, at.elastic_force, clearance, at.clearance) +
      work_of_radius<Lanes>(energy, at.elastic_energy, geometry.radius, at.radius);
  step.thermal_work = at.radius > 0.0 ? work : 0.0;
  at.elastic_force = step.touches ? elastic_force : at.elastic_force;
  at.elastic_energy = step.touches ? energy : at.elastic_energy;
  at.clearance = step.touches ? clearance : at.clearance;
  at.radius = step.touches ? geometry.radius : at.radius;
}

}  // namespace detail

/// One step of four contacts. Touching lanes receive their new state; deferred lanes keep the old
/// one.
/// @param length_1, length_2 current radii [m]; for a plane contact, pad radius and face distance
template <bool tracks_energy>
[[gnu::always_inline]] inline LanesStep step_lanes(ContactLanes& at, const MotionLanes& one,
                                                   const MotionLanes& two, const Pack& length_1,
                                                   const Pack& length_2, double time_step) {
  LanesStep step{};
  const detail::LanesGeometry geometry =
      detail::find_lanes(at, one.position - two.position, length_1, length_2, step.deferred);
  if (!any(at.real)) {
    step.deferred &= at.used;
    return step;
  }
  const Pack3 velocity = detail::relative_velocity(at, one, two, geometry, length_1);
  const detail::LanesNormal normal = detail::normal_lanes(at, geometry, velocity, step.deferred);
  const detail::LanesFriction friction =
      detail::friction_lanes(at, geometry.normal, normal, velocity, time_step, step.deferred);
  Pack damping_loss{};
  const Pack3 tangential_force = detail::damp_lanes(at, friction, time_step, damping_loss);
  step.force = tangential_force - geometry.normal * normal.force;
  step.deferred &= at.used;
  step.touches = at.real & at.used & ~step.deferred;
  if constexpr (tracks_energy) {
    detail::account_lanes(at, geometry, normal, friction, damping_loss, time_step, step);
  }
  at.normal = select(step.touches, geometry.normal, at.normal);
  at.tangential_force = select(step.touches, friction.force, at.tangential_force);
  at.stiffness = step.touches ? friction.stiffness : at.stiffness;
  at.slipping = step.touches ? friction.slipping : at.slipping;
  return step;
}

}  // namespace statejump::stepper
