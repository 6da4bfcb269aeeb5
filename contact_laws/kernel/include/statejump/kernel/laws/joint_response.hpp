// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <variant>

#include "statejump/kernel/contact_law.hpp"
#include "statejump/kernel/joint_kinematics.hpp"
#include "statejump/kernel/laws/joint_law.hpp"
#include "statejump/kernel/mindlin.hpp"
#include "statejump/kernel/vector.hpp"

namespace statejump::kernel::laws {

/// Where the two bodies of a joint are at this step. Arguments are trusted: this is the inner loop.
struct JointKinematics {
  JointContact contact;     ///< of revolute_contact() or plane_contact()
  NormalGeometry geometry;  ///< R1, R2 at the current temperature, contact length; R2 = +infinity
                            ///< for a flat wall, which the hertz_* laws alone cover
  BodyMotion motion_1;      ///< of the journal (slider)
  BodyMotion motion_2;      ///< of the bearing (slot)
  Vector3 axis;             ///< unit, of the bearing; read by the velocity law 'paper' only
  double impact_speed;      ///< approach speed when this contact began [m/s]
  double clearance_rate;  ///< dc/dt by expansion [m/s]; delta_dot = approach speed - clearance_rate
  double time_step;       ///< dt [s], >= 0
};

/// What the contact answers, and what of it the two bodies feel.
struct JointResponse {
  ContactResponse contact;   ///< forces at the contact, energies of this step
  Wrench wrench;             ///< by the same tangential velocity law as the velocity of friction
  double dissipation_force;  ///< of the dissipation law alone [N]; times clearance_rate it is work
                             ///< of the expansion
  double dissipation_slope;  ///< dF/d(approach speed) of the dissipation law [N s/m], >= 0
  double friction_slope;     ///< largest dF_T/dv of the friction law [N s/m], >= 0; with ambrosio a
                             ///< viscous damper that an explicit integrator has to resolve
};

/// Any joint law with the viscous contact damping of hertz_mindlin(). Normal:
///
///     F_N = max(0, F_el max(0, 1 + (chi/K) delta_dot) + c_n v_n),   c_n = 2 zeta_n sqrt(m k_n),
///
/// v_n = v . n being the approach speed of the bodies, delta_dot = v_n - dc/dt the rate of the
/// depth, see damped_force(). Tangential: the friction law with k_t = tangential_stiffness(); the
/// viscous part c_t belongs to the history spring, so friction laws without one (none, ambrosio)
/// have none. hertz_internal + none + mindlin + material is hertz_mindlin() up to rounding of k_t.
///
/// Velocity and wrench come from one tangential velocity law, never mixed. Energy: as there.
/// @param law its friction coefficient is not read: that of the contact pair counts
/// @param parameters see validate(); not checked here
/// @param history of this contact, rotated into the present tangent plane by the caller; updated
/// @throws std::domain_error when the depth is outside the range of the normal law
inline JointResponse joint_response(const JointLaw& law, const ContactParameters& parameters,
                                    const JointKinematics& at, ContactHistory& history) {
  const JointContact& contact = at.contact;
  const Vector3& n = contact.normal;
  const NormalState normal = evaluate(law.normal, contact.penetration_depth, at.geometry,
                                      NormalMaterial{parameters.elastic.effective_young_modulus});
  const Vector3 velocity = std::visit(
      [&](const auto& l) { return l.velocity(contact, at.motion_1, at.motion_2, at.axis); },
      law.tangential_velocity);
  const double approach_speed = velocity.dot(n);

  double normal_force = normal.force;
  double damping_dissipation = 0.0;
  double dissipation_force = 0.0;
  double dissipation_slope = 0.0;
  if (contact.penetration_depth > 0.0) {
    const double ratio = damping_ratio(law, at.impact_speed);
    dissipation_slope = ratio * normal.force;
    const double penetration_rate = approach_speed - at.clearance_rate;
    const double by_law = damped_force(normal.force, ratio, penetration_rate);
    dissipation_force = by_law - normal.force;
    normal_force = damped_normal_force(by_law,
                                       viscous_damping(parameters.normal_damping_ratio,
                                                       parameters.effective_mass, normal.stiffness),
                                       approach_speed);
    damping_dissipation =
        (dissipation_force * penetration_rate + (normal_force - by_law) * approach_speed) *
        at.time_step;
  }

  FrictionParameters friction_parameters = law.friction_parameters;
  friction_parameters.friction_coefficient = parameters.friction_coefficient;
  const double stiffness = tangential_stiffness(parameters.elastic, normal.stiffness);
  const Vector3 tangential_velocity = velocity - approach_speed * n;
  const FrictionResponse friction =
      evaluate(law.friction, friction_parameters,
               {normal_force, stiffness, tangential_velocity, at.time_step}, history);

  Vector3 tangential_force = friction.force_on_1;
  const double limit = parameters.friction_coefficient * normal_force;
  const bool sticks = history.tangential_stiffness > 0.0 && !history.slipping;
  if (parameters.tangential_damping_ratio > 0.0 && limit > 0.0 && sticks) {
    const double damping =
        viscous_damping(parameters.tangential_damping_ratio, parameters.effective_mass, stiffness);
    damping_dissipation +=
        add_tangential_damping(damping, limit, tangential_velocity, tangential_force) *
        at.time_step;
  }

  const Vector3 force_on_1 = tangential_force - normal_force * n;
  const Wrench wrench =
      std::visit([&](const auto& l) { return l.wrench(contact, force_on_1, at.axis); },
                 law.tangential_velocity);
  return {{normal_force, normal.force, normal.stiffness, history.tangential_stiffness,
           tangential_force, force_on_1, normal.elastic_energy, friction.elastic_energy,
           friction.dissipation, damping_dissipation},
          wrench,
          dissipation_force,
          dissipation_slope,
          largest_slope(law.friction, friction_parameters, normal_force)};
}

/// Change of the potential V(delta, R1, R2) of the normal law when only the radii change, at fixed
/// depth [J]; what their change does to the depth, -F dc, is not part of it. By a central
/// difference along the change, with 1e-5 of the smaller of clearance and R1 as its step: the
/// change of one time step itself is too small to subtract. Relative error about 1e-9.
/// @param before, after radii [m]; @param depth [m]
inline double radius_energy_change(const NormalLaw& law, const NormalMaterial& material,
                                   double depth, const NormalGeometry& before,
                                   const NormalGeometry& after) {
  const bool flat = std::isinf(before.bearing_radius) || std::isinf(after.bearing_radius);
  const double change_1 = after.journal_radius - before.journal_radius;
  const double change_2 = flat ? 0.0 : after.bearing_radius - before.bearing_radius;
  const double largest = std::max(std::abs(change_1), std::abs(change_2));
  if (!(largest > 0.0) || !(depth > 0.0)) return 0.0;
  NormalGeometry middle = before;
  middle.journal_radius += 0.5 * change_1;
  if (!flat) middle.bearing_radius += 0.5 * change_2;
  const double scale =
      1e-5 * std::min(std::abs(middle.clearance()), middle.journal_radius) / largest;
  const auto energy = [&](double steps) {
    NormalGeometry shifted = middle;
    shifted.journal_radius += steps * change_1;
    shifted.bearing_radius += steps * change_2;
    return evaluate(law, depth, shifted, material).elastic_energy;
  };
  return (energy(scale) - energy(-scale)) / (2.0 * scale);
}

}  // namespace statejump::kernel::laws
