// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "topology.hpp"

namespace statejump::geometry {

/// Intersection of a line with a jet, and the surface there.
struct JetHit {
  double s = 0;          ///< line parameter [m]
  Vector3 normal;        ///< unit, towards the free side
  Eigen::Matrix3d bend;  ///< curvature tensor [1/m], positive where the surface rises in the
                         ///< direction of the normal
};

/// Smooth surface around a vertex: the height over the tangent plane is a polynomial with h = 0 at
/// the vertex. h = sum of coefficients x^i y^j, 1 <= i + j <= 4, x = u/scale_u, y = v/scale_v.
struct Jet {
  Vector3 origin;
  Vector3 normal;  ///< normal of the plane, close to that of the surface
  Vector3 tangent_u;
  Vector3 tangent_v;
  double scale_u = 1;
  double scale_v = 1;
  std::array<double, 14> coefficient{};

  /// Line parameter s at which point + s direction intersects the surface, by iteration from a
  /// guess.
  double meet(const Vector3& point, const Vector3& direction, double guess) const;
  /// meet() with normal and curvature.
  JetHit hit(const Vector3& point, const Vector3& direction, double guess) const;
};

/// Fits a jet to the neighbours of a vertex by least squares; it passes through the vertex.
///
/// The columns of the least-squares matrix are scaled by 0.05^(degree - 1), where 0.05 is about the
/// ratio of stencil size to radius of curvature. If the neighbours do not determine all
/// coefficients, this scaling favours low powers.
/// @param origin the vertex, @param normal unit, estimate of the surface normal
/// @param along unit vector along the bore's axis, which becomes an axis of the polynomial
/// @param points neighbours, >= 2
/// @param degree 2 to 4
Jet fit_jet(const Vector3& origin, const Vector3& normal, const Vector3& along,
            const std::vector<Vector3>& points, int degree);

}  // namespace statejump::geometry
