// SPDX-License-Identifier: GPL-3.0-or-later
// Hertz and Mindlin for four contacts at once: the formulas of the kernel on packs, in the order of
// find_revolute(), find_ball(), find_plane() and hertz_mindlin_step() and without branches. The
// bodies do not rotate, and each contact stays open or stays in contact. Any other case is detected
// and left unchanged for those functions.
#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <vector>

#include "statejump/stepper/arrays.hpp"
#include "statejump/stepper/pack.hpp"

namespace statejump::stepper {

/// Up to four contacts of one joint type and their state. Unused lanes repeat the first contact.
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

  /// Loads the state of a contact. The other members do not change between steps.
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

  /// Writes back the state that the next scalar step of the contact needs.
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

using PackPoints = kernel::PointFormulas<PackLanes>;

/// kernel::transport() without twist. @param left gains the lanes with opposite normals
[[gnu::always_inline]] inline Pack3 transport(const Pack3& tangential, const Pack3& n_old,
                                              const Pack3& n_new, const Mask& real,
                                              Mask& deferred) {
  using Formulas = kernel::Transport<PackLanes>;
  const Pack3 half = n_old + n_new;
  const Pack half_squared = dot(half, half);
  deferred |= real & ~(half_squared > kernel::smallest_half_squared);
  return Formulas::rescaled(Formulas::turned(tangential, n_new, half, half_squared), n_new,
                            dot(tangential, tangential), real);
}

/// Geometry of four contacts.
struct LanesGeometry {
  Pack3 centres;  ///< from body 2 to body 1 [m]
  PackPoints::Point point;
  Pack radius;  ///< effective [m]
};

/// As find_revolute(), find_ball(), find_plane(). @param deferred gains contacts that begin or fail
[[gnu::always_inline]] inline LanesGeometry find_lanes(const ContactLanes& at, const Pack3& centres,
                                                       const Pack& length_1, const Pack& length_2,
                                                       Mask& deferred) {
  LanesGeometry found;
  found.centres = centres;
  if (at.joint == Joint::plane) {
    found.point = PackPoints::plane_point(centres, at.axis, length_1, length_2);
    found.radius = length_1;
    deferred = ~at.real & ~(found.point.depth <= 0.0);
    return found;
  }
  Pack3 offset = centres;
  if (at.joint == Joint::revolute) offset = PackPoints::perpendicular_part(centres, at.axis);
  const Pack squared = dot(offset, offset);
  const Pack gap = length_2 - length_1;
  const Mask open = PackPoints::is_apart(squared, gap);
  deferred = ~((length_1 > 0.0) & (length_2 > length_1) &
               (length_2 < std::numeric_limits<double>::infinity())) |
             (~at.real & ~open) | (at.real & ~(squared > std::numeric_limits<double>::min()));
  found.point = PackPoints::round_point(offset, squared, gap);
  found.radius = kernel::internal_effective_radius<PackLanes>(length_1, length_2, gap);
  return found;
}

/// Velocity of body 1 relative to body 2, of the material at the contact point [m/s].
[[gnu::always_inline]] inline Pack3 relative_velocity(const ContactLanes& at,
                                                      const MotionLanes& one,
                                                      const MotionLanes& two,
                                                      const LanesGeometry& geometry,
                                                      const Pack& length_1) {
  if (!at.spins) return one.velocity - two.velocity;
  const Pack3 arm_1 = PackPoints::arm_1(geometry.point.normal, length_1, geometry.point.depth);
  const Pack3 arm_2 = geometry.centres + arm_1;
  return PackPoints::material_velocity(one.velocity, at.spin_1, arm_1) -
         PackPoints::material_velocity(two.velocity, at.spin_2, arm_2);
}

/// Normal forces of four contacts.
struct LanesNormal {
  kernel::HertzLanes<PackLanes> elastic;
  Pack force;           ///< [N]
  Pack approach_speed;  ///< [m/s]
  Pack damping_power;   ///< [W]
};

/// As hertz() and the normal part of contact_step(). @param deferred gains unstable contacts
[[gnu::always_inline]] inline LanesNormal normal_lanes(const ContactLanes& at,
                                                       const LanesGeometry& geometry,
                                                       const Pack3& velocity, Mask& deferred) {
  LanesNormal normal;
  normal.elastic =
      kernel::hertz_overlap<PackLanes>(at.young, geometry.radius, geometry.point.depth);
  const Pack& stiffness = normal.elastic.stiffness;
  // The root is not positive without overlap. A stable stiffness implies both moduli > 0.
  deferred |= at.real &
              ~((normal.elastic.contact_radius > 0.0) & are_below(stiffness, at.stable_stiffness));
  normal.approach_speed = dot(velocity, geometry.point.normal);
  normal.force = normal.elastic.force;
  normal.damping_power = Pack{};
  if (at.damps_normal) {
    const Pack damping = kernel::viscous_damping<PackLanes>(at.normal_damping, at.mass, stiffness);
    const Mask damped = at.normal_damping > 0.0;
    normal.force = damped ? kernel::damped_normal_force<PackLanes>(normal.elastic.force, damping,
                                                                   normal.approach_speed)
                          : normal.force;
    normal.damping_power = (normal.force - normal.elastic.force) * normal.approach_speed;
  }
  return normal;
}

/// Tangential forces of four contacts.
struct LanesFriction {
  Pack3 velocity;  ///< tangential [m/s]
  Pack3 force;     ///< spring force on body 1 [N]
  Pack stiffness;  ///< k_t [N/m]
  Pack limit;      ///< mu F_N [N]
  Mask free;       ///< no friction
  Mask slipping;
};

/// As mindlin_step(). @param step receives the friction loss; its deferred gains contacts whose
/// normal reverses
template <bool tracks_energy>
[[gnu::always_inline]] inline LanesFriction friction_lanes(const ContactLanes& at,
                                                           const Pack3& normal,
                                                           const LanesNormal& pressed,
                                                           const Pack3& velocity, double time_step,
                                                           LanesStep& step) {
  LanesFriction friction;
  const Pack3 old_force = transport(at.tangential_force, at.normal, normal, at.real, step.deferred);
  friction.stiffness =
      kernel::mindlin_stiffness<PackLanes>(at.shear, pressed.elastic.contact_radius);
  friction.limit = at.friction * pressed.force;
  friction.velocity = velocity - normal * pressed.approach_speed;
  const kernel::MindlinSpring<PackLanes> spring = kernel::mindlin_spring<PackLanes>(
      friction.stiffness, friction.limit, friction.velocity * time_step, old_force, at.stiffness,
      at.real);
  friction.force = spring.force;
  friction.free = spring.free;
  friction.slipping = spring.slipping | spring.free;
  if constexpr (tracks_energy) step.friction = spring.dissipation;
  return friction;
}

/// As the tangential part of contact_step(). @param damping_loss set if energy is tracked [J]
/// @return tangential force with its viscous part [N]
template <bool tracks_energy>
[[gnu::always_inline]] inline Pack3 damp_lanes(const ContactLanes& at,
                                               const LanesFriction& friction, double time_step,
                                               Pack& damping_loss) {
  if (!at.damps_tangential) return friction.force;
  const Mask damped = (at.tangential_damping > 0.0) & ~friction.free & ~friction.slipping;
  const Pack damping =
      kernel::viscous_damping<PackLanes>(at.tangential_damping, at.mass, friction.stiffness);
  Pack3 sum = friction.force;
  const Pack power = kernel::add_tangential_damping<PackLanes>(damping, friction.limit,
                                                               friction.velocity, sum, damped);
  if constexpr (tracks_energy) damping_loss = damped ? power * time_step : 0.0;
  return select(damped, sum, friction.force);
}

/// As account(); updates the stored energy state of touching lanes.
[[gnu::always_inline]] inline void account_lanes(ContactLanes& at, const LanesGeometry& geometry,
                                                 const LanesNormal& normal, double time_step,
                                                 LanesStep& step) {
  step.damping = normal.damping_power * time_step + step.damping;
  using Work = ThermalWork<PackLanes>;
  const Pack& force = normal.elastic.force;
  const Pack& energy = normal.elastic.elastic_energy;
  const Pack clearance = geometry.point.eccentricity - geometry.point.depth;
  Pack work = Work::of_clearance(force, at.elastic_force, clearance, at.clearance);
  work += Work::of_radius(energy, at.elastic_energy, geometry.radius, at.radius);
  step.thermal_work = at.radius > 0.0 ? work : 0.0;
  at.elastic_force = step.touches ? force : at.elastic_force;
  at.elastic_energy = step.touches ? energy : at.elastic_energy;
  at.clearance = step.touches ? clearance : at.clearance;
  at.radius = step.touches ? geometry.radius : at.radius;
}

}  // namespace detail

/// One step of four contacts. Touching lanes receive their new state; deferred lanes keep the old
/// one.
/// @param length_1, length_2 current radii; for a plane, pad radius and face distance [m]
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
  const detail::LanesFriction friction = detail::friction_lanes<tracks_energy>(
      at, geometry.point.normal, normal, velocity, time_step, step);
  const Pack3 tangential_force =
      detail::damp_lanes<tracks_energy>(at, friction, time_step, step.damping);
  step.force = tangential_force - geometry.point.normal * normal.force;
  step.deferred &= at.used;
  step.touches = at.real & at.used & ~step.deferred;
  if constexpr (tracks_energy) detail::account_lanes(at, geometry, normal, time_step, step);
  at.normal = select(step.touches, geometry.point.normal, at.normal);
  at.tangential_force = select(step.touches, friction.force, at.tangential_force);
  at.stiffness = step.touches ? friction.stiffness : at.stiffness;
  at.slipping = step.touches ? friction.slipping : at.slipping;
  return step;
}

}  // namespace statejump::stepper
