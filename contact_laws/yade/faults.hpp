// SPDX-License-Identifier: GPL-3.0-or-later
// Numbers of a scene that no step may use: which one it is, as a failure that names it. What is
// asked of links and contacts is in statejump/stepper/checks.hpp. Off the path of every step.
#pragma once

#include <optional>

#include "failure.hpp"
#include "shapes.hpp"
#include "thermal.hpp"

namespace statejump::dem {

struct PrismaticJoint;
struct TorsionSpring;

// The first fault of what this plugin steps: bodies with our shapes and those that links and guides
// hold, with their materials and permanent forces; contacts, links, springs, guides; the time step.
[[gnu::cold]] std::optional<Failure> fault_of_scene(const yade::Scene& scene);

// Of a contact: its two bodies, its physics, its geometry and forces.
[[gnu::cold]] std::optional<Failure> fault_of_contact(const yade::Scene& scene,
                                                      const yade::Interaction& contact);

// Of a link: its two bodies, what it is given.
[[gnu::cold]] std::optional<Failure> fault_of_link(const yade::Scene& scene,
                                                   const ThermalLink& link);

// Of a torsion spring with both links: what it is given.
[[gnu::cold]] std::optional<Failure> fault_of_spring(const yade::Scene& scene,
                                                     const TorsionSpring& spring);

// Of a slider between two bodies: the bodies, what it is given.
[[gnu::cold]] std::optional<Failure> fault_of_prismatic(const yade::Scene& scene,
                                                        const PrismaticJoint& joint);

// What is wrong with a material; none where nothing is.
struct MaterialFault {
  const char* attribute;
  Real value;
  const char* allowed;  // with its unit
};
[[gnu::cold]] std::optional<MaterialFault> fault_of(const ThermalFrictMat& material);

// Throws: the temperature leaves a body no length.
[[noreturn, gnu::cold]] void fail_strain(const yade::Scene& scene, int id, Real strain,
                                         Real expansion);
// For functors: a law answered with what is no number.
[[gnu::cold]] void fail_answer(Real stiffness, const Vector3r& force, const yade::Scene& scene,
                               const yade::Interaction& contact);
// Throws: a force on a body is no number.
[[noreturn, gnu::cold]] void fail_force(const yade::Scene& scene, int id, const Vector3r& force);

}  // namespace statejump::dem
