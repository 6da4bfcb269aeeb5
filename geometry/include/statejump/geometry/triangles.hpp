// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <array>
#include <string>
#include <vector>

namespace statejump::geometry {

/// Triangles as arrays: what a file holds and what a generator makes. Nothing is checked here.
struct Triangles {
  std::vector<Eigen::Vector3d> vertices;  ///< [m], or the file's unit before scaling
  std::vector<std::array<int, 3>> faces;  ///< indices of vertices, anticlockwise seen from where
                                          ///< the normal points to
  int removed = 0;                        ///< faces of the file without an area, left out
};

/// Reads OFF, STL (text or binary), PLY or OBJ; the name's ending says which.
///
/// The file may come from a stranger: pipes, devices and files of more than 2 GiB are refused, and
/// so are counts that do not fit into the file. Equal vertices become one (STL has no shared ones),
/// and of floats of 32 bits those nearer than their rounding. Polygons become triangles; faces of
/// fewer than three vertices are left out. Vertices and faces keep their order.
/// @throws MeshFailure no such file, an ending of another format, not readable as that format (with
///         the line of a text), corners that do not exist, vertices that are not finite, no faces
Triangles read_triangles(const std::string& file);

/// A wave on a round bore, r = R + amplitude cos(harmonic (theta - phase)).
struct Lobe {
  int harmonic;      ///< waves per turn, >= 1; 2 is an ellipse, 3 a three-lobed bore
  double amplitude;  ///< [m], half of peak to valley
  double phase = 0;  ///< [rad], where the radius is largest
};

/// Shape of a bore along z; its inner wall is r(theta, z) = R + lobes + wear.
struct BoreShape {
  double radius;  ///< R [m], > 0
  double length;  ///< [m], > 0, from z = -length/2 to +length/2
  std::vector<Lobe> lobes = {};
  double wear_depth = 0;      ///< [m], >= 0, deepest removal of a smooth worn trough
  double wear_angle = 0;      ///< [rad], where the trough is deepest
  double wear_width = 0.5;    ///< [rad], depth exp(-((theta - angle)/width)^2)
  double crown = 0;           ///< [m], growth of the radius at both ends, (2z/length)^2
  double wall_thickness = 0;  ///< [m]; > 0 makes a closed ring with a round outside, 0 a tube
};

/// Radius of a shape's inner wall [m]. @param theta [rad], @param z [m]
double bore_radius(const BoreShape& shape, double theta, double z);

/// Mesh of a bore whose vertices lie on the shape: around facets around, along quadrilaterals of
/// two triangles along. Normals point to the axis (and out of the body, for a ring).
/// @param around >= 3, @param along >= 1
/// @throws std::invalid_argument when an argument is out of its range
Triangles bore_triangles(const BoreShape& shape, int around, int along);

/// Cup of a ball-and-socket joint: part of a sphere about the origin below the plane
/// z = radius cos(opening); normals point to the centre.
/// @param radius [m], > 0, @param opening polar angle of the rim [rad], in (0, pi)
/// @param around >= 3 facets around, @param along >= 2 rings from rim to pole
Triangles socket_triangles(double radius, double opening, int around, int along);

}  // namespace statejump::geometry
