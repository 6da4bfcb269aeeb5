// SPDX-License-Identifier: GPL-3.0-or-later
#include "joint_energies.hpp"

#include <string>

namespace statejump::dem {
namespace {

// The names are stored as strings, because the tracker needs a std::string in every step.
const std::string joint_elastic = "jointElastic";
const std::string joint_friction = "jointFriction";
const std::string joint_damping = "jointDamping";
const std::string joint_thermal_work = "jointThermalWork";

}  // namespace

// YADE extends its list of energies without a lock, so concurrent threads could lose entries.
// Therefore one thread enters all names before any thread adds a value.
void JointEnergies::name(const yade::Scene& scene) {
  if (named_.load(std::memory_order_acquire)) return;
  const std::lock_guard<std::mutex> lock(naming_);
  if (named_.load(std::memory_order_relaxed)) return;
  scene.energy->add(0, joint_elastic, ids_[0], true);
  scene.energy->add(0, joint_friction, ids_[1], false);
  scene.energy->add(0, joint_damping, ids_[2], false);
  scene.energy->add(0, joint_thermal_work, ids_[3], false);
  named_.store(true, std::memory_order_release);
}

void JointEnergies::add(const yade::Scene& scene, const stepper::ContactEnergy& step) {
  name(scene);
  scene.energy->add(step.elastic, joint_elastic, ids_[0], true);
  scene.energy->add(step.friction, joint_friction, ids_[1], false);
  scene.energy->add(step.damping, joint_damping, ids_[2], false);
  scene.energy->add(step.thermal_work, joint_thermal_work, ids_[3], false);
}

}  // namespace statejump::dem
