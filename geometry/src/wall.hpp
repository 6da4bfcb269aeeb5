// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "statejump/geometry/bore_mesh.hpp"
#include "topology.hpp"

namespace statejump::geometry {

/// Faces of the wall, and the least-squares cylinder (sphere) through them.
struct Wall {
  std::vector<int> faces;  ///< indices in the mesh, ascending
  bool closed = false;
  double radius = 0;
  Vector3 centre, axis, axis_x, axis_y;
  double low = 0, high = 0;  ///< axial range of the wall relative to `centre` [m]
};

/// Finds the wall. Rejects open borders that are not ends, normals that point away from the axis,
/// and radii outside the range of the options.
Wall find_wall(const Triangles& mesh, const Neighbours& neighbours, const BoreOptions& options,
               const std::string& name);

}  // namespace statejump::geometry
