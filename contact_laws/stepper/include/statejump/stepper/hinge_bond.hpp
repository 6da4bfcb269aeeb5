// SPDX-License-Identifier: GPL-3.0-or-later
// Hinges between two bodies at one position: they move together and rotate freely about one axis.
#pragma once

#include <array>
#include <cmath>

#include "statejump/kernel/vector.hpp"
#include "statejump/stepper/link.hpp"

namespace statejump::stepper {

/// A body at a hinge before its step. Force and torque are sums of everything but the hinge.
struct HingeBody {
  Vector3 position, velocity, spin, force, torque;
  Quaternion orientation;
  double mass;
  double inertia;    ///< equal about all axes [kg m2]
  unsigned blocked;  ///< bits of dofs: three translations, then three rotations
};

/// Returns whether a hinge can hold two bodies with these blocked rotations together: a body that
/// cannot rotate at all holds the other across the axis. Else both must have the same blocked
/// rotations, none or, about an axis of the coordinates, those across it.
/// @param axis of the hinge in space
inline bool can_hold(const HingeBody& one, const HingeBody& two, const Vector3& axis) {
  constexpr unsigned rotations = 56;
  const unsigned first = one.blocked & rotations, second = two.blocked & rotations;
  if (first == rotations || second == rotations || (first == 0 && second == 0)) return true;
  for (int k = 0; k < 3; ++k) {
    if (std::abs(axis[k]) != 1) continue;
    const unsigned across = rotations & ~(8U << k);
    return (first & across) == (second & across);
  }
  return false;
}

namespace detail {

inline Quaternion rotated(const Vector3& from, const Vector3& to, const Quaternion& orientation) {
  if (from == to) return orientation;
  Quaternion made = smallest_rotation(from, to) * orientation;
  made.normalize();
  return made;
}

/// Weight of body 1 in a mean: a body that cannot move has the weight 1.
inline double weight(double first, double second, bool first_fixed, bool second_fixed) {
  if (first_fixed || second_fixed) return first_fixed ? 1 : 0;
  return first / (first + second);
}

}  // namespace detail

/// Makes two bodies move as a hinge lets them: positions, velocities and spins across the axis
/// become equal, weighted by mass and inertia, and forces and torques give equal accelerations. The
/// means keep momentum and moment of momentum. A constraint between masses adds no frequency above
/// those of the free bodies.
/// @param axis in the reference configuration, unit vector
/// @return the axis in space
inline Vector3 hold_together(HingeBody& one, HingeBody& two, const Vector3& axis) {
  constexpr unsigned rotations = 56;
  for (int k = 0; k < 3; ++k) {
    const bool first = (one.blocked & (1U << k)) != 0, second = (two.blocked & (1U << k)) != 0;
    const double share = detail::weight(one.mass, two.mass, first, second);
    one.position[k] = two.position[k] =
        one.position[k] == two.position[k]
            ? one.position[k]
            : share * one.position[k] + (1 - share) * two.position[k];
    one.velocity[k] = two.velocity[k] =
        one.velocity[k] == two.velocity[k]
            ? one.velocity[k]
            : share * one.velocity[k] + (1 - share) * two.velocity[k];
    const double force = first || second ? 0 : one.force[k] + two.force[k];
    one.force[k] = share * force;
    two.force[k] = (1 - share) * force;
  }
  const bool first = (one.blocked & rotations) == rotations;
  const bool second = (two.blocked & rotations) == rotations;
  const double share = detail::weight(one.inertia, two.inertia, first, second);
  const Vector3 from1 = one.orientation * axis, from2 = two.orientation * axis;
  const Vector3 now =
      from1 == from2 ? from1 : Vector3(share * from1 + (1 - share) * from2).normalized();
  one.orientation = detail::rotated(from1, now, one.orientation);
  two.orientation = detail::rotated(from2, now, two.orientation);
  const double spin1 = one.spin.dot(now), spin2 = two.spin.dot(now);
  const double torque1 = one.torque.dot(now), torque2 = two.torque.dot(now);
  const Vector3 across1 = one.spin - spin1 * now, across2 = two.spin - spin2 * now;
  const Vector3 spin = across1 == across2 ? across1 : Vector3(share * across1 + (1 - share) * across2);
  one.spin = spin + spin1 * now;
  two.spin = spin + spin2 * now;
  Vector3 torque = Vector3::Zero();
  if (!first && !second) {
    torque = one.torque + two.torque;
    torque -= torque.dot(now) * now;
  }
  one.torque = share * torque + torque1 * now;
  two.torque = (1 - share) * torque + torque2 * now;
  return now;
}

/// Angle and moment of a hinge, by the law of a torsion spring; the moment acts on body 1 about the
/// axis in space, its opposite on body 2.
/// @param law with the axis in the reference configuration; updated
inline TorsionEnergy hinge_law(Torsion& law, const HingeBody& one, const HingeBody& two,
                               const Vector3& axis) {
  const Vector3 across = law.axis.unitOrthogonal();
  Torsion in_space = law;
  in_space.axis = axis;
  const TorsionEnergy energy = torsion_step(in_space, Span{one.orientation * across, 1},
                                            Span{two.orientation * across, 1});
  law.angle = in_space.angle;
  law.moment = in_space.moment;
  law.frictionMoment = in_space.frictionMoment;
  law.slipAngle = in_space.slipAngle;
  return energy;
}

}  // namespace statejump::stepper
