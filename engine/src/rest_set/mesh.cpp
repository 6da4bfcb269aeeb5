// SPDX-License-Identifier: GPL-3.0-or-later
#include "mesh.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <map>
#include <vector>

#include "detail.hpp"
#include "numerics/change_between.hpp"

namespace statejump::rest_set {

using Eigen::Vector3d;
using kernel::require;
using namespace detail;

void detail::check_mesh(const Mesh& mesh) {
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

Mesh welded(const Mesh& mesh, double tolerance) {
  require(std::isfinite(tolerance) && tolerance >= 0.0, "tolerance", tolerance, "finite, >= 0 m");
  check_mesh(mesh);
  Mesh result;
  result.project = mesh.project;
  result.normal = mesh.normal;
  // Buckets are as large as the tolerance, so coincident vertices are in the same or in adjacent
  // buckets.
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

namespace {

/// Marching tetrahedra: the grid and the mesh so far.
class MarchingTetrahedra {
 public:
  MarchingTetrahedra(const SpaceFunction& value, const SpaceGradient& slope,
                     const std::array<int, 3>& cells, const Vector3d& low, const Vector3d& extent)
      : value_(value), slope_(slope), n_(cells) {
    grid_.resize(number(n_[0], n_[1], n_[2]) + 1);
    free_.resize(grid_.size());
    for (int k = 0; k <= n_[2]; ++k) {
      for (int j = 0; j <= n_[1]; ++j) {
        for (int i = 0; i <= n_[0]; ++i) {
          Vector3d& p = grid_[number(i, j, k)];
          p = low +
              Vector3d(extent.x() * i / n_[0], extent.y() * j / n_[1], extent.z() * k / n_[2]);
          free_[number(i, j, k)] = value_(p) < 0.0;
        }
      }
    }
  }

  Mesh mesh() {
    for (int k = 0; k < n_[2]; ++k) {
      for (int j = 0; j < n_[1]; ++j) {
        for (int i = 0; i < n_[0]; ++i) add_cell({i, j, k});
      }
    }
    return std::move(mesh_);
  }

 private:
  std::size_t number(int i, int j, int k) const {
    return (static_cast<std::size_t>(k) * (n_[1] + 1) + j) * (n_[0] + 1) + i;
  }

  int vertex(std::size_t a, std::size_t b) {
    const auto [found, fresh] =
        on_edge_.try_emplace(std::minmax(a, b), static_cast<int>(mesh_.vertices.size()));
    if (fresh) {
      const Vector3d& inside = grid_[free_[a] ? a : b];
      const Vector3d edge = grid_[free_[a] ? b : a] - inside;
      const auto is_outside = [&](double t) { return !(value_(inside + t * edge) < 0.0); };
      const auto crossing = numerics::change_between(0.0, 1.0, is_outside, numerics::fine);
      mesh_.vertices.push_back(inside + 0.5 * (crossing.before + crossing.after) * edge);
      mesh_.normals.push_back(-slope_(mesh_.vertices.back()).normalized());
    }
    return found->second;
  }

  /// Divides a cell into six tetrahedra around its diagonal, one for each order of the three axes.
  void add_cell(const std::array<int, 3>& cell) {
    static constexpr int orders[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2},
                                         {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
    for (const auto& order : orders) {
      std::array<int, 3> at = cell;
      std::array<std::size_t, 4> corner;
      corner[0] = number(at[0], at[1], at[2]);
      for (int c = 0; c < 3; ++c) {
        ++at[order[c]];
        corner[c + 1] = number(at[0], at[1], at[2]);
      }
      add_tetrahedron(corner);
    }
  }

  void add_tetrahedron(const std::array<std::size_t, 4>& corner) {
    std::vector<std::size_t> in, out;
    for (const std::size_t c : corner) (free_[c] ? in : out).push_back(c);
    if (in.empty() || out.empty()) return;
    if (in.size() == 2) {
      const std::array<int, 4> q = {vertex(in[0], out[0]), vertex(in[0], out[1]),
                                    vertex(in[1], out[1]), vertex(in[1], out[0])};
      mesh_.triangles.push_back({q[0], q[1], q[2]});
      mesh_.triangles.push_back({q[0], q[2], q[3]});
    } else {
      const std::size_t tip = in.size() == 1 ? in[0] : out[0];
      const auto& base = in.size() == 1 ? out : in;
      mesh_.triangles.push_back({vertex(tip, base[0]), vertex(tip, base[1]), vertex(tip, base[2])});
    }
  }

  const SpaceFunction& value_;
  const SpaceGradient& slope_;
  std::array<int, 3> n_;
  std::vector<Vector3d> grid_;
  std::vector<bool> free_;
  std::map<std::pair<std::size_t, std::size_t>, int> on_edge_;
  Mesh mesh_;
};

}  // namespace

Mesh implicit_surface(const SpaceFunction& gamma, const SpaceGradient& gradient,
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
  const SpaceFunction value = [gamma](const Vector3d& p) {
    const double result = gamma(p);
    require(std::isfinite(result), "gamma", result, "finite in the whole box");
    return result;
  };
  const SpaceGradient slope = [gradient](const Vector3d& p) -> Vector3d {
    Vector3d result = gradient(p);
    const double norm = result.norm();
    require(std::isfinite(norm) && norm > 0.0, "size of the gradient of gamma on the surface", norm,
            "finite, > 0");
    return result;
  };
  Mesh mesh = MarchingTetrahedra(value, slope, n, low, extent).mesh();
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

Mesh clearance_sphere(double clearance, int level) {
  check_length(clearance, "clearance");
  require(level >= 0 && level <= 8, "level", level, "0 to 8");
  Mesh mesh;
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

}  // namespace statejump::rest_set
