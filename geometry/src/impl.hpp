// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <CGAL/AABB_tree.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/version.h>
#if CGAL_VERSION_NR >= \
    1060000000  // since CGAL 6.0 the names of the tree's parts contain the dimension
#include <CGAL/AABB_traits_3.h>
#include <CGAL/AABB_triangle_primitive_3.h>
#else
#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_triangle_primitive.h>
#endif

#include <algorithm>
#include <limits>

#include "jet.hpp"
#include "wall.hpp"

namespace statejump::geometry {

/// Intersection of a line with the smooth wall.
struct Hit {
  bool found = false;              ///< false: the line misses the wall; weights are then clamped
  double s = 0;                    ///< line parameter [m]
  int face = -1;                   ///< wall face (index in Wall::faces)
  std::array<double, 3> weight{};  ///< barycentric weights in the flat face
  Vector3 point, normal;
  Eigen::Matrix3d bend;  ///< curvature tensor [1/m], positive where the wall rises to the free side
};

/// Points of the smooth wall on a grid around the axis, from which searches start. Column i is at
/// the angle 2 pi i/columns; rows are levels of z (bore) or of the polar angle (socket).
struct Grid {
  int columns = 0, rows = 0;
  double low = 0, step = 0;    ///< first level and spacing of the rows
  std::vector<double> radius;  ///< [row * columns + column], from axis or centre [m]; NaN: no wall
  std::vector<Vector3> point;
  std::vector<int> face;      ///< wall face index
  std::vector<double> reach;  ///< radius of the wall that a sample represents, without `sag` [m]
  std::vector<double> cosine, sine;
  double least = 0;            ///< lower bound of the wall's distance from axis (centre) [m]
  std::vector<double> hollow;  ///< largest concave curvature of the faces around the sample [1/m]
  double sag = 0;              ///< largest error of linear interpolation between rows [m]

  /// Calls `use` for each of the up to eight cells around a cell. Columns are cyclic, rows are not.
  template <class Use>
  void for_neighbours(int cell, const Use& use) const {
    const int row = cell / columns, column = cell % columns;
    for (int r = std::max(row - 1, 0); r <= std::min(row + 1, rows - 1); ++r)
      for (int turn = -1; turn <= 1; ++turn)
        if (r != row || turn != 0) use(r * columns + (column + turn + columns) % columns);
  }
};

struct BoreMesh::Impl {
  using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
  using Facets = std::vector<Kernel::Triangle_3>;
#if CGAL_VERSION_NR >= 1060000000
  using Primitive = CGAL::AABB_triangle_primitive_3<Kernel, Facets::const_iterator>;
  using Tree = CGAL::AABB_tree<CGAL::AABB_traits_3<Kernel, Primitive>>;
#else
  using Primitive = CGAL::AABB_triangle_primitive<Kernel, Facets::const_iterator>;
  using Tree = CGAL::AABB_tree<CGAL::AABB_traits<Kernel, Primitive>>;
#endif

  Impl(Triangles given, const BoreOptions& options, const std::string& name);

  /// Finds the face that a line passes through, by walking from face to face, starting nearby.
  Hit follow(const Vector3& point, const Vector3& direction, int start) const;
  /// Finds the facet that a ray first hits from its front side; returns -1 if there is none.
  int shoot(const Vector3& point, const Vector3& direction) const;
  /// follow() from a nearby face; shoot() if that fails.
  Hit meet(const Vector3& point, const Vector3& direction, int start) const;
  /// Intersects a ray with the wall, starting from a nearby face and a good guess of the distance.
  /// Returns false if there is no intersection.
  bool meet_near(const Vector3& point, const Vector3& direction, int start, double guess,
                 Hit& hit) const;
  /// Computes point, normal and bend of a hit from its face, its weights and the distance s to the
  /// flat face.
  void blend(const Vector3& point, const Vector3& direction, Hit& hit) const;
  /// blend() without normal and curvature.
  double blended_parameter(const Vector3& point, const Vector3& direction, const Hit& hit) const;
  /// Finds the nearest point of the smooth wall, starting from a point on it. Returns false if the
  /// iteration leaves the wall.
  bool descend(const Vector3& query, Hit& hit) const;

  Triangles mesh;
  SurfaceKind kind;
  Wall wall;
  std::vector<std::array<int, 3>> corner;  ///< vertices of the wall faces, as indices of jets
  Neighbours neighbour;                    ///< neighbours of the wall faces
  std::vector<Jet> jet;
  std::vector<Vector3> vertex_normal;  ///< of all vertices of the mesh
  Facets facets;
  Tree tree;
  Grid grid;
  double error = 0, prominence = 0;
  double least_curvature = 0, most_curvature = 0;
  std::vector<double> vertex_curvature;  ///< of each jet, the smaller principal one [1/m]

 private:
  void make_jets(int degree);
  void make_grid();
  void make_reach();
  void make_hollow();
  void estimate_error();
  void refuse_coarse(const std::string& name) const;
};

/// Principal curvatures [1/m] (convex positive) and directions at a hit.
struct Principal {
  double larger, smaller;
  Vector3 direction_larger, direction_smaller;
};
Principal principal(const Hit& hit);

/// Curvatures of the wall in the section perpendicular to the axis of a journal.
struct SectionCurvature {
  Vector3 normal;  ///< unit normal of the section curve, in the section, towards the free side
  double section;  ///< normal curvature along the section curve [1/m], concave positive
  double axial;    ///< normal curvature perpendicular to it [1/m], concave positive
};
SectionCurvature section_curvature(const Hit& hit, const Vector3& axis);

/// Additional results of a search, for follow_contacts().
struct Survey {
  double travel = 0;    ///< in: distance that the centre may move [m]
  double not_flat = 0;  ///< out: smallest distance of wall not flatter than the journal (ball) [m]
  std::vector<Hit> hits;  ///< out: wall points of the contacts

  /// Includes a sample of the wall in the survey.
  /// @param sag sag of the wall between samples [m]
  void look_at(double distance, double hollow, double sag) {
    // Travel increases the distance. It is counted twice, the second time as a margin. The distance
    // from a centre off the axis also has a sag between samples, less than 1e-3 of the play.
    if (!(hollow * (distance + 2 * travel) < 1))
      not_flat = std::min(not_flat, distance - sag - 0.02 * travel);
  }
};

/// Implements BoreMesh::contacts() and ball_contacts().
/// @param previous normals of the contacts at the earlier call, @param survey may be null
std::vector<BoreContact> find_contacts(const BoreMesh::Impl& mesh, const Vector3& journal_centre,
                                       const Vector3& journal_axis, double journal_radius,
                                       double maximum_gap, const std::vector<Vector3>& previous,
                                       Survey* survey);
std::vector<BoreContact> find_ball_contacts(const BoreMesh::Impl& mesh, const Vector3& ball_centre,
                                            double ball_radius, double maximum_gap,
                                            const std::vector<Vector3>& previous, Survey* survey);

}  // namespace statejump::geometry
