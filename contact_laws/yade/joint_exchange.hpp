// SPDX-License-Identifier: GPL-3.0-or-later
// What every law of the joints reads from a contact's JointGeom and JointPhys for the kernel, and
// writes back. On the path of every step: inline.
#pragma once

#include "contact_parts.hpp"
#include "joint.hpp"
#include "statejump/kernel/contact_law.hpp"
#include "statejump/kernel/frame.hpp"

namespace statejump::dem {

inline kernel::ContactParameters contact_parameters(const JointPhys& physics) {
  return {{physics.effectiveYoungModulus, physics.effectiveShearModulus},
          physics.tangensOfFrictionAngle,
          physics.normalDampingRatio,
          physics.tangentialDampingRatio,
          physics.effectiveMass};
}

// History of friction, carried into the tangent plane of this step. YADE's forces act on body 2,
// the kernel's on body 1.
inline kernel::ContactHistory contact_history(const JointGeom& geometry, const JointPhys& physics) {
  kernel::ContactHistory history;
  history.tangential_force = kernel::transport(-physics.shearForce, geometry.previousNormal,
                                               geometry.normal, geometry.twistAngle);
  history.tangential_stiffness = physics.ks;
  history.slipping = physics.slipping;
  return history;
}

// What the contact keeps until the next step: stiffnesses, forces and history.
inline void store(const kernel::ContactResponse& response, const kernel::ContactHistory& history,
                  const Vector3r& normal, JointPhys& physics) {
  physics.kn = response.normal_stiffness;
  physics.ks = history.tangential_stiffness;
  physics.slipping = history.slipping;
  physics.normalForce = response.normal_force * normal;
  physics.shearForce = -history.tangential_force;
}

// Leapfrog is unstable beyond omega dt = 2 of the stiffest contact alone, whatever else acts.
inline void check_time_step(Real normal_stiffness, const JointPhys& physics,
                            const yade::Scene& scene, const yade::Interaction& contact) {
  if (scene.dt * scene.dt * normal_stiffness > 4 * physics.effectiveMass &&
      physics.effectiveMass > 0) {
    fail_unstable(physics.effectiveMass, normal_stiffness, scene, contact);
  }
}

// The entries of one contact in O.energy. Expansion works on it through the clearance c and the
// radii: with V(delta, radii) and delta = eccentricity - c, the part of dV that no motion of the
// bodies explains is -F dc plus what the radii change of V at fixed depth. Trapezoidal, as the
// motion is.
// @param dissipation_force of the dissipation law [N], @param radius kept until the next step [m]
// @param add_radius_work adds the work of the changing radii to a number [J]
template <class AddRadiusWork>
void account(const kernel::ContactResponse& response, Real dissipation_force, Real radius,
             const AddRadiusWork& add_radius_work, const JointGeom& geometry, JointPhys& physics,
             const yade::Scene& scene, JointEnergies& energies) {
  const Real clearance = geometry.eccentricity - geometry.penetrationDepth;
  Real thermal_work = 0;
  if (physics.previousRadius > 0) {
    const Real force = 0.5 * (response.elastic_normal_force + physics.previousElasticForce);
    thermal_work = -force * (clearance - physics.previousClearance) -
                   dissipation_force * geometry.clearanceRate * scene.dt;
    add_radius_work(thermal_work);
  }
  physics.previousElasticForce = response.elastic_normal_force;
  physics.previousElasticEnergy = response.normal_elastic_energy;
  physics.previousClearance = clearance;
  physics.previousRadius = radius;
  physics.previousBearingRadius = geometry.bearingRadius;
  physics.previousDepth = geometry.penetrationDepth;
  energies.add(scene, {response.normal_elastic_energy + response.tangential_elastic_energy,
                       response.friction_dissipation, response.damping_dissipation, thermal_work});
}

inline void apply(const kernel::Wrench& wrench, yade::Scene& scene,
                  const yade::Interaction& contact) {
  scene.forces.addForce(contact.id1, wrench.force_1);
  scene.forces.addTorque(contact.id1, wrench.torque_1);
  scene.forces.addForce(contact.id2, wrench.force_2);
  scene.forces.addTorque(contact.id2, wrench.torque_2);
}

// Forces of a contact that touches: what it keeps, and what the two bodies feel.
inline void exert(const kernel::ContactResponse& response, const kernel::Wrench& wrench,
                  const kernel::ContactHistory& history, const JointGeom& geometry,
                  JointPhys& physics, yade::Scene& scene, const yade::Interaction& contact) {
  check_time_step(response.normal_stiffness, physics, scene, contact);
  store(response, history, geometry.normal, physics);
  apply(wrench, scene, contact);
}

}  // namespace statejump::dem
