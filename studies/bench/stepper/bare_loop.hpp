// SPDX-License-Identifier: GPL-3.0-or-later
// Minimum cost of n joints of the benchmark with the project's kernel: one array of structures, one
// loop, without the data of a YADE scene.
#pragma once

#include <cmath>
#include <vector>

#include "statejump/kernel/contact_law.hpp"
#include "statejump/kernel/frame.hpp"
#include "statejump/kernel/joint_kinematics.hpp"
#include "statejump/stepper/scene.hpp"

namespace statejump::stepper::bench {

struct BareJoint {
  kernel::BodyMotion journal, bearing;
  kernel::Vector3 load;
  kernel::Vector3 normal = kernel::Vector3::Zero();
  kernel::Vector3 force = kernel::Vector3::Zero();
  double stiffness = 0;
  bool slipping = false;
};

class BareLoop {
 public:
  BareLoop(const Scene& scene, const ContactPhysics& physics)
      : parameters_{{physics.effectiveYoungModulus, physics.effectiveShearModulus},
                    physics.tangensOfFrictionAngle,
                    0,
                    0,
                    physics.effectiveMass},
        program_(scene.programs.front()),
        expansion_1_(scene.heaters.front().targets[0].expansion),
        expansion_2_(scene.heaters.front().targets[1].expansion),
        radius_1_(scene.contacts.front().length_1),
        radius_2_(scene.contacts.front().length_2),
        damping_(scene.newton.damping),
        dt_(scene.time_step) {
    for (const Contact& contact : scene.contacts) {
      const Body& journal = scene.bodies[static_cast<std::size_t>(contact.body_1)];
      const Body& bearing = scene.bodies[static_cast<std::size_t>(contact.body_2)];
      joints_.push_back({journal.motion, bearing.motion, journal.permanent_force});
      mass_ = journal.mass;
    }
  }

  void run(long steps) {
    for (long i = 0; i < steps; ++i) step();
  }

 private:
  void step() {
    const double change = program_.temperature_change(time_);
    const double r1 = radius_1_ * (1 + expansion_1_ * change);
    const double r2 = radius_2_ * (1 + expansion_2_ * change);
    const kernel::Vector3 axis = kernel::Vector3::UnitZ();
    for (BareJoint& joint : joints_) {
      const kernel::JointContact contact =
          kernel::revolute_contact(joint.journal, r1, joint.bearing, r2, axis);
      kernel::ContactHistory history;
      history.tangential_force = kernel::transport(joint.force, joint.normal, contact.normal);
      history.tangential_stiffness = joint.stiffness;
      history.slipping = joint.slipping;
      const kernel::ContactResponse response =
          kernel::hertz_mindlin(parameters_, kernel::contact_kinematics(contact, dt_), history);
      joint.normal = contact.normal;
      joint.force = history.tangential_force;
      joint.stiffness = history.tangential_stiffness;
      joint.slipping = history.slipping;
      kernel::Vector3 acceleration = (response.force_on_1 + joint.load) / mass_;
      acceleration[2] = 0;
      for (int i = 0; i < 2; ++i) {
        const double power =
            acceleration[i] * (joint.journal.velocity[i] + 0.5 * dt_ * acceleration[i]);
        acceleration[i] *= 1 - damping_ * (power > 0 ? 1 : power < 0 ? -1 : 0);
      }
      joint.journal.velocity += dt_ * acceleration;
      joint.journal.position += dt_ * joint.journal.velocity;
    }
    time_ += dt_;
  }

  kernel::ContactParameters parameters_;
  thermal::Program program_;
  double expansion_1_, expansion_2_, radius_1_, radius_2_, damping_, dt_;
  double mass_ = 0, time_ = 0;
  std::vector<BareJoint> joints_;
};

}  // namespace statejump::stepper::bench
