// SPDX-License-Identifier: GPL-3.0-or-later
// Part of a triangle whose interpolated normal lies in a friction cone. For rest_on_mesh() only;
// not installed.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <vector>

namespace statejump::rest_set::detail {

/// Friction cone of one force F, with f = −F/|F| and G(n) = μ² (f·n)² − |n − (f·n) f|².
struct Cone {
  Eigen::Vector3d axis;
  double mu;

  double form(const Eigen::Vector3d& a, const Eigen::Vector3d& b) const {
    const double fa = axis.dot(a), fb = axis.dot(b);
    return mu * mu * fa * fb - (a - fa * axis).dot(b - fb * axis);
  }
  bool holds(const Eigen::Vector3d& n) const { return axis.dot(n) > 0.0 && form(n, n) >= 0.0; }
};

inline double cone_angle(const Eigen::Vector3d& axis, const Eigen::Vector3d& n) {
  return std::atan2(axis.cross(n).norm(), axis.dot(n));
}

/// Interval of s within [0, 1] in which a + s (b − a) is in the cone. It is empty if first >
/// second.
struct Span {
  double a = 1.0, b = 0.0;
  bool empty() const { return a > b; }
};

Span span_of(const Cone& cone, const Eigen::Vector3d& a, const Eigen::Vector3d& b);

/// A point of a triangle, given by its weights for vertices 1 and 2.
using Plane = Eigen::Vector2d;
using Polygon = std::vector<Plane>;

inline double cross(const Plane& a, const Plane& b) {
  return a.x() * b.y() - a.y() * b.x();
}

double area_of(const Polygon& polygon);

/// Divides a convex polygon by a convex region into the part inside the region, and convex pieces
/// outside it.
void cut(const Polygon& polygon, const Polygon& region, double least, Polygon& inside,
         std::vector<Polygon>& outside);

/// The convex region of a triangle in which the interpolated normal lies in a friction cone.
class Region {
 public:
  Region(const Cone& cone, const std::array<Eigen::Vector3d, 3>& normals)
      : cone_(cone), n_(normals) {}

  Eigen::Vector3d at(const Plane& p) const {
    return n_[0] + p.x() * (n_[1] - n_[0]) + p.y() * (n_[2] - n_[0]);
  }

  /// Finds the point whose normal is parallel to the cone's axis. False if it does not exist or is
  /// not unique.
  bool axis_point(Plane& point) const;

  /// @param spans of the sides 0-1, 1-2, 2-0
  Polygon polygon(const std::array<Span, 3>& spans) const;

 private:
  /// Distance along a direction from a point inside the cone to its boundary, in multiples of the
  /// direction vector.
  double reach(const Plane& from, const Plane& direction) const;

  /// Appends points of the conic strictly between a and b. The conic lies to the right of the line
  /// a → b.
  void arc(const Plane& a, const Plane& b, int depth, Polygon& result) const;

  Cone cone_;
  std::array<Eigen::Vector3d, 3> n_;
};

}  // namespace statejump::rest_set::detail
