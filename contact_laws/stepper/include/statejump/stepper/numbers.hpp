// SPDX-License-Identifier: GPL-3.0-or-later
// Which numbers a step may use: ranges of what links and contacts are given, and what their answers
// must be. The plugin's engines and functors and the stepper ask the same questions, written so
// that NaN never passes.
//
// Two sorts of questions. Ranges are asked where a number enters: when an attribute is set, when a
// run begins, when arrays are filled. Answers are asked in every step, by a few comparisons that
// fail for whatever is not plain; only then is it looked at in detail.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

#include "statejump/kernel/joint_kinematics.hpp"
#include "statejump/kernel/vector.hpp"
#include "statejump/stepper/link.hpp"
#include "statejump/stepper/prismatic.hpp"

namespace statejump::stepper {

enum class Allowed : unsigned char { finite, not_negative, positive };

inline bool allows(Allowed allowed, double value) {
  return std::isfinite(value) && (allowed == Allowed::finite || value > 0 ||
                                  (allowed == Allowed::not_negative && value == 0));
}

/// In words, before a unit.
inline const char* words(Allowed allowed) {
  return allowed == Allowed::finite     ? "finite"
         : allowed == Allowed::positive ? "above 0"
                                        : "0 or above";
}

/// A number of an object, by the name that users know.
template <class Object>
struct Quantity {
  const char* name;
  double Object::*value;
  Allowed allowed;
  const char* unit;
};

template <class Object, std::size_t size>
using Quantities = std::array<Quantity<Object>, size>;

/// The first quantity of an object that is not allowed; null where all are.
template <class Object, std::size_t size>
const Quantity<Object>* first_wrong(const Quantities<Object, size>& quantities,
                                    const Object& object) {
  for (const Quantity<Object>& each : quantities) {
    if (!allows(each.allowed, object.*each.value)) return &each;
  }
  return nullptr;
}

/// Of a link that acts.
constexpr Quantities<Link, 6> link_quantities = {
    {{"youngModulus", &Link::youngModulus, Allowed::not_negative, "Pa"},
     {"crossSectionArea", &Link::crossSectionArea, Allowed::not_negative, "m2"},
     {"stressFreeLength", &Link::stressFreeLength, Allowed::positive, "m"},
     {"thermalExpansion", &Link::thermalExpansion, Allowed::finite, "1/K"},
     {"dampingRatio", &Link::dampingRatio, Allowed::not_negative, "-"},
     {"pinDamping", &Link::pinDamping, Allowed::not_negative, "N m s/rad"}}};

/// Of a torsion spring that acts. Where friction has a limit, its stiffness has to be above 0.
constexpr Quantities<Torsion, 8> torsion_quantities = {
    {{"stiffness", &Torsion::stiffness, Allowed::not_negative, "N m/rad"},
     {"freeAngle", &Torsion::freeAngle, Allowed::finite, "rad"},
     {"deadband", &Torsion::deadband, Allowed::not_negative, "rad"},
     {"preload", &Torsion::preload, Allowed::finite, "N m"},
     {"frictionLimit", &Torsion::frictionLimit, Allowed::not_negative, "N m"},
     {"frictionStiffness", &Torsion::frictionStiffness, Allowed::not_negative, "N m/rad"},
     {"slipAngle", &Torsion::slipAngle, Allowed::finite, "rad"},
     {"frictionMoment", &Torsion::frictionMoment, Allowed::finite, "N m"}}};

inline bool has_friction_without_stiffness(const Torsion& spring) {
  return spring.frictionLimit > 0 && !(spring.frictionStiffness > 0);
}

/// Of a slider between two bodies; where friction has a limit or there are stops, their stiffness
/// has to be above 0. Clearances are 0 or above, infinity where there is no stop.
constexpr Quantities<Prismatic, 9> prismatic_quantities = {
    {{"stiffnessAcross", &Prismatic::stiffnessAcross, Allowed::not_negative, "N/m"},
     {"frictionLimit", &Prismatic::frictionLimit, Allowed::not_negative, "N"},
     {"frictionStiffness", &Prismatic::frictionStiffness, Allowed::not_negative, "N/m"},
     {"stopStiffness", &Prismatic::stopStiffness, Allowed::not_negative, "N/m^1.5"},
     {"stopSpring", &Prismatic::stopSpring, Allowed::not_negative, "N/m"},
     {"play", &Prismatic::play, Allowed::not_negative, "m"},
     {"dampingRatio", &Prismatic::dampingRatio, Allowed::not_negative, "-"},
     {"slipPosition", &Prismatic::slipPosition, Allowed::finite, "m"},
     {"frictionForce", &Prismatic::frictionForce, Allowed::finite, "N"}}};

inline bool has_friction_without_stiffness(const Prismatic& joint) {
  return joint.frictionLimit > 0 && !(joint.frictionStiffness > 0);
}

inline bool has_stop_without_stiffness(const Prismatic& joint) {
  return std::isfinite(std::min(joint.clearanceMinus, joint.clearancePlus)) &&
         !(joint.stopStiffness + joint.stopSpring > 0);
}

/// Of a contact that touches: ContactPhysics or JointPhys.
template <class Physics>
constexpr Quantities<Physics, 6> contact_quantities = {
    {{"effectiveYoungModulus", &Physics::effectiveYoungModulus, Allowed::positive, "Pa"},
     {"effectiveShearModulus", &Physics::effectiveShearModulus, Allowed::positive, "Pa"},
     {"effectiveMass", &Physics::effectiveMass, Allowed::not_negative, "kg"},
     {"normalDampingRatio", &Physics::normalDampingRatio, Allowed::not_negative, "-"},
     {"tangentialDampingRatio", &Physics::tangentialDampingRatio, Allowed::not_negative, "-"},
     {"tangensOfFrictionAngle", &Physics::tangensOfFrictionAngle, Allowed::not_negative, "-"}}};

inline bool is_finite(const Vector3& v) {
  return std::isfinite(v[0]) && std::isfinite(v[1]) && std::isfinite(v[2]);
}

inline bool is_finite(const kernel::BodyMotion& motion) {
  return is_finite(motion.position) && is_finite(motion.velocity) &&
         is_finite(motion.angular_velocity);
}

/// Of every step: no number is missing, at one comparison. May be false for finite components whose
/// sum overflows.
inline bool is_plain(const Vector3& v) {
  const double sum = v[0] + v[1] + v[2];
  return sum - sum == 0;
}

/// A linear thermal strain that leaves a length [-].
inline bool is_strain(double strain) {
  return 1 + strain > 0 && std::isfinite(strain);
}

/// Of every step: far from a strain that leaves none.
inline bool is_plain_strain(double strain) {
  return std::abs(strain) < 1;
}

/// Leapfrog is unstable beyond omega dt = 2 of the stiffest contact alone, whatever else acts.
/// @param stiffness [N/m]; @param time_step [s]
template <class Physics>
bool step_is_too_long(double stiffness, const Physics& physics, double time_step) {
  return time_step * time_step * stiffness > 4 * physics.effectiveMass && physics.effectiveMass > 0;
}

/// Of every step of a contact that touches: it is stiff, and the step is not too long for it. Fails
/// for a modulus, depth, mass or time step that is none, and where both bodies are fixed.
template <class Physics>
bool is_plain_stiffness(double stiffness, const Physics& physics, double time_step) {
  const double rate = time_step * stiffness;
  return rate > 0 && time_step * rate <= 4 * physics.effectiveMass;
}

/// Of every run: below which stiffness of the normal law, 0 or above, is_plain_stiffness() holds
/// [N/m], less by more than rounding; NaN, below which is nothing, for numbers that are not
/// allowed.
template <class Physics>
double plain_stiffness(const Physics& physics, double time_step) {
  if (!(time_step > 0) || first_wrong(contact_quantities<Physics>, physics)) {
    return std::numeric_limits<double>::quiet_NaN();
  }
  constexpr double less = 1 - 8 * std::numeric_limits<double>::epsilon();
  return less * 4 * physics.effectiveMass / time_step / time_step;
}

/// Of every run: below which magnitude of a temperature change an expansion leaves every length
/// [K], less by more than rounding; 0 for a coefficient that is none. @param expansion [1/K]
inline double plain_change(double expansion) {
  constexpr double less = 1 - 8 * std::numeric_limits<double>::epsilon();
  return std::isfinite(expansion) ? less / std::abs(expansion) : 0;
}

/// Of every step: below a bound of the run. Fails where either is none.
inline bool is_below(double value, double bound) {
  return value < bound;
}

/// What is to be done with the answer of a contact that is not plain.
enum class Answer : unsigned char { good, step_is_too_long, no_number };

/// @param stiffness of the normal law [N/m]; @param force on body 1 [N]
template <class Physics>
Answer judge(double stiffness, const Vector3& force, const Physics& physics, double time_step) {
  const bool is_number = stiffness >= 0 && std::isfinite(stiffness) && is_finite(force);
  if (!is_number || !(time_step > 0) || first_wrong(contact_quantities<Physics>, physics)) {
    return Answer::no_number;
  }
  return step_is_too_long(stiffness, physics, time_step) ? Answer::step_is_too_long : Answer::good;
}

/// Of every step of a link: it has a length, and its force is a number.
inline bool is_plain(const LinkStep& step, const Vector3& force) {
  return step.stress_free_length > 0 && is_plain(force);
}

}  // namespace statejump::stepper
