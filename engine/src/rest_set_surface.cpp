// SPDX-License-Identifier: GPL-3.0-or-later
#include "statejump/rest_set_surface.hpp"

#include <Eigen/Dense>
#include <bitset>
#include <map>
#include <stdexcept>
#include <utility>

#include "rest_set_detail.hpp"

namespace statejump {

using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;
using kernel::require;
using namespace rest_detail;

namespace {

constexpr int most_forces = 256;
constexpr double point_cone = 1e-6;  // tan of the cone that stands for mu = 0
using Mask = std::bitset<most_forces>;

/// Friction cone of one force: f = −F/|F|, G(n) = μ² (f·n)² − |n − (f·n) f|².
struct Cone {
  Vector3d axis;
  double mu;

  double form(const Vector3d& a, const Vector3d& b) const {
    const double fa = axis.dot(a), fb = axis.dot(b);
    return mu * mu * fa * fb - (a - fa * axis).dot(b - fb * axis);
  }
  bool holds(const Vector3d& n) const { return axis.dot(n) > 0.0 && form(n, n) >= 0.0; }
};

double cone_angle(const Vector3d& axis, const Vector3d& n) {
  return std::atan2(axis.cross(n).norm(), axis.dot(n));
}

/// Real roots of G(a + s b) in s, in order.
std::vector<double> roots(const Cone& cone, const Vector3d& a, const Vector3d& b) {
  const double c0 = cone.form(a, a), c1 = cone.form(a, b), c2 = cone.form(b, b);
  const double square = c1 * c1 - c0 * c2;
  if (square < 0.0) return {};
  const double q = -(c1 + std::copysign(std::sqrt(square), c1));
  std::vector<double> result;
  if (c2 != 0.0) result.push_back(q / c2);
  if (q != 0.0) result.push_back(c0 / q);
  std::sort(result.begin(), result.end());
  return result;
}

/// Part of [0, 1] for which a + s (b − a) is in the cone; empty if first > second.
struct Span {
  double a = 1.0, b = 0.0;
  bool empty() const { return a > b; }
};

Span span_of(const Cone& cone, const Vector3d& a, const Vector3d& b) {
  std::vector<double> stations = {0.0};
  for (const double s : roots(cone, a, b - a)) {
    if (s > 0.0 && s < 1.0) stations.push_back(s);
  }
  stations.push_back(1.0);
  Span result;
  for (std::size_t i = 0; i + 1 < stations.size(); ++i) {
    const double middle = 0.5 * (stations[i] + stations[i + 1]);
    if (!cone.holds(a + middle * (b - a))) continue;
    result.a = std::min(result.a, stations[i]);
    result.b = std::max(result.b, stations[i + 1]);
  }
  return result;
}

/// A point of a triangle: its weights of vertices 1 and 2.
using Plane = Vector2d;
using Polygon = std::vector<Plane>;

double cross(const Plane& a, const Plane& b) {
  return a.x() * b.y() - a.y() * b.x();
}

double area_of(const Polygon& polygon) {
  double twice = 0.0;
  for (std::size_t i = 1; i + 1 < polygon.size(); ++i) {
    twice += cross(polygon[i] - polygon[0], polygon[i + 1] - polygon[0]);
  }
  return 0.5 * twice;
}

/// The side of the line through a and b that is left (sign 1) or right (−1) of it.
Polygon clipped(const Polygon& polygon, const Plane& a, const Plane& b, double sign) {
  Polygon result;
  const auto side = [&](const Plane& p) { return sign * cross(b - a, p - a); };
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Plane &p = polygon[i], &q = polygon[(i + 1) % polygon.size()];
    const double sp = side(p), sq = side(q);
    if (sp >= 0.0) result.push_back(p);
    if ((sp > 0.0 && sq < 0.0) || (sp < 0.0 && sq > 0.0)) {
      result.push_back(p + sp / (sp - sq) * (q - p));
    }
  }
  return result;
}

/// Cuts a convex polygon by a convex region: what is inside, and convex pieces of the rest.
void cut(const Polygon& polygon, const Polygon& region, double least, Polygon& inside,
         std::vector<Polygon>& outside) {
  inside = polygon;
  for (std::size_t i = 0; i < region.size() && !inside.empty(); ++i) {
    const Plane &a = region[i], &b = region[(i + 1) % region.size()];
    const Polygon off = clipped(inside, a, b, -1.0);
    if (area_of(off) <= least) continue;  // nothing of it is beyond this side
    outside.push_back(off);
    inside = clipped(inside, a, b, 1.0);
    if (area_of(inside) <= least) inside.clear();
  }
}

/// The convex region of a triangle in which the interpolated normal is in a cone.
class Region {
 public:
  Region(const Cone& cone, const std::array<Vector3d, 3>& normals) : cone_(cone), n_(normals) {}

  Vector3d at(const Plane& p) const {
    return n_[0] + p.x() * (n_[1] - n_[0]) + p.y() * (n_[2] - n_[0]);
  }

  /// Where the normal is parallel to the cone's axis, if that is one point of the triangle.
  bool axis_point(Plane& point) const {
    Matrix3d matrix;
    matrix << n_[0], n_[1], n_[2];
    const Eigen::FullPivLU<Matrix3d> lu(matrix);
    if (lu.rank() < 3) return false;
    Vector3d weights = lu.solve(cone_.axis);
    const double rounding = 1e-12 * weights.cwiseAbs().maxCoeff();
    if (!(weights.minCoeff() >= -rounding)) return false;
    weights = weights.cwiseMax(0.0);
    weights /= weights.sum();
    point = {weights[1], weights[2]};
    return true;
  }

  /// @param spans of the sides 0-1, 1-2, 2-0
  Polygon polygon(const std::array<Span, 3>& spans) const {
    static const std::array<Plane, 3> corner = {Plane(0, 0), Plane(1, 0), Plane(0, 1)};
    Polygon result;
    std::vector<std::pair<Plane, Plane>> chords;  // straight pieces on the sides
    for (int i = 0; i < 3; ++i) {
      if (spans[i].empty()) continue;
      const Plane &a = corner[i], &b = corner[(i + 1) % 3];
      chords.emplace_back(a + spans[i].a * (b - a), a + spans[i].b * (b - a));
    }
    Plane middle;
    if (chords.empty()) {
      if (!axis_point(middle)) return {};
      std::array<Plane, 4> ring;
      const std::array<Plane, 4> directions = {Plane(1, 0), Plane(0, 1), Plane(-1, 0),
                                               Plane(0, -1)};
      for (int i = 0; i < 4; ++i) ring[i] = middle + reach(middle, directions[i]) * directions[i];
      for (int i = 0; i < 4; ++i) {
        result.push_back(ring[i]);
        arc(ring[i], ring[(i + 1) % 4], 4, result);
      }
      return result;
    }
    for (std::size_t i = 0; i < chords.size(); ++i) {
      result.push_back(chords[i].first);
      result.push_back(chords[i].second);
      arc(chords[i].second, chords[(i + 1) % chords.size()].first, 3, result);
    }
    Polygon distinct;
    for (const Plane& p : result) {
      if (distinct.empty() || (p - distinct.back()).norm() > 1e-13) distinct.push_back(p);
    }
    while (distinct.size() > 1 && (distinct.front() - distinct.back()).norm() <= 1e-13) {
      distinct.pop_back();
    }
    return distinct;
  }

 private:
  /// Distance from a point inside to the boundary of the cone, in units of the direction.
  double reach(const Plane& from, const Plane& direction) const {
    for (const double s : roots(cone_, at(from), at(from + direction) - at(from))) {
      if (s > 0.0) return s;
    }
    return 0.0;
  }

  /// Appends points of the conic strictly between a and b; it lies to the right of a → b.
  void arc(const Plane& a, const Plane& b, int depth, Polygon& result) const {
    const Plane chord = b - a;
    if (depth == 0 || chord.norm() < 1e-12) return;
    const Plane outward(chord.y(), -chord.x());
    const Plane from = 0.5 * (a + b);
    if (!cone_.holds(at(from))) return;
    const double distance = reach(from, outward);
    if (!(distance < 4.0)) return;  // flat or nearly: the chord is it
    Plane middle = from + distance * outward;
    // Roots on the smooth surface may lie beside the conic of the linear normals.
    middle = middle.cwiseMax(0.0);
    if (middle.sum() > 1.0) middle /= middle.sum();
    arc(a, middle, depth - 1, result);
    result.push_back(middle);
    arc(middle, b, depth - 1, result);
  }

  Cone cone_;
  std::array<Vector3d, 3> n_;
};

using EdgeKey = std::pair<int, int>;

void check_mesh(const RestMesh& mesh) {
  require(!mesh.triangles.empty(), "number of triangles", 0.0, "at least 1");
  require(mesh.normals.empty() || mesh.normals.size() == mesh.vertices.size(), "number of normals",
          static_cast<double>(mesh.normals.size()), "0 or one per vertex");
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    for (const int v : mesh.triangles[i]) {
      require(v >= 0 && v < static_cast<int>(mesh.vertices.size()),
              ("triangles[" + std::to_string(i) + "]").c_str(), v, "an index of a vertex");
    }
  }
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    require(mesh.vertices[i].allFinite(), ("vertices[" + std::to_string(i) + "]").c_str(),
            mesh.vertices[i].sum(), "finite [m]");
  }
}

std::vector<Vector3d> unit_normals(const RestMesh& mesh) {
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

/// Everything about one mesh and all forces.
class Study {
 public:
  Study(const RestMesh& mesh, const std::vector<Vector3d>& forces, double mu)
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

  SurfaceRestStudy run() const {
    SurfaceRestStudy result;
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
    for (const Piece& piece : pieces_) {
      RestPiece shown;
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

  struct Piece {
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

  /// A root of the linear normals, moved to that of the smooth surface.
  double refined(const Cone& cone, const EdgeKey& edge, double s) const {
    if (!mesh_.normal || s <= 0.0 || s >= 1.0) return s;
    const Vector3d &a = mesh_.vertices[edge.first], &b = mesh_.vertices[edge.second];
    const auto excess = [&](double at) {
      return cone_angle(cone.axis, mesh_.normal(mesh_.project(a + at * (b - a)))) -
             std::atan(cone.mu);
    };
    double low = std::max(0.0, s - 0.1), high = std::min(1.0, s + 0.1);
    const double at_low = excess(low);
    if (at_low * excess(high) > 0.0) return s;
    for (int i = 0; i < 60; ++i) {
      const double middle = 0.5 * (low + high);
      (excess(middle) * at_low > 0.0 ? low : high) = middle;
    }
    return 0.5 * (low + high);
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
      std::vector<Piece> pieces = {{t, {Plane(0, 0), Plane(1, 0), Plane(0, 1)}, {}}};
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
        std::vector<Piece> next;
        for (const Piece& piece : pieces) {
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

  /// Nodes are (triangle, sort).
  /// @param sort_of sort of a piece by its mask, −1: not in the set
  /// @param linked whether sort k is connected through an edge with the given forces on it
  template <class SortOf, class Linked>
  RestSet described(int sorts, SortOf&& sort_of, Linked&& linked, bool every = false) const {
    const std::size_t triangles = mesh_.triangles.size();
    Components components(triangles * sorts);
    std::vector<bool> exists(triangles * sorts);
    const auto node = [&](int t, int sort) { return static_cast<std::size_t>(t) * sorts + sort; };
    for (const Piece& piece : pieces_) {
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
      RestPart part;
      std::vector<Vector3d> points;
      double least = std::numeric_limits<double>::infinity();
    };
    std::map<std::size_t, Collected> parts;
    for (const Piece& piece : pieces_) {
      const int own = sort_of(piece.mask);
      if (own < 0) continue;
      Collected& to = parts[components.find(node(piece.triangle, own))];
      const Vector3d p0 = place(piece.triangle, Plane(0, 0));
      const Vector3d a = place(piece.triangle, Plane(1, 0)) - p0;
      const Vector3d b = place(piece.triangle, Plane(0, 1)) - p0;
      to.part.area += area_of(piece.polygon) * a.cross(b).norm();
      const auto consider = [&](const Plane& p) {
        // For several forces: the worst of those that hold it.
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
      RestPart part = collected.part;
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

  const RestMesh& mesh_;
  std::vector<Vector3d> normals_;
  bool points_only_;
  std::vector<Cone> cones_;
  double longest_ = 0.0, size_ = 0.0;
  std::map<EdgeKey, Edge> edges_;
  std::map<std::pair<int, int>, Plane> axis_points_;
  std::vector<Piece> pieces_;
};

}  // namespace

RestMesh welded(const RestMesh& mesh, double tolerance) {
  require(std::isfinite(tolerance) && tolerance >= 0.0, "tolerance", tolerance, "finite, >= 0 m");
  check_mesh(mesh);
  RestMesh result;
  result.project = mesh.project;
  result.normal = mesh.normal;
  // Buckets as large as the tolerance; a neighbour may lie in the next one.
  const double bucket = tolerance > 0.0 ? tolerance : 1.0;
  std::map<std::array<double, 3>, std::vector<int>> known;
  std::vector<int> index;
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    const Vector3d& p = mesh.vertices[i];
    const Vector3d cell = tolerance > 0.0 ? (p / bucket).array().floor().matrix().eval() : p;
    int same = -1;
    const int reach = tolerance > 0.0 ? 1 : 0;
    for (int x = -reach; x <= reach && same < 0; ++x) {
      for (int y = -reach; y <= reach && same < 0; ++y) {
        for (int z = -reach; z <= reach && same < 0; ++z) {
          const auto found = known.find({cell.x() + x, cell.y() + y, cell.z() + z});
          if (found == known.end()) continue;
          for (const int j : found->second) {
            if ((result.vertices[j] - p).norm() <= tolerance) same = j;
          }
        }
      }
    }
    if (same < 0) {
      same = static_cast<int>(result.vertices.size());
      result.vertices.push_back(p);
      if (!mesh.normals.empty()) result.normals.push_back(Vector3d::Zero());
      known[{cell.x(), cell.y(), cell.z()}].push_back(same);
    }
    if (!mesh.normals.empty()) result.normals[same] += mesh.normals[i];
    index.push_back(same);
  }
  for (const auto& t : mesh.triangles) {
    const std::array<int, 3> w = {index[t[0]], index[t[1]], index[t[2]]};
    const Vector3d &p = result.vertices[w[0]], &q = result.vertices[w[1]],
                   &r = result.vertices[w[2]];
    if (w[0] == w[1] || w[1] == w[2] || w[2] == w[0] || (q - p).cross(r - p).norm() == 0.0)
      continue;
    result.triangles.push_back(w);
  }
  return result;
}

RestMesh implicit_surface(const SpaceFunction& gamma, const SpaceGradient& gradient,
                          const Vector3d& low, const Vector3d& high, int cells) {
  const Vector3d extent = high - low;
  for (int i = 0; i < 3; ++i) {
    require(std::isfinite(extent[i]) && extent[i] > 0.0, "high - low", extent[i],
            "finite, > 0 m in x, y and z");
  }
  require(cells >= 2 && cells <= 400, "cells", cells, "2 to 400");
  const double step = extent.maxCoeff() / cells;
  std::array<int, 3> n;
  for (int i = 0; i < 3; ++i) n[i] = std::max(1, static_cast<int>(std::lround(extent[i] / step)));
  const auto value = [gamma](const Vector3d& p) {
    const double result = gamma(p);
    require(std::isfinite(result), "gamma", result, "finite in the whole box");
    return result;
  };
  const auto slope = [gradient](const Vector3d& p) -> Vector3d {
    const Vector3d result = gradient(p);
    const double norm = result.norm();
    require(std::isfinite(norm) && norm > 0.0, "size of the gradient of gamma on the surface", norm,
            "finite, > 0");
    return result;
  };
  const auto number = [&](int i, int j, int k) {
    return (static_cast<std::size_t>(k) * (n[1] + 1) + j) * (n[0] + 1) + i;
  };
  const std::size_t points = number(n[0], n[1], n[2]) + 1;
  std::vector<Vector3d> grid(points);
  std::vector<bool> free(points);
  for (int k = 0; k <= n[2]; ++k) {
    for (int j = 0; j <= n[1]; ++j) {
      for (int i = 0; i <= n[0]; ++i) {
        Vector3d& p = grid[number(i, j, k)];
        p = low + Vector3d(extent.x() * i / n[0], extent.y() * j / n[1], extent.z() * k / n[2]);
        free[number(i, j, k)] = value(p) < 0.0;
      }
    }
  }
  RestMesh mesh;
  std::map<std::pair<std::size_t, std::size_t>, int> on_edge;
  const auto vertex = [&](std::size_t a, std::size_t b) {
    const auto [found, fresh] =
        on_edge.try_emplace(std::minmax(a, b), static_cast<int>(mesh.vertices.size()));
    if (fresh) {
      Vector3d inside = grid[free[a] ? a : b], outside = grid[free[a] ? b : a];
      for (int i = 0; i < 50; ++i) {
        const Vector3d middle = 0.5 * (inside + outside);
        (value(middle) < 0.0 ? inside : outside) = middle;
      }
      mesh.vertices.push_back(0.5 * (inside + outside));
      mesh.normals.push_back(-slope(mesh.vertices.back()).normalized());
    }
    return found->second;
  };
  // Six tetrahedra around the diagonal of each cell, one per order of the three axes.
  static constexpr int orders[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2},
                                       {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
  for (int k = 0; k < n[2]; ++k) {
    for (int j = 0; j < n[1]; ++j) {
      for (int i = 0; i < n[0]; ++i) {
        for (const auto& order : orders) {
          std::array<int, 3> at = {i, j, k};
          std::array<std::size_t, 4> corner;
          corner[0] = number(at[0], at[1], at[2]);
          for (int c = 0; c < 3; ++c) {
            ++at[order[c]];
            corner[c + 1] = number(at[0], at[1], at[2]);
          }
          std::vector<std::size_t> in, out;
          for (const std::size_t c : corner) (free[c] ? in : out).push_back(c);
          if (in.empty() || out.empty()) continue;
          if (in.size() == 2) {
            const std::array<int, 4> q = {vertex(in[0], out[0]), vertex(in[0], out[1]),
                                          vertex(in[1], out[1]), vertex(in[1], out[0])};
            mesh.triangles.push_back({q[0], q[1], q[2]});
            mesh.triangles.push_back({q[0], q[2], q[3]});
          } else {
            const std::size_t tip = in.size() == 1 ? in[0] : out[0];
            const auto& base = in.size() == 1 ? out : in;
            mesh.triangles.push_back(
                {vertex(tip, base[0]), vertex(tip, base[1]), vertex(tip, base[2])});
          }
        }
      }
    }
  }
  require(!mesh.triangles.empty(), "number of triangles of gamma = 0 in the box", 0.0,
          "at least 1: gamma must change its sign between grid points");
  // Right-hand normals on the side of N.
  for (auto& t : mesh.triangles) {
    const Vector3d face = (mesh.vertices[t[1]] - mesh.vertices[t[0]])
                              .cross(mesh.vertices[t[2]] - mesh.vertices[t[0]]);
    if (face.dot(mesh.normals[t[0]] + mesh.normals[t[1]] + mesh.normals[t[2]]) < 0.0) {
      std::swap(t[1], t[2]);
    }
  }
  mesh.project = [value, slope, step](const Vector3d& start) {
    Vector3d p = start;
    for (int i = 0; i < 50; ++i) {
      const Vector3d g = slope(p);
      const Vector3d move = value(p) / g.squaredNorm() * g;
      p -= move;
      if (move.norm() <= 1e-15 * (p.norm() + step)) break;
    }
    return p;
  };
  mesh.normal = [slope](const Vector3d& p) -> Vector3d { return -slope(p).normalized(); };
  return mesh;
}

RestMesh clearance_sphere(double clearance, int level) {
  check_length(clearance, "clearance");
  require(level >= 0 && level <= 8, "level", level, "0 to 8");
  RestMesh mesh;
  const double g = 0.5 * (1.0 + std::sqrt(5.0));
  mesh.vertices = {{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                   {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
  mesh.triangles = {{0, 11, 5}, {0, 5, 1},  {0, 1, 7},   {0, 7, 10}, {0, 10, 11},
                    {1, 5, 9},  {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
                    {3, 9, 4},  {3, 4, 2},  {3, 2, 6},   {3, 6, 8},  {3, 8, 9},
                    {4, 9, 5},  {2, 4, 11}, {6, 2, 10},  {8, 6, 7},  {9, 8, 1}};
  for (int l = 0; l < level; ++l) {
    std::map<EdgeKey, int> middles;
    std::vector<std::array<int, 3>> finer;
    const auto middle = [&](int a, int b) {
      const auto [found, fresh] =
          middles.try_emplace(std::minmax(a, b), static_cast<int>(mesh.vertices.size()));
      if (fresh) {
        const Vector3d sum = mesh.vertices[a].normalized() + mesh.vertices[b].normalized();
        mesh.vertices.push_back(sum);
      }
      return found->second;
    };
    for (const auto& t : mesh.triangles) {
      const int a = middle(t[0], t[1]), b = middle(t[1], t[2]), c = middle(t[2], t[0]);
      finer.insert(finer.end(), {{t[0], a, c}, {t[1], b, a}, {t[2], c, b}, {a, b, c}});
    }
    mesh.triangles = std::move(finer);
  }
  for (Vector3d& v : mesh.vertices) {
    v.normalize();
    mesh.normals.push_back(-v);
    v *= clearance;
  }
  for (auto& t : mesh.triangles) std::swap(t[1], t[2]);  // right-hand normals inwards
  return mesh;
}

SurfaceRestStudy rest_on_mesh(const RestMesh& mesh, const std::vector<Vector3d>& forces,
                              double mu) {
  check(forces, mu);
  require(forces.size() <= most_forces, "number of forces", static_cast<double>(forces.size()),
          "at most 256 on a mesh");
  check_mesh(mesh);
  return Study(mesh, forces, mu).run();
}

}  // namespace statejump
