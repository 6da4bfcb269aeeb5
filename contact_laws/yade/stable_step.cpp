// SPDX-License-Identifier: GPL-3.0-or-later
#include "stable_step.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <vector>

#include "beam.hpp"
#include "blocked_motion.hpp"
#include "bore.hpp"
#include "joint.hpp"
#include "prismatic.hpp"
#include "statejump/kernel/stable_step.hpp"
#include "thermal.hpp"
#include "torsion.hpp"

namespace statejump::dem {
namespace {

// Acceleration of a body per unit force with the given lever arm [1/kg]: from translation along the
// force and, if the body can rotate, from rotation. A force that does not rotate the body has arm
// 0.
Real mobility(const yade::State& state, Real arm_squared) {
  Real smallest_inertia = 0;
  for (int i = 0; i < 3; ++i) {
    const bool free = !(state.blockedDOFs & (8u << i));
    if (free && state.inertia[i] > 0 &&
        (smallest_inertia == 0 || state.inertia[i] < smallest_inertia)) {
      smallest_inertia = state.inertia[i];
    }
  }
  return inverse_mass(state) + (smallest_inertia > 0 ? arm_squared / smallest_inertia : 0);
}

// Sums stiffness and damping over the springs and dashpots of each body.
//
// Let s be the elongation of a spring of stiffness k between two bodies. Then s^2 <= 2 (s1^2 +
// s2^2) and, for its end on body i, s_i^2 <= mobility_i * 2 * (kinetic energy per unit rate
// squared). So the largest eigenvalue is at most the largest sum of 2 k mobility over the springs
// of one body.
class BodySums {
 public:
  explicit BodySums(const yade::Scene& scene)
      : scene_(scene), stiffness_(number_of_bodies(scene), 0), damping_(stiffness_) {}

  void add(const yade::Interaction& contact) {
    if (const auto* pair = dynamic_cast<const BoreGeom*>(contact.geom.get())) {
      const auto* all = dynamic_cast<const BorePhys*>(contact.phys.get());
      const std::size_t count = all ? std::min(pair->contacts.size(), all->contacts.size()) : 0;
      for (std::size_t k = 0; k < count; ++k) {
        if (pair->contacts[k]->penetrationDepth > 0) {
          add_at(contact, *pair->contacts[k], *all->contacts[k]);
        }
      }
      return;
    }
    const auto* physics = dynamic_cast<const JointPhys*>(contact.phys.get());
    const auto* geometry = dynamic_cast<const JointGeom*>(contact.geom.get());
    if (physics && geometry) add_at(contact, *geometry, *physics);
  }

  void add(const ThermalLink& link) {
    const yade::State& one = state_of(link.id1, "ThermalLink.id1");
    const yade::State& two = state_of(link.id2, "ThermalLink.id2");
    const Real root = inverse_mass(one), tip = inverse_mass(two);
    // The step divides the axial stiffness by the present stress-free length l_T, and pin damping
    // by the present length. The reference length bounds both in later states without cooling.
    const Real change = link.program ? link.program->temperature_change(scene_.time) : 0;
    const Real length = std::min(link.stressFreeLength, stepper::stress_free_length(link, change));
    const Real across = std::min(length, (two.se3.position - one.se3.position).norm());
    const Real k = link.youngModulus * link.crossSectionArea / length;
    const Real c =
        stepper::damping_coefficient(link, root + tip) + link.pinDamping / (across * across);
    add(link.id1, root, k, c);
    add(link.id2, tip, k, c);
  }

  void add(const TorsionSpring& spring) {
    if (!spring.link1 || !spring.link2) return;
    // The angle is a sum of up to four displacements, each divided by the length of its link. Its
    // square is at most the number of moving ends times the sum of squares. A common factor 2 is
    // applied later.
    const std::array<LinkEnds, 2> links = {ends_of(scene_, *spring.link1),
                                           ends_of(scene_, *spring.link2)};
    int moving = 0;
    for (const LinkEnds& ends : links) {
      moving += (inverse_mass(ends.root) > 0) + (inverse_mass(ends.tip) > 0);
    }
    for (std::size_t i = 0; i < links.size(); ++i) {
      const ThermalLink& link = i == 0 ? *spring.link1 : *spring.link2;
      const Real k = 0.5 * moving * stepper::largest_stiffness(spring) /
                     (links[i].span.length * links[i].span.length);
      add(link.id1, inverse_mass(links[i].root), k, 0);
      add(link.id2, inverse_mass(links[i].tip), k, 0);
    }
  }

  void add(const BeamBond& bond) {
    if (bond.axisX.isZero(0)) return;  // before the first step
    const kernel::Beam beam = stepper::placed(bond).beam;
    const stepper::Mobility one =
        stepper::at_offset(mobility_of(state_of(bond.id1, "BeamBond.id1")), bond.offset1);
    const stepper::Mobility two =
        stepper::at_offset(mobility_of(state_of(bond.id2, "BeamBond.id2")), bond.offset2);
    const Real change = bond.program ? bond.program->temperature_change(scene_.time) : 0;
    const Real length = std::min(bond.stressFreeLength,
                                 bond.stressFreeLength * (1 + bond.thermalExpansion * change));
    kernel::BeamStep::Vector6 stiffness = stepper::unloaded_stiffness(beam, length);
    const kernel::BeamStep::Vector6 damping =
        stepper::mode_damping(bond.dampingRatio, stiffness, length, one, two);
    const Real tension = std::max(bond.force2[0], 0.0);
    for (int k = 0; k < 2; ++k) {
      stiffness[1 + k] += tension * length / 3;
      stiffness[3 + k] += tension * length / 5;
    }
    // The modes of one end, while the other is fixed, bound its part of the modes.
    const auto add_end = [&](int id, const stepper::Mobility& end) {
      add(id, 1, stepper::largest_rate(stiffness, tension / length, length, end, {}),
          stepper::largest_rate(damping, 0, length, end, {}));
    };
    add_end(bond.id1, one);
    add_end(bond.id2, two);
  }

  void add(const PrismaticJoint& joint) {
    const Real one = inverse_mass(state_of(joint.id1, "PrismaticJoint.id1"));
    const Real two = inverse_mass(state_of(joint.id2, "PrismaticJoint.id2"));
    const Real k = stepper::largest_stiffness(joint);
    const Real c = one + two > 0 ? stepper::largest_damping(joint, 1 / (one + two)) : 0;
    add(joint.id1, one, k, c);
    add(joint.id2, two, k, c);
  }

  double stable_time_step() const {
    double smallest = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < stiffness_.size(); ++i) {
      smallest =
          std::min(smallest, kernel::critical_time_step(1, 2 * stiffness_[i], 2 * damping_[i]));
    }
    return smallest;
  }

 private:
  const yade::State& state_of(int id, const char* who) const {
    return *body_of(scene_, id, who).state;
  }

  void add(int id, Real mobility_of_body, Real k, Real c) {
    stiffness_[static_cast<std::size_t>(id)] += mobility_of_body * k;
    damping_[static_cast<std::size_t>(id)] += mobility_of_body * c;
  }

  void add_at(const yade::Interaction& contact, const JointGeom& geometry,
              const JointPhys& physics) {
    const Real normal_damping =
        kernel::viscous_damping(physics.normalDampingRatio, physics.effectiveMass, physics.kn) +
        physics.dissipationSlope;
    const Real tangential_damping =
        kernel::viscous_damping(physics.tangentialDampingRatio, physics.effectiveMass, physics.ks) +
        physics.frictionSlope;
    for (const int id : {contact.id1, contact.id2}) {
      const yade::State& state = state_of(id, "stable_time_step");
      const Vector3r arm = geometry.contactPoint - state.se3.position;
      add(id, mobility(state, arm.cross(geometry.normal).squaredNorm()), physics.kn,
          normal_damping);
      add(id, mobility(state, arm.squaredNorm()), physics.ks, tangential_damping);
    }
  }

  const yade::Scene& scene_;
  std::vector<Real> stiffness_;  // stiffness times mobility [1/s2]
  std::vector<Real> damping_;    // damping times mobility [1/s]
};

template <class List>
void add_each(const List& list, BodySums& sums) {
  for (const auto& one : list) {
    if (one) sums.add(*one);
  }
}

}  // namespace

double stable_time_step(const yade::Scene& scene) {
  BodySums sums(scene);
  for (std::size_t i = 0; i < number_of_interactions(scene); ++i) {
    const yade::Interaction& contact = interaction_at(scene, i);
    if (contact.isReal()) sums.add(contact);
  }
  for (const auto& engine : scene.engines) {
    if (const auto* links = dynamic_cast<const ThermalLinks*>(engine.get())) {
      add_each(links->links, sums);
    } else if (const auto* springs = dynamic_cast<const TorsionSprings*>(engine.get())) {
      add_each(springs->springs, sums);
    } else if (const auto* joints = dynamic_cast<const PrismaticJoints*>(engine.get())) {
      add_each(joints->joints, sums);
    } else if (const auto* beams = dynamic_cast<const BeamBonds*>(engine.get())) {
      add_each(beams->bonds, sums);
    }
  }
  return sums.stable_time_step();
}

}  // namespace statejump::dem
