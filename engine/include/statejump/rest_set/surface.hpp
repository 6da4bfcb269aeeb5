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
  /// N at the vertices: from II to I, to the free side; need not be unit vectors. Empty: the mean
  /// of the triangles' right-hand normals, weighted by their angle at the vertex.
  std::vector<Eigen::Vector3d> normals;
  /// Optional: the smooth surface behind the mesh, nearest point to x and N there. Ends of edges'
  /// rest intervals are then roots on that surface, and diameters are measured between its points.
  std::function<Eigen::Vector3d(const Eigen::Vector3d&)> project;
  std::function<Eigen::Vector3d(const Eigen::Vector3d&)> normal;
};

/// A convex polygon of a triangle with the same answer everywhere.
struct Piece {
  std::vector<Eigen::Vector3d> polygon;  ///< in order, at least 3 [m]
  int triangle = 0;                      ///< it is part of
  int forces = 0;                        ///< number of forces that it allows rest under
};

/// Rest sets and the surface cut into pieces.
struct SurfaceStudy {
  Study study;
  std::vector<Piece> pieces;        ///< together the whole mesh
  std::vector<double> cone_angles;  ///< smallest angle(−F, N) over the forces at each vertex [rad]
};

using SpaceFunction = std::function<double(const Eigen::Vector3d&)>;
using SpaceGradient = std::function<Eigen::Vector3d(const Eigen::Vector3d&)>;

/// Vertices that coincide are made one, triangles without area are dropped; for triangle soups.
/// @param tolerance [m], >= 0: distance up to which they coincide
Mesh welded(const Mesh& mesh, double tolerance);

/// Γ(x, y, z) = 0 in a box, Γ < 0 where the centre is free, as a mesh: marching tetrahedra, roots
/// on edges by bisection, normals −∇Γ. Triangles are flat: areas have an error of second order.
/// @param low,high corners of the box [m]  @param cells along its longest side, 2 to 400
Mesh implicit_surface(const SpaceFunction& gamma, const SpaceGradient& gradient,
                      const Eigen::Vector3d& low, const Eigen::Vector3d& high, int cells = 40);

/// Sphere of radius c about the origin, N inwards: the configuration surface of rest_in_socket().
/// @param level of refinement of an icosahedron, 0 to 8: 20 · 4^level triangles
Mesh clearance_sphere(double clearance, int level);

/// Rest sets on a mesh, N interpolated linearly over each triangle.
///
/// With f = −F/|F| the test is G(n) = μ² (f·n)² − |n − (f·n) f|² >= 0 and f·n >= 0: a convex cone
/// in n, and n is linear in the position, so the set cuts a convex region with a conic boundary out
/// of every triangle. Its ends on edges are roots of a quadratic, common to both neighbours,
/// further points of the conic likewise; between them it is replaced by chords, 8 per triangle.
/// Parts are connected through edges. Against a smooth surface with exact vertex normals the error
/// is of second order in the edge length. μ = 0 is answered with a cone of 1e-6: parts that it
/// leaves smaller than 1e-4 of the mesh are isolated points, slivers are lines. diameter_error is
/// an estimate: twice the sagitta of the longest edge on a sphere as large as the mesh's bounding
/// box. At most 256 forces.
SurfaceStudy rest_on_mesh(const Mesh& mesh, const std::vector<Eigen::Vector3d>& forces, double mu);

}  // namespace statejump::rest_set
