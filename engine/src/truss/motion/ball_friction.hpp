// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>

#include "truss/joints/ball_contact.hpp"

namespace statejump::truss::detail {

using Eigen::Vector3d;

/// Friction of a ball in its socket, in the tangent plane at the middle of a step. The friction is
/// a vector, and a contact of motion acts along one direction, so a ball has two contacts. The
/// first acts along `along`, the direction of friction at the end of the step, and has Coulomb's
/// limit. The second acts across it. Its stiffness is the tangent of the law there, the limit over
/// the deflection, and its force vanishes when the direction is found; see Stepper::turn_balls().
/// With partial slip both contacts are components of one law, along and across a direction that
/// rotates with the contact, and the direction is not iterated.
struct BallFriction {
  const BallJoint* joint = nullptr;
  std::size_t place = 0;  ///< Of its contact among all; the one beside is the next.
  int first_column = 0;   ///< Of the joint's three forces.
  bool slips_in_part() const { return joint->partial_slip != 0; }

  // Remembered from step to step.
  /// State of the last update of its friction: positions, directions, elastic friction.
  BallMemory memory{none(), none(), none(), none(), none(), 0.0, 0.0, 0.0, 0.0};

  // Of the current step, at its middle.
  BallState<double> now{none(), none(), none(), none(), none(), none(), 0.0, 0.0, 0.0, 0.0, 0.0};
  Vector3d kept = Vector3d::Zero();   ///< Elastic friction of the last step, carried along [N].
  Vector3d along = Vector3d::Zero();  ///< Unit; zero where no normal is known.
  Vector3d across() const { return now.normal.cross(along); }

  /// Updates the plane to the middle of a step and rotates the stored friction into it.
  void measure(const Trial& at);
  /// Sets the direction in the present plane. @param to any vector in it; zero: keeps the direction
  void point(const Vector3d& to);
  /// Stores the present friction. @param friction elastic [N]
  void remember(const Vector3d& friction);

 private:
  static Vector3d none() { return Vector3d::Zero(); }
};

/// Unit vector from the socket's centre to the ball's centre; zero if they coincide.
Vector3d ball_normal(const Trial& at);

}  // namespace statejump::truss::detail
