// SPDX-License-Identifier: GPL-3.0-or-later
// Finds the invalid number of a scene and reports it as a failure with its name. The ranges of
// links and contacts are in statejump/stepper/checks.hpp. Not called in regular steps.
#pragma once

#include <optional>

#include "failure.hpp"
#include "shapes.hpp"
#include "thermal.hpp"

namespace statejump::dem {

struct PrismaticJoint;
struct TorsionSpring;

// The first fault of the plugin's objects: bodies with its shapes or in links and guides, with
// their materials and permanent forces; contacts, links, springs, guides; the time step.
[[gnu::cold]] std::optional<Failure> fault_of_scene(const yade::Scene& scene);

// Of a contact: bodies, physics, geometry and forces.
[[gnu::cold]] std::optional<Failure> fault_of_contact(const yade::Scene& scene,
                                                      const yade::Interaction& contact);

// Of a link: bodies and parameters.
[[gnu::cold]] std::optional<Failure> fault_of_link(const yade::Scene& scene,
                                                   const ThermalLink& link);

// Of a torsion spring with both links: parameters.
[[gnu::cold]] std::optional<Failure> fault_of_spring(const yade::Scene& scene,
                                                     const TorsionSpring& spring);

// Of a slider between two bodies: bodies and parameters.
[[gnu::cold]] std::optional<Failure> fault_of_prismatic(const yade::Scene& scene,
                                                        const PrismaticJoint& joint);

// The invalid value of a material; empty if there is none.
struct MaterialFault {
  const char* attribute;
  Real value;
  const char* allowed;  // with its unit
};
[[gnu::cold]] std::optional<MaterialFault> fault_of(const ThermalFrictMat& material);

// Throws: the temperature gives a body no positive length.
[[noreturn, gnu::cold]] void fail_strain(const yade::Scene& scene, int id, Real strain,
                                         Real expansion);
// For functors: a law returned a number that is not finite.
[[gnu::cold]] void fail_answer(Real stiffness, const Vector3r& force, const yade::Scene& scene,
                               const yade::Interaction& contact);
// Throws: a force on a body is not finite.
[[noreturn, gnu::cold]] void fail_force(const yade::Scene& scene, int id, const Vector3r& force);

}  // namespace statejump::dem
