// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <array>
#include <functional>
#include <vector>

#include "statejump/rest_set/rest_set.hpp"

namespace statejump::rest_set {

/// A triangulated configuration surface.
struct Mesh {
  std::vector<Eigen::Vector3d> vertices;      ///< positions of the component's centre [m]
  std::vector<std::array<int, 3>> triangles;  ///< indices of vertices
  /// N at the vertices, from II to I towards the free side; any length. Empty: the mean of the
  /// triangles' right-hand normals, weighted by their angle at the vertex.
  std::vector<Eigen::Vector3d> normals;
  /// Optional: the smooth surface approximated by the mesh, as nearest point to x and N there. Ends
  /// of edges' rest intervals are then roots on that surface, and diameters are distances between
  /// its points.
  std::function<Eigen::Vector3d(const Eigen::Vector3d&)> project;
  std::function<Eigen::Vector3d(const Eigen::Vector3d&)> normal;
};

/// A convex polygon of a triangle with one set of allowed forces.
struct Piece {
  std::vector<Eigen::Vector3d> polygon;  ///< in order, at least 3 [m]
  int triangle = 0;                      ///< triangle that contains it
  int forces = 0;                        ///< number of forces under which it allows rest
};

/// Rest sets and the surface cut into pieces.
struct SurfaceStudy {
  RestStudy study;
  std::vector<Piece> pieces;        ///< together the whole mesh
  std::vector<double> cone_angles;  ///< smallest angle(−F, N) over the forces at each vertex [rad]
};

using SpaceFunction = std::function<double(const Eigen::Vector3d&)>;
using SpaceGradient = std::function<Eigen::Vector3d(const Eigen::Vector3d&)>;

/// Merges coincident vertices and drops triangles without area; for triangle soups.
/// @param tolerance [m], >= 0: largest distance of coincident vertices
Mesh welded(const Mesh& mesh, double tolerance);

/// Mesh of Γ(x, y, z) = 0 in a box, Γ < 0 where the centre is free. Marching tetrahedra, roots on
/// edges by bisection, normals −∇Γ. Triangles are flat: areas have an error of second order.
/// @param low,high corners of the box [m]
/// @param cells along its longest side, 2 to 400
Mesh implicit_surface(const SpaceFunction& gamma, const SpaceGradient& gradient,
                      const Eigen::Vector3d& low, const Eigen::Vector3d& high, int cells = 40);

/// Sphere of radius c about the origin, N inwards: the configuration surface of rest_in_socket().
/// @param level of refinement of an icosahedron, 0 to 8: 20 · 4^level triangles
Mesh clearance_sphere(double clearance, int level);

/// Rest sets on a mesh, N interpolated linearly over each triangle.
///
/// With f = −F/|F| the test is G(n) = μ² (f·n)² − |n − (f·n) f|² >= 0 and f·n >= 0: a convex cone
/// in n. n is linear in the position, so the set is a convex region with a conic boundary in every
/// triangle. Its ends on edges are roots of a quadratic, common to both neighbours. Further points
/// of the conic are computed alike; chords replace it between them, 8 per triangle. Components are
/// connected through edges. Relative to a smooth surface with exact vertex normals, the error is of
/// second order in the edge length. For μ = 0 a cone of 1e-6 is used: components smaller than 1e-4
/// of the mesh are reported as isolated points, slivers as lines. diameter_error is an estimate:
/// twice the sagitta of the longest edge on a sphere as large as the mesh's bounding box. At most
/// 256 forces.
SurfaceStudy rest_on_mesh(const Mesh& mesh, const std::vector<Eigen::Vector3d>& forces, double mu);

}  // namespace statejump::rest_set
