// SPDX-License-Identifier: GPL-3.0-or-later
#include "statejump/rest_set/surface.hpp"

#include <Eigen/Geometry>
#include <bitset>
#include <map>
#include <utility>

#include "detail.hpp"
#include "mesh.hpp"
#include "numerics/change_between.hpp"
#include "region.hpp"

namespace statejump::rest_set {

using Eigen::Vector3d;
using kernel::require;
using namespace detail;

namespace {

constexpr int most_forces = 256;
constexpr double point_cone = 1e-6;  // tan of the cone used for mu = 0
using Mask = std::bitset<most_forces>;

std::vector<Vector3d> unit_normals(const Mesh& mesh) {
  std::vector<Vector3d> result = mesh.normals;
  if (result.empty()) {
    result.assign(mesh.vertices.size(), Vector3d::Zero());
    for (const auto& t : mesh.triangles) {
      const std::array<Vector3d, 3> p = {mesh.vertices[t[0]], mesh.vertices[t[1]],
                                         mesh.vertices[t[2]]};
      const Vector3d face = (p[1] - p[0]).cross(p[2] - p[0]);
      if (!(face.norm() > 0.0)) continue;
      for (int i = 0; i < 3; ++i) {
        const Vector3d a = p[(i + 1) % 3] - p[i], b = p[(i + 2) % 3] - p[i];
        result[t[i]] += std::atan2(a.cross(b).norm(), a.dot(b)) * face.normalized();
      }
    }
  }
  std::vector<bool> needed(result.size());
  for (const auto& t : mesh.triangles) {
    for (const int v : t) needed[v] = true;
  }
  for (std::size_t i = 0; i < result.size(); ++i) {
    if (!needed[i]) continue;
    const double size = result[i].norm();
    require(std::isfinite(size) && size > 0.0,
            ("size of normals[" + std::to_string(i) + "]").c_str(), size, "finite, > 0");
    result[i] /= size;
  }
  return result;
}

/// Data of one mesh and all forces.
class Cutter {
 public:
  Cutter(const Mesh& mesh, const std::vector<Vector3d>& forces, double mu)
      : mesh_(mesh), normals_(unit_normals(mesh)), points_only_(mu == 0.0) {
    for (const Vector3d& force : forces) {
      cones_.push_back({-force.stableNormalized(), std::max(mu, points_only_ ? point_cone : 0.0)});
    }
    Vector3d low = mesh.vertices[mesh.triangles[0][0]], high = low;
    for (const auto& t : mesh.triangles) {
      for (int i = 0; i < 3; ++i) {
        low = low.cwiseMin(mesh.vertices[t[i]]);
        high = high.cwiseMax(mesh.vertices[t[i]]);
        longest_ = std::max(longest_, (mesh.vertices[t[i]] - mesh.vertices[t[(i + 1) % 3]]).norm());
      }
    }
    size_ = (high - low).norm();
    cut_all();
  }

  SurfaceStudy run() const {
    SurfaceStudy result;
    for (std::size_t k = 0; k < cones_.size(); ++k) {
      result.study.each.push_back(described(
          1, [k](const Mask& m) { return m[k] ? 0 : -1; },
          [k](int, const Mask& edge) { return edge[k]; }));
    }
    const int n = static_cast<int>(cones_.size());
    result.study.any = described(
        n,
        [n](const Mask& m) {
          for (int k = 0; k < n; ++k) {
            if (m[k]) return k;
          }
          return -1;
        },
        [](int k, const Mask& edge) { return edge[k]; });
    Mask every;
    for (int k = 0; k < n; ++k) every.set(k);
    result.study.all = described(
        1, [every](const Mask& m) { return m == every ? 0 : -1; },
        [](int, const Mask&) { return false; }, true);
    for (const Cell& piece : pieces_) {
      Piece shown;
      for (const Plane& p : piece.polygon) shown.polygon.push_back(place(piece.triangle, p));
      shown.triangle = piece.triangle;
      shown.forces = static_cast<int>(piece.mask.count());
      result.pieces.push_back(std::move(shown));
    }
    for (const Vector3d& n_at : normals_) {
      double least = pi;
      for (const Cone& cone : cones_) least = std::min(least, cone_angle(cone.axis, n_at));
      result.cone_angles.push_back(least);
    }
    return result;
  }

 private:
  struct Edge {
    std::vector<Span> spans;  ///< one per force, from the vertex with the smaller index
    std::vector<int> around;  ///< triangles
  };

  struct Cell {
    int triangle;
    Polygon polygon;
    Mask mask;
  };

  Vector3d place(int triangle, const Plane& p) const {
    const auto& t = mesh_.triangles[triangle];
    return (1.0 - p.x() - p.y()) * mesh_.vertices[t[0]] + p.x() * mesh_.vertices[t[1]] +
           p.y() * mesh_.vertices[t[2]];
  }

  Vector3d normal_at(int triangle, const Plane& p) const {
    const auto& t = mesh_.triangles[triangle];
    return (1.0 - p.x() - p.y()) * normals_[t[0]] + p.x() * normals_[t[1]] + p.y() * normals_[t[2]];
  }

  /// Moves a root s found with linearly interpolated normals to the root on the smooth surface.
  double refined(const Cone& cone, const EdgeKey& edge, double s) const {
    if (!mesh_.normal || s <= 0.0 || s >= 1.0) return s;
    const Vector3d &a = mesh_.vertices[edge.first], &b = mesh_.vertices[edge.second];
    const auto excess = [&](double at) {
      return cone_angle(cone.axis, mesh_.normal(mesh_.project(a + at * (b - a)))) -
             std::atan(cone.mu);
    };
    const double low = std::max(0.0, s - 0.1), high = std::min(1.0, s + 0.1);
    const double at_low = excess(low);
    if (at_low * excess(high) > 0.0) return s;
    const auto passed = [&](double at) { return !(excess(at) * at_low > 0.0); };
    const auto found = numerics::change_between(low, high, passed, numerics::fine * (high - low));
    return 0.5 * (found.before + found.after);
  }

  /// Spans of the forces on an edge of triangle t.
  const std::vector<Span>& edge_spans(const EdgeKey& key, int t) {
    auto [found, fresh] = edges_.try_emplace(key);
    Edge& edge = found->second;
    edge.around.push_back(t);
    if (fresh) {
      for (const Cone& cone : cones_) {
        Span span = span_of(cone, normals_[key.first], normals_[key.second]);
        if (!span.empty()) {
          span.a = refined(cone, key, span.a);
          span.b = std::max(span.a, refined(cone, key, span.b));
        }
        edge.spans.push_back(span);
      }
    }
    return edge.spans;
  }

  void cut_all() {
    for (int t = 0; t < static_cast<int>(mesh_.triangles.size()); ++t) {
      const auto& v = mesh_.triangles[t];
      const std::array<Vector3d, 3> normals = {normals_[v[0]], normals_[v[1]], normals_[v[2]]};
      std::array<const std::vector<Span>*, 3> sides;
      for (int i = 0; i < 3; ++i) {
        sides[i] = &edge_spans(std::minmax(v[i], v[(i + 1) % 3]), t);
      }
      std::vector<Cell> pieces = {{t, {Plane(0, 0), Plane(1, 0), Plane(0, 1)}, {}}};
      for (std::size_t k = 0; k < cones_.size(); ++k) {
        std::array<Span, 3> spans;
        for (int i = 0; i < 3; ++i) {
          spans[i] = (*sides[i])[k];
          if (!spans[i].empty() && v[i] > v[(i + 1) % 3]) {
            spans[i] = {1.0 - spans[i].b, 1.0 - spans[i].a};
          }
        }
        const Region region(cones_[k], normals);
        const Polygon polygon = region.polygon(spans);
        const double area = polygon.size() < 3 ? 0.0 : area_of(polygon);
        if (!(area > 0.0)) continue;
        Plane deepest;
        if (region.axis_point(deepest)) axis_points_[{t, static_cast<int>(k)}] = deepest;
        const double least = 1e-10 * std::min(area, 1e-4);
        std::vector<Cell> next;
        for (const Cell& piece : pieces) {
          Polygon inside;
          std::vector<Polygon> outside;
          cut(piece.polygon, polygon, least, inside, outside);
          for (Polygon& o : outside) next.push_back({t, std::move(o), piece.mask});
          if (!inside.empty()) {
            next.push_back({t, std::move(inside), piece.mask});
            next.back().mask.set(k);
          }
        }
        pieces = std::move(next);
      }
      pieces_.insert(pieces_.end(), pieces.begin(), pieces.end());
    }
  }

  /// Connects pieces to a rest set. Graph nodes are pairs (triangle, sort).
  /// @param sort_of returns the sort of a piece from its mask of forces; −1: not in the set
  /// @param linked returns whether pieces of sort k are connected through an edge with the given
  /// forces
  template <class SortOf, class Linked>
  RestSet described(int sorts, SortOf&& sort_of, Linked&& linked, bool every = false) const {
    const std::size_t triangles = mesh_.triangles.size();
    Components components(triangles * sorts);
    std::vector<bool> exists(triangles * sorts);
    const auto node = [&](int t, int sort) { return static_cast<std::size_t>(t) * sorts + sort; };
    for (const Cell& piece : pieces_) {
      const int own = sort_of(piece.mask);
      if (own < 0) continue;
      exists[node(piece.triangle, own)] = true;
      if (sorts == 1) continue;
      for (int k = 0; k < sorts; ++k) {  // a piece of several forces connects their regions
        if (!piece.mask[k]) continue;
        exists[node(piece.triangle, k)] = true;
        components.join(node(piece.triangle, own), node(piece.triangle, k));
      }
    }
    for (const auto& [key, edge] : edges_) {
      const std::vector<Span>& spans = edge.spans;
      const std::vector<int>& around = edge.around;
      if (around.size() < 2) continue;
      Mask on_edge;
      Span common{0.0, 1.0};
      for (std::size_t k = 0; k < spans.size(); ++k) {
        on_edge[k] = !spans[k].empty();
        common = {std::max(common.a, spans[k].a), std::min(common.b, spans[k].b)};
      }
      for (int k = 0; k < sorts; ++k) {
        if (!(every ? !common.empty() : linked(k, on_edge))) continue;
        for (const int other : around) {
          if (exists[node(around[0], k)] && exists[node(other, k)]) {
            components.join(node(around[0], k), node(other, k));
          }
        }
      }
    }
    struct Collected {
      RestComponent part;
      std::vector<Vector3d> points;
      double least = std::numeric_limits<double>::infinity();
    };
    std::map<std::size_t, Collected> parts;
    for (const Cell& piece : pieces_) {
      const int own = sort_of(piece.mask);
      if (own < 0) continue;
      Collected& to = parts[components.find(node(piece.triangle, own))];
      const Vector3d p0 = place(piece.triangle, Plane(0, 0));
      const Vector3d a = place(piece.triangle, Plane(1, 0)) - p0;
      const Vector3d b = place(piece.triangle, Plane(0, 1)) - p0;
      to.part.area += area_of(piece.polygon) * a.cross(b).norm();
      const auto consider = [&](const Plane& p) {
        // Largest cone angle over all forces under which the piece allows rest.
        double worst = 0.0;
        for (std::size_t k = 0; k < cones_.size(); ++k) {
          if (!piece.mask[k]) continue;
          worst = std::max(worst, cone_angle(cones_[k].axis, normal_at(piece.triangle, p)));
        }
        if (worst < to.least) {
          to.least = worst;
          to.part.representative = place(piece.triangle, p);
        }
      };
      Plane middle = Plane::Zero();
      for (const Plane& p : piece.polygon) {
        to.points.push_back(place(piece.triangle, p));
        middle += p / static_cast<double>(piece.polygon.size());
      }
      consider(middle);
      for (std::size_t k = 0; k < cones_.size(); ++k) {
        const auto found = axis_points_.find({piece.triangle, static_cast<int>(k)});
        if (found == axis_points_.end() || !piece.mask[k]) continue;
        bool inside = true;
        for (std::size_t i = 0; i < piece.polygon.size(); ++i) {
          const Plane &p = piece.polygon[i], &q = piece.polygon[(i + 1) % piece.polygon.size()];
          inside = inside && cross(q - p, found->second - p) >= -1e-15;
        }
        if (inside) consider(found->second);
      }
    }
    RestSet result;
    std::vector<Vector3d> all_points;
    for (auto& [root, collected] : parts) {
      RestComponent part = collected.part;
      std::vector<Vector3d>& points = collected.points;
      if (mesh_.project) {
        part.representative = mesh_.project(part.representative);
        for (Vector3d& p : points) p = mesh_.project(p);
      }
      std::sort(points.begin(), points.end(), [](const Vector3d& p, const Vector3d& q) {
        return std::lexicographical_compare(p.data(), p.data() + 3, q.data(), q.data() + 3);
      });
      points.erase(std::unique(points.begin(), points.end()), points.end());
      std::size_t first = 0, second = 0;
      part.diameter = farthest_pair(points, first, second);
      if (points_only_ && part.diameter < 1e-4 * size_) {
        part.area = part.diameter = 0.0;
        part.points = points = {part.representative};
      } else if (points_only_ && part.area < 1e-4 * part.diameter * part.diameter) {
        part.area = 0.0;
        part.length = part.diameter;
        part.points = {points[first], points[second]};
      }
      result.area += part.area;
      result.length += part.length;
      all_points.insert(all_points.end(), points.begin(), points.end());
      result.parts.push_back(std::move(part));
    }
    std::size_t first = 0, second = 0;
    result.diameter = farthest_pair(all_points, first, second);
    if (!all_points.empty()) {
      result.farthest = {all_points[first], all_points[second]};
      result.diameter_error = longest_ * longest_ / (2.0 * size_);
    }
    return result;
  }

  const Mesh& mesh_;
  std::vector<Vector3d> normals_;
  bool points_only_;
  std::vector<Cone> cones_;
  double longest_ = 0.0, size_ = 0.0;
  std::map<EdgeKey, Edge> edges_;
  std::map<std::pair<int, int>, Plane> axis_points_;
  std::vector<Cell> pieces_;
};

}  // namespace

SurfaceStudy rest_on_mesh(const Mesh& mesh, const std::vector<Vector3d>& forces, double mu) {
  check(forces, mu);
  require(forces.size() <= most_forces, "number of forces", static_cast<double>(forces.size()),
          "at most 256 on a mesh");
  check_mesh(mesh);
  return Cutter(mesh, forces, mu).run();
}

}  // namespace statejump::rest_set
