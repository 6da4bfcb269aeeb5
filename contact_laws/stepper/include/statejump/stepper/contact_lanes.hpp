// SPDX-License-Identifier: GPL-3.0-or-later
// Hertz and Mindlin for four contacts at once: the operations of find_revolute(), find_ball(),
// find_plane() and hertz_mindlin_step(), in their order and without their branches, for contacts
// whose bodies do not turn and that are open or touch and go on touching. What else happens to a
// contact is for those functions to do: it is found here, and nothing is changed.
#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <vector>

#include "statejump/stepper/arrays.hpp"
#include "statejump/stepper/pack.hpp"

namespace statejump::stepper {

/// Up to four contacts of one kind of joint, and what they keep from step to step. Lanes that are
/// not used repeat the first.
struct ContactLanes {
  std::size_t first;  ///< place in Scene::contacts; the others follow
  std::size_t count;
  Joint joint;
  std::array<std::size_t, lanes> body_1, body_2, strain_1, strain_2;
  std::array<bool, lanes> moves_1, moves_2;
  bool any_moves_2, damps_normal, damps_tangential;
  bool spins;  // where none does, what spins add is 0
  Mask used, real;
  Pack length_1, length_2;  // [m]
  Pack3 axis;               // unit, of the bearing; of a plane its normal
  Pack3 position_2, velocity_2, spin_1, spin_2;
  Pack young, shear, friction, normal_damping, tangential_damping, mass;
  Pack plain_stiffness;  // [N/m]
  // State of a contact that is real.
  Pack3 normal, tangential_force;  // on body 1 [N]
  Pack stiffness;                  // tangential [N/m]
  Mask slipping;
  Pack elastic_force, elastic_energy, clearance, radius;  // of the last step

  /// Takes over a contact; the rest of a lane stays what it is from step to step.
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
    plain_stiffness[lane] = contact.plain_stiffness;
    put(normal, lane, contact.geometry.normal);
    put(tangential_force, lane, -physics.shearForce);
    stiffness[lane] = physics.ks;
    slipping[lane] = physics.slipping ? -1 : 0;
    elastic_force[lane] = physics.previousElasticForce;
    elastic_energy[lane] = physics.previousElasticEnergy;
    clearance[lane] = physics.previousClearance;
    radius[lane] = physics.previousRadius;
  }

  /// Gives back what the next step of the contact asks for.
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

/// Four contacts of one step.
struct LanesStep {
  Mask left;                             ///< not computed here: it begins, ends or fails
  Mask touches;                          ///< of the others: real, the rest is open
  Pack3 force;                           ///< on body 1 [N]
  Pack friction, damping, thermal_work;  ///< as ContactEnergy
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

/// kernel::transport() without twist. @param left gains the lanes where the normals are opposite
[[gnu::always_inline]] inline Pack3 transport(const Pack3& tangential, const Pack3& n_old,
                                              const Pack3& n_new, const Mask& real, Mask& left) {
  const Pack magnitude_squared = dot(tangential, tangential);
  const Pack3 half = n_old + n_new;
  const Pack half_squared = dot(half, half);
  left |= real & ~(half_squared > 1e-16);
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

}  // namespace detail

/// One step of four contacts. Those that touch have their new state in lanes, those that are left
/// their old.
/// @param length_1, length_2 radii, or pad and distance of the face, as they are now [m]
template <bool tracks_energy>
[[gnu::always_inline]] inline LanesStep step_lanes(ContactLanes& at, const MotionLanes& one,
                                                   const MotionLanes& two, const Pack& length_1,
                                                   const Pack& length_2, double time_step) {
  LanesStep step{};
  const Pack3 centres = one.position - two.position;
  Pack3 normal;
  Pack eccentricity, depth, radius;
  if (at.joint == Joint::plane) {
    normal = at.axis;
    eccentricity = dot(centres, normal);
    depth = length_1 - (length_2 - eccentricity);
    radius = length_1;
    step.left = ~at.real & ~(depth <= 0.0);
  } else {
    Pack3 offset = centres;
    if (at.joint == Joint::revolute) offset = centres - at.axis * dot(centres, at.axis);
    const Pack squared = dot(offset, offset);
    const Pack gap = length_2 - length_1;
    const Mask open = squared <= gap * gap;
    step.left = ~((length_1 > 0.0) & (length_2 > length_1) &
                  (length_2 < std::numeric_limits<double>::infinity())) |
                (~at.real & ~open) | (at.real & ~(squared > std::numeric_limits<double>::min()));
    eccentricity = root(squared);
    normal = offset * (1.0 / eccentricity);
    depth = eccentricity - gap;
    radius = length_1 * (length_2 / gap);
  }
  if (!any(at.real)) {
    step.left &= at.used;
    return step;
  }
  Pack3 velocity;
  if (at.spins) {
    const Pack3 arm_1 = normal * (length_1 - 0.5 * depth);
    const Pack3 arm_2 = centres + arm_1;
    velocity = (one.velocity + cross(at.spin_1, arm_1)) - (two.velocity + cross(at.spin_2, arm_2));
  } else {
    velocity = one.velocity - two.velocity;
  }

  // hertz() and the normal part of contact_step()
  const Pack contact_radius = root(radius * depth);
  const Pack normal_stiffness = 2.0 * at.young * contact_radius;
  // Without a depth there is no root. Both moduli are above 0 where any stiffness is plain.
  step.left |=
      at.real & ~((contact_radius > 0.0) & detail::are_below(normal_stiffness, at.plain_stiffness));
  const Pack elastic_force = 2.0 / 3.0 * normal_stiffness * depth;
  const Pack approach_speed = dot(velocity, normal);
  Pack normal_force = elastic_force;
  Pack damping_power{};
  if (at.damps_normal) {
    const Pack damping = 2.0 * at.normal_damping * root(at.mass * normal_stiffness);
    const Mask damped = at.normal_damping > 0.0;
    normal_force = damped ? not_negative(elastic_force + damping * approach_speed) : normal_force;
    damping_power = (normal_force - elastic_force) * approach_speed;
  }

  // mindlin_step()
  const Pack3 old_force =
      detail::transport(at.tangential_force, at.normal, normal, at.real, step.left);
  const Pack stiffness = 8.0 * at.shear * contact_radius;
  const Pack limit = at.friction * normal_force;
  const Pack3 tangential_velocity = velocity - normal * approach_speed;
  const Pack3 slide = tangential_velocity * time_step;
  const Mask stored = at.stiffness > 0.0;
  const Pack old_compliance = stored ? 1.0 / at.stiffness : 0.0;
  const Mask free = ~(limit > 0.0);
  const Mask loading = (stiffness >= at.stiffness) & stored;
  const Pack kept = loading ? 1.0 : stiffness * old_compliance;
  Pack3 force = old_force * kept - slide * stiffness;
  Pack force_squared = dot(force, force);
  Mask slipping = force_squared > limit * limit;
  const bool slips = any(slipping & at.real & ~free);
  Pack compliance, old_squared, old_work;
  if constexpr (tracks_energy) {
    compliance = 1.0 / stiffness;
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
      step.friction = slipping ? step.friction + loss : step.friction;
    }
    force = select(slipping, direction * limit, force);
  }
  force = select(free, Pack3{}, force);
  slipping |= free;
  if constexpr (tracks_energy) {
    const Pack released = 0.5 * (old_squared * old_compliance - old_work);
    step.friction = not_negative(free ? released : step.friction);
  }

  // the tangential part of contact_step()
  Pack3 with_damping = force;
  if (at.damps_tangential) {
    const Mask damped = (at.tangential_damping > 0.0) & ~free & ~slipping;
    const Pack damping = 2.0 * at.tangential_damping * root(at.mass * stiffness);
    Pack3 sum = force - tangential_velocity * damping;
    const Pack squared = dot(sum, sum);
    const Mask over = squared > limit * limit;
    if (any(over & damped)) sum = select(over, sum * (limit / root(squared)), sum);
    with_damping = select(damped, sum, force);
    if constexpr (tracks_energy) {
      const Pack power = over ? not_negative(dot(force - sum, tangential_velocity))
                              : damping * dot(tangential_velocity, tangential_velocity);
      step.damping = damped ? power * time_step : 0.0;
    }
  }
  step.force = with_damping - normal * normal_force;
  step.left &= at.used;
  step.touches = at.real & at.used & ~step.left;

  if constexpr (tracks_energy) {  // account()
    step.damping = damping_power * time_step + step.damping;
    const Pack energy = 0.4 * elastic_force * depth;
    const Pack clearance = eccentricity - depth;
    Pack work = -(0.5 * (elastic_force + at.elastic_force)) * (clearance - at.clearance);
    work += 0.5 * (energy + at.elastic_energy) / (2.0 * (0.5 * (radius + at.radius))) *
            (radius - at.radius);
    step.thermal_work = at.radius > 0.0 ? work : 0.0;
    at.elastic_force = step.touches ? elastic_force : at.elastic_force;
    at.elastic_energy = step.touches ? energy : at.elastic_energy;
    at.clearance = step.touches ? clearance : at.clearance;
    at.radius = step.touches ? radius : at.radius;
  }
  at.normal = select(step.touches, normal, at.normal);
  at.tangential_force = select(step.touches, force, at.tangential_force);
  at.stiffness = step.touches ? stiffness : at.stiffness;
  at.slipping = step.touches ? slipping : at.slipping;
  return step;
}

}  // namespace statejump::stepper
