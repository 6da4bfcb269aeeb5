// SPDX-License-Identifier: GPL-3.0-or-later
// All numbers of a scene that a step writes, and a bitwise comparison of two scenes.
#pragma once

#include <gtest/gtest.h>

#include <cstring>
#include <variant>
#include <vector>

#include "statejump/stepper/scene.hpp"

namespace statejump::stepper::bits {

class Numbers {
 public:
  template <class... Values>
  void add(const Values&... values) {
    (add_one(values), ...);
  }
  const std::vector<double>& all() const { return all_; }

 private:
  void add_one(double value) { all_.push_back(value); }
  void add_one(const Vector3& v) { all_.insert(all_.end(), v.data(), v.data() + 3); }
  std::vector<double> all_;
};

inline std::vector<double> of(const Scene& scene) {
  Numbers numbers;
  numbers.add(scene.time, static_cast<double>(scene.iteration));
  for (const Strain& each : scene.strains) numbers.add(each.strain, each.rate);
  for (const Body& each : scene.bodies) {
    numbers.add(each.motion.position, each.motion.velocity, each.motion.angular_velocity,
                Vector3(each.orientation.vec()), each.orientation.w(), each.force, each.torque);
  }
  for (const Contact& each : scene.contacts) {
    numbers.add(each.real, each.renewed, static_cast<double>(each.made));
    if (!each.real) continue;
    const ContactGeometry& g = each.geometry;
    numbers.add(g.normal, g.penetrationDepth, g.effectiveRadius, g.eccentricity, g.relativeVelocity,
                g.journalRadius, g.bearingRadius, g.arm1, g.arm2, g.previousNormal, g.twistAngle,
                g.axis, g.clearanceRate);
    const ContactPhysics& p = each.physics;
    numbers.add(p.kn, p.ks, p.normalForce, p.shearForce, p.slipping, p.impactSpeed,
                p.previousElasticForce, p.previousElasticEnergy, p.previousClearance,
                p.previousRadius, p.previousBearingRadius, p.previousDepth);
  }
  for (const Stage& stage : scene.stages) {
    const auto* links = std::get_if<Links>(&stage);
    if (!links) continue;
    for (const LinkEntry& place : links->links) {
      numbers.add(place.link.axialForce, place.link.previousExtension, place.link.tipDirection);
    }
  }
  const Energies& e = scene.energies;
  numbers.add(e.joint_friction, e.joint_damping, e.joint_thermal_work, e.link_damping,
              e.pin_damping, e.link_thermal_work, e.numerical_damping, e.gravity_work);
  return numbers.all();
}

inline void expect_same(const Scene& one, const Scene& other) {
  const std::vector<double> first = of(one), second = of(other);
  ASSERT_EQ(first.size(), second.size());
  for (std::size_t i = 0; i < first.size(); ++i) {
    ASSERT_EQ(std::memcmp(&first[i], &second[i], sizeof(double)), 0)
        << "number " << i << ": " << first[i] << " is not " << second[i];
  }
}

}  // namespace statejump::stepper::bits
