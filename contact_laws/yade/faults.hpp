// SPDX-License-Identifier: GPL-3.0-or-later
// Finds an invalid number of a scene and reports it as a failure with its name. The ranges of links
// and contacts are in statejump/stepper/checks.hpp. Not called in regular steps.
#pragma once

#include <optional>

#include "failure.hpp"
#include "shapes.hpp"
#include "thermal.hpp"

namespace statejump::dem {

struct BeamBond;
struct PrismaticJoint;
struct TorsionSpring;

// First fault of the plugin's objects. The check covers bodies that have a shape of the plugin or
// belong to links or guides, with their materials and permanent forces; also contacts, links,
// springs, guides and the time step.
[[gnu::cold]] std::optional<Failure> fault_of_scene(const yade::Scene& scene);

// First fault of a contact: its bodies, physics, geometry and forces.
[[gnu::cold]] std::optional<Failure> fault_of_contact(const yade::Scene& scene,
                                                      const yade::Interaction& contact);

// First fault of a link: its bodies and parameters.
[[gnu::cold]] std::optional<Failure> fault_of_link(const yade::Scene& scene,
                                                   const ThermalLink& link);

// First fault in the parameters of a torsion spring. Both of its links must exist.
[[gnu::cold]] std::optional<Failure> fault_of_spring(const yade::Scene& scene,
                                                     const TorsionSpring& spring);

// First fault of a slider between two bodies, in its bodies or parameters.
[[gnu::cold]] std::optional<Failure> fault_of_prismatic(const yade::Scene& scene,
                                                        const PrismaticJoint& joint);

// First fault of a beam between two bodies, in its bodies or parameters.
[[gnu::cold]] std::optional<Failure> fault_of_beam(const yade::Scene& scene, const BeamBond& bond);

// An invalid value of a material.
struct MaterialFault {
  const char* attribute;
  Real value;
  const char* allowed;  // allowed range with its unit
};
[[gnu::cold]] std::optional<MaterialFault> fault_of(const ThermalFrictMat& material);

// Throws the failure that a body has no positive length at this thermal strain.
[[noreturn, gnu::cold]] void fail_strain(const yade::Scene& scene, int id, Real strain,
                                         Real expansion);
// Functors call this to record that a law returned a number that is not finite.
[[gnu::cold]] void fail_answer(Real stiffness, const Vector3r& force, const yade::Scene& scene,
                               const yade::Interaction& contact);
// Throws because a force on a body is not finite.
[[noreturn, gnu::cold]] void fail_force(const yade::Scene& scene, int id, const Vector3r& force);

}  // namespace statejump::dem
