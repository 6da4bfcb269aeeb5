// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <array>
#include <memory>
#include <string>
#include <vector>

#include "statejump/geometry/triangles.hpp"

namespace statejump::geometry {

/// Type of the joint surface that the mesh represents.
enum class SurfaceKind {
  bore,   ///< through-hole for a journal: a tube with two open ends, or a closed ring
  socket  ///< cup for a ball: one open rim
};

/// Interpretation of the mesh.
struct BoreOptions {
  SurfaceKind kind = SurfaceKind::bore;
  double scale = 1.0;             ///< length unit of the mesh [m], e.g. 1e-3 for millimetres
  bool flip = false;              ///< reverse the orientation of every face
  double smallest_radius = 1e-5;  ///< [m]; a smaller mean radius is rejected as a wrong unit
  double largest_radius = 0.5;    ///< [m]; a larger mean radius is rejected as a wrong unit
  int fit_degree = 4;  ///< degree of the polynomial fitted to a vertex's neighbours, 2 to 4
};

/// Point of the smooth wall.
struct WallPoint {
  Eigen::Vector3d point;   ///< [m], on the smooth wall
  Eigen::Vector3d normal;  ///< unit, towards the free side where the journal is
  double distance;         ///< distance of the query from the wall [m], positive on the free side
  double curvature_1;  ///< larger principal curvature [1/m], convex positive: a cylinder bore of
                       ///< radius R has curvatures 0 and -1/R
  double curvature_2;  ///< smaller principal curvature [1/m]
  Eigen::Vector3d direction_1;        ///< unit, tangential, of curvature_1; its sign is arbitrary
  Eigen::Vector3d direction_2;        ///< unit, tangential, of curvature_2, direction_1 x normal
  int face;                           ///< index of the mesh face, as in the file
  std::array<double, 3> barycentric;  ///< weights of the corners of that face, >= 0, sum 1
  /// Whether the nearest point is on the rim of the wall and not the foot of a normal. Its accuracy
  /// is then that of the facets, h^2/(8 R) for an edge length h.
  bool on_rim;
};

/// A point at which a journal or ball touches the wall or nearly touches it.
struct BoreContact {
  Eigen::Vector3d point;     ///< [m], on the smooth wall
  Eigen::Vector3d normal;    ///< unit, from the journal into the wall, perpendicular to its axis
  double depth;              ///< [m], positive: overlap, negative: gap
  double section_curvature;  ///< [1/m], curvature of the wall in the section perpendicular to the
                             ///< journal; convex positive: -1/R2
  double axial_curvature;  ///< [1/m], curvature of the wall perpendicular to that section; 0 for a
                           ///< straight bore
  double curvature_1;      ///< [1/m], larger principal curvature of the wall, convex positive
  double curvature_2;      ///< [1/m], smaller one
  Eigen::Vector3d direction_1;  ///< unit, of curvature_1
  Eigen::Vector3d direction_2;  ///< unit, of curvature_2
  int face;                     ///< index of the mesh face under the point
  int previous;  ///< index of the contact of `previous` that this one continues, or -1
};

/// Inner surface of a bore (or of a socket) given by triangles.
///
/// **The wall.** In an open tube every face can belong to the wall. In a closed ring, the wall is
/// part of one patch: the largest one that surrounds an axis and has normals pointing to it.
/// Patches end where faces meet at more than 40 degrees, so a closed ring needs more than 9 facets
/// around. In both cases, faces inclined by more than 45 degrees to the axis (ends, chamfers) do
/// not belong to the wall. Axis and mean radius are those of the least-squares cylinder through the
/// wall's vertices, weighted with their areas (for a socket: sphere).
///
/// **The smooth wall.** The vertices are taken as points of the true surface. The chord of a facet
/// is h^2/(8 R) inside the true circle, far more than an elastic depth. So the facets only locate a
/// point. A polynomial of degree 4 over the tangent plane is fitted by least squares to each vertex
/// and its neighbours, two rings (the jet of Cazals and Pouget, Computer Aided Geometric Design 22,
/// 2005). Within a face, the polynomials of the three corners are blended with weights that vanish
/// smoothly on the opposite edge. Points, normals and curvatures are those of the blend. On a round
/// bore the error of the distance is of order h^6, e.g. 2e-13 m at a radius of 5.1 mm and 200
/// facets around. Limits: the fit follows noise of the vertices, and curvature amplifies this noise
/// by 1/h^2. Coordinates stored as float, as in binary STL, cause an error of the depth of 2.5e-10
/// m at a radius of 5.1 mm. With a clearance of 0.1 mm the error of the effective radius 1/(1/R1 +
/// section_curvature) is then 1 % at 200 facets around, 16 % at 800. Sharp edges inside the wall
/// (keyways, grooves) are rounded.
///
/// The object is immutable after construction; all queries are const and may run in any number of
/// threads. Copies share the mesh.
class BoreMesh {
 public:
  /// Checks the triangles and prepares the queries.
  /// @param name name of the mesh, printed first in errors
  /// @throws std::invalid_argument when an option is out of its range
  /// @throws std::runtime_error with one sentence that names the defect and its position: no faces,
  ///         a
  ///         corner that does not exist, a vertex that is not finite, a face without area, an edge
  ///         of three faces, a vertex where two sheets meet, several parts, a hole, faces that
  ///         intersect, normals that point away from the axis, a radius outside the range of the
  ///         options, or facets so coarse that the surface is uncertain by a fiftieth of the
  ///         radius (for a cylinder: fewer than 7 around)
  explicit BoreMesh(Triangles triangles, const BoreOptions& options = {},
                    const std::string& name = "mesh");

  /// read_triangles(), then the constructor.
  static BoreMesh read(const std::string& file, const BoreOptions& options = {});

  /// Nearest point of the smooth wall. If two points of the wall are equally near, as for a query
  /// on the axis, the result is one of them. @param query [m]
  WallPoint closest_point(const Eigen::Vector3d& query) const;

  /// All separate contacts of a journal with the wall, deepest first, including gaps below
  /// `maximum_gap`.
  ///
  /// Only the section through the journal's centre and perpendicular to its axis is searched.
  /// Contacts are local minima of the distance between wall and centre in this section. For a
  /// tilted journal, whose end touches first, call this again with a centre shifted along its axis.
  /// Two minima count as one if the distance between them rises by less than prominence().
  /// The cost does not depend on the number of faces.
  /// @param journal_centre [m], inside the bore, @param journal_axis vector of any length, either
  ///     direction
  /// @param journal_radius [m], > 0
  /// @param maximum_gap [m], >= 0: contacts with depth > -maximum_gap are returned
  /// @param previous result of an earlier call; BoreContact::previous then identifies the contact
  ///     that continues, the nearest one within a twelfth of a turn
  /// Limits: minima at angles that differ by less than 2 pi/256 may be merged. In the section,
  /// every wall point must be visible from the journal's centre. The result is empty if the section
  /// misses the wall.
  std::vector<BoreContact> contacts(const Eigen::Vector3d& journal_centre,
                                    const Eigen::Vector3d& journal_axis, double journal_radius,
                                    double maximum_gap,
                                    const std::vector<BoreContact>& previous = {}) const;

  /// Contacts of a ball in a socket or bore: local minima of the distance between wall and centre.
  /// BoreContact::section_curvature is the smaller principal curvature, axial_curvature the larger
  /// one.
  std::vector<BoreContact> ball_contacts(const Eigen::Vector3d& ball_centre, double ball_radius,
                                         double maximum_gap,
                                         const std::vector<BoreContact>& previous = {}) const;

  /// Radii of the smooth wall [m] around the fitted axis, at the axial position z [m] from the
  /// wall's middle, at angles 2 pi i/count from axis_x() towards axis_y(). NaN where there is no
  /// wall.
  std::vector<double> section_radii(double z, int count) const;

  const Triangles& triangles() const;    ///< scaled and flipped, otherwise as given
  const std::vector<int>& wall() const;  ///< indices of the faces of the wall, ascending
  SurfaceKind kind() const;
  bool closed() const;                    ///< whether the mesh is a closed ring (or shell)
  double mean_radius() const;             ///< [m], of the least-squares cylinder (sphere)
  const Eigen::Vector3d& centre() const;  ///< [m], on the axis, in the wall's middle
  const Eigen::Vector3d& axis() const;    ///< unit; its largest component is positive
  const Eigen::Vector3d& axis_x() const;  ///< unit, perpendicular to axis(): angle 0
  const Eigen::Vector3d& axis_y() const;  ///< axis() x axis_x(): angle pi/2
  double length() const;                  ///< [m], of the wall along the axis
  double smallest_curvature() const;      ///< [1/m], of the wall at its vertices, convex positive
  double largest_curvature() const;       ///< [1/m]
  /// Estimated error of the smooth wall [m]: the largest difference between the polynomials of
  /// neighbouring vertices, evaluated at a quarter of their common edge.
  double reconstruction_error() const;
  /// Smallest rise of the distance [m] that separates two minima in contacts(). It is 1e-12 plus 4
  /// times the 95 % quantile of the differences that reconstruction_error() uses.
  double prominence() const;
  /// Unit vertex normals, towards the free side; zero for vertices outside the wall.
  const std::vector<Eigen::Vector3d>& vertex_normals() const;

  struct Impl;  ///< implementation with CGAL
  const Impl& impl() const { return *impl_; }

 private:
  std::shared_ptr<const Impl> impl_;
};

}  // namespace statejump::geometry
