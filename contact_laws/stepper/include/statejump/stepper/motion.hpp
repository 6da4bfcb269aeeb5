// SPDX-License-Identifier: GPL-3.0-or-later
// Motion of one body in one step: the arithmetic of YADE's NewtonIntegrator and of its container of
// forces, operation by operation, so that both give the same bits.
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
constexpr unsigned everything = all_translations | all_rotations;

/// What the integrator is told; the attributes of NewtonIntegrator.
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
  unsigned blocked = everything;
  bool damped = true;
  // Added up since the last sum, as YADE's threads do, and the sums.
  Vector3 added_force = Vector3::Zero(), added_torque = Vector3::Zero();
  Vector3 force = Vector3::Zero(), torque = Vector3::Zero();
  Vector3 permanent_force = Vector3::Zero(), permanent_torque = Vector3::Zero();
  // The collider looks again when the body has come so far from there [m].
  Vector3 bound_position = Vector3::Zero();
  double bound_reach = 0;
  bool bounded = false;
  bool turns = false;  ///< its orientation changes, or may
  bool moves = false;  ///< anything of it changes, or may
  // A link that turns its tip in the plane asks for no more of how the tip lay than on which half
  // of all quaternions: what the integrator would turn before is left out.
  bool turn_may_wait = false;  ///< nothing but such a link and round joints asks how it lies
  bool turn_waits = false;     ///< of the last step
};

/// Sums up what was added. @param first whether it is the first sum of the step
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

/// Whether turning without spin, which normalizes, leaves the orientation as it is.
inline bool is_normalized(const Quaternion& orientation) {
  Quaternion normalized = orientation;
  normalized.normalize();
  return normalized.coeffs() == orientation.coeffs();
}

}  // namespace detail

/// Whether nothing of a body changes as long as nothing else turns it.
inline bool rests(const Body& body) {
  return body.blocked == everything && body.motion.velocity.isZero(0) &&
         body.motion.angular_velocity.isZero(0) && detail::is_normalized(body.orientation);
}

inline bool can_turn(const Body& body) {
  return (body.blocked & all_rotations) != all_rotations ||
         !body.motion.angular_velocity.isZero(0) || !detail::is_normalized(body.orientation);
}

/// Whether the collider would look again at a body that is where it is.
inline bool left_its_bound(const Body& body) {
  if (!body.bounded) return false;
  const Vector3 moved = body.motion.position - body.bound_position;
  const double most =
      std::max(std::abs(moved[0]), std::max(std::abs(moved[1]), std::abs(moved[2])));
  return most != 0 && !(most < body.bound_reach);
}

/// Turns a body by its spin, as the last part of a step. Not a part of who calls it, where its
/// loads would be made before it is known whether the turn can wait. @param time_step [s]
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

/// Whether the turn of this step can wait for a link that may make it needless: it is about z, as
/// all turns of the body were, so that its axis stays where it is; and short, so that it stays on
/// its half of all quaternions.
inline bool can_wait(const Body& body, double time_step) {
  const Quaternion& lies = body.orientation;
  const Vector3& spin = body.motion.angular_velocity;
  return body.turn_may_wait && lies.x() == 0 && lies.y() == 0 && spin.x() == 0 && spin.y() == 0 &&
         std::abs(spin.z()) * time_step < 0.1;
}

/// One leapfrog step with the forces as they are summed up. @param time_step [s]
/// @param last whether somebody may look at the body before its next step
inline void move(Body& body, const Newton& newton, double time_step, bool last = true) {
  if (body.blocked != everything) {
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
    if (body.turns) {
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
  if (!body.turns) return;
  body.turn_waits = !last && can_wait(body, time_step);
  if (!body.turn_waits) turn(body, time_step);
}

}  // namespace statejump::stepper
