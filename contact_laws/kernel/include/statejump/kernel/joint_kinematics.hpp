// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <limits>

#include "statejump/kernel/arithmetic.hpp"
#include "statejump/kernel/contact_law.hpp"
#include "statejump/kernel/frame.hpp"
#include "statejump/kernel/hertz.hpp"
#include "statejump/kernel/vector.hpp"

namespace statejump::kernel {

/// Motion of one rigid body, world frame.
struct BodyMotion {
  Vector3 position;          ///< of the centre [m]
  Vector3 velocity;          ///< of the centre [m/s]
  Vector3 angular_velocity;  ///< [rad/s]
};

/// Geometry of one contact point between body 1 (journal, ball, slider) and body 2 (bearing,
/// socket, slot, other ball). For a gap, the contact point is the middle of the gap.
struct JointContact {
  double penetration_depth;   ///< delta [m]; negative: gap
  Vector3 normal;             ///< unit, from body 1 into body 2
  Vector3 arm_1;              ///< contact point minus centre of body 1 [m]
  Vector3 arm_2;              ///< contact point minus centre of body 2 [m]
  Vector3 relative_velocity;  ///< v1 - v2 of the material at the contact point [m/s]
  double effective_radius;    ///< R [m] for hertz()
  double eccentricity;        ///< offset of body 1 from body 2 along the normal [m]
};
using RevoluteContact = JointContact;  ///< of revolute_contact()
using BallContact = JointContact;      ///< of ball_contact()
using PlaneContact = JointContact;     ///< of plane_contact()

/// Converts the geometry of a joint to the input of the contact law.
/// @param time_step dt [s]
inline ContactKinematics contact_kinematics(const JointContact& contact, double time_step) {
  return {contact.normal, contact.penetration_depth, contact.effective_radius,
          contact.relative_velocity, time_step};
}

/// Velocity [m/s] of the material of a body at the position centre + arm.
/// @param velocity of the centre [m/s]; @param spin [rad/s]; @param arm [m]
template <class A>
[[gnu::always_inline]] inline typename A::Vector material_velocity(
    const typename A::Vector& velocity, const typename A::Vector& spin,
    const typename A::Vector& arm) {
  return velocity + A::cross(spin, arm);
}
inline Vector3 material_velocity(const BodyMotion& body, const Vector3& arm) {
  return material_velocity<Single>(body.velocity, body.angular_velocity, arm);
}

/// Penetration depth [m] of a round body inside another one; negative: gap.
/// @param offset distance of the centres [m]; @param inner_radius R1, outer_radius R2 [m]
template <class A = Single>
[[gnu::always_inline]] inline typename A::Number depth_inside(
    const typename A::Number& offset, const typename A::Number& inner_radius,
    const typename A::Number& outer_radius) {
  return offset - (outer_radius - inner_radius);
}

/// Penetration depth [m] of a pad in a plane face; negative: gap.
/// @param eccentricity offset of the pad's centre along the normal [m]
/// @param pad_radius R [m]; @param face_distance w [m]
template <class A = Single>
[[gnu::always_inline]] inline typename A::Number depth_in_plane(
    const typename A::Number& eccentricity, const typename A::Number& pad_radius,
    const typename A::Number& face_distance) {
  return pad_radius - (face_distance - eccentricity);
}

/// Contact point, half-way between the two surfaces, minus the centre of body 1 [m].
/// @param radius R1 [m]; @param depth delta [m]
template <class A = Single>
[[gnu::always_inline]] inline typename A::Vector arm_of_first(const typename A::Number& radius,
                                                              const typename A::Number& depth,
                                                              const typename A::Vector& normal) {
  return normal * (radius - 0.5 * depth);
}

/// Penetration depth of journal and bearing [m], eq. (12): delta = |d| - (R2 - R1), where d is the
/// offset of eq. (11) perpendicular to the axis. A negative depth is a gap. The cost is one square
/// root.
/// @param journal_centre, bearing_centre [m]; @param journal_radius, bearing_radius [m]
/// @param axis unit vector along the bearing's axis
inline double revolute_penetration(const Vector3& journal_centre, double journal_radius,
                                   const Vector3& bearing_centre, double bearing_radius,
                                   const Vector3& axis) {
  return depth_inside(perpendicular_part(journal_centre - bearing_centre, axis).norm(),
                      journal_radius, bearing_radius);
}

/// Returns whether journal and bearing touch, i.e. revolute_penetration() > 0. It compares squares,
/// without a square root. Both functions may disagree within rounding, |delta| of about 1e-16 of
/// the clearance. A bearing not larger than the journal counts as touching, so that
/// revolute_contact() reports it. NaN positions count as touching too, so that the depth becomes
/// NaN.
inline bool revolute_touches(const Vector3& journal_centre, double journal_radius,
                             const Vector3& bearing_centre, double bearing_radius,
                             const Vector3& axis) {
  const double clearance = bearing_radius - journal_radius;
  return !(clearance > 0.0) ||
         !(perpendicular_part(journal_centre - bearing_centre, axis).squaredNorm() <=
           clearance * clearance);
}

namespace detail {

/// One contact of round bodies: a journal or ball inside a bearing or socket.
/// @param centres position of centre 1 minus that of centre 2 [m]
/// @param offset d [m], the component of `centres` that closes the clearance
/// @param concentric_normal returns the normal when d is zero
template <class Normal>
[[gnu::always_inline]] inline JointContact round_contact(
    const BodyMotion& inner, double inner_radius, const BodyMotion& outer, double outer_radius,
    const Vector3& centres, const Vector3& offset, const Normal& concentric_normal) {
  JointContact contact;
  const double offset_squared = offset.squaredNorm();
  if (offset_squared <= std::numeric_limits<double>::min()) {
    contact.eccentricity = 0.0;
    contact.normal = concentric_normal();
  } else {  // also for NaN, which then propagates to the depth
    contact.eccentricity = std::sqrt(offset_squared);
    contact.normal = offset * (1.0 / contact.eccentricity);
  }
  contact.effective_radius = internal_effective_radius(inner_radius, outer_radius);
  contact.penetration_depth = depth_inside(contact.eccentricity, inner_radius, outer_radius);
  contact.arm_1 = arm_of_first(inner_radius, contact.penetration_depth, contact.normal);
  contact.arm_2 = centres + contact.arm_1;
  contact.relative_velocity =
      material_velocity(inner, contact.arm_1) - material_velocity(outer, contact.arm_2);
  return contact;
}

}  // namespace detail

/// Journal in a bearing with clearance c = R2 - R1, the paper's eqs (11) to (13):
///
///     d = r_C - r_D, perpendicular to the bearing's axis;   delta = |d| - c;   n = d/|d|.
///
/// The paper's two contact points of eq. (14), r_C + R1 n and r_D + R2 n, are delta apart. This
/// function uses a single point half-way between them, in the journal's mid-plane,
///
///    P = r_C + (R1 - delta/2) n = r_D + (axial offset) + (R2 + delta/2) n,
///
/// so that the moments of action and reaction balance. The velocities are those of the material at
/// P, v + omega x arm. Eqs (15) and (16) differentiate the geometric points instead. These
/// derivatives omit the spin, and thus the sliding of a rotating journal.
///
/// Cost: one square root, two divisions. The axial offset does not change the depth, because the
/// joint counts as infinitely long. Tilt of the journal relative to the axis is ignored.
/// @param journal_radius R1 [m], @param bearing_radius R2 [m], 0 < R1 < R2
/// @param axis unit vector along the bearing's axis, either direction
/// @return the contact; concentric bodies have a gap (depth -c) and any unit normal perpendicular
///     to the axis
/// @throws std::invalid_argument when not 0 < R1 < R2
[[gnu::always_inline]] inline RevoluteContact revolute_contact(const BodyMotion& journal,
                                                               double journal_radius,
                                                               const BodyMotion& bearing,
                                                               double bearing_radius,
                                                               const Vector3& axis) {
  const Vector3 centres = journal.position - bearing.position;
  const auto across_the_axis = [&] {
    const Vector3 away = std::abs(axis.x()) < 0.6 ? Vector3::UnitX() : Vector3::UnitY();
    return Vector3(perpendicular_part(away, axis).normalized());
  };
  return detail::round_contact(journal, journal_radius, bearing, bearing_radius, centres,
                               perpendicular_part(centres, axis), across_the_axis);
}

/// Penetration depth of a ball in its socket [m]: delta = |d| - (R2 - R1), d from socket centre to
/// ball centre. A negative depth is a gap.
/// @param ball_centre, socket_centre [m]; @param ball_radius R1, socket_radius R2 [m]
inline double ball_penetration(const Vector3& ball_centre, double ball_radius,
                               const Vector3& socket_centre, double socket_radius) {
  return depth_inside((ball_centre - socket_centre).norm(), ball_radius, socket_radius);
}

/// Whether ball and socket touch; decided as in revolute_touches().
inline bool ball_touches(const Vector3& ball_centre, double ball_radius,
                         const Vector3& socket_centre, double socket_radius) {
  const double clearance = socket_radius - ball_radius;
  return !(clearance > 0.0) ||
         !((ball_centre - socket_centre).squaredNorm() <= clearance * clearance);
}

/// Ball of radius R1 in a spherical socket of radius R2: the joint of revolute_contact() with the
/// offset d in all three directions,
///
///     d = r_C - r_D;   delta = |d| - c;   n = d/|d|;   P = r_C + (R1 - delta/2) n.
///
/// The bodies touch exactly along a circle of effective radius R1 R2/(R2 - R1), as Hertz's formulas
/// assume. The socket counts as a whole inner sphere; its opening is ignored. Cost: one square
/// root, two divisions.
/// @param ball_radius R1 [m], @param socket_radius R2 [m], 0 < R1 < R2
/// @return the contact; concentric bodies have a gap (depth -c) and the normal x
/// @throws std::invalid_argument when not 0 < R1 < R2
[[gnu::always_inline]] inline BallContact ball_contact(const BodyMotion& ball, double ball_radius,
                                                       const BodyMotion& socket,
                                                       double socket_radius) {
  const Vector3 centres = ball.position - socket.position;
  return detail::round_contact(ball, ball_radius, socket, socket_radius, centres, centres,
                               [] { return Vector3(Vector3::UnitX()); });
}

/// Returns whether two balls touch each other from outside, by comparison of squares as in
/// revolute_touches(). NaN positions count as touching.
/// @param centre_1, centre_2 [m]; @param radius_1 R1, radius_2 R2 [m]
inline bool outer_balls_touch(const Vector3& centre_1, double radius_1, const Vector3& centre_2,
                              double radius_2) {
  const double reach = radius_1 + radius_2;
  return !((centre_1 - centre_2).squaredNorm() >= reach * reach);
}

/// Contact of two balls from outside. With d = r_1 - r_2
///
///     delta = R1 + R2 - |d|;   n = -d/|d|;   P = r_1 + (R1 - delta/2) n.
///
/// This is ball_contact() for a socket turned inside out, R2 < 0. The effective radius is R1 R2/(R1
/// + R2), the clearance -(R1 + R2) and the eccentricity -|d|. Cost: one square root, two divisions.
/// @param radius_1 R1 [m], @param radius_2 R2 [m], both > 0; |d| > 0
/// @throws std::invalid_argument when R1 or R2 is not > 0
/// Limit: Hertz's theory needs a contact small relative to both balls, i.e. a depth far below both
/// radii.
inline BallContact outer_ball_contact(const BodyMotion& ball_1, double radius_1,
                                      const BodyMotion& ball_2, double radius_2) {
  BallContact contact;
  const Vector3 centres = ball_1.position - ball_2.position;
  const double distance = centres.norm();
  contact.eccentricity = -distance;
  contact.normal = centres * (-1.0 / distance);
  contact.effective_radius = internal_effective_radius(radius_1, -radius_2);
  contact.penetration_depth = (radius_1 + radius_2) - distance;
  contact.arm_1 = arm_of_first(radius_1, contact.penetration_depth, contact.normal);
  contact.arm_2 = centres + contact.arm_1;
  contact.relative_velocity =
      material_velocity(ball_1, contact.arm_1) - material_velocity(ball_2, contact.arm_2);
  return contact;
}

/// Contact of a slider's spherical pad with the flat end wall of its slot.
///
///     delta = R - (w - (r_1 - r_2) . n),   P = r_1 + (R - delta/2) n,
///
/// where w is the distance of the wall from the slot's centre. The velocities are those of the
/// material at P. The effective radius is R, because the wall is flat. Cost: no square root, no
/// division.
/// @param slider body 1, whose centre is the pad's centre of curvature
/// @param pad_radius R [m], > 0
/// @param slot body 2
/// @param face_normal unit normal n from the slider into the wall, world frame
/// @param face_distance distance w [m] of the wall from the slot's centre along n
inline PlaneContact plane_contact(const BodyMotion& slider, double pad_radius,
                                  const BodyMotion& slot, const Vector3& face_normal,
                                  double face_distance) {
  PlaneContact contact;
  const Vector3 centres = slider.position - slot.position;
  contact.eccentricity = centres.dot(face_normal);
  contact.penetration_depth = depth_in_plane(contact.eccentricity, pad_radius, face_distance);
  contact.normal = face_normal;
  contact.arm_1 = arm_of_first(pad_radius, contact.penetration_depth, face_normal);
  contact.arm_2 = centres + contact.arm_1;
  contact.relative_velocity =
      material_velocity(slider, contact.arm_1) - material_velocity(slot, contact.arm_2);
  contact.effective_radius = pad_radius;
  return contact;
}

}  // namespace statejump::kernel
