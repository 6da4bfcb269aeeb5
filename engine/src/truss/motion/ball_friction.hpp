// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>

#include "statejump/truss/joints/pad.hpp"
#include "truss/joints/ball_contact.hpp"

namespace statejump::truss::detail {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// Friction of a ball in its socket, or of a pad on its plane, in the tangent plane at the middle
/// of a step. A pad counts as a ball whose normal, towards the plane, is constant. Friction is a
/// vector, but a contact acts along one direction, so there are two contacts. The first contact
/// acts in the direction `along` of friction at the end of the step, and has Coulomb's limit. The
/// second, the transverse contact, acts perpendicular to it. Its stiffness is the law's transverse
/// tangent, limit over deflection. Its force vanishes once the direction has converged; see
/// direct_balls(). With partial slip both contacts are components of one law, along and across a
/// direction that rotates with the contact, so no direction is iterated.
struct BallFriction {
  const BallJoint* joint = nullptr;      ///< Null: a pad.
  const Pad* pad = nullptr;              ///< Null: a ball.
  Matrix3d axes = Matrix3d::Identity();  ///< Directions of the joint's forces.
  std::size_t place = 0;  ///< Index of its first contact; the transverse contact follows.
  int first_column = 0;   ///< First column of the joint's three forces.
  bool slips_in_part() const { return joint != nullptr && joint->partial_slip != 0; }

  // Memory.
  /// Positions, directions and elastic friction at the last update of friction.
  BallMemory memory{none(), none(), none(), none(), none(), 0.0, 0.0, 0.0, 0.0};

  // Values at the middle of the current step.
  BallState<double> now{none(), none(), none(), none(), none(), none(), 0.0, 0.0, 0.0, 0.0, 0.0};
  Vector3d kept = Vector3d::Zero();   ///< Elastic friction of the last step, rotated [N].
  Vector3d along = Vector3d::Zero();  ///< Unit vector; zero without a normal.
  Vector3d across() const { return now.normal.cross(along); }

  /// Updates the tangent plane to the middle of a step, and rotates the stored friction into this
  /// plane.
  void measure(const Trial& at);
  /// Sets the direction of friction in the present tangent plane.
  /// @param to vector in the plane, of any length; zero keeps the direction
  void point(const Vector3d& to);
  /// Sets the friction of a pad at the start [N].
  void begin(const Vector3d& friction);
  /// Stores the present friction.
  /// @param friction elastic [N]
  void remember(const Vector3d& friction);

 private:
  static Vector3d none() { return Vector3d::Zero(); }
};

/// Unit vector from the socket's centre to the ball's centre; zero if they coincide.
Vector3d ball_normal(const Trial& at);

}  // namespace statejump::truss::detail
