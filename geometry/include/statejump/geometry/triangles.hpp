// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <array>
#include <string>
#include <vector>

namespace statejump::geometry {

/// Unchecked triangles as arrays, from a file or a generator.
struct Triangles {
  std::vector<Eigen::Vector3d> vertices;  ///< [m], or the file's unit before scaling
  /// Vertex indices of each face, anticlockwise as seen from the side to which the normal points.
  std::vector<std::array<int, 3>> faces;
  int removed = 0;  ///< number of faces of the file without area, which were left out
};

/// Reads a file in the format OFF, STL (text or binary), PLY or OBJ, selected by the extension of
/// its name.
///
/// The file may be untrusted: pipes, devices and files of more than 2 GiB are rejected, and so are
/// counts that exceed the size of the file. Equal vertices are merged (STL repeats them in each
/// facet), and 32-bit float vertices also if they differ only by rounding. Polygons are split into
/// triangles; faces with fewer than three vertices are left out. Faces keep their order.
/// @throws MeshFailure if there is no such file, the extension is unknown, the content is not of
///         that format (for a text file, the error names the line), a corner does not exist, a
///         vertex is not finite, or
///         there are no faces
Triangles read_triangles(const std::string& file);

/// A wave on a round bore, r = R + amplitude cos(harmonic (theta - phase)).
struct Lobe {
  int harmonic;      ///< number of waves per turn, >= 1; 2: ellipse, 3: three-lobed bore
  double amplitude;  ///< [m], half of the peak-to-valley value
  double phase = 0;  ///< [rad], angle of the largest radius
};

/// Shape of a bore along z. Its inner wall is r(theta, z) = R + lobes + wear.
struct BoreShape {
  double radius;  ///< R [m], > 0
  double length;  ///< [m], > 0, from z = -length/2 to +length/2
  std::vector<Lobe> lobes = {};
  double wear_depth = 0;    ///< depth of a smooth worn trough at its deepest point [m], >= 0
  double wear_angle = 0;    ///< angle of the deepest point [rad]
  double wear_width = 0.5;  ///< [rad]; wear is wear_depth exp(-((theta - wear_angle)/wear_width)^2)
  double crown = 0;  ///< increase of the radius at both ends [m], proportional to (2z/length)^2
  double wall_thickness = 0;  ///< [m]; > 0: closed ring with a round outer surface, 0: open tube
};

/// Radius of the inner wall [m]. @param theta [rad], @param z [m]
double bore_radius(const BoreShape& shape, double theta, double z);

/// Mesh of a bore whose vertices lie on the shape, with `around` facets around and `along` rows of
/// quadrilaterals, each of two triangles. Normals point to the axis (for a ring: out of its
/// material).
/// @param around >= 3, @param along >= 1
/// @throws std::invalid_argument when an argument is out of its range
Triangles bore_triangles(const BoreShape& shape, int around, int along);

/// Mesh of the cup of a ball-and-socket joint: the part of a sphere about the origin below the
/// plane z = radius cos(opening). Normals point to the centre.
/// @param radius [m], > 0, @param opening polar angle of the rim [rad], in (0, pi)
/// @param around >= 3 facets around, @param along >= 2 rings from rim to pole
Triangles socket_triangles(double radius, double opening, int around, int along);

}  // namespace statejump::geometry
