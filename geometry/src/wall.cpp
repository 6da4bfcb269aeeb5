// SPDX-License-Identifier: GPL-3.0-or-later
#include "wall.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "statejump/geometry/mesh_failure.hpp"

namespace statejump::geometry {
namespace {

constexpr double pi = 3.141592653589793238462643;
constexpr double cosine_45 = 0.70710678118654752440;
constexpr double crease = 0.76604444311897803520;

/// Least-squares surface: a cylinder, or a sphere whose axis is only a reference direction.
struct Round {
  Vector3 centre, axis;
  double radius = 0;
};

struct Face {
  Vector3 centre, normal;
  double area = 0;
};

std::vector<Face> measure(const Triangles& mesh) {
  std::vector<Face> faces(mesh.faces.size());
  for (int f = 0; f < static_cast<int>(faces.size()); ++f) {
    const Vector3 vector = area_vector(mesh, f);
    const double norm = vector.norm();
    faces[f] = {face_centre(mesh, f), vector / norm, 0.5 * norm};
  }
  return faces;
}

void frame(const Vector3& axis, Vector3& x, Vector3& y) {
  const Vector3 away = std::abs(axis.x()) < 0.8 ? Vector3::UnitX() : Vector3::UnitY();
  x = (away - away.dot(axis) * axis).normalized();
  y = cross(axis, x);
}

Vector3 to_axis(const Round& round, const Vector3& point, SurfaceKind kind) {
  Vector3 way = round.centre - point;
  if (kind == SurfaceKind::bore) way -= way.dot(round.axis) * round.axis;
  return way;
}

struct Weighted {
  Vector3 point;
  double weight;
};

/// Vertices of the chosen faces. The weight of a vertex is a third of the area of its faces.
std::vector<Weighted> corners(const Triangles& mesh, const std::vector<Face>& faces,
                              const std::vector<int>& chosen) {
  std::vector<double> weight(mesh.vertices.size(), 0.0);
  for (const int f : chosen)
    for (const int corner : mesh.faces[f]) weight[corner] += faces[f].area / 3;
  std::vector<Weighted> result;
  for (std::size_t v = 0; v < weight.size(); ++v)
    if (weight[v] > 0) result.push_back({mesh.vertices[v], weight[v]});
  return result;
}

/// Kasa's fit |p|^2 = 2 c p + k, linear in c and k. For a cylinder, the fit is done in its
/// cross-section.
Round linear_fit(const std::vector<Weighted>& points, const Vector3& axis, SurfaceKind kind) {
  Vector3 mean = Vector3::Zero();
  double total = 0;
  for (const auto& p : points) {
    mean += p.weight * p.point;
    total += p.weight;
  }
  mean /= total;
  Vector3 x, y;
  frame(axis, x, y);
  Eigen::Matrix4d normal = Eigen::Matrix4d::Zero();
  Eigen::Vector4d right = Eigen::Vector4d::Zero();
  for (const auto& p : points) {
    const Vector3 from = p.point - mean;
    const double w = kind == SurfaceKind::bore ? 0.0 : from.dot(axis);
    const Eigen::Vector4d row(from.dot(x), from.dot(y), w, 1.0);
    normal += p.weight * row * row.transpose();
    right += p.weight * row.head<3>().squaredNorm() * row;
  }
  if (kind == SurfaceKind::bore) normal(2, 2) = total;
  const Eigen::Vector4d s = normal.fullPivLu().solve(right);
  const Vector3 half = 0.5 * s.head<3>();
  return {mean + half.x() * x + half.y() * y + half.z() * axis, axis,
          std::sqrt(std::max(0.0, s(3) + half.squaredNorm()))};
}

/// Gauss-Newton iteration on the distances from cylinder or sphere.
Round refine(const std::vector<Weighted>& points, Round round, SurfaceKind kind) {
  for (int iteration = 0; iteration < 30; ++iteration) {
    Vector3 x, y;
    frame(round.axis, x, y);
    Eigen::Matrix<double, 6, 6> normal = Eigen::Matrix<double, 6, 6>::Zero();
    Eigen::Matrix<double, 6, 1> right = Eigen::Matrix<double, 6, 1>::Zero();
    double length = 0;
    for (const auto& p : points)
      length = std::max(length, std::abs((p.point - round.centre).dot(round.axis)));
    for (const auto& p : points) {
      const Vector3 way = -to_axis(round, p.point, kind);
      const double distance = way.norm();
      if (!(distance > 0)) continue;
      const Vector3 out = way / distance;
      const double z = (p.point - round.centre).dot(round.axis) / length;
      Eigen::Matrix<double, 6, 1> row;
      row << -out.dot(x), -out.dot(y), -1.0, 0, 0, 0;
      if (kind == SurfaceKind::bore)
        row.tail<3>() << -z * out.dot(x), -z * out.dot(y), 0;
      else
        row(5) = -out.dot(round.axis);
      normal += p.weight * row * row.transpose();
      right += p.weight * (distance - round.radius) * row;
    }
    for (int i = 0; i < 6; ++i)
      if (!(normal(i, i) > 0)) normal(i, i) = 1;
    const Eigen::Matrix<double, 6, 1> step = -normal.ldlt().solve(right);
    if (!step.allFinite()) break;
    round.centre += step(0) * x + step(1) * y;
    round.radius += step(2);
    if (kind == SurfaceKind::bore)
      round.axis = (round.axis + (step(3) * x + step(4) * y) / length).normalized();
    else
      round.centre += step(5) * round.axis;
    if (step.norm() < 1e-14 * round.radius) break;
  }
  return round;
}

Vector3 axis_of_normals(const std::vector<Face>& faces, const std::vector<int>& chosen) {
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (const int f : chosen) sum += faces[f].area * faces[f].normal * faces[f].normal.transpose();
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(sum).eigenvectors().col(0);
}

/// Area-weighted mean cosine between normals and the direction to the axis (for a socket: centre).
double inward(const std::vector<Face>& faces, const std::vector<int>& chosen, const Round& round,
              SurfaceKind kind) {
  double sum = 0, total = 0;
  for (const int f : chosen) {
    sum += faces[f].area * faces[f].normal.dot(to_axis(round, faces[f].centre, kind).normalized());
    total += faces[f].area;
  }
  return sum / total;
}

Round fit(const Triangles& mesh, const std::vector<Face>& faces, const std::vector<int>& chosen,
          SurfaceKind kind) {
  Vector3 axis = Vector3::UnitZ();
  if (kind == SurfaceKind::bore) axis = axis_of_normals(faces, chosen);
  const auto points = corners(mesh, faces, chosen);
  return refine(points, linear_fit(points, axis, kind), kind);
}

/// Patches of faces in which neighbours meet at less than the crease angle.
std::vector<std::vector<int>> patches(const std::vector<Face>& faces,
                                      const Neighbours& neighbours) {
  std::vector<std::vector<int>> result;
  std::vector<char> seen(faces.size(), 0);
  for (int start = 0; start < static_cast<int>(faces.size()); ++start) {
    if (seen[start]) continue;
    std::vector<int> patch{start};
    seen[start] = 1;
    for (std::size_t i = 0; i < patch.size(); ++i)
      for (const int next : neighbours[patch[i]])
        if (next >= 0 && !seen[next] && faces[next].normal.dot(faces[patch[i]].normal) > crease) {
          seen[next] = 1;
          patch.push_back(next);
        }
    result.push_back(std::move(patch));
  }
  return result;
}

/// Returns whether faces surround the axis: no angular gap between the centres of adjacent faces
/// exceeds 0.67 pi.
bool surrounds(const std::vector<Face>& faces, const std::vector<int>& chosen, const Round& round) {
  if (chosen.size() < 3) return false;
  Vector3 x, y;
  frame(round.axis, x, y);
  std::vector<double> angles;
  for (const int f : chosen) {
    const Vector3 from = faces[f].centre - round.centre;
    angles.push_back(std::atan2(from.dot(y), from.dot(x)));
  }
  std::sort(angles.begin(), angles.end());
  double gap = angles.front() + 2 * pi - angles.back();
  for (std::size_t i = 1; i < angles.size(); ++i) gap = std::max(gap, angles[i] - angles[i - 1]);
  return gap < 0.67 * pi;  // three facets around have gaps of 2 pi/3
}

MeshFields loop_fields(const Triangles& mesh, const Loop& loop) {
  Vector3 sum = Vector3::Zero();
  for (const int v : loop) sum += mesh.vertices[v];
  return {{"edges", loop.size()}, {"at_m", place(sum / double(loop.size()))}};
}

double loop_length(const Triangles& mesh, const Loop& loop) {
  double length = 0;
  for (std::size_t i = 0; i < loop.size(); ++i)
    length += (mesh.vertices[loop[i]] - mesh.vertices[loop[(i + 1) % loop.size()]]).norm();
  return length;
}

void check_borders(const Triangles& mesh, std::vector<Loop> loops, SurfaceKind kind,
                   const std::string& name) {
  const std::size_t ends = kind == SurfaceKind::bore ? 2 : 1;
  if (loops.empty() || loops.size() == ends) return;
  if (loops.size() < ends)
    throw MeshFailure(name, MeshReason::one_open_end, loop_fields(mesh, loops[0]));
  std::sort(loops.begin(), loops.end(), [&](const Loop& a, const Loop& b) {
    return loop_length(mesh, a) > loop_length(mesh, b);
  });
  MeshFields fields = loop_fields(mesh, loops[ends]);
  fields.emplace_back("holes", loops.size() - ends);
  throw MeshFailure(name, MeshReason::holes, std::move(fields));
}

double volume(const Triangles& mesh) {
  const Vector3 origin = mesh.vertices[mesh.faces[0][0]];
  double six = 0;
  for (const auto& f : mesh.faces)
    six += (mesh.vertices[f[0]] - origin)
               .dot(cross(mesh.vertices[f[1]] - origin, mesh.vertices[f[2]] - origin));
  return six / 6;
}

}  // namespace

Wall find_wall(const Triangles& mesh, const Neighbours& neighbours, const BoreOptions& options,
               const std::string& name) {
  const SurfaceKind kind = options.kind;
  const auto loops = border_loops(mesh, neighbours);
  check_borders(mesh, loops, kind, name);
  const std::vector<Face> faces = measure(mesh);
  const std::string towards = kind == SurfaceKind::bore ? "the axis" : "the centre";

  std::vector<int> all(faces.size());
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = static_cast<int>(i);
  std::vector<int> chosen = all;
  if (loops.empty() && kind == SurfaceKind::bore) {
    if (volume(mesh) < 0) throw MeshFailure(name, MeshReason::body_inside_out);
    chosen.clear();
    double largest = 0;
    for (const auto& patch : patches(faces, neighbours)) {
      double area = 0;
      for (const int f : patch) area += faces[f].area;
      if (area <= largest || patch.size() < 3) continue;
      const Round round = fit(mesh, faces, patch, kind);
      if (inward(faces, patch, round, kind) < cosine_45 || !surrounds(faces, patch, round))
        continue;
      chosen = patch;
      largest = area;
    }
    if (chosen.empty()) throw MeshFailure(name, MeshReason::no_smooth_wall);
  }

  Round round = fit(mesh, faces, chosen, kind);
  const double facing = inward(faces, chosen, round, kind);
  if (facing < 0)
    throw MeshFailure(
        name, MeshReason::wall_inside_out,
        {{"target", towards}, {"face", chosen[0]}, {"at_m", place(faces[chosen[0]].centre)}});
  if (facing < 0.5 || (kind == SurfaceKind::bore && !surrounds(faces, chosen, round)))
    throw MeshFailure(name, kind == SurfaceKind::bore ? MeshReason::surrounds_no_axis
                                                      : MeshReason::faces_no_centre);
  // Removes ends and chamfers, then fits the axis to the remaining faces; both are done twice.
  for (int pass = 0; pass < 2; ++pass) {
    std::vector<int> kept;
    for (const int f : chosen)
      if (faces[f].normal.dot(to_axis(round, faces[f].centre, kind).normalized()) > cosine_45)
        kept.push_back(f);
    if (kept.size() < 3) throw MeshFailure(name, MeshReason::too_few_faces, {{"target", towards}});
    round = fit(mesh, faces, kept, kind);
    if (pass == 1 || kept.size() == chosen.size()) {
      chosen = kept;
      break;
    }
  }
  if (!(round.radius >= options.smallest_radius && round.radius <= options.largest_radius)) {
    const bool is_large = round.radius > options.largest_radius;
    throw MeshFailure(name, is_large ? MeshReason::radius_too_large : MeshReason::radius_too_small,
                      {{"mean_radius_m", round.radius},
                       {"smallest_m", options.smallest_radius},
                       {"largest_m", options.largest_radius}});
  }

  Wall wall;
  std::sort(chosen.begin(), chosen.end());
  wall.faces = chosen;
  wall.closed = loops.empty();
  wall.radius = round.radius;
  wall.axis = round.axis;
  if (kind == SurfaceKind::socket) {
    Vector3 sum = Vector3::Zero();
    for (const int f : chosen) sum += faces[f].area * faces[f].normal;
    double total = 0;
    for (const int f : chosen) total += faces[f].area;
    wall.axis = sum.norm() > 1e-3 * total ? Vector3(sum.normalized()) : Vector3(Vector3::UnitZ());
  } else {
    Eigen::Index largest = 0;
    wall.axis.cwiseAbs().maxCoeff(&largest);
    if (wall.axis(largest) < 0) wall.axis = -wall.axis;
  }
  double low = INFINITY, high = -INFINITY;
  for (const int f : chosen)
    for (const int v : mesh.faces[f]) {
      const double z = (mesh.vertices[v] - round.centre).dot(wall.axis);
      low = std::min(low, z);
      high = std::max(high, z);
    }
  const double middle = kind == SurfaceKind::bore ? 0.5 * (low + high) : 0.0;
  wall.centre = round.centre + middle * wall.axis;
  wall.low = low - middle;
  wall.high = high - middle;
  frame(wall.axis, wall.axis_x, wall.axis_y);
  return wall;
}

}  // namespace statejump::geometry
