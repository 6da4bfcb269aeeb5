// SPDX-License-Identifier: GPL-3.0-or-later
// Transfers the results of a contact step (statejump/stepper) to YADE. Called in every step, so
// inline.
#pragma once

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "contact_parts.hpp"
#include "faults.hpp"
#include "joint.hpp"
#include "shapes.hpp"
#include "statejump/kernel/elastic_pair.hpp"
#include "statejump/stepper/contact.hpp"

namespace statejump::dem {

struct ContactHost {
  yade::Scene& scene;
  const yade::Interaction& contact;
  JointEnergies& energies;

  Real time_step() const { return scene.dt; }
  bool tracks_energy() const { return scene.trackEnergy; }
  void add(const stepper::ContactEnergy& energy) const { energies.add(scene, energy); }
  void apply(const kernel::Wrench& wrench) const {
    scene.forces.addForce(contact.id1, wrench.force_1);
    scene.forces.addTorque(contact.id1, wrench.torque_1);
    scene.forces.addForce(contact.id2, wrench.force_2);
    scene.forces.addTorque(contact.id2, wrench.torque_2);
  }
  static constexpr bool checks_response = true;
  [[gnu::cold, gnu::noinline]] bool accepts(Real stiffness, const Vector3r& force,
                                            const JointPhys& physics) const {
    const stepper::ResponseCheck answer =
        stepper::check_response(stiffness, force, physics, scene.dt);
    if (answer == stepper::ResponseCheck::step_is_too_long) {
      fail_unstable(physics.effectiveMass, stiffness, scene, contact);
    } else if (answer == stepper::ResponseCheck::not_finite) {
      fail_answer(stiffness, force, scene, contact);
    }
    return answer == stepper::ResponseCheck::valid;
  }
};

// Sets the physics of a new contact between two materials.
// @param inverse_mass 1/m1 + 1/m2 [1/kg]; @param fail function that receives the sentence of an
//     error
template <class Physics, class Fail>
void fill_physics(const Ip2_ThermalFrictMat_ThermalFrictMat_JointPhys& functor,
                  const ThermalFrictMat& first, const ThermalFrictMat& second, Real inverse_mass,
                  Physics& physics, Fail&& fail) {
  if (fault_of(first) || fault_of(second)) return fail("");  // record_failure() names the fault
  try {
    const kernel::ElasticPair elastic =
        kernel::elastic_pair(first.young, first.poisson, second.young, second.poisson);
    physics.effectiveYoungModulus = elastic.effective_young_modulus;
    physics.effectiveShearModulus = elastic.effective_shear_modulus;
  } catch (const std::invalid_argument& error) {
    fail(error.what());
  }
  const Real angle = std::min(first.frictionAngle, second.frictionAngle);
  physics.tangensOfFrictionAngle = std::tan(angle);
  physics.effectiveMass = inverse_mass > 0 ? 1 / inverse_mass : 0;
  physics.normalDampingRatio = functor.normalDampingRatio;
  physics.tangentialDampingRatio = functor.tangentialDampingRatio;
}

// Copies the state of a contact from YADE's objects to plain values, or in the opposite direction.
template <class From, class To>
void copy_geometry(const From& from, To& to) {
  to.normal = from.normal;
  to.penetrationDepth = from.penetrationDepth;
  to.effectiveRadius = from.effectiveRadius;
  to.eccentricity = from.eccentricity;
  to.relativeVelocity = from.relativeVelocity;
  to.journalRadius = from.journalRadius;
  to.bearingRadius = from.bearingRadius;
  to.arm1 = from.arm1;
  to.arm2 = from.arm2;
  to.previousNormal = from.previousNormal;
  to.twistAngle = from.twistAngle;
  to.axis = from.axis;
  to.clearanceRate = from.clearanceRate;
}

template <class From, class To>
void copy_physics(const From& from, To& to) {
  to.kn = from.kn;
  to.ks = from.ks;
  to.normalForce = from.normalForce;
  to.shearForce = from.shearForce;
  to.tangensOfFrictionAngle = from.tangensOfFrictionAngle;
  to.effectiveYoungModulus = from.effectiveYoungModulus;
  to.effectiveShearModulus = from.effectiveShearModulus;
  to.effectiveMass = from.effectiveMass;
  to.normalDampingRatio = from.normalDampingRatio;
  to.tangentialDampingRatio = from.tangentialDampingRatio;
  to.slipping = from.slipping;
  to.slipAxis = from.slipAxis;
  to.slipMemory = from.slipMemory;
  to.slipSlope = from.slipSlope;
  to.slipMerged = from.slipMerged;
  to.slipHeld = from.slipHeld;
  to.slipShift = from.slipShift;
  to.slipSums = from.slipSums;
  to.slipLine = from.slipLine;
  to.begun = from.begun;
  to.impactSpeed = from.impactSpeed;
  to.dissipationSlope = from.dissipationSlope;
  to.frictionSlope = from.frictionSlope;
  to.previousElasticForce = from.previousElasticForce;
  to.previousElasticEnergy = from.previousElasticEnergy;
  to.previousClearance = from.previousClearance;
  to.previousRadius = from.previousRadius;
  to.previousBearingRadius = from.previousBearingRadius;
  to.previousDepth = from.previousDepth;
}

}  // namespace statejump::dem
