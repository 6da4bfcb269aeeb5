// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cmath>

#include "statejump/kernel/elastic_pair.hpp"
#include "statejump/kernel/hertz.hpp"
#include "statejump/kernel/mindlin.hpp"
#include "statejump/kernel/require.hpp"
#include "statejump/kernel/vector.hpp"

namespace statejump::kernel {

/// Material, friction and damping of one contact, constant during a run. Call validate() once.
struct ContactParameters {
  ElasticPair elastic;                    ///< E*, G* [Pa], both > 0; see elastic_pair()
  double friction_coefficient = 0.0;      ///< mu [-], >= 0; 0: frictionless (default)
  double normal_damping_ratio = 0.0;      ///< zeta_n [-], >= 0; 0: undamped (default)
  double tangential_damping_ratio = 0.0;  ///< zeta_t [-], >= 0; 0: undamped (default)
  double effective_mass = 0.0;            ///< m = m1 m2/(m1 + m2) [kg], >= 0; only damping uses it
};

/// Kinematics of the two bodies of a contact in one step. The inner loop does not check them.
struct ContactKinematics {
  Vector3 normal;  ///< unit, from body 1 (journal, slider) into body 2 (bearing, slot); body 1
                   ///< pushes along it
  double penetration_depth;   ///< delta [m], > 0 overlap, <= 0 gap
  double effective_radius;    ///< R [m], > 0, finite
  Vector3 relative_velocity;  ///< v1 - v2 [m/s], material velocities at the common contact point
  double time_step;           ///< dt [s], >= 0
};

/// Forces and energies of a contact after one step. The forces are those on body 1; body 2 gets the
/// opposite.
struct ContactResponse {
  double normal_force;               ///< F_N with its viscous part [N], >= 0: clipped, no adhesion
  double elastic_normal_force;       ///< Hertz part of F_N [N], >= 0
  double normal_stiffness;           ///< dF/d(delta) of the Hertz part [N/m], >= 0
  double tangential_stiffness;       ///< k_t = 8 G* a [N/m], >= 0
  Vector3 tangential_force;          ///< friction on body 1, viscous part included [N]
  Vector3 force_on_1;                ///< -F_N n + tangential_force [N]
  double normal_elastic_energy;      ///< [J], >= 0
  double tangential_elastic_energy;  ///< of the history spring [J], >= 0
  double friction_dissipation;       ///< of this step [J], >= 0, see mindlin_step()
  double damping_dissipation;        ///< of this step [J], >= 0
};

/// Checks the parameters of a contact. Call it whenever they are set.
/// @throws std::invalid_argument that names the field, its value and its range.
inline void validate(const ContactParameters& parameters) {
  const auto positive = [&](double value, const char* name, const char* range) {
    require(std::isfinite(value) && value > 0.0, name, value, range);
  };
  const auto non_negative = [&](double value, const char* name, const char* range) {
    require(std::isfinite(value) && value >= 0.0, name, value, range);
  };
  positive(parameters.elastic.effective_young_modulus, "effective_young_modulus", "(0, inf) Pa");
  positive(parameters.elastic.effective_shear_modulus, "effective_shear_modulus", "(0, inf) Pa");
  non_negative(parameters.friction_coefficient, "friction_coefficient", "[0, inf)");
  non_negative(parameters.normal_damping_ratio, "normal_damping_ratio", "[0, inf)");
  non_negative(parameters.tangential_damping_ratio, "tangential_damping_ratio", "[0, inf)");
  non_negative(parameters.effective_mass, "effective_mass", "[0, inf) kg");
}

/// Viscous damping c = 2 zeta sqrt(m k) [N s/m] of a contact spring at its current stiffness.
/// @param damping_ratio zeta [-], @param mass m [kg], @param stiffness k [N/m]
template <class A = Single>
[[gnu::always_inline]] inline typename A::Number viscous_damping(
    const typename A::Number& damping_ratio, const typename A::Number& mass,
    const typename A::Number& stiffness) {
  return 2.0 * damping_ratio * A::root(mass * stiffness);
}

/// Normal force with its viscous part [N], clipped at 0: the bodies never pull on each other.
/// @param force elastic force F [N], @param damping c [N s/m]
/// @param approach_speed [m/s]
template <class A = Single>
[[gnu::always_inline]] inline typename A::Number damped_normal_force(
    const typename A::Number& force, const typename A::Number& damping,
    const typename A::Number& approach_speed) {
  return A::larger(typename A::Number{}, force + damping * approach_speed);
}

/// Adds the viscous force -c v_t of a sticking spring and projects the sum onto the disc of radius
/// mu F_N. The projection is monotone, so the remaining viscous force still opposes v_t.
/// @param damping c [N s/m], @param limit mu F_N [N], @param velocity v_t [m/s]
/// @param force on input the force of the spring [N], at most `limit`; on output the sum
/// @param counts contacts whose result is used
/// @return power dissipated by the viscous part [W], >= 0
template <class A = Single>
[[gnu::always_inline]] inline typename A::Number add_tangential_damping(
    const typename A::Number& damping, const typename A::Number& limit,
    const typename A::Vector& velocity, const typename A::Mask& counts, typename A::Vector& force) {
  using Number = typename A::Number;
  const typename A::Vector spring = force;
  force = force - velocity * damping;
  const Number squared = A::squared(force);
  const typename A::Mask over = squared > limit * limit;
  if (A::any(over & counts)) {
    force = A::select(over, force * (limit / A::root(squared)), force);
  }
  return over ? A::larger(Number{}, A::dot(spring - force, velocity))
              : damping * A::squared(velocity);
}

/// Input and output of a dissipation law in one contact_step().
struct ImpactDamping {
  double ratio = 0.0;           ///< chi/K [s/m], see laws::damped_force()
  double clearance_rate = 0.0;  ///< dc/dt by thermal expansion [m/s]
  double force = 0.0;           ///< out: force of the dissipation law [N]
};

/// One step of a contact, common to all laws. Normal force:
///
///    F_N = max(0, F_el max(0, 1 + (chi/K) delta_dot) + c_n v_n),   c_n = 2 zeta_n sqrt(m k_n),
///
/// with the approach speed v_n = v . n of the bodies and the rate of the depth delta_dot = v_n -
/// dc/dt. The friction law gives the tangential force. While its spring sticks,
/// add_tangential_damping() adds a viscous force.
///
/// @tparam Laws the laws, resolved at compile time:
///  normal()                      elastic state with force, stiffness, elastic_energy
///  velocity()                    velocity of body 1 relative to body 2 [m/s], used by friction
///  tangential_stiffness(normal)  k_t [N/m]
///  friction(k_t, mu F_N, F_N, v_t, history) -> MindlinEnergy
///  friction_force(history)       force on body 1 after friction() [N], without the viscous part
///  dissipates                    whether impact() returns an ImpactDamping&
///  always_spring                 friction is always a spring of stiffness k_t; if false,
///  history.tangential_stiffness > 0 marks a spring
/// @param normal n, unit; @param depth delta [m]; @param time_step dt [s]
/// @param history memory of this contact, updated; the caller has rotated it into the current
///     tangent plane
template <class Laws>
[[gnu::always_inline]] inline ContactResponse contact_step(Laws& laws,
                                                           const ContactParameters& parameters,
                                                           const Vector3& normal, double depth,
                                                           double time_step,
                                                           ContactHistory& history) {
  const auto normal_state = laws.normal();
  const Vector3& n = normal;
  const Vector3& velocity = laws.velocity();
  const double approach_speed = velocity.dot(n);

  double normal_force = normal_state.force;
  double damping_power = 0.0;
  const bool touching = depth > 0.0;
  if constexpr (Laws::dissipates) {
    if (touching) {
      ImpactDamping& impact = laws.impact();
      const double rate = approach_speed - impact.clearance_rate;
      normal_force = normal_state.force * std::max(0.0, 1.0 + impact.ratio * rate);
      impact.force = normal_force - normal_state.force;
      damping_power = impact.force * rate;
    }
  }
  if (touching && parameters.normal_damping_ratio > 0.0) {
    const double by_laws = normal_force;
    normal_force =
        damped_normal_force(by_laws,
                            viscous_damping(parameters.normal_damping_ratio,
                                            parameters.effective_mass, normal_state.stiffness),
                            approach_speed);
    damping_power += (normal_force - by_laws) * approach_speed;
  }
  double damping_dissipation = damping_power * time_step;

  const double tangential_stiffness = laws.tangential_stiffness(normal_state);
  const double limit = parameters.friction_coefficient * normal_force;
  const Vector3 tangential_velocity = velocity - approach_speed * n;
  const MindlinEnergy friction_energy =
      laws.friction(tangential_stiffness, limit, normal_force, tangential_velocity, history);
  Vector3 tangential_force = laws.friction_force(history);
  if (parameters.tangential_damping_ratio > 0.0 && limit > 0.0 && !history.slipping &&
      (Laws::always_spring || history.tangential_stiffness > 0.0)) {
    const double damping = viscous_damping(parameters.tangential_damping_ratio,
                                           parameters.effective_mass, tangential_stiffness);
    damping_dissipation +=
        add_tangential_damping(damping, limit, tangential_velocity, true, tangential_force) *
        time_step;
  }

  return {normal_force,
          normal_state.force,
          normal_state.stiffness,
          Laws::always_spring ? tangential_stiffness : history.tangential_stiffness,
          tangential_force,
          tangential_force - normal_force * n,
          normal_state.elastic_energy,
          friction_energy.elastic,
          friction_energy.dissipation,
          damping_dissipation};
}

namespace detail {

/// Laws of hertz_mindlin() for contact_step().
struct HertzMindlinLaws {
  const ContactParameters& parameters;
  const ContactKinematics& kinematics;
  static constexpr bool dissipates = false;
  static constexpr bool always_spring = true;

  HertzState normal() const {
    return hertz(parameters.elastic.effective_young_modulus, kinematics.effective_radius,
                 kinematics.penetration_depth);
  }
  const Vector3& velocity() const { return kinematics.relative_velocity; }
  double tangential_stiffness(const HertzState& state) const {
    return mindlin_stiffness(parameters.elastic.effective_shear_modulus, state.contact_radius);
  }
  [[gnu::always_inline]] MindlinEnergy friction(double stiffness, double limit, double,
                                                const Vector3& velocity,
                                                ContactHistory& history) const {
    return mindlin_step(stiffness, limit, velocity * kinematics.time_step, history);
  }
  const Vector3& friction_force(const ContactHistory& history) const {
    return history.tangential_force;
  }
};

}  // namespace detail

/// Hertz normal contact, Mindlin history friction under Coulomb's limit, viscous damping.
///
/// Normal: F_el = 4/3 E* sqrt(R) delta^1.5 and k_n = 2 E* a, a = sqrt(R delta), see hertz(). With
/// the approach speed v_n = v . n (the rate of delta),
///
///    F_N = max(0, F_el + c_n v_n),   c_n = 2 zeta_n sqrt(m k_n).
///
/// The bodies never pull on each other. k_n is the tangent stiffness at this depth, so zeta_n is
/// the damping ratio of a small oscillation there.
///
/// Tangential: a history spring of stiffness k_t = 8 G* a under the limit mu F_N, see
/// mindlin_step(). F_N is the clipped total normal force, because that force presses the surfaces
/// together. While the spring sticks, the viscous force -c_t v_t, c_t = 2 zeta_t sqrt(m k_t), is
/// added. add_tangential_damping() projects the sum onto the disc of radius mu F_N. While the
/// spring slips, there is no viscous force. |tangential_force| <= mu F_N always; with mu = 0 it is
/// exactly zero.
///
/// Energy: the friction loss follows from the identity of mindlin_step(), the damping loss is
/// (viscous force) . v dt with the given velocity. A leapfrog integrator does work with the mean
/// velocity of two half steps, so its damping work differs from this value at first order in dt.
///
/// Cost: one square root, one more during slip, one more per active damper.
/// @param parameters see validate(); not checked here
/// @param kinematics motion of the two bodies in this step
/// @param history memory of this contact, updated; the caller has rotated it into the current
///     tangent plane. A gap clears it and counts the energy of the spring as friction loss.
/// Limits: those of hertz() and mindlin_step(); no rolling or twisting resistance.
[[gnu::always_inline]] inline ContactResponse hertz_mindlin(const ContactParameters& parameters,
                                                            const ContactKinematics& kinematics,
                                                            ContactHistory& history) {
  const detail::HertzMindlinLaws laws{parameters, kinematics};
  return contact_step(laws, parameters, kinematics.normal, kinematics.penetration_depth,
                      kinematics.time_step, history);
}

/// Forces [N] and torques [N m] that one contact exerts on the centres of its two bodies, world
/// frame.
struct Wrench {
  Vector3 force_1;
  Vector3 torque_1;
  Vector3 force_2;
  Vector3 torque_2;
};

/// Transfers the contact force to the centres of the two bodies: torque = arm x force.
///
/// The forces on both bodies act at the same point, so forces and moments about any point cancel
/// exactly. (The paper's eq. 14 has two points at a distance delta, which would leave a torque
/// delta F_t.)
/// @param force_on_1 force on body 1 [N]; body 2 gets the opposite
/// @param arm_1, arm_2 contact point minus centre of body 1 and 2 [m]
inline Wrench contact_wrench(const Vector3& force_on_1, const Vector3& arm_1,
                             const Vector3& arm_2) {
  return {force_on_1, cross(arm_1, force_on_1), -force_on_1, cross(force_on_1, arm_2)};
}

}  // namespace statejump::kernel
