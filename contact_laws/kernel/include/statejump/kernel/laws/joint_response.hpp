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

/// Kinematics of the two bodies of a joint in one step. The inner loop does not check them.
struct JointKinematics {
  JointContact contact;     ///< from revolute_contact() or plane_contact()
  NormalGeometry geometry;  ///< R1, R2 at the current temperature, contact length. R2 = +infinity
                            ///< is a flat wall, which only the hertz_* laws accept.
  BodyMotion motion_1;      ///< of the journal (slider)
  BodyMotion motion_2;      ///< of the bearing (slot)
  Vector3 axis;             ///< unit, of the bearing; read only by the velocity law 'paper'
  double impact_speed;      ///< approach speed when this contact began [m/s]
  double clearance_rate;    ///< dc/dt by thermal expansion [m/s]; delta_dot = approach speed -
                            ///< clearance_rate
  double time_step;         ///< dt [s], >= 0
};

/// Contact forces of a joint and their effect on the two bodies.
struct JointResponse {
  ContactResponse contact;   ///< forces at the contact, energies of this step
  Wrench wrench;             ///< computed with the arms of the same tangential velocity law
  double dissipation_force;  ///< force of the dissipation law alone [N]; times clearance_rate it is
                             ///< the power of the thermal expansion
  double dissipation_slope;  ///< dF/d(approach speed) of the dissipation law [N s/m], >= 0
  double friction_slope;  ///< largest dF_T/dv of the friction law [N s/m], >= 0: a viscous damper
                          ///< that an explicit integrator has to resolve (ambrosio)
};

namespace detail {

/// Implements the Laws of contact_step() with laws of the catalogue. Members are set once, because
/// this is the inner loop.
template <class Law>
struct CatalogueLaws {
  const Law& law;
  const ContactParameters& parameters;
  const JointKinematics& at;
  const FrictionParameters friction_parameters;
  const NormalState normal_state;
  const Vector3 relative_velocity;
  ImpactDamping damping;
  Vector3 tangential_force;
  static constexpr bool dissipates = true;
  static constexpr bool always_spring = false;

  CatalogueLaws(const Law& its_law, const ContactParameters& its_parameters,
                const JointKinematics& its_kinematics)
      : law(its_law),
        parameters(its_parameters),
        at(its_kinematics),
        friction_parameters{parameters.friction_coefficient, law.friction_parameters.v0,
                            law.friction_parameters.v1},
        normal_state(evaluate(law.normal, at.contact.penetration_depth, at.geometry,
                              NormalMaterial{parameters.elastic.effective_young_modulus})),
        relative_velocity(visit_law(law.tangential_velocity,
                                    [&](const auto& l) {
                                      return l.velocity(at.contact, at.motion_1, at.motion_2,
                                                        at.axis);
                                    })),
        damping{0.0, at.clearance_rate, 0.0} {}

  const NormalState& normal() const { return normal_state; }
  const Vector3& velocity() const { return relative_velocity; }
  ImpactDamping& impact() {
    damping.ratio = damping_ratio(law, at.impact_speed);
    return damping;
  }
  double tangential_stiffness(const NormalState& state) const {
    return laws::tangential_stiffness(parameters.elastic, state.stiffness);
  }
  MindlinEnergy friction(double stiffness, double, double normal_force, const Vector3& velocity,
                         ContactHistory& history) {
    const FrictionResponse response =
        evaluate(law.friction, friction_parameters,
                 {normal_force, stiffness, velocity, at.time_step, at.contact.normal}, history);
    tangential_force = response.force_on_1;
    return {response.elastic_energy, response.dissipation};
  }
  const Vector3& friction_force(const ContactHistory&) const { return tangential_force; }
};

}  // namespace detail

/// One contact_step() with any joint law and k_t = tangential_stiffness(). The dashpot c_t belongs
/// to the history spring, so friction laws without a spring (none, ambrosio) have no c_t.
/// hertz_internal + none + mindlin + material equals hertz_mindlin() up to rounding of k_t.
///
/// Velocity and wrench come from the same tangential velocity law. Energies are defined as in
/// hertz_mindlin().
/// @param law a JointLaw or a StaticJointLaw. Its friction coefficient is ignored; that of
///     `parameters` applies.
/// @param parameters see validate(); not checked here
/// @param history memory of this contact, updated; the caller has rotated it into the current
///     tangent plane
/// @throws std::domain_error when the depth is outside the range of the normal law
template <class Law>
JointResponse joint_response(const Law& law, const ContactParameters& parameters,
                             const JointKinematics& at, ContactHistory& history) {
  const JointContact& contact = at.contact;
  detail::CatalogueLaws<Law> laws(law, parameters, at);
  const ContactResponse response = contact_step(laws, parameters, contact.normal,
                                                contact.penetration_depth, at.time_step, history);
  const Wrench wrench = visit_law(law.tangential_velocity, [&](const auto& l) {
    return l.wrench(contact, response.force_on_1, at.axis);
  });
  return {response, wrench, laws.damping.force, laws.damping.ratio * response.elastic_normal_force,
          largest_slope(law.friction, laws.friction_parameters, response.normal_force)};
}

/// Change of the potential V(delta, R1, R2) of the normal law when only the radii change, at fixed
/// depth [J]. The effect of the radii on the depth, -F dc, is not included. The change in one time
/// step is too small to subtract two values of V. A central difference along the change is used,
/// with a step of 1e-5 of the smaller of clearance and R1. Its relative error is about 1e-9.
/// @param depth [m]; @param before, after radii at both ends of the step [m]
template <class Law>
double radius_energy_change(const Law& law, const NormalMaterial& material, double depth,
                            const NormalGeometry& before, const NormalGeometry& after) {
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
