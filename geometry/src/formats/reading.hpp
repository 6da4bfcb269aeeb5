// SPDX-License-Identifier: GPL-3.0-or-later
// What mesh files are read into.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "../formats.hpp"
#include "statejump/geometry/mesh_failure.hpp"

namespace statejump::geometry::formats {

/// What was read, and where errors are told.
class Reading {
 public:
  Reading(MeshFormat format, const std::string& name) : format_(format), name_(name) {}

  [[noreturn]] void refuse(const std::string& cause) const {
    throw MeshFailure(name_, MeshFault::unreadable,
                      std::string("not readable as ") + to_string(format_) + ": " + cause);
  }
  [[noreturn]] void refuse_line(int line, const std::string& cause) const {
    refuse("line " + std::to_string(line) + " " + cause);
  }

  void add_point(const Eigen::Vector3d& point) { points_.push_back(point); }
  /// @param corners from 0; any integer is taken here and checked in the end
  void add_polygon(const std::vector<std::int64_t>& corners) {
    if (corners.size() < 3)
      refuse_faces("face " + std::to_string(polygons_) + " has fewer than 3 corners");
    for (std::size_t k = 1; k + 1 < corners.size(); ++k) {
      fans_.push_back({corners[0], corners[k], corners[k + 1]});
      polygon_of_.push_back(polygons_);
    }
    ++polygons_;
  }
  std::size_t points() const { return points_.size(); }

  Triangles triangles() const {
    if (fans_.empty()) refuse_faces("the mesh has no faces");
    Triangles result;
    std::map<std::array<double, 3>, int> known;
    std::vector<int> number(points_.size());
    for (std::size_t i = 0; i < points_.size(); ++i) {
      if (!points_[i].allFinite()) refuse_faces("vertex " + std::to_string(i) + " is not finite");
      const std::array<double, 3> key{points_[i].x(), points_[i].y(), points_[i].z()};
      const auto [place, fresh] = known.emplace(key, static_cast<int>(result.vertices.size()));
      if (fresh) result.vertices.push_back(points_[i]);
      number[i] = place->second;
    }
    const auto count = static_cast<std::int64_t>(points_.size());
    for (std::size_t f = 0; f < fans_.size(); ++f) {
      for (const std::int64_t corner : fans_[f])
        if (corner < 0 || corner >= count)
          refuse_faces("face " + std::to_string(polygon_of_[f]) + " has corner " +
                       std::to_string(corner) + ", but there are only " + std::to_string(count) +
                       " vertices");
      const auto& fan = fans_[f];
      result.faces.push_back({number[static_cast<std::size_t>(fan[0])],
                              number[static_cast<std::size_t>(fan[1])],
                              number[static_cast<std::size_t>(fan[2])]});
    }
    return result;
  }

 private:
  [[noreturn]] void refuse_faces(const std::string& cause) const {
    throw MeshFailure(name_, MeshFault::bad_faces, cause);
  }

  MeshFormat format_;
  const std::string& name_;
  std::vector<Eigen::Vector3d> points_;
  std::vector<std::array<std::int64_t, 3>> fans_;
  std::vector<std::size_t> polygon_of_;  ///< of each triangle
  std::size_t polygons_ = 0;
};

// Each adds to what was read; arguments: the file's whole content.
void read_off(std::string_view content, Reading& reading);
void read_stl(std::string_view content, Reading& reading);
void read_ply(std::string_view content, Reading& reading);
void read_obj(std::string_view content, Reading& reading);

}  // namespace statejump::geometry::formats
