// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cmath>

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
inline double mindlin_stiffness(double effective_shear_modulus, double contact_radius) {
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

/// Energy account of one step of the tangential spring.
struct MindlinEnergy {
  double elastic;      ///< 1/2 F^2 / k_t after the step [J], >= 0
  double dissipation;  ///< friction loss of this step [J], >= 0
};

/// One step of the tangential history spring with Coulomb's limit; updates the history.
///
/// The spring carries F = -k s on body 1, where s is the elastic slide of 1 relative to 2. A step
/// has three parts, with F0 and k0 from the history, the current stiffness k and the slide u of
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
/// @param stiffness k [N/m]; <= 0 means that contact is lost; all spring energy then counts as loss
/// @param limit mu F_N [N]; <= 0 means no friction; the force is then exactly zero
/// @param slide u, tangential slide of 1 relative to 2 in this step [m]
/// @param history on input F0 (in the current tangent plane) and k0, on output F1 and k. A force
///     stored with k0 = 0 is ignored.
/// Limits: a single spring for the whole contact; Mindlin and Deresiewicz's partial-slip loops
/// below the limit are not resolved. A cyclic normal load reduces a stuck force, because loading
/// keeps it and unloading scales it down.
inline MindlinEnergy mindlin_step(double stiffness, double limit, const Vector3& slide,
                                  ContactHistory& history) {
  const Vector3 old_force = history.tangential_force;
  const double old_stiffness = history.tangential_stiffness;
  const double old_compliance = old_stiffness > 0.0 ? 1.0 / old_stiffness : 0.0;
  const double old_force_squared = old_force.squaredNorm();
  const double old_work = old_force.dot(slide);

  if (!(stiffness > 0.0) || !(limit > 0.0)) {
    detail::keep(Vector3::Zero(), std::max(stiffness, 0.0), stiffness > 0.0, history);
    return {0.0, std::max(0.0, 0.5 * (old_force_squared * old_compliance - old_work))};
  }

  const double compliance = 1.0 / stiffness;
  double kept = 1.0;  // F' / F0
  double dissipation;
  if (stiffness >= old_stiffness && old_stiffness > 0.0) {
    dissipation = 0.5 * old_force_squared * (old_compliance - compliance);
  } else {
    kept = stiffness * old_compliance;
    dissipation = 0.5 * (1.0 - kept) * (old_force_squared * old_compliance - old_work);
  }

  Vector3 force = kept * old_force - stiffness * slide;
  double force_squared = force.squaredNorm();
  const bool slipping = force_squared > limit * limit;
  if (slipping) {
    const double trial = std::sqrt(force_squared);
    const Vector3 direction = force * (1.0 / trial);
    const double slip = (trial - limit) * compliance;
    dissipation += 0.5 * (kept * old_force.dot(direction) + limit) * slip;
    force = limit * direction;
    force_squared = limit * limit;
  }
  detail::keep(force, stiffness, slipping, history);
  return {0.5 * force_squared * compliance, std::max(0.0, dissipation)};
}

}  // namespace statejump::kernel
