// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>

#include "statejump/kernel/rotation.hpp"
#include "statejump/truss/joints/interface.hpp"

namespace statejump::truss::detail {

/// Rotation vector of a node [rad].
/// @param site a local site of the joint that is the rotation of a node
inline Eigen::Vector3d rotation_vector(const Trial& trial, std::size_t site) {
  return trial.moved[site] / trial.frame.arms[site];
}

/// A rotation as a quaternion with scalar part w and vector part v. Its rate is a spin on the left:
/// dv = (w ω + ω × v)/2.
struct RotationAt {
  double w = 1.0;
  Eigen::Vector3d v = Eigen::Vector3d::Zero();
};

/// Gradient of a function of a rotation by the spin, and its derivative by the spin.
struct SpinGradient {
  Eigen::Vector3d value;
  Eigen::Matrix3d slope;
};

/// Rates of w and v by the spin.
struct QuaternionRates {
  Eigen::RowVector3d w;
  Eigen::Matrix3d v;

  explicit QuaternionRates(const RotationAt& at)
      : w(-0.5 * at.v.transpose()),
        v(0.5 * (at.w * Eigen::Matrix3d::Identity() - kernel::skew(at.v))) {}
};

/// Angle of a rotation about an axis [rad]: that of its twist, 2 atan2(v·a, w).
double angle_about(const RotationAt& at, const Eigen::Vector3d& axis);
/// Gradient of angle_about().
SpinGradient angle_gradient(const RotationAt& at, const Eigen::Vector3d& axis);

/// Sets the site of a joint that rotates its part at a node.
/// @param far local site
/// @param link link whose far end rotates the part; −1: none
/// @param with_node whether the rotation of the node rotates the part
void turn_part(const Model& model, std::size_t far, int link, int with_node, int node,
               JointFrame& frame);

/// Angle of a node about a fixed axis, and its derivatives by the displacement of the rotation
/// site.
struct NodeTurn {
  double angle;              ///< [rad]
  Eigen::Vector3d gradient;  ///< [1/m]
  Eigen::Matrix3d hessian;   ///< [1/m²]
};

/// Angle of a node about a fixed axis [rad].
/// @param site a local site of the joint that is the rotation of a node
double node_angle(const Trial& trial, std::size_t site, const Eigen::Vector3d& axis);
NodeTurn node_turn(const Trial& trial, std::size_t site, const Eigen::Vector3d& axis);

}  // namespace statejump::truss::detail
