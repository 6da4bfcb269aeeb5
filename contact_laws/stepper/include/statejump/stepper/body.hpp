// SPDX-License-Identifier: GPL-3.0-or-later
// Motion of one body in one step: the arithmetic of YADE's NewtonIntegrator and ForceContainer,
// operation by operation, so that both give the same bits.
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "statejump/kernel/joint_kinematics.hpp"
#include "statejump/kernel/vector.hpp"

namespace statejump::stepper {

using kernel::Vector3;
using Quaternion = Eigen::Quaterniond;

/// Bits of Body::blocked: three translations, then three rotations.
constexpr unsigned all_translations = 7;
constexpr unsigned all_rotations = 56;
constexpr unsigned all_dofs = all_translations | all_rotations;

/// Parameters of the integrator; the attributes of NewtonIntegrator.
struct Newton {
  double damping = 0;                 ///< [-]
  Vector3 gravity = Vector3::Zero();  ///< [m/s2]
  bool dampGravity = true;
};

struct Body {
  kernel::BodyMotion motion{Vector3::Zero(), Vector3::Zero(), Vector3::Zero()};
  Quaternion orientation = Quaternion::Identity();
  Vector3 inertia = Vector3::Zero();  ///< [kg m2]
  double mass = 0;                    ///< [kg]
  double inverse_mass = 0;            ///< [1/kg], 0 for a body that cannot move
  unsigned blocked = all_dofs;
  bool damped = true;
  // Forces since the last sum (`added_...`), from any thread as in YADE, and the sums.
  Vector3 added_force = Vector3::Zero(), added_torque = Vector3::Zero();
  Vector3 force = Vector3::Zero(), torque = Vector3::Zero();
  Vector3 permanent_force = Vector3::Zero(), permanent_torque = Vector3::Zero();
  // When the body is farther than bound_reach [m] from this position, the collider must run again.
  Vector3 bound_position = Vector3::Zero();
  double bound_reach = 0;
  bool bounded = false;
  bool rotates = false;  ///< its orientation changes or can change
  bool moves = false;    ///< any part of its state changes or can change
  // A link that rotates its tip in the plane overwrites the tip's orientation. It uses only the
  // half space of the old quaternion, so the integrator may skip the rotation.
  bool rotation_deferrable = false;  ///< only such a link and round joints read the orientation
  bool rotation_deferred = false;    ///< the rotation of the last step was skipped
};

/// Adds the new forces to the force sums.
/// @param first whether this is the first sum of the step
inline void sum_forces(Body& body, bool first) {
  if (first) {
    body.force = body.added_force + body.permanent_force;
    body.torque = body.added_torque + body.permanent_torque;
  } else {
    body.force += body.added_force;
    body.torque += body.added_torque;
  }
  body.added_force = body.added_torque = Vector3::Zero();
}

namespace detail {

inline double sign(double value) {
  return value > 0 ? 1 : value < 0 ? -1 : 0;
}

/// Numerical damping of an acceleration (Cundall).
inline void damp(double damping, double time_step, const Vector3& velocity, Vector3& acceleration) {
  for (int i = 0; i < 3; ++i) {
    acceleration[i] *=
        1 - damping * sign(acceleration[i] * (velocity[i] + 0.5 * time_step * acceleration[i]));
  }
}

/// Returns whether normalization leaves the orientation unchanged. A rotation without spin only
/// normalizes.
inline bool is_normalized(const Quaternion& orientation) {
  Quaternion normalized = orientation;
  normalized.normalize();
  return normalized.coeffs() == orientation.coeffs();
}

}  // namespace detail

/// Returns whether the body's state cannot change unless another object rotates the body.
inline bool is_at_rest(const Body& body) {
  return body.blocked == all_dofs && body.motion.velocity.isZero(0) &&
         body.motion.angular_velocity.isZero(0) && detail::is_normalized(body.orientation);
}

inline bool can_rotate(const Body& body) {
  return (body.blocked & all_rotations) != all_rotations ||
         !body.motion.angular_velocity.isZero(0) || !detail::is_normalized(body.orientation);
}

/// Returns whether the collider would run again because of the body's current position.
inline bool left_bound(const Body& body) {
  if (!body.bounded) return false;
  const Vector3 moved = body.motion.position - body.bound_position;
  const double most =
      std::max(std::abs(moved[0]), std::max(std::abs(moved[1]), std::abs(moved[2])));
  return most != 0 && !(most < body.bound_reach);
}

/// Rotates a body by its spin, as the last part of a step. The function is not inlined: otherwise
/// the caller loads the body's data before it knows whether the rotation can be deferred.
/// @param time_step [s]
[[gnu::noinline]] inline void turn(Body& body, double time_step) {
  const Vector3& spin = body.motion.angular_velocity;
  const double speed_squared = spin.squaredNorm();
  if (speed_squared != 0) {
    const double speed = std::sqrt(speed_squared);
    const Quaternion by(Eigen::AngleAxisd(speed * time_step, spin / speed));
    body.orientation = by * body.orientation;
  }
  body.orientation.normalize();
}

/// Returns whether the integrator may skip the rotation of this step, because a link overwrites it.
/// The rotation must be about z, so that the axis stays fixed, and small, so that the quaternion
/// stays in its half space.
inline bool can_defer_rotation(const Body& body, double time_step) {
  const Quaternion& lies = body.orientation;
  const Vector3& spin = body.motion.angular_velocity;
  return body.rotation_deferrable && lies.x() == 0 && lies.y() == 0 && spin.x() == 0 &&
         spin.y() == 0 && std::abs(spin.z()) * time_step < 0.1;
}

/// Makes one leapfrog step with the current force sums.
/// @param time_step [s]
/// @param last whether other code may read the body before its next step
inline void move(Body& body, const Newton& newton, double time_step, bool last = true) {
  if (body.blocked != all_dofs) {
    Vector3 acceleration = Vector3::Zero();
    if (body.blocked == 0) {
      acceleration = body.force / body.mass;
      if (newton.dampGravity) acceleration += newton.gravity;
    } else {
      for (int i = 0; i < 3; ++i) {
        if (body.blocked & (1U << i)) continue;
        acceleration[i] += newton.dampGravity ? body.force[i] / body.mass + newton.gravity[i]
                                              : body.force[i] / body.mass;
      }
    }
    const bool damped = body.damped && newton.damping != 0;
    if (damped) detail::damp(newton.damping, time_step, body.motion.velocity, acceleration);
    if (!newton.dampGravity) {
      for (int i = 0; i < 3; ++i) {
        acceleration[i] += body.blocked & (1U << i) ? 0 : newton.gravity[i];
      }
    }
    body.motion.velocity += time_step * acceleration;
    if (body.rotates) {
      Vector3 turning = Vector3::Zero();
      if (body.blocked == 0) {
        turning = body.torque.cwiseQuotient(body.inertia);
      } else {
        for (int i = 0; i < 3; ++i) {
          if (!(body.blocked & (8U << i))) turning[i] += body.torque[i] / body.inertia[i];
        }
      }
      if (damped) detail::damp(newton.damping, time_step, body.motion.angular_velocity, turning);
      body.motion.angular_velocity += time_step * turning;
    }
  }
  body.motion.position += body.motion.velocity * time_step;
  if (!body.rotates) return;
  body.rotation_deferred = !last && can_defer_rotation(body, time_step);
  if (!body.rotation_deferred) turn(body, time_step);
}

}  // namespace statejump::stepper
