// SPDX-License-Identifier: GPL-3.0-or-later
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/IO/polygon_soup_io.h>
#include <CGAL/Polygon_mesh_processing/repair_polygon_soup.h>

#include <algorithm>
#include <cctype>
#include <fstream>
#include <map>

#include "statejump/geometry/mesh_failure.hpp"
#include "statejump/geometry/triangles.hpp"

namespace statejump::geometry {
namespace {

using Point = CGAL::Exact_predicates_inexact_constructions_kernel::Point_3;

std::string lower_ending(const std::string& file) {
  const auto dot = file.find_last_of('.');
  const auto slash = file.find_last_of('/');
  if (dot == std::string::npos || (slash != std::string::npos && dot < slash)) return "";
  std::string ending = file.substr(dot + 1);
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return ending;
}

bool read_soup(const std::string& file, const std::string& ending, std::vector<Point>& points,
               std::vector<std::vector<std::size_t>>& polygons) {
  if (ending == "off") return CGAL::IO::read_OFF(file, points, polygons);
  if (ending == "stl") return CGAL::IO::read_STL(file, points, polygons);
  if (ending == "ply") return CGAL::IO::read_PLY(file, points, polygons);
  return CGAL::IO::read_OBJ(file, points, polygons);
}

}  // namespace

Triangles read_triangles(const std::string& file) {
  const std::string ending = lower_ending(file);
  if (ending != "off" && ending != "stl" && ending != "ply" && ending != "obj")
    throw MeshFailure(file, MeshFault::unreadable,
                      "a mesh file ends with .off, .stl, .ply or .obj");
  {
    std::ifstream stream(file, std::ios::binary);
    if (!stream || stream.peek() == std::ifstream::traits_type::eof())
      throw MeshFailure(file, MeshFault::unreadable,
                        stream.is_open() && !stream.bad() && stream.eof() ? "the file is empty"
                                                                          : "cannot be opened");
  }
  std::vector<Point> points;
  std::vector<std::vector<std::size_t>> polygons;
  bool read = false;
  try {
    read = read_soup(file, ending, points, polygons);
  } catch (const std::exception&) {
    read = false;
  }
  std::string format = ending;
  for (char& c : format) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  if (!read) throw MeshFailure(file, MeshFault::unreadable, "not readable as " + format);
  if (polygons.empty()) throw MeshFailure(file, MeshFault::bad_faces, "the mesh has no faces");

  // Equal points become one, numbered by first appearance.
  Triangles result;
  std::map<std::array<double, 3>, int> known;
  std::vector<int> number(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const std::array<double, 3> key{points[i].x(), points[i].y(), points[i].z()};
    const auto [place, fresh] = known.emplace(key, static_cast<int>(result.vertices.size()));
    if (fresh) result.vertices.emplace_back(key[0], key[1], key[2]);
    number[i] = place->second;
  }
  for (std::size_t f = 0; f < polygons.size(); ++f) {
    const auto& polygon = polygons[f];
    if (polygon.size() < 3)
      throw MeshFailure(file, MeshFault::bad_faces,
                        "face " + std::to_string(f) + " has fewer than 3 corners");
    for (const std::size_t corner : polygon)
      if (corner >= number.size())
        throw MeshFailure(file, MeshFault::bad_faces,
                          "face " + std::to_string(f) + " has corner " + std::to_string(corner) +
                              ", but there are only " + std::to_string(number.size()) +
                              " vertices");
    for (std::size_t k = 1; k + 1 < polygon.size(); ++k)
      result.faces.push_back({number[polygon[0]], number[polygon[k]], number[polygon[k + 1]]});
  }
  return result;
}

}  // namespace statejump::geometry
