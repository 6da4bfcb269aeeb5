// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <stdexcept>

#include "statejump/geometry/triangles.hpp"
#include "statejump/kernel/require.hpp"

namespace statejump::geometry {
namespace {

constexpr double pi = 3.141592653589793238462643;

using kernel::require;

void validate(const BoreShape& shape) {
  require(shape.radius > 0 && std::isfinite(shape.radius), "radius", shape.radius, "(0, inf) m");
  require(shape.length > 0 && std::isfinite(shape.length), "length", shape.length, "(0, inf) m");
  double sum = 0;
  for (const Lobe& lobe : shape.lobes) {
    require(lobe.harmonic >= 1, "harmonic", lobe.harmonic, "1, 2, 3, ...");
    sum += std::abs(lobe.amplitude);
  }
  require(sum < 0.5 * shape.radius, "sum of the lobes' amplitudes", sum, "[0, radius/2) m");
  require(shape.wear_depth >= 0 && std::isfinite(shape.wear_depth), "wear_depth", shape.wear_depth,
          "[0, inf) m");
  require(shape.wear_width > 0 && std::isfinite(shape.wear_width), "wear_width", shape.wear_width,
          "(0, inf) rad");
  require(shape.wall_thickness >= 0 && std::isfinite(shape.wall_thickness), "wall_thickness",
          shape.wall_thickness, "[0, inf) m");
  require(std::abs(shape.crown) < 0.5 * shape.radius, "crown", shape.crown,
          "(-radius/2, radius/2) m");
}

/// Adds a closed band of quadrilaterals, each of two triangles, with normals along d/di x d/dj.
void add_band(Triangles& mesh, int around, const std::vector<int>& lower,
              const std::vector<int>& upper) {
  for (int i = 0; i < around; ++i) {
    const int next = (i + 1) % around;
    mesh.faces.push_back({lower[i], lower[next], upper[next]});
    mesh.faces.push_back({lower[i], upper[next], upper[i]});
  }
}

}  // namespace

double bore_radius(const BoreShape& shape, double theta, double z) {
  double radius = shape.radius;
  for (const Lobe& lobe : shape.lobes)
    radius += lobe.amplitude * std::cos(lobe.harmonic * (theta - lobe.phase));
  if (shape.wear_depth > 0) {
    const double angle = std::remainder(theta - shape.wear_angle, 2 * pi) / shape.wear_width;
    radius += shape.wear_depth * std::exp(-angle * angle);
  }
  const double end = 2 * z / shape.length;
  return radius + shape.crown * end * end;
}

Triangles bore_triangles(const BoreShape& shape, int around, int along) {
  validate(shape);
  require(around >= 3, "around", around, "3, 4, 5, ...");
  require(along >= 1, "along", along, "1, 2, 3, ...");
  Triangles mesh;
  std::vector<std::vector<int>> rings;
  const auto add_ring = [&](double z, double outside) {
    std::vector<int> ring;
    for (int i = 0; i < around; ++i) {
      const double theta = 2 * pi * i / around;
      const double radius = outside > 0 ? outside : bore_radius(shape, theta, z);
      ring.push_back(static_cast<int>(mesh.vertices.size()));
      mesh.vertices.emplace_back(radius * std::cos(theta), radius * std::sin(theta), z);
    }
    rings.push_back(ring);
  };
  for (int j = along; j >= 0; --j) add_ring(shape.length * (double(j) / along - 0.5), 0);
  if (shape.wall_thickness > 0) {
    double largest = 0;
    for (const auto& vertex : mesh.vertices)
      largest = std::max(largest, std::hypot(vertex.x(), vertex.y()));
    for (int j = 0; j <= along; ++j)
      add_ring(shape.length * (double(j) / along - 0.5), largest + shape.wall_thickness);
    rings.push_back(rings.front());
  }
  for (std::size_t j = 0; j + 1 < rings.size(); ++j)
    add_band(mesh, around, rings[j], rings[j + 1]);  // downwards inside: normals towards the axis
  return mesh;
}

Triangles socket_triangles(double radius, double opening, int around, int along) {
  require(radius > 0 && std::isfinite(radius), "radius", radius, "(0, inf) m");
  require(opening > 0 && opening < pi, "opening", opening, "(0, pi) rad");
  require(around >= 3, "around", around, "3, 4, 5, ...");
  require(along >= 2, "along", along, "2, 3, 4, ...");
  Triangles mesh;
  std::vector<std::vector<int>> rings;
  for (int j = 0; j < along; ++j) {
    const double polar = opening + (pi - opening) * j / along;
    std::vector<int> ring;
    for (int i = 0; i < around; ++i) {
      const double theta = 2 * pi * i / around;
      ring.push_back(static_cast<int>(mesh.vertices.size()));
      mesh.vertices.emplace_back(radius * std::sin(polar) * std::cos(theta),
                                 radius * std::sin(polar) * std::sin(theta),
                                 radius * std::cos(polar));
    }
    rings.push_back(ring);
  }
  for (std::size_t j = 0; j + 1 < rings.size(); ++j) add_band(mesh, around, rings[j], rings[j + 1]);
  const int pole = static_cast<int>(mesh.vertices.size());
  mesh.vertices.emplace_back(0, 0, -radius);
  for (int i = 0; i < around; ++i)
    mesh.faces.push_back({rings.back()[i], rings.back()[(i + 1) % around], pole});
  return mesh;
}

}  // namespace statejump::geometry
