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

/// Neighbours of each face: neighbours[f][k] shares the edge opposite to corner k; -1 at the
/// border.
using Neighbours = std::vector<std::array<int, 3>>;

/// Border loop: its vertices in order.
using Loop = std::vector<int>;

/// Rejects meshes without faces, corners that do not exist, vertices that are not finite, edges of
/// three faces, orientations that CGAL cannot make consistent, sheets that meet in a vertex, and
/// several parts. Removes faces with collinear corners; rejects those that cannot be removed.
/// Reverses faces where neighbours disagree, so that all agree with the first face.
/// @return neighbours of every face
Neighbours check_topology(Triangles& mesh, const std::string& name);

std::vector<Loop> border_loops(const Triangles& mesh, const Neighbours& neighbours);

/// Rejects the first pair of faces that intersect (CGAL, exact predicates).
void check_self_intersection(const Triangles& mesh, const std::string& name);

/// Neighbours among the given faces only, as indices in `faces`; -1 for faces that are not given.
Neighbours restricted(const Neighbours& neighbours, const std::vector<int>& faces, int face_count);

/// @throws kernel::OutOfRange with the first coordinate that is not finite
void require_finite(const Vector3& point, const std::string& name);

inline Vector3 cross(const Vector3& a, const Vector3& b) {
  return {a.y() * b.z() - a.z() * b.y(), a.z() * b.x() - a.x() * b.z(),
          a.x() * b.y() - a.y() * b.x()};
}

/// Normal vector with twice the area as its length.
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
