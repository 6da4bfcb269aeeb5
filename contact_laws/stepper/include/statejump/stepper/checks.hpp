// SPDX-License-Identifier: GPL-3.0-or-later
// Checks of link and contact parameters and of the results of a step. The plugin's engines and
// functors and the stepper use the same checks. NaN never passes.
//
// Parameters are checked when they enter: when an attribute is set, a run begins or arrays are
// filled. Results are checked in every step by a few comparisons; only a result that fails these is
// examined in detail.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

#include "statejump/kernel/joint_kinematics.hpp"
#include "statejump/kernel/vector.hpp"
#include "statejump/stepper/beam_bond.hpp"
#include "statejump/stepper/link.hpp"
#include "statejump/stepper/prismatic.hpp"

namespace statejump::stepper {

enum class ValueRange : unsigned char { finite, not_negative, positive };

inline bool allows(ValueRange allowed, double value) {
  return std::isfinite(value) && (allowed == ValueRange::finite || value > 0 ||
                                  (allowed == ValueRange::not_negative && value == 0));
}

/// Text of the range for messages; the unit follows it.
inline const char* range_text(ValueRange allowed) {
  return allowed == ValueRange::finite     ? "finite"
         : allowed == ValueRange::positive ? "above 0"
                                           : "0 or above";
}

/// A number of an object, with its public name, its member, its allowed range and its unit.
template <class Object>
struct Quantity {
  const char* name;
  double Object::*value;
  ValueRange allowed;
  const char* unit;
};

template <class Object, std::size_t size>
using Quantities = std::array<Quantity<Object>, size>;

/// Returns the first quantity of an object that is out of range, or null.
template <class Object, std::size_t size>
const Quantity<Object>* first_invalid(const Quantities<Object, size>& quantities,
                                      const Object& object) {
  for (const Quantity<Object>& each : quantities) {
    if (!allows(each.allowed, object.*each.value)) return &each;
  }
  return nullptr;
}

/// Parameters of an active link.
constexpr Quantities<Link, 6> link_quantities = {
    {{"youngModulus", &Link::youngModulus, ValueRange::not_negative, "Pa"},
     {"crossSectionArea", &Link::crossSectionArea, ValueRange::not_negative, "m2"},
     {"stressFreeLength", &Link::stressFreeLength, ValueRange::positive, "m"},
     {"thermalExpansion", &Link::thermalExpansion, ValueRange::finite, "1/K"},
     {"dampingRatio", &Link::dampingRatio, ValueRange::not_negative, "-"},
     {"pinDamping", &Link::pinDamping, ValueRange::not_negative, "N m s/rad"}}};

/// Parameters of an active torsion spring. A frictionLimit > 0 requires a frictionStiffness > 0.
constexpr Quantities<Torsion, 8> torsion_quantities = {
    {{"stiffness", &Torsion::stiffness, ValueRange::not_negative, "N m/rad"},
     {"freeAngle", &Torsion::freeAngle, ValueRange::finite, "rad"},
     {"deadband", &Torsion::deadband, ValueRange::not_negative, "rad"},
     {"preload", &Torsion::preload, ValueRange::finite, "N m"},
     {"frictionLimit", &Torsion::frictionLimit, ValueRange::not_negative, "N m"},
     {"frictionStiffness", &Torsion::frictionStiffness, ValueRange::not_negative, "N m/rad"},
     {"slipAngle", &Torsion::slipAngle, ValueRange::finite, "rad"},
     {"frictionMoment", &Torsion::frictionMoment, ValueRange::finite, "N m"}}};

inline bool has_friction_without_stiffness(const Torsion& spring) {
  return spring.frictionLimit > 0 && !(spring.frictionStiffness > 0);
}

/// Parameters of a slider between two bodies. A friction limit or a stop requires a stiffness > 0.
/// Clearances are >= 0, and infinite without a stop.
constexpr Quantities<Prismatic, 9> prismatic_quantities = {
    {{"stiffnessAcross", &Prismatic::stiffnessAcross, ValueRange::not_negative, "N/m"},
     {"frictionLimit", &Prismatic::frictionLimit, ValueRange::not_negative, "N"},
     {"frictionStiffness", &Prismatic::frictionStiffness, ValueRange::not_negative, "N/m"},
     {"stopStiffness", &Prismatic::stopStiffness, ValueRange::not_negative, "N/m^1.5"},
     {"stopSpring", &Prismatic::stopSpring, ValueRange::not_negative, "N/m"},
     {"play", &Prismatic::play, ValueRange::not_negative, "m"},
     {"dampingRatio", &Prismatic::dampingRatio, ValueRange::not_negative, "-"},
     {"slipPosition", &Prismatic::slipPosition, ValueRange::finite, "m"},
     {"frictionForce", &Prismatic::frictionForce, ValueRange::finite, "N"}}};

inline bool has_friction_without_stiffness(const Prismatic& joint) {
  return joint.frictionLimit > 0 && !(joint.frictionStiffness > 0);
}

inline bool has_stop_without_stiffness(const Prismatic& joint) {
  return std::isfinite(std::min(joint.clearanceMinus, joint.clearancePlus)) &&
         !(joint.stopStiffness + joint.stopSpring > 0);
}

/// Parameters of an active beam. Shear stiffnesses are > 0, and infinite without shear deformation.
constexpr Quantities<BeamBond, 9> beam_quantities = {
    {{"axialStiffness", &BeamBond::axialStiffness, ValueRange::positive, "N"},
     {"torsionalStiffness", &BeamBond::torsionalStiffness, ValueRange::positive, "N m2"},
     {"bendingStiffnessY", &BeamBond::bendingStiffnessY, ValueRange::positive, "N m2"},
     {"bendingStiffnessZ", &BeamBond::bendingStiffnessZ, ValueRange::positive, "N m2"},
     {"stressFreeLength", &BeamBond::stressFreeLength, ValueRange::positive, "m"},
     {"thermalExpansion", &BeamBond::thermalExpansion, ValueRange::finite, "1/K"},
     {"gradientY", &BeamBond::gradientY, ValueRange::finite, "1/m"},
     {"gradientZ", &BeamBond::gradientZ, ValueRange::finite, "1/m"},
     {"dampingRatio", &BeamBond::dampingRatio, ValueRange::not_negative, "-"}}};

/// Parameters of a contact that touches; Physics is ContactPhysics or JointPhys.
template <class Physics>
constexpr Quantities<Physics, 6> contact_quantities = {
    {{"effectiveYoungModulus", &Physics::effectiveYoungModulus, ValueRange::positive, "Pa"},
     {"effectiveShearModulus", &Physics::effectiveShearModulus, ValueRange::positive, "Pa"},
     {"effectiveMass", &Physics::effectiveMass, ValueRange::not_negative, "kg"},
     {"normalDampingRatio", &Physics::normalDampingRatio, ValueRange::not_negative, "-"},
     {"tangentialDampingRatio", &Physics::tangentialDampingRatio, ValueRange::not_negative, "-"},
     {"tangensOfFrictionAngle", &Physics::tangensOfFrictionAngle, ValueRange::not_negative, "-"}}};

inline bool is_finite(const Vector3& v) {
  return std::isfinite(v[0]) && std::isfinite(v[1]) && std::isfinite(v[2]);
}

inline bool is_finite(const kernel::BodyMotion& motion) {
  return is_finite(motion.position) && is_finite(motion.velocity) &&
         is_finite(motion.angular_velocity);
}

/// Fast check in every step that all components are finite. It may return false for finite
/// components if their sum overflows.
inline bool is_finite_fast(const Vector3& v) {
  const double sum = v[0] + v[1] + v[2];
  return sum - sum == 0;
}

/// Returns whether a body with this linear thermal strain [-] has a positive length.
inline bool is_strain(double strain) {
  return 1 + strain > 0 && std::isfinite(strain);
}

/// Fast check in every step; sufficient for is_strain().
inline bool is_small_strain(double strain) {
  return std::abs(strain) < 1;
}

/// Returns whether the step exceeds the stability limit omega dt = 2 of this contact alone.
/// Leapfrog is then unstable, whatever the other forces are.
/// @param stiffness [N/m]; @param time_step [s]
template <class Physics>
bool step_is_too_long(double stiffness, const Physics& physics, double time_step) {
  return time_step * time_step * stiffness > 4 * physics.effectiveMass && physics.effectiveMass > 0;
}

/// Fast check in every step of a touching contact that its stiffness is positive and the step
/// stable. It returns false if a modulus, depth, mass or time step is NaN, and if both bodies are
/// fixed.
template <class Physics>
bool is_stable_stiffness(double stiffness, const Physics& physics, double time_step) {
  const double rate = time_step * stiffness;
  return rate > 0 && time_step * rate <= 4 * physics.effectiveMass;
}

/// Largest normal stiffness [N/m] for which is_stable_stiffness() holds, computed once per run and
/// reduced by a margin for rounding. It is NaN for invalid parameters, so that every comparison
/// with it is false.
template <class Physics>
double stable_stiffness(const Physics& physics, double time_step) {
  if (!(time_step > 0) || first_invalid(contact_quantities<Physics>, physics)) {
    return std::numeric_limits<double>::quiet_NaN();
  }
  constexpr double less = 1 - 8 * std::numeric_limits<double>::epsilon();
  return less * 4 * physics.effectiveMass / time_step / time_step;
}

/// Largest |temperature change| [K] for which thermal expansion leaves every length positive. It is
/// computed once per run and reduced by a margin for rounding. It is 0 for a NaN coefficient.
/// @param expansion [1/K]
inline double safe_temperature_change(double expansion) {
  constexpr double less = 1 - 8 * std::numeric_limits<double>::epsilon();
  return std::isfinite(expansion) ? less / std::abs(expansion) : 0;
}

/// Fast comparison in every step with a bound computed once per run. It returns false if a number
/// is NaN.
inline bool is_below(double value, double bound) {
  return value < bound;
}

/// Result of the detailed check of a response.
enum class ResponseCheck : unsigned char { valid, step_is_too_long, not_finite };

/// @param stiffness normal stiffness of the contact [N/m]; @param force force on body 1 [N]
template <class Physics>
ResponseCheck check_response(double stiffness, const Vector3& force, const Physics& physics,
                             double time_step) {
  const bool is_number = stiffness >= 0 && std::isfinite(stiffness) && is_finite(force);
  if (!is_number || !(time_step > 0) || first_invalid(contact_quantities<Physics>, physics)) {
    return ResponseCheck::not_finite;
  }
  return step_is_too_long(stiffness, physics, time_step) ? ResponseCheck::step_is_too_long
                                                         : ResponseCheck::valid;
}

/// Fast check in every step of a link that its stress-free length is positive and its force finite.
inline bool is_finite_fast(const LinkStep& step, const Vector3& force) {
  return step.stress_free_length > 0 && is_finite_fast(force);
}

}  // namespace statejump::stepper
