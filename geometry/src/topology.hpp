// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <array>
#include <string>
#include <vector>

#include "statejump/geometry/triangles.hpp"

namespace statejump::geometry {

using Vector3 = Eigen::Vector3d;

/// As a field of a failure.
inline std::array<double, 3> place(const Vector3& point) {
  return {point.x(), point.y(), point.z()};
}

/// Face behind each edge: neighbours[f][k] lies across the edge opposite to corner k; -1: border.
using Neighbours = std::vector<std::array<int, 3>>;

/// A loop of border edges: vertices in order.
using Loop = std::vector<int>;

/// Refuses faces that do not exist or are not finite, edges of three faces,
/// inconsistent orientation that CGAL cannot mend, sheets meeting in a vertex and several parts.
/// Faces whose corners lie in line are taken out; those that cannot be are refused.
/// Turns faces over where neighbours disagree, so that they agree with the first face.
/// @return neighbours of every face
Neighbours check_topology(Triangles& mesh, const std::string& name);

/// Loops of the border.
std::vector<Loop> border_loops(const Triangles& mesh, const Neighbours& neighbours);

/// Refuses the first pair of faces that intersect (CGAL, exact predicates).
void check_self_intersection(const Triangles& mesh, const std::string& name);

/// Of the given faces only, -1 where a neighbour is not among them. Indices into faces.
Neighbours restricted(const Neighbours& neighbours, const std::vector<int>& faces, int face_count);

/// @throws kernel::OutOfRange with the first coordinate that is not finite
void require_finite(const Vector3& point, const std::string& name);

inline Vector3 cross(const Vector3& a, const Vector3& b) {
  return {a.y() * b.z() - a.z() * b.y(), a.z() * b.x() - a.x() * b.z(),
          a.x() * b.y() - a.y() * b.x()};
}

/// Normal times twice the area.
inline Vector3 area_vector(const Triangles& mesh, const std::array<int, 3>& corner) {
  const Vector3& a = mesh.vertices[corner[0]];
  return cross(mesh.vertices[corner[1]] - a, mesh.vertices[corner[2]] - a);
}

inline Vector3 area_vector(const Triangles& mesh, int face) {
  return area_vector(mesh, mesh.faces[face]);
}

inline Vector3 face_centre(const Triangles& mesh, int face) {
  const auto& corner = mesh.faces[face];
  return (mesh.vertices[corner[0]] + mesh.vertices[corner[1]] + mesh.vertices[corner[2]]) / 3.0;
}

}  // namespace statejump::geometry
