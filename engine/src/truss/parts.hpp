// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>
#include <cstddef>

#include "statejump/truss/model.hpp"

namespace statejump::truss::detail {

using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::VectorXd;
using Matrix32 = Eigen::Matrix<double, 3, 2>;

inline double cross(const Vector2d& a, const Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}
inline Vector2d turned_left(const Vector2d& v) {
  return {-v.y(), v.x()};
}

inline std::size_t index(int i) {
  return static_cast<std::size_t>(i);
}

/// The vector drawn + moved between two nodes, its length, and the increase of its length. No
/// difference of two lengths is used.
struct Lengths {
  Vector3d along;
  double drawn;
  double now;
  double growth;
};

inline Lengths lengths(const Vector3d& drawn, const Vector3d& moved) {
  const Vector3d along = drawn + moved;
  const double before = drawn.norm();
  const double now = along.norm();
  return {along, before, now, moved.dot(2.0 * drawn + moved) / (before + now)};
}

/// Gradient and Hessian of the angle of an in-plane vector.
struct AngleDerivatives {
  Vector3d gradient;
  Matrix3d hessian;
};

/// Gradient and Hessian in the two coordinates of the plane.
struct PlanarAngle {
  Vector2d gradient;
  Eigen::Matrix2d hessian;
};

/// Angle by which a vector rotates if its end moves [rad]. If the tangent t of the angle is below
/// 1e-3, three terms of the arc tangent series are used. Their relative error is t⁶/7 < 1.5e-19,
/// and they need a tenth of the time of atan2.
inline double turn_by(const Vector2d& direction, const Vector2d& moved) {
  const double across = cross(direction, moved);
  const double along = direction.dot(direction + moved);
  if (!(std::abs(across) < 1e-3 * along)) return std::atan2(across, along);
  const double tangent = across / along;
  const double squared = tangent * tangent;
  return tangent * (1.0 - squared * (1.0 / 3.0 - 0.2 * squared));
}

inline PlanarAngle planar_angle(const Vector2d& v) {
  const double squared = v.squaredNorm();
  const Vector2d left = turned_left(v);
  return {left / squared, -(v * left.transpose() + left * v.transpose()) / (squared * squared)};
}

inline AngleDerivatives angle_derivatives(const Vector2d& v, const Matrix32& plane) {
  const PlanarAngle flat = planar_angle(v);
  return {plane * flat.gradient, plane * flat.hessian * plane.transpose()};
}

/// Two unit vectors that form a right-handed frame with the axis. For the z axis they are x and y.
inline Matrix32 plane_of(const Vector3d& axis) {
  Matrix32 plane;
  const Vector3d a = axis.normalized();
  if (a.isApprox(Vector3d::UnitZ())) {
    plane << 1, 0, 0, 1, 0, 0;
    return plane;
  }
  Eigen::Index smallest = 0;
  a.cwiseAbs().minCoeff(&smallest);
  const Vector3d first = Vector3d::Unit(smallest).cross(a).normalized();
  plane << first, a.cross(first);
  return plane;
}

inline bool moves_along(const Node& node, const Vector3d& direction) {
  for (int i = 0; i < node.freedoms; ++i) {
    if (std::abs(node.free_directions.col(i).dot(direction)) > 1e-9) return true;
  }
  return false;
}

}  // namespace statejump::truss::detail
