// SPDX-License-Identifier: GPL-3.0-or-later
// Constrains bodies to planes of any orientation.
#pragma once

#include <vector>

#include "failure.hpp"
#include "registered.hpp"

namespace statejump::dem {

struct GuidePlanes : Registered<GuidePlanes, yade::GlobalEngine>, RaisesFailures {
  static constexpr const char* class_name = "GuidePlanes";
  static constexpr const char* base_name = "GlobalEngine";
  static constexpr const char* doc =
      "Keeps bodies in the plane through their position across a normal, as blockedDOFs does for "
      "planes across x, y and z: takes force and velocity along the normal away, without friction "
      "and without work. Place it right before the NewtonIntegrator, after everything that adds "
      "forces.";
  std::vector<int> ids;
  std::vector<Vector3r> normals;

  void action() override;
  void check() const;
  static auto attributes() {
    return std::make_tuple(
        attribute("ids", &GuidePlanes::ids, "Bodies that stay in their plane [-]"),
        attribute("normals", &GuidePlanes::normals, "Normal of each plane, unit vectors [-]"));
  }
};

}  // namespace statejump::dem
