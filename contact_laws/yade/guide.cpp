// SPDX-License-Identifier: GPL-3.0-or-later
#include "guide.hpp"

#include <stdexcept>
#include <string>

#include "failure.hpp"
#include "faults.hpp"
#include "ranges.hpp"
#include "statejump/stepper/checks.hpp"
#include "thermal.hpp"

namespace statejump::dem {

void GuidePlanes::check() const {
  for (const Vector3r& normal : normals) require_unit(class_name, "normals", normal);
}

void GuidePlanes::action() {
  begin(*scene);
  if (ids.size() != normals.size()) {
    refuse({"other_number", "GuidePlanes", std::to_string(ids.size()),
            std::to_string(normals.size())});
  }
  // Reads all forces before adding the first one. After an addition, YADE requires another sum over
  // threads before it returns a force.
  scene->forces.sync();
  std::vector<Vector3r> held(ids.size());
  for (std::size_t i = 0; i < ids.size(); ++i) {
    yade::State& state = *body_of(*scene, ids[i], "GuidePlanes.ids").state;
    const Vector3r& force = scene->forces.getForce(ids[i]);
    held[i] = force.dot(normals[i]) * normals[i];
    if (!stepper::is_finite_fast(held[i])) fail_force(*scene, ids[i], force);
    state.vel -= state.vel.dot(normals[i]) * normals[i];
  }
  for (std::size_t i = 0; i < ids.size(); ++i) scene->forces.addForce(ids[i], -held[i]);
}

}  // namespace statejump::dem
