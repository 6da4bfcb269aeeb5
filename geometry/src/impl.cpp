// SPDX-License-Identifier: GPL-3.0-or-later
#include "impl.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <thread>

#include "statejump/geometry/mesh_failure.hpp"
#include "statejump/kernel/require.hpp"

namespace statejump::geometry {
namespace {

constexpr double pi = 3.141592653589793238462643;
constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr int fewest_neighbours = 9;  // fitted to one vertex, if the wall has that many
constexpr int most_neighbours = 60;
constexpr int bore_columns = 256;
constexpr int bore_rows = 33;
constexpr int socket_columns = 96;
constexpr int socket_rows = 49;
constexpr int most_steps = 4096;               // largest number of faces that follow() visits
constexpr double prominence_per_mismatch = 4;  // see BoreMesh::prominence()
constexpr double least_prominence = 1e-12;     // [m]

/// Runs work(begin, end) on parts of 0..count in parallel threads. Results must not depend on the
/// division.
template <class Work>
void in_parallel(int count, const Work& work) {
  const int threads = std::clamp(static_cast<int>(std::thread::hardware_concurrency()), 1, 8);
  if (threads == 1 || count < 4096) {
    work(0, count);
    return;
  }
  std::vector<std::thread> pool;
  for (int t = 0; t < threads; ++t)
    pool.emplace_back([&, t] {
      work(static_cast<int>(std::int64_t(count) * t / threads),
           static_cast<int>(std::int64_t(count) * (t + 1) / threads));
    });
  for (std::thread& thread : pool) thread.join();
}

/// A smooth step with zero slope at 0 and 1, with which blended patches join smoothly across edges.
double step(double x) {
  return x * x * (3 - 2 * x);
}

std::array<double, 3> blend_weights(const std::array<double, 3>& barycentric) {
  std::array<double, 3> w{step(barycentric[0]), step(barycentric[1]), step(barycentric[2])};
  const double sum = w[0] + w[1] + w[2];
  for (double& x : w) x /= sum;
  return w;
}

CGAL::Exact_predicates_inexact_constructions_kernel::Point_3 to_cgal(const Vector3& v) {
  return {v.x(), v.y(), v.z()};
}

}  // namespace

BoreMesh::Impl::Impl(Triangles given, const BoreOptions& options, const std::string& name)
    : mesh(std::move(given)), kind(options.kind) {
  using kernel::require;
  require(options.scale > 0 && std::isfinite(options.scale), "scale", options.scale, "(0, inf) m");
  require(options.fit_degree >= 2 && options.fit_degree <= 4, "fit_degree", options.fit_degree,
          "2, 3 or 4");
  require(options.smallest_radius >= 0, "smallest_radius", options.smallest_radius, "[0, inf) m");
  require(options.largest_radius > options.smallest_radius, "largest_radius",
          options.largest_radius, "(smallest_radius, inf] m");
  if (options.scale != 1.0)
    for (Vector3& v : mesh.vertices) v *= options.scale;
  if (options.flip)
    for (auto& face : mesh.faces) std::swap(face[1], face[2]);

  const Neighbours all = check_topology(mesh, name);
  wall = find_wall(mesh, all, options, name);
  check_self_intersection(mesh, name);
  neighbour = restricted(all, wall.faces, static_cast<int>(mesh.faces.size()));

  make_jets(options.fit_degree);
  facets.reserve(wall.faces.size());
  for (const int f : wall.faces) {
    const auto& c = mesh.faces[f];
    facets.emplace_back(to_cgal(mesh.vertices[c[0]]), to_cgal(mesh.vertices[c[1]]),
                        to_cgal(mesh.vertices[c[2]]));
  }
  tree.insert(facets.cbegin(), facets.cend());
  tree.build();
  tree.accelerate_distance_queries();
  estimate_error();
  make_grid();
  refuse_coarse(name);
  make_hollow();
}

void BoreMesh::Impl::make_jets(int degree) {
  const int face_count = static_cast<int>(wall.faces.size());
  std::vector<int> index(mesh.vertices.size(), -1);
  std::vector<int> vertices;
  corner.resize(face_count);
  for (int f = 0; f < face_count; ++f)
    for (int k = 0; k < 3; ++k) {
      const int v = mesh.faces[wall.faces[f]][k];
      if (index[v] < 0) {
        index[v] = static_cast<int>(vertices.size());
        vertices.push_back(v);
      }
      corner[f][k] = index[v];
    }
  const int count = static_cast<int>(vertices.size());

  // Finds the faces at each vertex and computes vertex normals weighted with the angles of the
  // faces.
  std::vector<int> start(count + 1, 0);
  for (const auto& c : corner)
    for (const int v : c) ++start[v + 1];
  for (int v = 0; v < count; ++v) start[v + 1] += start[v];
  std::vector<int> faces_at(start[count]);
  std::vector<Vector3> normal(count, Vector3::Zero());
  {
    std::vector<int> filled(start.begin(), start.end() - 1);
    for (int f = 0; f < face_count; ++f)
      for (int k = 0; k < 3; ++k) {
        const int v = corner[f][k];
        faces_at[filled[v]++] = f;
        const Vector3& here = mesh.vertices[vertices[v]];
        const Vector3 a = mesh.vertices[vertices[corner[f][(k + 1) % 3]]] - here;
        const Vector3 b = mesh.vertices[vertices[corner[f][(k + 2) % 3]]] - here;
        const Vector3 out = cross(a, b);
        normal[v] += std::atan2(out.norm(), a.dot(b)) * out.normalized();
      }
  }
  for (Vector3& n : normal) n.normalize();

  jet.resize(count);
  vertex_normal.assign(mesh.vertices.size(), Vector3::Zero());
  std::vector<double>& least = vertex_curvature;
  least.resize(count);
  std::vector<double> most(count);
  in_parallel(count, [&](int begin, int end) {
    std::vector<int> seen(count, -1);
    std::vector<int> ring;
    std::vector<Vector3> points;
    for (int v = begin; v < end; ++v) {
      ring.assign(1, v);
      seen[v] = v;
      std::size_t done = 0;
      // If the first ring alone exceeds most_neighbours, two complete rings are used. Part of a
      // ring leaves one side undetermined; one ring does not determine the fourth order.
      std::size_t taken = most_neighbours;
      for (int rings = 0; rings < 6; ++rings) {
        const std::size_t last = ring.size();
        for (; done < last && ring.size() < taken; ++done)
          for (int i = start[ring[done]]; i < start[ring[done] + 1]; ++i)
            for (const int w : corner[faces_at[i]])
              // Do not fit across a crease.
              if (seen[w] != v && normal[w].dot(normal[v]) > 0.5) {
                seen[w] = v;
                ring.push_back(w);
              }
        if (rings == 0 && ring.size() > most_neighbours + 1) taken = vertices.size();
        if (ring.size() == last) break;
        if (rings >= 1 && ring.size() > fewest_neighbours) break;
      }
      points.clear();
      for (std::size_t i = 1; i < ring.size() && i <= taken; ++i)
        points.push_back(mesh.vertices[vertices[ring[i]]]);
      const Vector3& here = mesh.vertices[vertices[v]];
      if (points.size() < 2) {
        for (int i = start[v]; i < start[v + 1]; ++i)
          for (const int w : corner[faces_at[i]])
            if (w != v) points.push_back(mesh.vertices[vertices[w]]);
      }
      jet[v] = fit_jet(here, normal[v], wall.axis, points, degree);
      Hit hit;
      const JetHit own = jet[v].hit(here, normal[v], 0.0);
      hit.normal = own.normal;
      hit.bend = own.bend;
      vertex_normal[vertices[v]] = own.normal;
      const Principal p = principal(hit);
      least[v] = p.smaller;
      most[v] = p.larger;
    }
  });
  least_curvature = *std::min_element(least.begin(), least.end());
  most_curvature = *std::max_element(most.begin(), most.end());
}

void BoreMesh::Impl::estimate_error() {
  std::vector<double> mismatch;
  for (std::size_t f = 0; f < corner.size(); ++f)
    for (int k = 0; k < 3; ++k) {
      if (neighbour[f][k] >= 0 && neighbour[f][k] < static_cast<int>(f)) continue;
      const Jet& a = jet[corner[f][(k + 1) % 3]];
      const Jet& b = jet[corner[f][(k + 2) % 3]];
      // Not at the middle, where equal errors of both polynomials cancel.
      const Vector3 point = 0.75 * a.origin + 0.25 * b.origin;
      const Vector3 normal = (a.normal + b.normal).normalized();
      const double apart = std::abs(a.meet(point, normal, 0) - b.meet(point, normal, 0));
      mismatch.push_back(std::isnan(apart) ? std::numeric_limits<double>::infinity() : apart);
    }
  error = *std::max_element(mismatch.begin(), mismatch.end());
  const auto high = mismatch.begin() + static_cast<std::ptrdiff_t>(0.95 * double(mismatch.size()));
  std::nth_element(mismatch.begin(), high, mismatch.end());
  prominence = prominence_per_mismatch * *high + least_prominence;
}

void BoreMesh::Impl::make_grid() {
  const bool bore = kind == SurfaceKind::bore;
  grid.columns = bore ? bore_columns : socket_columns;
  grid.rows = bore ? bore_rows : socket_rows;
  grid.low = bore ? wall.low : 0.0;
  grid.step = (bore ? wall.high - wall.low : pi) / (grid.rows - 1);
  const int cells = grid.rows * grid.columns;
  grid.radius.assign(cells, nan);
  grid.point.assign(cells, Vector3::Constant(nan));
  grid.face.assign(cells, -1);
  for (int c = 0; c < grid.columns; ++c) {
    grid.cosine.push_back(std::cos(2 * pi * c / grid.columns));
    grid.sine.push_back(std::sin(2 * pi * c / grid.columns));
  }
  for (int r = 0; r < grid.rows; ++r) {
    int near = -1;
    for (int c = 0; c < grid.columns; ++c) {
      const Vector3 across = grid.cosine[c] * wall.axis_x + grid.sine[c] * wall.axis_y;
      Vector3 from = wall.centre, direction = across;
      if (bore) {
        // The ray starts slightly inside both ends, because rounding of the border could hide the
        // wall there.
        double z = grid.low + r * grid.step;
        z = std::clamp(z, wall.low + 1e-6 * (wall.high - wall.low),
                       wall.high - 1e-6 * (wall.high - wall.low));
        from += z * wall.axis;
      } else {
        const double polar = std::clamp(grid.low + r * grid.step, 1e-6, pi - 1e-6);
        // The axis points to the opening, so the polar angle 0 is the bottom of the cup.
        direction = std::sin(polar) * across - std::cos(polar) * wall.axis;
      }
      const Hit hit = meet(from, direction, near);
      if (!hit.found) continue;
      near = hit.face;
      const int cell = r * grid.columns + c;
      grid.radius[cell] = hit.s;
      grid.point[cell] = hit.point;
      grid.face[cell] = hit.face;
    }
  }
  // Between samples the wall can be nearer than at them, at most by the largest difference of
  // neighbours.
  double least = std::numeric_limits<double>::infinity(), largest_step = 0;
  for (int r = 0; r < grid.rows; ++r)
    for (int c = 0; c < grid.columns; ++c) {
      const double here = grid.radius[r * grid.columns + c];
      const double after = grid.radius[r * grid.columns + (c + 1) % grid.columns];
      const double above = grid.radius[std::min(r + 1, grid.rows - 1) * grid.columns + c];
      if (here < least) least = here;
      for (const double other : {after, above})
        if (std::abs(other - here) > largest_step) largest_step = std::abs(other - here);
    }
  grid.least = least - largest_step - prominence;
  make_reach();
}

/// Computes how far a sample represents the wall: half-way to its neighbours, or the whole way if
/// one is missing.
void BoreMesh::Impl::make_reach() {
  grid.reach.assign(grid.radius.size(), 0);
  for (int cell = 0; cell < static_cast<int>(grid.radius.size()); ++cell) {
    if (std::isnan(grid.radius[cell])) continue;
    double farthest = 0, share = 0.5;
    grid.for_neighbours(cell, [&](int other) {
      if (std::isnan(grid.radius[other]))
        share = 1;
      else
        farthest = std::max(farthest, (grid.point[other] - grid.point[cell]).norm());
    });
    grid.reach[cell] = share * farthest;
  }
}

/// Rejects facets that are too coarse to determine the surface between them. At 95 % of the edges
/// the uncertainty must be below a fiftieth of the radius, which equals the clearance of a wide
/// joint. At the remaining edges, such as sharp ones, the limit is half a radius. No polynomial may
/// diverge.
void BoreMesh::Impl::refuse_coarse(const std::string& name) const {
  const double usual = (prominence - least_prominence) / prominence_per_mismatch;
  const double allowed = 0.02 * wall.radius;
  const bool is_near = std::all_of(grid.radius.begin(), grid.radius.end(), [&](double radius) {
    return std::isnan(radius) || (radius > 0 && radius < 5 * wall.radius);
  });
  if (usual <= allowed && error <= 0.5 * wall.radius && is_near) return;
  throw MeshFailure(
      name, MeshReason::facets_too_coarse,
      {{"open_m", std::max({usual, error, is_near ? 0 : wall.radius})}, {"allowed_m", allowed}});
}

void BoreMesh::Impl::make_hollow() {
  constexpr double none = -std::numeric_limits<double>::infinity();
  grid.hollow.assign(grid.radius.size(), none);
  std::vector<double> column(jet.size()), row(jet.size());
  for (std::size_t v = 0; v < jet.size(); ++v) {
    const Vector3 from = jet[v].origin - wall.centre;
    const double x = from.dot(wall.axis_x), y = from.dot(wall.axis_y);
    column[v] = std::atan2(y, x) * grid.columns / (2 * pi);
    const double z = from.dot(wall.axis);
    const double level =
        kind == SurfaceKind::bore ? z : std::atan2(std::hypot(x, y), -z);  // as in make_grid()
    row[v] = (level - grid.low) / grid.step;
  }
  for (const auto& c : corner) {
    double hollow = none, first = 0, last = 0, low = row[c[0]], high = low;
    for (const int v : c) {
      hollow = std::max(hollow, -vertex_curvature[v]);
      const double turned = std::remainder(column[v] - column[c[0]], double(grid.columns));
      first = std::min(first, turned);
      last = std::max(last, turned);
      low = std::min(low, row[v]);
      high = std::max(high, row[v]);
    }
    const int from = static_cast<int>(std::floor(column[c[0]] + first)) + grid.columns;
    const int to = static_cast<int>(std::ceil(column[c[0]] + last)) + grid.columns;
    const int bottom = std::max(static_cast<int>(std::floor(low)), 0);
    const int top = std::min(static_cast<int>(std::ceil(high)), grid.rows - 1);
    for (int r = bottom; r <= top; ++r)
      for (int i = from; i <= to; ++i) {
        double& cell = grid.hollow[r * grid.columns + i % grid.columns];
        cell = std::max(cell, hollow);
      }
  }
  for (int cell = grid.columns; cell + grid.columns < int(grid.radius.size()); ++cell) {
    const double bend =
        grid.radius[cell - grid.columns] - 2 * grid.radius[cell] + grid.radius[cell + grid.columns];
    if (std::abs(bend) / 8 > grid.sag) grid.sag = std::abs(bend) / 8;
  }
}

int BoreMesh::Impl::shoot(const Vector3& point, const Vector3& direction) const {
  const Kernel::Ray_3 ray(to_cgal(point),
                          Kernel::Vector_3(direction.x(), direction.y(), direction.z()));
  const auto found = tree.first_intersected_primitive(ray);
  return found ? static_cast<int>(*found - facets.cbegin()) : -1;
}

Hit BoreMesh::Impl::follow(const Vector3& point, const Vector3& direction, int start) const {
  Hit hit;
  int face = start;
  int from = -1;
  for (int i = 0; i < most_steps; ++i) {
    const auto& c = corner[face];
    const Vector3 a = jet[c[0]].origin - point;
    const Vector3 b = jet[c[1]].origin - point;
    const Vector3 d = jet[c[2]].origin - point;
    // These signed volumes are equal for both faces of an edge, so no line passes between the
    // faces.
    const std::array<double, 3> volume{direction.dot(cross(b, d)), direction.dot(cross(d, a)),
                                       direction.dot(cross(a, b))};
    const double sum = volume[0] + volume[1] + volume[2];
    if (sum == 0) return hit;
    const double sign = sum > 0 ? 1.0 : -1.0;
    int out = -1;
    double worst = 0;
    for (int k = 0; k < 3; ++k)
      if (sign * volume[k] < worst && (neighbour[face][k] < 0 || neighbour[face][k] != from)) {
        worst = sign * volume[k];
        out = k;
      }
    hit.face = face;
    for (int k = 0; k < 3; ++k) hit.weight[k] = volume[k] / sum;
    if (out < 0) {
      hit.found = true;
      double total = 0;
      for (double& w : hit.weight) total += (w = std::max(w, 0.0));
      for (double& w : hit.weight) w /= total;
      break;
    }
    if (neighbour[face][out] < 0) {
      // Another edge may lead to a neighbour.
      int other = -1;
      for (int k = 0; k < 3; ++k)
        if (sign * volume[k] < 0 && neighbour[face][k] >= 0 && neighbour[face][k] != from)
          other = k;
      if (other < 0) {
        // A line that misses the border only by rounding hits the wall.
        const bool touching = *std::min_element(hit.weight.begin(), hit.weight.end()) > -1e-9;
        double total = 0;
        for (double& w : hit.weight) total += (w = std::max(w, 0.0));
        for (double& w : hit.weight) w /= total;
        hit.found = touching;
        break;
      }
      out = other;
    }
    from = face;
    face = neighbour[face][out];
  }
  if (hit.face < 0) return hit;
  const auto& c = corner[hit.face];
  const Vector3 flat = hit.weight[0] * jet[c[0]].origin + hit.weight[1] * jet[c[1]].origin +
                       hit.weight[2] * jet[c[2]].origin;
  hit.s = direction.dot(flat - point) / direction.squaredNorm();
  return hit;
}

void BoreMesh::Impl::blend(const Vector3& point, const Vector3& direction, Hit& hit) const {
  const auto weight = blend_weights(hit.weight);
  const double guess = hit.s;
  hit.s = 0;
  hit.normal.setZero();
  hit.bend.setZero();
  for (int k = 0; k < 3; ++k) {
    if (weight[k] == 0) continue;
    const JetHit part = jet[corner[hit.face][k]].hit(point, direction, guess);
    hit.s += weight[k] * part.s;
    hit.normal += weight[k] * part.normal;
    hit.bend += weight[k] * part.bend;
  }
  hit.normal.normalize();
  hit.point = point + hit.s * direction;
}

Hit BoreMesh::Impl::meet(const Vector3& point, const Vector3& direction, int start) const {
  Hit hit;
  if (start >= 0) hit = follow(point, direction, start);
  // The ray must hit the free side of the wall at a distance s > 0.
  const auto faces_ray = [&](const Hit& h) {
    if (!h.found || !(h.s > 0)) return false;
    const auto& c = corner[h.face];
    const Vector3 normal =
        cross(jet[c[1]].origin - jet[c[0]].origin, jet[c[2]].origin - jet[c[0]].origin);
    return normal.dot(direction) < 0;
  };
  if (!faces_ray(hit)) {
    const int first = shoot(point, direction);
    if (first < 0) {
      hit.found = false;
      return hit;
    }
    hit = follow(point, direction, first);
    if (!faces_ray(hit)) {
      hit.found = false;
      return hit;
    }
  }
  blend(point, direction, hit);
  return hit;
}

bool BoreMesh::Impl::meet_near(const Vector3& point, const Vector3& direction, int start,
                               double guess, Hit& hit) const {
  hit = follow(point, direction, start);
  if (!hit.found || !(hit.s > 0)) return false;
  hit.s = guess;
  blend(point, direction, hit);
  return hit.normal.dot(direction) < 0;
}

bool BoreMesh::Impl::descend(const Vector3& query, Hit& hit) const {
  // Newton's method for the foot of the normal. The step is halved until the distance decreases.
  double distance = (query - hit.point).norm();
  for (int iteration = 0; iteration < 50; ++iteration) {
    const Vector3 way = query - hit.point;
    const double off = way.dot(hit.normal);
    const Vector3 rest = way - off * hit.normal;
    if (rest.norm() <= 1e-13 * wall.radius) return true;
    const Principal p = principal(hit);
    // Divides by the Hessian of half the squared distance, 1 - off * (curvature towards the free
    // side).
    const auto divided = [&](const Vector3& direction, double curvature) -> Vector3 {
      const double hessian = 1 + off * curvature;
      return rest.dot(direction) / (hessian > 1e-6 ? hessian : std::max(-hessian, 1e-2)) *
             direction;
    };
    Vector3 move = divided(p.direction_larger, p.larger) + divided(p.direction_smaller, p.smaller);
    const double most = 0.2 * wall.radius;
    if (move.norm() > most) move *= most / move.norm();
    bool moved = false;
    for (int halving = 0; halving < 20 && !moved; ++halving, move *= 0.5) {
      const Vector3 target = hit.point + move;
      Hit next = follow(target, hit.normal, hit.face);
      if (next.face < 0) continue;
      if (!next.found) {
        if (halving < 8) continue;
        return false;
      }
      blend(target, hit.normal, next);
      const double now = (query - next.point).norm();
      // Also accepts the last quadratic steps, which change the distance by less than rounding.
      if (now <= distance * (1 + 4e-16) + 1e-17) {
        const bool last = move.norm() <= 1e-13 * wall.radius;
        hit = next;
        distance = now;
        moved = true;
        if (last) return true;
      }
    }
    if (!moved) return true;  // stationary within rounding
  }
  return true;
}

Principal principal(const Hit& hit) {
  const Vector3 away = std::abs(hit.normal.x()) < 0.6 ? Vector3::UnitX() : Vector3::UnitY();
  const Vector3 u = (away - away.dot(hit.normal) * hit.normal).normalized();
  const Vector3 v = cross(hit.normal, u);
  const Vector3 bu = hit.bend * u, bv = hit.bend * v;
  const double uu = u.dot(bu), uv = 0.5 * (u.dot(bv) + v.dot(bu)), vv = v.dot(bv);
  const double mean = 0.5 * (uu + vv);
  const double difference = 0.5 * (uu - vv);
  const double radius = std::hypot(difference, uv);
  const double angle = 0.5 * std::atan2(uv, difference);  // of the curvature mean + radius
  const Vector3 high = std::cos(angle) * u + std::sin(angle) * v;
  Principal p;
  p.smaller = -(mean + radius);
  p.larger = -(mean - radius);
  p.direction_smaller = high;
  p.direction_larger = cross(high, hit.normal);
  return p;
}

SectionCurvature section_curvature(const Hit& hit, const Vector3& axis) {
  const Vector3 in_plane = hit.normal - hit.normal.dot(axis) * axis;
  const Vector3 normal = in_plane.normalized();
  const Vector3 tangent = cross(axis, normal);
  const Vector3 axial = cross(tangent, hit.normal);
  return {normal, tangent.dot(hit.bend * tangent), axial.dot(hit.bend * axial)};
}

}  // namespace statejump::geometry
