// SPDX-License-Identifier: GPL-3.0-or-later
#include "topology.hpp"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/orient_polygon_soup.h>
#include <CGAL/Polygon_mesh_processing/polygon_soup_to_polygon_mesh.h>
#include <CGAL/Polygon_mesh_processing/self_intersections.h>
#include <CGAL/Surface_mesh.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <unordered_map>
#include <utility>

#include "statejump/geometry/mesh_failure.hpp"
#include "statejump/kernel/require.hpp"

namespace statejump::geometry {
namespace {

namespace pmp = CGAL::Polygon_mesh_processing;
using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using SurfaceMesh = CGAL::Surface_mesh<Kernel::Point_3>;

/// Largest coordinate [m]; the squares of larger areas would overflow.
constexpr double farthest = 1e60;

std::string listed(const std::array<int, 3>& numbers) {
  return std::to_string(numbers[0]) + ", " + std::to_string(numbers[1]) + ", " +
         std::to_string(numbers[2]);
}

/// A face with its corners and its position.
MeshFields face_fields(const Triangles& mesh, int face) {
  return {{"face", face},
          {"corners", listed(mesh.faces[face])},
          {"at_m", place(face_centre(mesh, face))}};
}

[[noreturn]] void refuse(const std::string& name, MeshReason reason, MeshFields fields = {}) {
  throw MeshFailure(name, reason, std::move(fields));
}

void check_faces(const Triangles& mesh, const std::string& name) {
  if (mesh.faces.empty()) refuse(name, MeshReason::no_faces);
  const int count = static_cast<int>(mesh.vertices.size());
  for (int i = 0; i < count; ++i)
    if (!mesh.vertices[i].allFinite())
      refuse(name, MeshReason::vertex_not_finite, {{"vertex", i}});
    else if (mesh.vertices[i].cwiseAbs().maxCoeff() > farthest)
      refuse(name, MeshReason::vertex_too_far, {{"vertex", i}, {"at_m", place(mesh.vertices[i])}});
  for (int f = 0; f < static_cast<int>(mesh.faces.size()); ++f) {
    for (const int corner : mesh.faces[f])
      if (corner < 0 || corner >= count)
        refuse(name, MeshReason::no_such_corner,
               {{"face", f}, {"corner", corner}, {"vertices", count}});
  }
}

struct LongestSide {
  int opposite;  ///< index of the opposite corner, 0 to 2
  double squared;
};

LongestSide longest_side(const Triangles& mesh, const std::array<int, 3>& face) {
  LongestSide longest{0, -1};
  for (int k = 0; k < 3; ++k) {
    const double squared =
        (mesh.vertices[face[(k + 1) % 3]] - mesh.vertices[face[(k + 2) % 3]]).squaredNorm();
    if (squared > longest.squared) longest = {k, squared};
  }
  return longest;
}

bool has_area(const Triangles& mesh, const std::array<int, 3>& face) {
  // A height below 1e-12 of the longest side is caused by rounding of the corners.
  return area_vector(mesh, face).norm() > 1e-12 * longest_side(mesh, face).squared;
}

void check_areas(const Triangles& mesh, const std::string& name) {
  for (int f = 0; f < static_cast<int>(mesh.faces.size()); ++f)
    if (!has_area(mesh, mesh.faces[f]))
      refuse(name, MeshReason::face_without_area, face_fields(mesh, f));
}

struct Edge {
  int face[2] = {-1, -1};
  int opposite[2] = {-1, -1};
  bool forward[2] = {false, false};  ///< the face runs from the smaller to the larger vertex index
};

using Edges = std::unordered_map<std::uint64_t, Edge>;

std::uint64_t edge_key(int a, int b) {
  return (static_cast<std::uint64_t>(std::min(a, b)) << 32) |
         static_cast<std::uint64_t>(std::max(a, b));
}

Edges edges_of(const Triangles& mesh, const std::string& name) {
  Edges edges;
  edges.reserve(mesh.faces.size() * 2);
  for (int f = 0; f < static_cast<int>(mesh.faces.size()); ++f)
    for (int k = 0; k < 3; ++k) {
      const int a = mesh.faces[f][(k + 1) % 3];
      const int b = mesh.faces[f][(k + 2) % 3];
      Edge& edge = edges[edge_key(a, b)];
      const int side = edge.face[0] < 0 ? 0 : 1;
      if (edge.face[side] >= 0)
        refuse(name, MeshReason::edge_of_three_faces,
               {{"vertex", std::min(a, b)},
                {"other_vertex", std::max(a, b)},
                {"at_m", place(0.5 * (mesh.vertices[a] + mesh.vertices[b]))},
                {"faces", listed({edge.face[0], edge.face[1], f})}});
      edge.face[side] = f;
      edge.opposite[side] = k;
      edge.forward[side] = a < b;
    }
  return edges;
}

/// The two faces at each edge. Edges with more faces are rejected later.
class FacesAtEdges {
 public:
  explicit FacesAtEdges(const Triangles& mesh) {
    for (int f = 0; f < static_cast<int>(mesh.faces.size()); ++f)
      for (int k = 0; k < 3; ++k) replace(mesh.faces[f][k], mesh.faces[f][(k + 1) % 3], nobody, f);
  }
  /// The face that shares the edge with this one, or nobody.
  int beside(int a, int b, int face) const {
    const auto found = faces_.find(edge_key(a, b));
    if (found == faces_.end()) return nobody;
    return found->second[found->second[0] == face ? 1 : 0];
  }
  bool known(int a, int b) const { return faces_.count(edge_key(a, b)) > 0; }
  void replace(int a, int b, int old_face, int face) {
    auto& at = faces_.try_emplace(edge_key(a, b), std::array<int, 2>{nobody, nobody}).first->second;
    at[at[0] == old_face ? 0 : 1] = face;
  }
  void erase(int a, int b) { faces_.erase(edge_key(a, b)); }
  static constexpr int nobody = -1;

 private:
  std::unordered_map<std::uint64_t, std::array<int, 2>> faces_;
};

/// Removes faces with collinear corners, which exporters leave if an edge is divided in only one of
/// its faces. The neighbour at the longest side is divided instead, so the surface does not change.
/// If this creates another face without area, the first face stays and is rejected later.
void divide_at_flat_faces(Triangles& mesh) {
  std::vector<int> flat;
  for (int f = 0; f < static_cast<int>(mesh.faces.size()); ++f)
    if (!has_area(mesh, mesh.faces[f])) flat.push_back(f);
  if (flat.empty()) return;
  // The longest face comes first: of several flat faces on one line, it has a neighbour with an
  // area.
  std::stable_sort(flat.begin(), flat.end(), [&](int a, int b) {
    return longest_side(mesh, mesh.faces[a]).squared > longest_side(mesh, mesh.faces[b]).squared;
  });
  FacesAtEdges edges(mesh);
  std::vector<bool> gone(mesh.faces.size(), false);
  for (const int f : flat) {
    const std::array<int, 3> face = mesh.faces[f];
    const int k = longest_side(mesh, face).opposite;
    const int middle = face[k];
    const int a = face[(k + 1) % 3];
    const int b = face[(k + 2) % 3];
    const int other = edges.beside(a, b, f);
    if (other == FacesAtEdges::nobody) {
      edges.erase(a, b);
      edges.replace(b, middle, f, FacesAtEdges::nobody);
      edges.replace(middle, a, f, FacesAtEdges::nobody);
    } else {
      const auto& [c, d, e] = mesh.faces[other];
      const int turn = (c == a || c == b) && (d == a || d == b) ? 0 : (d == a || d == b) ? 1 : 2;
      const int from = mesh.faces[other][turn];
      const int to = mesh.faces[other][(turn + 1) % 3];
      const int top = mesh.faces[other][(turn + 2) % 3];
      const std::array<int, 3> first{from, middle, top};
      const std::array<int, 3> second{middle, to, top};
      if (top == middle || edges.known(middle, top) || !has_area(mesh, first) ||
          !has_area(mesh, second))
        continue;
      edges.erase(a, b);
      edges.replace(from, middle, f, other);
      edges.replace(to, top, other, f);
      edges.replace(middle, top, FacesAtEdges::nobody, other);
      edges.replace(middle, top, FacesAtEdges::nobody, f);
      mesh.faces[other] = first;
      mesh.faces[f] = second;
    }
    gone[f] = other == FacesAtEdges::nobody;
    ++mesh.removed;
  }
  std::size_t kept = 0;
  for (std::size_t f = 0; f < mesh.faces.size(); ++f)
    if (!gone[f]) mesh.faces[kept++] = mesh.faces[f];
  mesh.faces.resize(kept);
}

/// Orients the faces consistently; CGAL reverses polygons.
void orient(Triangles& mesh, const std::string& name) {
  std::vector<Kernel::Point_3> points;
  points.reserve(mesh.vertices.size());
  for (const Vector3& v : mesh.vertices) points.emplace_back(v.x(), v.y(), v.z());
  std::vector<std::vector<std::size_t>> polygons;
  polygons.reserve(mesh.faces.size());
  for (const auto& face : mesh.faces)
    polygons.push_back({std::size_t(face[0]), std::size_t(face[1]), std::size_t(face[2])});
  if (!pmp::orient_polygon_soup(points, polygons)) refuse(name, MeshReason::one_sided);
  bool first_turned = false;
  for (std::size_t f = 0; f < polygons.size(); ++f) {
    std::array<int, 3> face{static_cast<int>(polygons[f][0]), static_cast<int>(polygons[f][1]),
                            static_cast<int>(polygons[f][2])};
    const auto& old = mesh.faces[f];
    const auto start = std::find(face.begin(), face.end(), old[0]);
    std::rotate(face.begin(), start, face.end());
    if (f == 0) first_turned = face[1] != old[1];
    if (first_turned) std::swap(face[1], face[2]);
    mesh.faces[f] = face;
  }
}

}  // namespace

void require_finite(const Vector3& point, const std::string& name) {
  for (int k = 0; k < 3; ++k)
    if (!std::isfinite(point[k]))
      throw kernel::OutOfRange("", name + "." + "xyz"[k], point[k], "finite [m]");
}

Neighbours check_topology(Triangles& mesh, const std::string& name) {
  check_faces(mesh, name);
  divide_at_flat_faces(mesh);
  check_areas(mesh, name);
  const int face_count = static_cast<int>(mesh.faces.size());
  Edges edges = edges_of(mesh, name);
  const auto disagrees = [](const Edge& edge) {
    return edge.face[1] >= 0 && edge.forward[0] == edge.forward[1];
  };
  if (std::any_of(edges.begin(), edges.end(), [&](const auto& e) { return disagrees(e.second); })) {
    orient(mesh, name);
    edges = edges_of(mesh, name);
  }
  Neighbours neighbours(face_count, {-1, -1, -1});
  for (const auto& [key, edge] : edges)
    if (edge.face[1] >= 0) {
      neighbours[edge.face[0]][edge.opposite[0]] = edge.face[1];
      neighbours[edge.face[1]][edge.opposite[1]] = edge.face[0];
    }

  // The faces around a vertex must form a single fan.
  std::vector<int> faces_at(mesh.vertices.size(), 0);
  std::vector<int> some_face(mesh.vertices.size(), -1);
  for (int f = 0; f < face_count; ++f)
    for (const int corner : mesh.faces[f]) {
      ++faces_at[corner];
      some_face[corner] = f;
    }
  for (int v = 0; v < static_cast<int>(mesh.vertices.size()); ++v) {
    if (some_face[v] < 0) continue;
    const auto step = [&](int face, int turn) {
      const auto& corner = mesh.faces[face];
      const int k = static_cast<int>(std::find(corner.begin(), corner.end(), v) - corner.begin());
      return neighbours[face][(k + turn) % 3];
    };
    int reached = 1;
    int face = step(some_face[v], 1);
    while (face >= 0 && face != some_face[v] && reached <= faces_at[v]) {
      ++reached;
      face = step(face, 1);
    }
    if (face < 0) {
      face = step(some_face[v], 2);
      while (face >= 0 && reached <= faces_at[v]) {
        ++reached;
        face = step(face, 2);
      }
    }
    if (reached != faces_at[v])
      refuse(name, MeshReason::sheets_at_vertex,
             {{"vertex", v}, {"at_m", place(mesh.vertices[v])}});
  }

  std::vector<int> part(face_count, -1);
  std::vector<int> stack{0};
  part[0] = 0;
  int reached = 0;
  while (!stack.empty()) {
    const int face = stack.back();
    stack.pop_back();
    ++reached;
    for (const int next : neighbours[face])
      if (next >= 0 && part[next] < 0) {
        part[next] = 0;
        stack.push_back(next);
      }
  }
  if (reached != face_count) {
    const int other = static_cast<int>(std::find(part.begin(), part.end(), -1) - part.begin());
    refuse(name, MeshReason::several_parts, face_fields(mesh, other));
  }
  return neighbours;
}

std::vector<Loop> border_loops(const Triangles& mesh, const Neighbours& neighbours) {
  std::map<int, int> next;  // along the border; each vertex is on at most one loop, because its
                            // faces form a single fan
  for (int f = 0; f < static_cast<int>(mesh.faces.size()); ++f)
    for (int k = 0; k < 3; ++k)
      if (neighbours[f][k] < 0) next[mesh.faces[f][(k + 1) % 3]] = mesh.faces[f][(k + 2) % 3];
  std::vector<Loop> loops;
  while (!next.empty()) {
    Loop loop;
    auto at = next.begin();
    while (at != next.end()) {
      loop.push_back(at->first);
      const int to = at->second;
      next.erase(at);
      at = next.find(to);
    }
    loops.push_back(loop);
  }
  return loops;
}

void check_self_intersection(const Triangles& mesh, const std::string& name) {
  SurfaceMesh surface;
  surface.reserve(static_cast<SurfaceMesh::size_type>(mesh.vertices.size()),
                  static_cast<SurfaceMesh::size_type>(mesh.faces.size() * 3 / 2),
                  static_cast<SurfaceMesh::size_type>(mesh.faces.size()));
  for (const Vector3& v : mesh.vertices) surface.add_vertex({v.x(), v.y(), v.z()});
  using Index = SurfaceMesh::Vertex_index;
  for (const auto& face : mesh.faces)
    surface.add_face(Index(static_cast<unsigned>(face[0])), Index(static_cast<unsigned>(face[1])),
                     Index(static_cast<unsigned>(face[2])));
  std::vector<std::pair<SurfaceMesh::Face_index, SurfaceMesh::Face_index>> pairs;
  pmp::self_intersections(surface, std::back_inserter(pairs));
  if (pairs.empty()) return;
  std::pair<int, int> first{INT_MAX, INT_MAX};
  for (const auto& [a, b] : pairs) {
    const int i = static_cast<int>(a.idx());
    const int j = static_cast<int>(b.idx());
    first = std::min(first, {std::min(i, j), std::max(i, j)});
  }
  MeshFields fields{{"face", first.first},
                    {"other_face", first.second},
                    {"at_m", place(face_centre(mesh, first.first))}};
  if (pairs.size() > 1) fields.emplace_back("more_pairs", pairs.size() - 1);
  throw MeshFailure(name, MeshReason::faces_intersect, std::move(fields));
}

Neighbours restricted(const Neighbours& neighbours, const std::vector<int>& faces, int face_count) {
  std::vector<int> index(face_count, -1);
  for (int i = 0; i < static_cast<int>(faces.size()); ++i) index[faces[i]] = i;
  Neighbours result(faces.size());
  for (std::size_t i = 0; i < faces.size(); ++i)
    for (int k = 0; k < 3; ++k) {
      const int other = neighbours[faces[i]][k];
      result[i][k] = other < 0 ? -1 : index[other];
    }
  return result;
}

}  // namespace statejump::geometry
