// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>

#include "truss/joints/ball_contact.hpp"

namespace statejump::truss::detail {

using Eigen::Vector3d;

/// Friction of a ball in its socket, in the plane of directions that its contact has at the middle
/// of a step. It is a vector, and contacts of a motion rub along one direction: so there are two of
/// them. The first rubs along `along`, where the friction of the step's end points to, and has
/// Coulomb's bound; the one beside it holds across that as the law does, whose tangent there is the
/// bound over the bend. What it holds vanishes as the direction is found; see
/// Stepper::turn_balls(). Where it slips in part both contacts are components of one law along and
/// across a direction that is carried with the contact, and neither is turned.
struct BallFriction {
  const BallJoint* joint = nullptr;
  std::size_t place = 0;  ///< Of its contact among all; the one beside is the next.
  int first_column = 0;   ///< Of the joint's three forces.
  bool slips_in_part() const { return joint->partial_slip != 0; }

  // Remembered from step to step.
  /// Where its friction was found: places, directions, elastic friction.
  BallMemory memory{none(), none(), none(), none(), none(), 0.0, 0.0, 0.0, 0.0};

  // Of the current step, at its middle.
  BallState<double> now{none(), none(), none(), none(), none(), none(), 0.0, 0.0, 0.0, 0.0, 0.0};
  Vector3d kept = Vector3d::Zero();   ///< Elastic friction of the last step, carried along [N].
  Vector3d along = Vector3d::Zero();  ///< Unit; zero where no normal is known.
  Vector3d across() const { return now.normal.cross(along); }

  /// Measures it at the middle of a step and turns the friction that it remembers there.
  void measure(const Trial& at);
  /// Sets the direction in the present plane. @param to any vector in it; zero: leaves it
  void point(const Vector3d& to);
  /// Takes over where its friction is now. @param friction elastic [N]
  void remember(const Vector3d& friction);

 private:
  static Vector3d none() { return Vector3d::Zero(); }
};

/// Unit vector from the socket's to the ball's centre; zero in the very middle.
Vector3d ball_normal(const Trial& at);

}  // namespace statejump::truss::detail
