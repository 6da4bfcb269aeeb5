// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <array>
#include <memory>
#include <string>
#include <vector>

#include "statejump/geometry/triangles.hpp"

namespace statejump::geometry {

/// What the mesh is taken for.
enum class SurfaceKind {
  bore,   ///< through-hole for a journal: a tube with two open ends, or a closed ring
  socket  ///< cup for a ball: one open rim
};

/// How a mesh becomes a bore.
struct BoreOptions {
  SurfaceKind kind = SurfaceKind::bore;
  double scale = 1.0;             ///< the mesh's unit [m], 1e-3 for millimetres
  bool flip = false;              ///< turn every face over
  double smallest_radius = 1e-5;  ///< [m], a mean radius below is refused as a wrong unit
  double largest_radius = 0.5;    ///< [m], a mean radius above is refused as a wrong unit
  int fit_degree = 4;             ///< of the polynomial through a vertex's neighbours, 2 to 4
};

/// Point of the smooth wall.
struct WallPoint {
  Eigen::Vector3d point;        ///< [m], on the smooth wall
  Eigen::Vector3d normal;       ///< unit, towards the free side where the journal is
  double distance;              ///< [m] of the query from the wall, positive on the free side
  double curvature_1;           ///< [1/m], larger of the principal ones; convex positive, so that a
                                ///< cylinder bore of radius R has 0 and -1/R
  double curvature_2;           ///< [1/m], the smaller one
  Eigen::Vector3d direction_1;  ///< unit, tangential, of curvature_1; its sign means nothing
  Eigen::Vector3d direction_2;  ///< unit, tangential, of curvature_2, direction_1 x normal
  int face;                     ///< of the mesh, as numbered in its file
  std::array<double, 3> barycentric;  ///< of the corners of that face, >= 0, sum 1
  /// The nearest point is on the wall's rim and not the foot of a normal; it is then only as good
  /// as the facets, h^2/(8 R).
  bool on_rim;
};

/// One place where a journal or a ball touches the wall or nearly does.
struct BoreContact {
  Eigen::Vector3d point;        ///< [m], on the smooth wall
  Eigen::Vector3d normal;       ///< unit, from the journal into the wall, perpendicular to its axis
  double depth;                 ///< [m], positive: overlap, negative: gap
  double section_curvature;     ///< [1/m] of the wall around the journal; convex positive: -1/R2
  double axial_curvature;       ///< [1/m] of the wall across that; 0 for a straight bore
  double curvature_1;           ///< [1/m], larger principal curvature of the wall, convex positive
  double curvature_2;           ///< [1/m], smaller one
  Eigen::Vector3d direction_1;  ///< unit, of curvature_1
  Eigen::Vector3d direction_2;  ///< unit, of curvature_2
  int face;                     ///< of the mesh under the point
  int previous;                 ///< index of the earlier contact that this one continues, or -1
};

/// Inner surface of a bore (or of a socket) given by triangles.
///
/// **The wall.** Of a tube every face may be wall; of a closed ring the faces of the largest patch
/// that surrounds an axis with normals pointing to it. Patches end where faces meet at more than 40
/// degrees, so a closed ring needs more than 9 facets around. In both, faces that lean more than 45
/// degrees against the axis (ends, chamfers) are not wall. Axis and mean radius are the cylinder of
/// least squares through the wall's vertices, weighted with their areas (for a socket: the sphere).
///
/// **The smooth wall.** The vertices are taken as points of the true surface. A chord lies inside a
/// circle by h^2/(8 R), far more than an elastic depth, so the facets only say where to look.
/// Through each vertex and its neighbours (two rings) goes a polynomial of degree 4 over the
/// tangent plane, by least squares (the jet of Cazals and Pouget, Computer Aided Geometric Design
/// 22, 2005), and within a face the three corners' polynomials are blended with weights that vanish
/// smoothly on the opposite edge. Points, normals and curvatures are those of the blend; on a round
/// bore the distance errs as h^6, by 2e-13 m at a radius of 5.1 mm and 200 facets around. Limits:
/// noise of the vertices is followed, not smoothed, and curvature enlarges it by 1/h^2. Coordinates
/// kept as float, as binary STL does, leave 2.5e-10 m in the depth at a radius of 5.1 mm; with a
/// clearance of 0.1 mm the effective radius 1/(1/R1 + section_curvature) then errs by 1 % at 200
/// facets around, 16 % at 800. Sharp edges inside the wall (keyways, grooves) are rounded.
///
/// Immutable after construction; all queries are const and may run in any number of threads. Copies
/// share the mesh.
class BoreMesh {
 public:
  /// Checks the triangles and prepares the queries.
  /// @param name said first in errors
  /// @throws std::invalid_argument when an option is out of its range
  /// @throws std::runtime_error with one sentence that says what is wrong and where: no faces, a
  ///         corner that does not exist, a vertex that is not finite, a face without area, an edge
  ///         of three faces, a vertex where two sheets meet, several parts, a hole, faces that
  ///         intersect, normals that point away from the axis, a radius out of the range that
  ///         options allow, facets so coarse that they leave the surface open by a fiftieth of the
  ///         radius (of a cylinder fewer than 7 around)
  explicit BoreMesh(Triangles triangles, const BoreOptions& options = {},
                    const std::string& name = "mesh");

  /// read_triangles(), then the constructor.
  static BoreMesh read(const std::string& file, const BoreOptions& options = {});

  /// Nearest point of the smooth wall. @param query [m]
  /// Limit: where two parts of the wall are equally near, as at the axis, it is either.
  WallPoint closest_point(const Eigen::Vector3d& query) const;

  /// All separate places where a journal touches the wall or comes nearer than a gap, deepest
  /// first.
  ///
  /// Looked at is the section through the journal's centre and perpendicular to its axis: contacts
  /// are local minima of the wall's distance from the centre there. A journal that tilts until its
  /// end touches first is seen by asking again with a centre further along its axis.
  /// Two minima with a rise between them that is lower than prominence() count as one.
  /// Cost does not depend on the number of faces.
  /// @param journal_centre [m], inside the bore, @param journal_axis any length, either direction
  /// @param journal_radius [m], > 0
  /// @param maximum_gap [m], >= 0: contacts with depth > -maximum_gap are reported
  /// @param previous an earlier result: BoreContact::previous then says which contact continues
  ///        which (the nearest, within a twelfth of a turn)
  /// Limits: minima nearer than 2 pi/256 around the bore may be taken for one. The wall must be
  /// seen whole from the centre in the section. Empty when the section misses the wall.
  std::vector<BoreContact> contacts(const Eigen::Vector3d& journal_centre,
                                    const Eigen::Vector3d& journal_axis, double journal_radius,
                                    double maximum_gap,
                                    const std::vector<BoreContact>& previous = {}) const;

  /// The same for a ball in a socket or bore: local minima of the wall's distance from its centre.
  /// BoreContact::section_curvature is the smaller, axial_curvature the larger principal curvature.
  std::vector<BoreContact> ball_contacts(const Eigen::Vector3d& ball_centre, double ball_radius,
                                         double maximum_gap,
                                         const std::vector<BoreContact>& previous = {}) const;

  /// Radii of the smooth wall [m] around the fitted axis at axial position z [m] from the wall's
  /// middle, at angles 2 pi i/count from axis_x() towards axis_y(). NaN where there is no wall.
  std::vector<double> section_radii(double z, int count) const;

  const Triangles& triangles() const;    ///< scaled and flipped, otherwise as given
  const std::vector<int>& wall() const;  ///< faces of the wall, ascending
  SurfaceKind kind() const;
  bool closed() const;                    ///< a closed ring (or shell), not an open one
  double mean_radius() const;             ///< [m], of the cylinder (sphere) of least squares
  const Eigen::Vector3d& centre() const;  ///< [m], on the axis, in the wall's middle
  const Eigen::Vector3d& axis() const;    ///< unit; its largest component is positive
  const Eigen::Vector3d& axis_x() const;  ///< unit, perpendicular to axis(): angle 0
  const Eigen::Vector3d& axis_y() const;  ///< axis() x axis_x(): angle pi/2
  double length() const;                  ///< [m], of the wall along the axis
  double smallest_curvature() const;      ///< [1/m], of the wall at its vertices, convex positive
  double largest_curvature() const;       ///< [1/m]
  /// How far the polynomials of neighbouring vertices disagree [m], largest a quarter along an
  /// edge: an estimate of the error of the smooth wall.
  double reconstruction_error() const;
  /// Rise between two minima below which contacts() takes them for one [m]: 1e-12 plus 4 times the
  /// disagreement that 95 % of the edges stay below.
  double prominence() const;
  /// Corner normals, unit, towards the free side; zero for vertices that are not on the wall.
  const std::vector<Eigen::Vector3d>& vertex_normals() const;

  struct Impl;  ///< CGAL's part, hidden
  const Impl& impl() const { return *impl_; }

 private:
  std::shared_ptr<const Impl> impl_;
};

}  // namespace statejump::geometry
