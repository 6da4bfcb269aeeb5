// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>

#include "statejump/kernel/arithmetic.hpp"
#include "statejump/kernel/partial_slip.hpp"
#include "statejump/kernel/vector.hpp"

namespace statejump::kernel {

/// Memory of a contact between steps. The caller stores it, rotates its force and axis with the
/// contact (transport() in frame.hpp), and default-constructs it for a new contact.
struct ContactHistory {
  Vector3 tangential_force = Vector3::Zero();  ///< spring force on body 1 [N]; no viscous part
  double tangential_stiffness = 0.0;  ///< k_t [N/m] when that force was stored; 0: new contact
  bool slipping = false;              ///< the last step ended at the Coulomb limit
  Vector3 tangential_axis = Vector3::Zero();  ///< unit, first tangent of `memory`; zero: no memory
  PartialSlipMemory memory{};                 ///< only for a law with partial slip
};

/// Elastic energy [J] of a contact's friction: that of the partial-slip memory if it exists,
/// otherwise that of the spring.
inline double elastic_energy(const ContactHistory& history) {
  if (history.memory.size() > 0) return elastic_energy(history.memory);
  const double stiffness = history.tangential_stiffness;
  return stiffness > 0.0 ? 0.5 * history.tangential_force.squaredNorm() / stiffness : 0.0;
}

/// Mindlin's tangential stiffness k_t = 8 G* a [N/m] of a circular contact without slip (Mindlin
/// 1949; Johnson 1985, eq. 7.44).
/// @param effective_shear_modulus G* [Pa], see ElasticPair; @param contact_radius a [m]
template <class A = Single>
[[gnu::always_inline]] inline typename A::Number mindlin_stiffness(
    const typename A::Number& effective_shear_modulus, const typename A::Number& contact_radius) {
  return 8.0 * effective_shear_modulus * contact_radius;
}

namespace detail {

/// Stores the state of a spring.
inline void keep(const Vector3& force, double stiffness, bool slipping, ContactHistory& history) {
  history.tangential_force = force;
  history.tangential_stiffness = stiffness;
  history.slipping = slipping;
  history.tangential_axis = Vector3::Zero();
  history.memory.clear();
}

}  // namespace detail

/// Tangential spring before a step, with quantities that its loss needs. @tparam A arithmetic, see
/// Single
template <class A>
struct SpringBefore {
  typename A::Number stiffness;   ///< k0 [N/m]; 0: no force stored
  typename A::Number compliance;  ///< 1/k0 [m/N]; 0 without stiffness
  typename A::Number squared;     ///< F0^2 [N^2]
  typename A::Number work;        ///< F0 . u with the slide u of the step [J]
  /// F0^2/k0 - F0 . u [J]. Half of it is the loss if the spring loses its whole force.
  [[gnu::always_inline]] typename A::Number released() const { return squared * compliance - work; }
};
/// @param force F0 [N]; @param stiffness k0 [N/m]; @param slide u [m]
template <class A>
[[gnu::always_inline]] inline SpringBefore<A> spring_before(const typename A::Vector& force,
                                                            const typename A::Number& stiffness,
                                                            const typename A::Vector& slide) {
  return {stiffness, stiffness > 0.0 ? 1.0 / stiffness : 0.0, A::squared(force),
          A::dot(force, slide)};
}

/// Tangential spring after a step. @tparam A arithmetic, see Single
template <class A>
struct SpringStep {
  typename A::Vector force;        ///< F1 on body 1 [N]
  typename A::Number elastic;      ///< 1/2 F1^2 / k [J], >= 0
  typename A::Number dissipation;  ///< friction loss of this step [J], >= 0
  typename A::Mask slipping;       ///< the step ended at the Coulomb limit
};

/// One step of the tangential history spring with Coulomb's limit.
///
/// The spring carries F = -k s on body 1, where s is the elastic slide of 1 relative to 2. A step
/// has three parts, with F0 and k0 of the last step, the current stiffness k and the slide u of
/// this step:
///
///  1. The stiffness follows the normal load. Loading (k >= k0): the new annulus of contact has no
///    traction, so the force stays, F' = F0. Unloading (k < k0): the slide s stays, F' = F0 k/k0.
///    Either way the spring loses the energy 1/2 F0^2/k0 - 1/2 F'^2/k >= 0 by micro-slip at the
///    rim. If unloading kept F0, it would create energy (Thornton, Cummins and Cleary, 2013).
///  2. Stick: trial force T = F' - k u.
///  3. Coulomb: if |T| exceeds the limit, F1 = limit T/|T|; the excess slip = (|T| - limit)/k is
///    plastic. Otherwise F1 = T.
///
/// Discrete energy identity. With u = v(n-1/2) dt, a leapfrog integrator does the work -1/2 (F0 +
/// F1) . u on the contact in a step (summation by parts of F . v dt). The dissipation D is defined
/// by
///
///    -1/2 (F0 + F1) . u = (1/2 F1^2/k - 1/2 F0^2/k0) + D,
///
/// which the three parts transform into sums without cancellation:
///
///    loading       1/2 F0^2 (1/k0 - 1/k)
///    unloading     1/2 (1 - k/k0) (F0^2/k0 - F0 . u)
///    slip          1/2 (F' . T/|T| + limit) slip     (limit * slip in steady sliding)
///
/// So the energy balance closes to rounding in every step, with one exception. If the force
/// reverses within a step while the normal load decreases, the mean of the two end forces
/// underestimates the work. The identity would give a negative D of second order in the step, so D
/// is set to 0.
///
/// Cost: one square root and three divisions in a slip step, two divisions in a stick step.
/// @param stiffness k [N/m], > 0
/// @param limit mu F_N [N], > 0
/// @param slide u, tangential slide of 1 relative to 2 in this step [m]
/// @param old_force F0, in the current tangent plane [N]. A force stored with k0 = 0 is ignored.
/// @param before from spring_before() with F0, k0 and u
/// @param counts contacts whose result is used
/// Limits: a single spring for the whole contact; Mindlin and Deresiewicz's partial-slip loops
/// below the limit are not resolved. A cyclic normal load reduces a stuck force, because loading
/// keeps it and unloading scales it down.
template <class A>
[[gnu::always_inline]] inline SpringStep<A> spring_step(const typename A::Number& stiffness,
                                                        const typename A::Number& limit,
                                                        const typename A::Vector& slide,
                                                        const typename A::Vector& old_force,
                                                        const SpringBefore<A>& before,
                                                        const typename A::Mask& counts) {
  using Number = typename A::Number;
  using Mask = typename A::Mask;
  const Number compliance = 1.0 / stiffness;
  const Mask loading = (stiffness >= before.stiffness) & (before.stiffness > 0.0);
  const Number kept = loading ? 1.0 : stiffness * before.compliance;  // F' / F0
  Number dissipation = loading ? 0.5 * before.squared * (before.compliance - compliance)
                               : 0.5 * (1.0 - kept) * before.released();
  typename A::Vector force = old_force * kept - slide * stiffness;
  Number force_squared = A::squared(force);
  const Mask slipping = force_squared > limit * limit;
  if (A::any(slipping & counts)) {
    const Number trial = A::root(force_squared);
    const typename A::Vector direction = force * (1.0 / trial);
    const Number slip = (trial - limit) * compliance;
    const Number loss = 0.5 * (kept * A::dot(old_force, direction) + limit) * slip;
    dissipation = slipping ? dissipation + loss : dissipation;
    force = A::select(slipping, direction * limit, force);
    force_squared = slipping ? limit * limit : force_squared;
  }
  return {force, 0.5 * force_squared * compliance, A::larger(Number{}, dissipation), slipping};
}

/// Energy account of one step of the tangential spring.
struct MindlinEnergy {
  double elastic;      ///< 1/2 F^2 / k_t after the step [J], >= 0
  double dissipation;  ///< friction loss of this step [J], >= 0
};

/// spring_step() of one contact; updates the history.
/// @param stiffness k [N/m]; <= 0 means that contact is lost; all spring energy then counts as loss
/// @param limit mu F_N [N]; <= 0 means no friction; the force is then exactly zero
/// @param history on input F0 (in the current tangent plane) and k0, on output F1 and k
/// Limits: those of spring_step().
inline MindlinEnergy mindlin_step(double stiffness, double limit, const Vector3& slide,
                                  ContactHistory& history) {
  const SpringBefore<Single> before =
      spring_before<Single>(history.tangential_force, history.tangential_stiffness, slide);
  if (!(stiffness > 0.0) || !(limit > 0.0)) {
    detail::keep(Vector3::Zero(), std::max(stiffness, 0.0), stiffness > 0.0, history);
    return {0.0, std::max(0.0, 0.5 * before.released())};
  }
  const SpringStep<Single> step =
      spring_step<Single>(stiffness, limit, slide, history.tangential_force, before, true);
  detail::keep(step.force, stiffness, step.slipping, history);
  return {step.elastic, step.dissipation};
}

}  // namespace statejump::kernel
