// SPDX-License-Identifier: GPL-3.0-or-later
// Hertz–Mindlin contact of four contacts at once: the operations of find_revolute(), find_ball(),
// find_plane() and hertz_mindlin_step(), in the same order and without branches. It applies if the
// bodies do not rotate and each contact stays open or stays in contact. Lanes with any other case
// are marked as deferred and left to those functions.
#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <vector>

#include "statejump/stepper/arrays.hpp"
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

/// kernel::transport() without twist. @param deferred gains the lanes with opposite normals
[[gnu::always_inline]] inline Pack3 transport(const Pack3& tangential, const Pack3& n_old,
                                              const Pack3& n_new, const Mask& real,
                                              Mask& deferred) {
  const Pack magnitude_squared = dot(tangential, tangential);
  const Pack3 half = n_old + n_new;
  const Pack half_squared = dot(half, half);
  deferred |= real & ~(half_squared > 1e-16);
  Pack3 turned = tangential - half * (2.0 * dot(tangential, n_new) / half_squared);
  turned = turned - n_new * dot(turned, n_new);
  const Pack ratio = dot(turned, turned) / magnitude_squared;
  const Mask vanishes = (magnitude_squared <= 0.0) | (ratio <= 1e-30);
  const Pack excess = 1.0 - ratio;
  const Mask far = ~(absolute(excess) < 1e-8);
  Pack factor = 1.0 + 0.5 * excess;
  if (any(real & far & ~vanishes)) factor = far ? 1.0 / root(ratio) : factor;
  return select(vanishes, Pack3{}, turned * factor);
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
    found.depth = length_1 - (length_2 - found.eccentricity);
    found.radius = length_1;
    deferred = ~at.real & ~(found.depth <= 0.0);
    return found;
  }
  Pack3 offset = centres;
  if (at.joint == Joint::revolute) offset = centres - at.axis * dot(centres, at.axis);
  const Pack squared = dot(offset, offset);
  const Pack gap = length_2 - length_1;
  const Mask open = squared <= gap * gap;
  deferred = ~((length_1 > 0.0) & (length_2 > length_1) &
               (length_2 < std::numeric_limits<double>::infinity())) |
             (~at.real & ~open) | (at.real & ~(squared > std::numeric_limits<double>::min()));
  found.eccentricity = root(squared);
  found.normal = offset * (1.0 / found.eccentricity);
  found.depth = found.eccentricity - gap;
  found.radius = length_1 * (length_2 / gap);
  return found;
}

/// Velocity of body 1 relative to body 2, of the material at the contact point [m/s].
[[gnu::always_inline]] inline Pack3 relative_velocity(const ContactLanes& at,
                                                      const MotionLanes& one,
                                                      const MotionLanes& two,
                                                      const LanesGeometry& geometry,
                                                      const Pack& length_1) {
  if (!at.spins) return one.velocity - two.velocity;
  const Pack3 arm_1 = geometry.normal * (length_1 - 0.5 * geometry.depth);
  const Pack3 arm_2 = geometry.centres + arm_1;
  return (one.velocity + cross(at.spin_1, arm_1)) - (two.velocity + cross(at.spin_2, arm_2));
}

/// Normal forces of four contacts.
struct LanesNormal {
  Pack contact_radius;        ///< a [m]
  Pack elastic_force, force;  ///< [N]
  Pack approach_speed;        ///< [m/s]
  Pack damping_power;         ///< [W]
};

/// Normal forces of four contacts, as by hertz() and contact_step().
/// @param deferred on return includes unstable contacts
[[gnu::always_inline]] inline LanesNormal normal_lanes(const ContactLanes& at,
                                                       const LanesGeometry& geometry,
                                                       const Pack3& velocity, Mask& deferred) {
  LanesNormal normal;
  normal.contact_radius = root(geometry.radius * geometry.depth);
  const Pack stiffness = 2.0 * at.young * normal.contact_radius;
  // Without overlap the root is not positive. A stable stiffness implies that both moduli are > 0.
  deferred |=
      at.real & ~((normal.contact_radius > 0.0) & are_below(stiffness, at.stable_stiffness));
  normal.elastic_force = 2.0 / 3.0 * stiffness * geometry.depth;
  normal.approach_speed = dot(velocity, geometry.normal);
  normal.force = normal.elastic_force;
  normal.damping_power = Pack{};
  if (at.damps_normal) {
    const Pack damping = 2.0 * at.normal_damping * root(at.mass * stiffness);
    const Mask damped = at.normal_damping > 0.0;
    normal.force = damped ? not_negative(normal.elastic_force + damping * normal.approach_speed)
                          : normal.force;
    normal.damping_power = (normal.force - normal.elastic_force) * normal.approach_speed;
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

/// Friction of four contacts, as by mindlin_step().
/// @param step receives the friction loss; its `deferred` on return includes contacts whose normal
///     reverses
template <bool tracks_energy>
[[gnu::always_inline]] inline LanesFriction friction_lanes(const ContactLanes& at,
                                                           const Pack3& normal,
                                                           const LanesNormal& pressed,
                                                           const Pack3& velocity, double time_step,
                                                           LanesStep& step) {
  LanesFriction friction;
  const Pack3 old_force = transport(at.tangential_force, at.normal, normal, at.real, step.deferred);
  friction.stiffness = 8.0 * at.shear * pressed.contact_radius;
  friction.limit = at.friction * pressed.force;
  friction.velocity = velocity - normal * pressed.approach_speed;
  const Pack& limit = friction.limit;
  const Pack3 slide = friction.velocity * time_step;
  const Mask stored = at.stiffness > 0.0;
  const Pack old_compliance = stored ? 1.0 / at.stiffness : 0.0;
  friction.free = ~(limit > 0.0);
  const Mask loading = (friction.stiffness >= at.stiffness) & stored;
  const Pack kept = loading ? 1.0 : friction.stiffness * old_compliance;
  Pack3 force = old_force * kept - slide * friction.stiffness;
  const Pack force_squared = dot(force, force);
  friction.slipping = force_squared > limit * limit;
  const bool slips = any(friction.slipping & at.real & ~friction.free);
  Pack compliance, old_squared, old_work;
  if constexpr (tracks_energy) {
    compliance = 1.0 / friction.stiffness;
    old_squared = dot(old_force, old_force);
    old_work = dot(old_force, slide);
    step.friction = loading ? 0.5 * old_squared * (old_compliance - compliance)
                            : 0.5 * (1.0 - kept) * (old_squared * old_compliance - old_work);
  }
  if (slips) {
    const Pack trial = root(force_squared);
    const Pack3 direction = force * (1.0 / trial);
    if constexpr (tracks_energy) {
      const Pack slip = (trial - limit) * compliance;
      const Pack loss = 0.5 * (kept * dot(old_force, direction) + limit) * slip;
      step.friction = friction.slipping ? step.friction + loss : step.friction;
    }
    force = select(friction.slipping, direction * limit, force);
  }
  friction.force = select(friction.free, Pack3{}, force);
  friction.slipping |= friction.free;
  if constexpr (tracks_energy) {
    const Pack released = 0.5 * (old_squared * old_compliance - old_work);
    step.friction = not_negative(friction.free ? released : step.friction);
  }
  return friction;
}

/// Tangential force of four contacts, as by contact_step().
/// @param damping_loss set if energy is tracked [J]
/// @return tangential force with its viscous part [N]
template <bool tracks_energy>
[[gnu::always_inline]] inline Pack3 damp_lanes(const ContactLanes& at,
                                               const LanesFriction& friction, double time_step,
                                               Pack& damping_loss) {
  if (!at.damps_tangential) return friction.force;
  const Mask damped = (at.tangential_damping > 0.0) & ~friction.free & ~friction.slipping;
  const Pack damping = 2.0 * at.tangential_damping * root(at.mass * friction.stiffness);
  Pack3 sum = friction.force - friction.velocity * damping;
  const Pack squared = dot(sum, sum);
  const Mask over = squared > friction.limit * friction.limit;
  if (any(over & damped)) sum = select(over, sum * (friction.limit / root(squared)), sum);
  if constexpr (tracks_energy) {
    const Pack power = over ? not_negative(dot(friction.force - sum, friction.velocity))
                            : damping * dot(friction.velocity, friction.velocity);
    damping_loss = damped ? power * time_step : 0.0;
  }
  return select(damped, sum, friction.force);
}

/// As account(); updates the stored energy state of touching lanes.
[[gnu::always_inline]] inline void account_lanes(ContactLanes& at, const LanesGeometry& geometry,
                                                 const LanesNormal& normal, double time_step,
                                                 LanesStep& step) {
  step.damping = normal.damping_power * time_step + step.damping;
  const Pack energy = 0.4 * normal.elastic_force * geometry.depth;
  const Pack clearance = geometry.eccentricity - geometry.depth;
  Pack work = -(0.5 * (normal.elastic_force + at.elastic_force)) * (clearance - at.clearance);
  work += 0.5 * (energy + at.elastic_energy) / (2.0 * (0.5 * (geometry.radius + at.radius))) *
          (geometry.radius - at.radius);
  step.thermal_work = at.radius > 0.0 ? work : 0.0;
  at.elastic_force = step.touches ? normal.elastic_force : at.elastic_force;
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
      detail::friction_lanes<tracks_energy>(at, geometry.normal, normal, velocity, time_step, step);
  const Pack3 tangential_force =
      detail::damp_lanes<tracks_energy>(at, friction, time_step, step.damping);
  step.force = tangential_force - geometry.normal * normal.force;
  step.deferred &= at.used;
  step.touches = at.real & at.used & ~step.deferred;
  if constexpr (tracks_energy) detail::account_lanes(at, geometry, normal, time_step, step);
  at.normal = select(step.touches, geometry.normal, at.normal);
  at.tangential_force = select(step.touches, friction.force, at.tangential_force);
  at.stiffness = step.touches ? friction.stiffness : at.stiffness;
  at.slipping = step.touches ? friction.slipping : at.slipping;
  return step;
}

}  // namespace statejump::stepper
