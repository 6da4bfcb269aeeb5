// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <CGAL/AABB_tree.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/version.h>
#if CGAL_VERSION_NR >= \
    1060000000  // the tree's parts carry their dimension in their names since then
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

/// The smooth wall where a line meets it.
struct Hit {
  bool found = false;  ///< false: the line passes the wall's border; weights are then clamped
  double s = 0;        ///< line parameter [m]
  int face = -1;       ///< of the wall (index into Wall::faces)
  std::array<double, 3> weight{};  ///< barycentric, in the flat face
  Vector3 point, normal;
  Eigen::Matrix3d bend;  ///< [1/m], positive where the wall rises to the free side
};

/// Points of the smooth wall on a grid around the axis: seeds of searches. Column i is at the angle
/// 2 pi i/columns; rows are levels of z (bore) or of the polar angle from the axis (socket).
struct Grid {
  int columns = 0, rows = 0;
  double low = 0, step = 0;    ///< of the rows
  std::vector<double> radius;  ///< [row * columns + column] from axis or centre; NaN: no wall
  std::vector<Vector3> point;
  std::vector<int> face;      ///< of the wall
  std::vector<double> reach;  ///< no wall of this sample's own is farther from it, but for sag [m]
  std::vector<double> cosine, sine;
  double least = 0;            ///< no wall is nearer to the axis (centre) [m]
  std::vector<double> hollow;  ///< largest hollow curvature of the faces around [1/m]
  double sag = 0;              ///< what straight interpolation between the rows leaves, at most [m]

  /// Uses the cells around one, up to eight of them: rows end, columns close.
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

  /// Follows a line from face to face until it passes through one; start is a face near by.
  Hit follow(const Vector3& point, const Vector3& direction, int start) const;
  /// Where a ray from a point first meets a facet that faces it; -1: nowhere.
  int shoot(const Vector3& point, const Vector3& direction) const;
  /// follow() from a face near by, shoot() where that fails.
  Hit meet(const Vector3& point, const Vector3& direction, int start) const;
  /// Where a ray meets the wall, from a face near by and a good guess of the distance; false where
  /// it does not.
  bool meet_near(const Vector3& point, const Vector3& direction, int start, double guess,
                 Hit& hit) const;
  /// Fills point, normal and bend of a hit whose face, weights and flat s are known.
  void blend(const Vector3& point, const Vector3& direction, Hit& hit) const;
  /// Same without normal and curvature.
  double blended_parameter(const Vector3& point, const Vector3& direction, const Hit& hit) const;
  /// Nearest point of the smooth wall, from a start on it; false when the foot leaves the wall.
  bool descend(const Vector3& query, Hit& hit) const;

  Triangles mesh;
  SurfaceKind kind;
  Wall wall;
  std::vector<std::array<int, 3>> corner;  ///< of wall faces, into jets
  Neighbours neighbour;                    ///< of wall faces
  std::vector<Jet> jet;
  std::vector<Vector3> vertex_normal;  ///< of all vertices of the mesh
  Facets facets;
  Tree tree;
  Grid grid;
  double error = 0, prominence = 0;
  double least_curvature = 0, most_curvature = 0;
  std::vector<double> vertex_curvature;  ///< of jets, the smaller principal one, convex positive

 private:
  void make_jets(int degree);
  void make_grid();
  void make_reach();
  void make_hollow();
  void estimate_error();
  void refuse_coarse(const std::string& name) const;
};

/// Principal curvatures (convex positive) and directions of a hit.
struct Principal {
  double larger, smaller;
  Vector3 direction_larger, direction_smaller;
};
Principal principal(const Hit& hit);

/// The wall at a hit, cut across a journal's axis.
struct SectionCurvature {
  Vector3 normal;  ///< unit, of the wall's curve in the section, towards the free side
  double section;  ///< [1/m], normal curvature along that curve, hollow positive
  double axial;    ///< [1/m], normal curvature across it
};
SectionCurvature section_curvature(const Hit& hit, const Vector3& axis);

/// What a search knows beside its contacts, for follow_contacts().
struct Survey {
  double travel = 0;      ///< in: [m] that the centre may move
  double not_flat = 0;    ///< out: no wall nearer than this [m] is as hollow as the journal (ball)
  std::vector<Hit> hits;  ///< out: of the contacts

  /// Takes note of a sample of the wall. @param sag of the wall between samples [m]
  void look_at(double distance, double hollow, double sag) {
    // Once the travel for the distance, which it lengthens, and once to spare. Between samples the
    // distance from a centre off the axis sags, too, by less than 1e-3 of the play.
    if (!(hollow * (distance + 2 * travel) < 1))
      not_flat = std::min(not_flat, distance - sag - 0.02 * travel);
  }
};

/// BoreMesh::contacts() and ball_contacts(). @param previous normals of the earlier contacts,
/// @param survey may be null
std::vector<BoreContact> find_contacts(const BoreMesh::Impl& mesh, const Vector3& journal_centre,
                                       const Vector3& journal_axis, double journal_radius,
                                       double maximum_gap, const std::vector<Vector3>& previous,
                                       Survey* survey);
std::vector<BoreContact> find_ball_contacts(const BoreMesh::Impl& mesh, const Vector3& ball_centre,
                                            double ball_radius, double maximum_gap,
                                            const std::vector<Vector3>& previous, Survey* survey);

}  // namespace statejump::geometry
