// SPDX-License-Identifier: GPL-3.0-or-later
// Sliders between two bodies: one step of each. The plugin's engine and the stepper call the same
// functions.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "statejump/kernel/contact_law.hpp"
#include "statejump/kernel/stable_step.hpp"
#include "statejump/kernel/vector.hpp"

namespace statejump::stepper {

using kernel::Vector3;

/// A slider between two bodies. The members are the attributes of PrismaticJoint. Body 1 slides
/// relative to body 2 along an axis fixed in space. With the slide s = (x1 - x2 - offset) . axis,
/// friction and stop act on body 1 opposite to the axis:
///
///    friction  F_f = clamp(k_t b; -f, f), a spring in series with a friction slider at s_f;
///    stop      K d^1.5 (Hertz) + k_s d, where d is the excess of s over a clearance.
///
/// The spring deflection b is the part of s - s_f beyond half of the play w: b = (s - s_f) -
/// clamp(s - s_f; -w/2, w/2). Within the play only the stops resist.
///
/// A spring k_n resists relative displacement perpendicular to the axis. Forces act at the bodies'
/// centres and do not rotate them. Each spring has a dashpot with the damping ratio. The dashpot of
/// the friction spring acts during stick, within the friction limit. The dashpot of a stop or of a
/// closed play acts only while its total force is compressive.
struct Prismatic {
  int id1 = -1;
  int id2 = -1;
  Vector3 axis = Vector3::UnitX();
  Vector3 offset = Vector3::Zero();                                 ///< x1 - x2 at zero slide [m]
  double stiffnessAcross = 0;                                       ///< k_n [N/m]
  double frictionLimit = 0;                                         ///< f [N]
  double frictionStiffness = 0;                                     ///< k_t [N/m]
  double clearanceMinus = std::numeric_limits<double>::infinity();  ///< [m]
  double clearancePlus = std::numeric_limits<double>::infinity();   ///< [m]
  double stopStiffness = 0;                                         ///< K [N/m^1.5]
  double stopSpring = 0;                                            ///< k_s [N/m]
  double play = 0;                                                  ///< w [m]
  double dampingRatio = 0;                                          ///< [-]
  double slide = 0;                                                 ///< s [m]
  double slipPosition = 0;                                          ///< s_f [m]
  double frictionForce = 0;                                         ///< F_f without its dashpot [N]
  double stopForce = 0;  ///< of stop and its dashpot, positive opposite to the axis [N]
};

/// Position and velocity of body 1 relative to body 2.
struct PrismaticMotion {
  Vector3 apart;     ///< x1 - x2 [m]
  Vector3 velocity;  ///< v1 - v2 [m/s]
  double mass;       ///< reduced mass 1/(1/m1 + 1/m2) [kg]; 0: neither body moves
};

/// Result of a step.
struct PrismaticStep {
  Vector3 force;        ///< on body 1 [N]; body 2 gets the opposite
  double elastic;       ///< stored energy [J]
  double friction;      ///< loss of this step [J]
  double damping;       ///< loss of this step by dashpots [J]
  double largest_step;  ///< stable time step of the joint alone [s]
};

/// Depth [m] by which the slide exceeds its stop; negative if the stop is open.
inline double stop_depth(const Prismatic& joint) {
  return joint.slide > 0 ? joint.slide - joint.clearancePlus : -joint.slide - joint.clearanceMinus;
}

/// Stiffness of the stop [N/m]; 0 if it is open.
inline double stop_stiffness(const Prismatic& joint, double depth) {
  return depth > 0 ? 1.5 * joint.stopStiffness * std::sqrt(depth) + joint.stopSpring : 0.0;
}

/// Largest stiffness of the joint at its current slide [N/m].
inline double largest_stiffness(const Prismatic& joint) {
  const double stop = stop_stiffness(joint, stop_depth(joint));
  const double sticks = joint.frictionLimit > 0 ? joint.frictionStiffness : 0;
  return std::max(joint.stiffnessAcross, sticks + stop);
}

/// Damping coefficient [N s/m] that belongs to largest_stiffness().
/// @param mass 1/(1/m1 + 1/m2) [kg]
inline double largest_damping(const Prismatic& joint, double mass) {
  return kernel::viscous_damping(joint.dampingRatio, mass, largest_stiffness(joint));
}

/// Deflection b of the friction spring [m]: the part of s - s_f that exceeds half of the play.
inline double friction_bend(const Prismatic& joint) {
  const double bend = joint.slide - joint.slipPosition;
  return bend - std::clamp(bend, -0.5 * joint.play, 0.5 * joint.play);
}

/// @param time_step [s]
inline PrismaticStep prismatic_step(Prismatic& joint, const PrismaticMotion& motion,
                                    double time_step) {
  const Vector3 moved = motion.apart - joint.offset;
  const double slide = moved.dot(joint.axis);
  const Vector3 across = moved - slide * joint.axis;
  const double speed = motion.velocity.dot(joint.axis);
  const Vector3 speed_across = motion.velocity - speed * joint.axis;
  const auto dashpot = [&](double stiffness) {
    return kernel::viscous_damping(joint.dampingRatio, motion.mass, stiffness);
  };
  joint.slide = slide;

  const double damping_across = dashpot(joint.stiffnessAcross);
  PrismaticStep step{-joint.stiffnessAcross * across - damping_across * speed_across,
                     0.5 * joint.stiffnessAcross * across.squaredNorm(), 0,
                     damping_across * speed_across.squaredNorm() * time_step, 0};

  double along = 0;  // force on body 1 opposite to the axis [N]
  if (joint.frictionLimit > 0) {
    const double limit = joint.frictionLimit;
    double friction = joint.frictionStiffness * friction_bend(joint);
    if (std::abs(friction) > limit) {
      friction = std::copysign(limit, friction);
      const double slid_to =
          slide - friction / joint.frictionStiffness - std::copysign(0.5 * joint.play, friction);
      // Leapfrog does work with the mean of two successive forces.
      step.friction = 0.5 * (friction + joint.frictionForce) * (slid_to - joint.slipPosition);
      joint.slipPosition = slid_to;
      along = friction;
    } else if (joint.play == 0 || friction != 0) {
      const double most = joint.play > 0 && friction < 0 ? 0 : limit;
      const double least = joint.play > 0 && friction > 0 ? 0 : -limit;
      along = std::clamp(friction + dashpot(joint.frictionStiffness) * speed, least, most);
      step.damping += (along - friction) * speed * time_step;
    }
    step.elastic += 0.5 * friction * friction_bend(joint);
    joint.frictionForce = friction;
  }

  joint.stopForce = 0;
  const double depth = stop_depth(joint);
  if (depth > 0) {
    const double sign = slide > 0 ? 1.0 : -1.0;
    const double hertz = joint.stopStiffness * depth * std::sqrt(depth);
    const double pushes = hertz + joint.stopSpring * depth;
    const double pressed =
        kernel::damped_normal_force(pushes, dashpot(stop_stiffness(joint, depth)), sign * speed);
    joint.stopForce = sign * pressed;
    step.elastic += 0.4 * hertz * depth + 0.5 * joint.stopSpring * depth * depth;
    step.damping += (pressed - pushes) * sign * speed * time_step;
  }
  step.force -= (along + joint.stopForce) * joint.axis;

  step.largest_step = motion.mass > 0
                          ? kernel::critical_time_step(motion.mass, largest_stiffness(joint),
                                                       largest_damping(joint, motion.mass))
                          : std::numeric_limits<double>::infinity();
  return step;
}

}  // namespace statejump::stepper
