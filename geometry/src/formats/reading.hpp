// SPDX-License-Identifier: GPL-3.0-or-later
// Collects the data read from a mesh file.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "../formats.hpp"
#include "statejump/geometry/mesh_failure.hpp"

namespace statejump::geometry::formats {

/// Collects the vertices and polygons of a file, and reports the errors of its reader.
class Reading {
 public:
  Reading(MeshFormat format, const std::string& name) : format_(format), name_(name) {}

  [[noreturn]] void refuse(MeshReason reason, MeshFields fields = {}) const {
    fields.insert(fields.begin(), {"format", to_string(format_)});
    throw MeshFailure(name_, reason, std::move(fields));
  }
  [[noreturn]] void refuse_line(int line, MeshReason reason) const {
    refuse(reason, {{"line", line}});
  }
  [[noreturn]] void refuse_line(int line, MeshReason reason, const char* word) const {
    refuse(reason, {{"line", line}, {"word", word}});
  }

  void add_point(const Eigen::Vector3d& point) { points_.push_back(point); }
  /// Call this for 32-bit coordinates. Copies of a vertex in different faces may then differ by
  /// rounding.
  void has_floats() { floats_ = true; }
  /// @param corners vertex indices from 0, checked only at the end. Polygons with fewer than three
  ///     corners are left out, because some programs write edges and points in this way.
  void add_polygon(const std::vector<std::int64_t>& corners) {
    if (corners.size() < 3) ++short_polygons_;
    for (std::size_t k = 1; k + 1 < corners.size(); ++k) {
      fans_.push_back({corners[0], corners[k], corners[k + 1]});
      polygon_of_.push_back(polygons_);
    }
    ++polygons_;
  }
  std::size_t points() const { return points_.size(); }

  Triangles triangles() const {
    if (fans_.empty())
      refuse_faces(short_polygons_ > 0 ? MeshReason::no_triangles : MeshReason::no_faces);
    Triangles result;
    result.removed = short_polygons_;
    const std::vector<int> number = weld(result.vertices);
    const auto count = static_cast<std::int64_t>(points_.size());
    for (std::size_t f = 0; f < fans_.size(); ++f) {
      for (const std::int64_t corner : fans_[f])
        if (corner < 0 || corner >= count)
          refuse_faces(MeshReason::no_such_corner,
                       {{"face", polygon_of_[f]}, {"corner", corner}, {"vertices", count}});
      std::array<int, 3> face{};
      for (std::size_t k = 0; k < 3; ++k) face[k] = number[static_cast<std::size_t>(fans_[f][k])];
      // Leaves out facets with two equal corners, which some exporters write. They do not change
      // the surface.
      if (face[0] == face[1] || face[1] == face[2] || face[2] == face[0])
        ++result.removed;
      else
        result.faces.push_back(face);
    }
    if (result.faces.empty()) refuse_faces(MeshReason::no_triangles);
    return result;
  }

 private:
  using Cells = std::multimap<std::array<double, 3>, int>;  ///< vertices by cell

  /// Merges equal vertices, and 32-bit float vertices that differ only by rounding.
  /// @param[out] vertices in the order of first appearance
  /// @return index of the vertex of each point
  std::vector<int> weld(std::vector<Eigen::Vector3d>& vertices) const {
    double largest = 0;
    for (std::size_t i = 0; i < points_.size(); ++i) {
      if (!points_[i].allFinite()) refuse_faces(MeshReason::vertex_not_finite, {{"vertex", i}});
      largest = std::max(largest, points_[i].cwiseAbs().maxCoeff());
    }
    // Two units in the last place of the largest coordinate, because each of two vertices is
    // rounded once.
    const double near = floats_ ? 2 * std::numeric_limits<float>::epsilon() * largest : 0;
    Cells known;
    std::vector<int> number(points_.size());
    for (std::size_t i = 0; i < points_.size(); ++i) {
      number[i] = known_vertex(known, vertices, points_[i], near);
      if (number[i] >= 0) continue;
      number[i] = static_cast<int>(vertices.size());
      known.emplace(cell_of(points_[i], near), number[i]);
      vertices.push_back(points_[i]);
    }
    return number;
  }
  static std::array<double, 3> cell_of(const Eigen::Vector3d& point, double size) {
    if (!(size > 0)) return {point.x(), point.y(), point.z()};
    return {std::floor(point.x() / size), std::floor(point.y() / size),
            std::floor(point.z() / size)};
  }
  /// First vertex whose coordinates all differ from the given ones by at most `near`; -1 if there
  /// is none.
  static int known_vertex(const Cells& known, const std::vector<Eigen::Vector3d>& vertices,
                          const Eigen::Vector3d& point, double near) {
    const std::array<double, 3> cell = cell_of(point, near);
    int found = -1;
    for (int k = 0; k < (near > 0 ? 27 : 1); ++k) {
      std::array<double, 3> beside = cell;
      if (near > 0) beside = {cell[0] + k % 3 - 1, cell[1] + k / 3 % 3 - 1, cell[2] + k / 9 - 1};
      for (auto [at, end] = known.equal_range(beside); at != end; ++at)
        if ((found < 0 || at->second < found) &&
            (vertices[static_cast<std::size_t>(at->second)] - point).cwiseAbs().maxCoeff() <= near)
          found = at->second;
    }
    return found;
  }
  [[noreturn]] void refuse_faces(MeshReason reason, MeshFields fields = {}) const {
    throw MeshFailure(name_, reason, std::move(fields));
  }

  MeshFormat format_;
  const std::string& name_;
  std::vector<Eigen::Vector3d> points_;
  std::vector<std::array<std::int64_t, 3>> fans_;
  std::vector<std::size_t> polygon_of_;  ///< index of the polygon of each triangle
  std::size_t polygons_ = 0;
  int short_polygons_ = 0;
  bool floats_ = false;
};

// Each function adds the data of a file in its format.
// @param content the whole file
void read_off(std::string_view content, Reading& reading);
void read_stl(std::string_view content, Reading& reading);
void read_ply(std::string_view content, Reading& reading);
void read_obj(std::string_view content, Reading& reading);

}  // namespace statejump::geometry::formats
