// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <sstream>
#include <string>

#include "../support/argument.hpp"
#include "statejump/geometry/bore_mesh.hpp"
#include "statejump/geometry/mesh_failure.hpp"

namespace statejump::geometry::testing {

using Eigen::Vector3d;

constexpr double pi = 3.14159265358979323846;
// [m]; bearing_radius and journal_radius are those of the paper's joint
constexpr double bearing_radius = 5.1e-3;
constexpr double journal_radius = 5e-3;  // [m]

inline BoreShape round_bore() {
  return {bearing_radius, 10e-3};
}

/// Reason and fields of a failure: "no_such_corner face=7 corner=99 vertices=36".
inline std::string shown(const MeshFailure& failure) {
  std::ostringstream text;
  text << text_of(failure.reason()).name;
  for (const auto& [name, value] : failure.fields()) {
    text << ' ' << name << '=';
    if (const auto* at = std::get_if<std::array<double, 3>>(&value)) {
      text << (*at)[0] + 0.0 << ',' << (*at)[1] + 0.0 << ',' << (*at)[2] + 0.0;
    } else {
      std::visit(
          [&](const auto& one) {
            if constexpr (!std::is_same_v<std::decay_t<decltype(one)>, std::array<double, 3>>)
              text << one;
          },
          value);
    }
  }
  return text.str();
}

/// Text of the MeshFailure that `work` throws; empty if `work` throws none.
template <class Work>
std::string mesh_failure(Work&& work) {
  try {
    work();
  } catch (const MeshFailure& failure) {
    return shown(failure);
  }
  return {};
}

/// Uniform numbers with a fixed seed, the same on every system.
class Random {
 public:
  double uniform(double low, double high) {
    return low + (high - low) * (static_cast<double>(generator_()) / 4294967296.0);
  }

 private:
  std::mt19937 generator_{20210110};
};

/// Mesh as by bore_triangles(), with irregular vertices on the wall: shifted rings, uneven spacing.
inline Triangles uneven_bore(const BoreShape& shape, int around, int along, double unevenness) {
  Triangles mesh = bore_triangles(shape, around, along);
  Random random;
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    Vector3d& v = mesh.vertices[i];
    const bool end = i < std::size_t(around) || i >= mesh.vertices.size() - std::size_t(around);
    const double z =
        v.z() + (end ? 0 : random.uniform(-0.5, 0.5) * unevenness * shape.length / along);
    const double theta =
        std::atan2(v.y(), v.x()) + random.uniform(-0.5, 0.5) * unevenness * 2 * pi / around;
    const double r = bore_radius(shape, theta, z);
    v = {r * std::cos(theta), r * std::sin(theta), z};
  }
  return mesh;
}

}  // namespace statejump::geometry::testing
