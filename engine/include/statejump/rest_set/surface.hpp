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
  /// Vectors along N at the vertices, towards free positions, of any length. If empty, N is the
  /// mean of the triangles' right-hand normals, weighted by their angles.
  std::vector<Eigen::Vector3d> normals;
  /// Optional functions for the smooth surface that the mesh approximates: `project` returns the
  /// surface point nearest to x, `normal` returns N there. The ends of rest intervals on edges are
  /// then roots on that surface, and diameters are distances between its points.
  std::function<Eigen::Vector3d(const Eigen::Vector3d&)> project;
  std::function<Eigen::Vector3d(const Eigen::Vector3d&)> normal;
};

/// A convex polygon within a triangle, in which the same set of forces is allowed.
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

/// Merges coincident vertices and removes triangles without area. For triangles that share no
/// vertices.
/// @param tolerance [m], >= 0: largest distance of coincident vertices
Mesh welded(const Mesh& mesh, double tolerance);

/// Mesh of Γ(x, y, z) = 0 in a box, with Γ < 0 at free positions. Marching tetrahedra give the
/// triangles, bisection the roots on edges, −∇Γ the normals. Triangles are flat, so the error of
/// areas is of second order.
/// @param low,high corners of the box [m]
/// @param cells number along the longest side, 2 to 400
Mesh implicit_surface(const SpaceFunction& gamma, const SpaceGradient& gradient,
                      const Eigen::Vector3d& low, const Eigen::Vector3d& high, int cells = 40);

/// Sphere of radius c about the origin with N inwards. It is the configuration surface of
/// rest_in_socket().
/// @param level number of refinements of an icosahedron, 0 to 8, which give 20 · 4^level triangles
Mesh clearance_sphere(double clearance, int level);

/// Computes rest sets on a mesh, with N interpolated linearly over each triangle.
///
/// With f = −F/|F| the conditions are G(n) = μ² (f·n)² − |n − (f·n) f|² >= 0 and f·n >= 0, a convex
/// cone of normals n. As n is linear in the position, the rest set in a triangle is a convex region
/// with a conic boundary. This boundary meets edges at roots of a quadratic, common to both
/// adjacent triangles. Further points of the conic are computed alike; 8 chords per triangle
/// connect them. Components are connected through edges. For smooth surfaces with exact vertex
/// normals, the error is of second order in the edge length. For μ = 0 a friction coefficient of
/// 1e-6 is used; components smaller than 1e-4 of the mesh are then reported as isolated points, and
/// slivers as lines. diameter_error is an estimate: twice the sagitta of the longest edge on a
/// sphere as large as the mesh's bounding box. At most 256 forces.
SurfaceStudy rest_on_mesh(const Mesh& mesh, const std::vector<Eigen::Vector3d>& forces, double mu);

}  // namespace statejump::rest_set
