// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "topology.hpp"

namespace statejump::geometry {

/// Where a line meets a jet, and the surface there.
struct JetHit {
  double s = 0;          ///< line parameter [m]
  Vector3 normal;        ///< unit, towards the free side
  Eigen::Matrix3d bend;  ///< curvature tensor [1/m], positive where the surface rises to the normal
};

/// Polynomial height over the tangent plane of a vertex, through the vertex: the smooth surface as
/// seen from there. h = sum of coefficients x^i y^j, 1 <= i + j <= 4, x = u/scale_u, y = v/scale_v.
struct Jet {
  Vector3 origin;
  Vector3 normal;  ///< of the plane, near the surface's
  Vector3 tangent_u;
  Vector3 tangent_v;
  double scale_u = 1;
  double scale_v = 1;
  std::array<double, 14> coefficient{};

  /// Line parameter where point + s direction meets the surface, from a guess.
  double meet(const Vector3& point, const Vector3& direction, double guess) const;
  /// meet() with normal and curvature.
  JetHit hit(const Vector3& point, const Vector3& direction, double guess) const;
};

/// Fits a jet to neighbours of a vertex, by least squares through the vertex itself.
///
/// Columns are scaled by 0.05^(degree - 1), about the ratio of the stencil to the radius of
/// curvature: where the neighbours do not determine all coefficients, the lower powers are taken.
/// @param origin the vertex, @param normal unit, a guess of the surface's
/// @param along unit, an axis of the surface (the bore's): one direction of the polynomial
/// @param points neighbours, >= 2
/// @param degree 2 to 4
Jet fit_jet(const Vector3& origin, const Vector3& normal, const Vector3& along,
            const std::vector<Vector3>& points, int degree);

}  // namespace statejump::geometry
