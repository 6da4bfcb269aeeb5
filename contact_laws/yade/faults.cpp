// SPDX-License-Identifier: GPL-3.0-or-later
#include "faults.hpp"

#include <array>
#include <cmath>
#include <string>
#include <utility>

#include "beam.hpp"
#include "bore.hpp"
#include "contact_parts.hpp"
#include "guide.hpp"
#include "joint.hpp"
#include "known_cast.hpp"
#include "prismatic.hpp"
#include "statejump/stepper/checks.hpp"
#include "torsion.hpp"

namespace statejump::dem {
namespace {

using stepper::ValueRange;
using Part = Failure::Part;
using Fault = std::optional<Failure>;

// " is nan kg, allowed is above 0"
template <class Value>
std::string wrong(const Value& value, const std::string& unit, const std::string& allowed) {
  return " is " + text_of(value) + unit + ", allowed is " + allowed;
}

template <class Value>
FailureDetail not_allowed(const std::string& quantity, const Value& value,
                          const std::string& allowed) {
  return {"not_allowed", quantity, text_of(value), allowed};
}

// Creates a sentence such as "the mass of body 3 is nan kg, allowed is above 0" from the name
// "mass".
template <class Value>
Failure of_body(const yade::Scene& scene, int id, const std::string& name, const Value& value,
                const std::string& unit, const std::string& allowed) {
  return failure(scene, Part::body, id, -1, "the " + name + " of ", wrong(value, unit, allowed),
                 not_allowed(name, value, allowed));
}

Fault fault_of_motion(const yade::Scene& scene, int id, const yade::State& state) {
  const std::array<std::pair<const char*, const Vector3r*>, 3> vectors = {
      {{"position", &state.se3.position},
       {"velocity", &state.vel},
       {"angular velocity", &state.angVel}}};
  const std::array<const char*, 3> units = {" m", " m/s", " rad/s"};
  for (std::size_t i = 0; i < vectors.size(); ++i) {
    const auto& [name, value] = vectors[i];
    if (!stepper::is_finite(*value)) {
      return of_body(scene, id, name, *value, units[i], range_text(ValueRange::finite));
    }
  }
  const Real norm = state.se3.orientation.norm();
  if (!(norm > 0) || !std::isfinite(norm)) {
    return of_body(scene, id, "norm of the orientation", norm, "", "above 0");
  }
  return std::nullopt;
}

// The mass must be > 0 if the body can translate. An inertia must be > 0 if the body can rotate
// about that axis. Otherwise they may be 0.
Fault fault_of_inertia(const yade::Scene& scene, int id, const yade::State& state) {
  constexpr unsigned translations = 7;
  const bool moves = (state.blockedDOFs & translations) != translations;
  const ValueRange mass = moves ? ValueRange::positive : ValueRange::not_negative;
  if (!allows(mass, state.mass)) {
    return of_body(scene, id, "mass", state.mass, " kg", range_text(mass));
  }
  for (int i = 0; i < 3; ++i) {
    const bool turns = (state.blockedDOFs & (8u << i)) == 0;
    const ValueRange inertia = turns ? ValueRange::positive : ValueRange::not_negative;
    if (!allows(inertia, state.inertia[i])) {
      return of_body(scene, id, "moment of inertia", state.inertia, " kg m2", range_text(inertia));
    }
  }
  return std::nullopt;
}

// Permanent forces are valid only after the ForceResetter has run in this step.
Fault fault_of_forces(const yade::Scene& scene, int id) {
  auto& forces = const_cast<yade::ForceContainer&>(scene.forces);  // its getters are not const
  if (forces.lastReset != scene.iter || !forces.getPermForceUsed()) return std::nullopt;
  const Vector3r& force = forces.getPermForce(id);
  if (!stepper::is_finite(force)) {
    return of_body(scene, id, "permanent force", force, " N", range_text(ValueRange::finite));
  }
  const Vector3r& torque = forces.getPermTorque(id);
  if (!stepper::is_finite(torque)) {
    return of_body(scene, id, "permanent torque", torque, " N m", range_text(ValueRange::finite));
  }
  return std::nullopt;
}

Fault fault_of_body(const yade::Scene& scene, int id) {
  if (!scene.bodies->exists(id)) return std::nullopt;
  const yade::Body& body = *body_at(scene, static_cast<std::size_t>(id));
  const yade::State& state = *body.state;
  // Checks causes before their effects, so that the cause is reported.
  if (Fault fault = fault_of_inertia(scene, id, state)) return fault;
  if (Fault fault = fault_of_forces(scene, id)) return fault;
  if (Fault fault = fault_of_motion(scene, id, state)) return fault;
  if (const auto* material = known_cast<const ThermalFrictMat>(body.material.get())) {
    if (const auto fault = fault_of(*material)) {
      const std::string name = std::string(ThermalFrictMat::class_name) + "." + fault->attribute;
      return failure(scene, Part::body, id, -1, name + " of ",
                     wrong(fault->value, "", fault->allowed),
                     not_allowed(name, fault->value, fault->allowed));
    }
  }
  if (const auto* shape = known_cast<const ThermalShape>(body.shape.get())) {
    if (!stepper::is_strain(shape->thermalStrain)) {
      return of_body(scene, id, "thermal strain", shape->thermalStrain, "", "above -1");
    }
  }
  return std::nullopt;
}

Fault fault_of_physics(const yade::Scene& scene, const yade::Interaction& contact,
                       const JointPhys& physics) {
  const auto* quantity = stepper::first_invalid(stepper::contact_quantities<JointPhys>, physics);
  if (!quantity) return std::nullopt;
  return failure(scene, Part::contact, contact.id1, contact.id2,
                 std::string(JointPhys::class_name) + "." + quantity->name +
                     wrong(physics.*quantity->value, std::string(" ") + quantity->unit,
                           range_text(quantity->allowed)),
                 "",
                 not_allowed(std::string(JointPhys::class_name) + "." + quantity->name,
                             physics.*quantity->value, range_text(quantity->allowed)));
}

Fault fault_of_physics(const yade::Scene& scene, const yade::Interaction& contact) {
  if (const auto* many = known_cast<const BorePhys>(contact.phys.get())) {
    for (const auto& one : many->contacts) {
      if (Fault fault = one ? fault_of_physics(scene, contact, *one) : std::nullopt) return fault;
    }
  }
  const auto* physics = known_cast<const JointPhys>(contact.phys.get());
  return physics ? fault_of_physics(scene, contact, *physics) : std::nullopt;
}

Fault fault_of_values(const yade::Scene& scene, const ThermalLink& link) {
  const auto* quantity = stepper::first_invalid<stepper::Link>(stepper::link_quantities, link);
  if (!quantity) return std::nullopt;
  const stepper::Link& values = link;
  return failure(scene, Part::link, link.id1, link.id2,
                 std::string(ThermalLink::class_name) + "." + quantity->name + " of ",
                 wrong(values.*quantity->value, std::string(" ") + quantity->unit,
                       range_text(quantity->allowed)),
                 not_allowed(std::string(ThermalLink::class_name) + "." + quantity->name,
                             values.*quantity->value, range_text(quantity->allowed)));
}

template <class List, class FaultOf>
Fault first_of(const List& list, FaultOf&& fault_of_one) {
  for (const auto& one : list) {
    if (Fault fault = fault_of_one(one)) return fault;
  }
  return std::nullopt;
}

Fault fault_of_engine(const yade::Scene& scene, const yade::Engine& engine) {
  if (const auto* group = known_cast<const ThermalLinks>(&engine)) {
    return first_of(group->links, [&](const auto& link) {
      return link ? fault_of_link(scene, *link) : std::nullopt;
    });
  }
  if (const auto* group = known_cast<const TorsionSprings>(&engine)) {
    return first_of(group->springs, [&](const auto& spring) {
      const bool whole = spring && spring->link1 && spring->link2;
      return whole ? fault_of_spring(scene, *spring) : std::nullopt;
    });
  }
  if (const auto* group = known_cast<const PrismaticJoints>(&engine)) {
    return first_of(group->joints, [&](const auto& joint) {
      return joint ? fault_of_prismatic(scene, *joint) : std::nullopt;
    });
  }
  if (const auto* group = known_cast<const BeamBonds>(&engine)) {
    return first_of(group->bonds, [&](const auto& bond) {
      return bond ? fault_of_beam(scene, *bond) : std::nullopt;
    });
  }
  if (const auto* guides = known_cast<const GuidePlanes>(&engine)) {
    return first_of(guides->ids, [&](int id) { return fault_of_body(scene, id); });
  }
  return std::nullopt;
}

}  // namespace

std::optional<MaterialFault> fault_of(const ThermalFrictMat& material) {
  constexpr Real right_angle = 1.57079632679489661923;
  if (!(material.young > 0)) return MaterialFault{"young", material.young, "(0, inf] Pa"};
  if (!(material.poisson > -1 && material.poisson <= 0.5)) {
    return MaterialFault{"poisson", material.poisson, "(-1, 0.5]"};
  }
  if (!(material.frictionAngle >= 0 && material.frictionAngle < right_angle)) {
    return MaterialFault{"frictionAngle", material.frictionAngle, "[0, pi/2) rad"};
  }
  if (!std::isfinite(material.thermalExpansion)) {
    return MaterialFault{"thermalExpansion", material.thermalExpansion, "finite [1/K]"};
  }
  return std::nullopt;
}

Fault fault_of_spring(const yade::Scene& scene, const TorsionSpring& spring) {
  const auto fault = [&](const char* name, Real value, const std::string& unit,
                         const char* allowed) {
    return failure(
        scene, Part::torsion_spring, spring.link1->id2, spring.link2->id2,
        std::string(TorsionSpring::class_name) + "." + name + " of ", wrong(value, unit, allowed),
        not_allowed(std::string(TorsionSpring::class_name) + "." + name, value, allowed));
  };
  const stepper::Torsion& values = spring;
  if (const auto* wrong_one =
          stepper::first_invalid<stepper::Torsion>(stepper::torsion_quantities, values)) {
    return fault(wrong_one->name, values.*wrong_one->value, std::string(" ") + wrong_one->unit,
                 range_text(wrong_one->allowed));
  }
  if (stepper::has_friction_without_stiffness(values)) {
    return fault("frictionStiffness", values.frictionStiffness, " N m/rad",
                 "above 0 with a frictionLimit");
  }
  if (!stepper::is_finite(spring.axis)) {
    return fault("axis (its length)", spring.axis.norm(), "", "1");
  }
  return std::nullopt;
}

Fault fault_of_prismatic(const yade::Scene& scene, const PrismaticJoint& joint) {
  if (!allows(ValueRange::positive, scene.dt)) return fault_of_scene(scene);
  for (const int id : {joint.id1, joint.id2}) {
    if (Fault fault = fault_of_body(scene, id)) return fault;
  }
  const auto fault = [&](const char* name, Real value, const std::string& unit,
                         const char* allowed) {
    return failure(
        scene, Part::prismatic_joint, joint.id1, joint.id2,
        std::string(PrismaticJoint::class_name) + "." + name + " of ", wrong(value, unit, allowed),
        not_allowed(std::string(PrismaticJoint::class_name) + "." + name, value, allowed));
  };
  const stepper::Prismatic& values = joint;
  if (const auto* wrong_one =
          stepper::first_invalid<stepper::Prismatic>(stepper::prismatic_quantities, values)) {
    return fault(wrong_one->name, values.*wrong_one->value, std::string(" ") + wrong_one->unit,
                 range_text(wrong_one->allowed));
  }
  if (stepper::has_friction_without_stiffness(values)) {
    return fault("frictionStiffness", values.frictionStiffness, " N/m",
                 "above 0 with a frictionLimit");
  }
  if (stepper::has_stop_without_stiffness(values)) {
    return fault("stopStiffness", values.stopStiffness, " N/m^1.5", "above 0 with a stop");
  }
  for (const auto& [name, value] : {std::pair{"clearanceMinus", values.clearanceMinus},
                                    std::pair{"clearancePlus", values.clearancePlus}}) {
    if (!(value >= 0)) return fault(name, value, " m", "0 or above");
  }
  if (!stepper::is_finite(values.axis)) {
    return fault("axis (its length)", values.axis.norm(), "", "1");
  }
  if (!stepper::is_finite(values.offset)) {
    return fault("offset (its length)", values.offset.norm(), " m", "finite");
  }
  return std::nullopt;
}

Fault fault_of_beam(const yade::Scene& scene, const BeamBond& bond) {
  if (!allows(ValueRange::positive, scene.dt)) return fault_of_scene(scene);
  for (const int id : {bond.id1, bond.id2}) {
    if (Fault fault = fault_of_body(scene, id)) return fault;
  }
  const stepper::BeamBond& values = bond;
  const auto* wrong_one =
      stepper::first_invalid<stepper::BeamBond>(stepper::beam_quantities, values);
  if (!wrong_one) return std::nullopt;
  const std::string name = std::string(BeamBond::class_name) + "." + wrong_one->name;
  return failure(scene, Part::beam, bond.id1, bond.id2, name + " of ",
                 wrong(values.*wrong_one->value, std::string(" ") + wrong_one->unit,
                       range_text(wrong_one->allowed)),
                 not_allowed(name, values.*wrong_one->value, range_text(wrong_one->allowed)));
}

Fault fault_of_scene(const yade::Scene& scene) {
  if (!allows(ValueRange::positive, scene.dt)) {
    return failure(scene, Part::scene, -1, -1,
                   "the time step O.dt" + wrong(scene.dt, " s", range_text(ValueRange::positive)),
                   "", not_allowed("O.dt", scene.dt, range_text(ValueRange::positive)));
  }
  for (std::size_t i = 0; i < number_of_bodies(scene); ++i) {
    const auto& body = body_at(scene, i);
    if (!body || !known_cast<const ThermalShape>(body->shape.get())) continue;
    if (Fault fault = fault_of_body(scene, static_cast<int>(i))) return fault;
  }
  for (std::size_t i = 0; i < number_of_interactions(scene); ++i) {
    if (Fault fault = fault_of_physics(scene, interaction_at(scene, i))) return fault;
  }
  return first_of(scene.engines,
                  [&](const auto& engine) { return fault_of_engine(scene, *engine); });
}

Fault fault_of_contact(const yade::Scene& scene, const yade::Interaction& contact) {
  if (!allows(ValueRange::positive, scene.dt)) return fault_of_scene(scene);
  for (const int id : {contact.id1, contact.id2}) {
    if (Fault fault = fault_of_body(scene, id)) return fault;
  }
  return fault_of_physics(scene, contact);
}

Fault fault_of_link(const yade::Scene& scene, const ThermalLink& link) {
  if (!allows(ValueRange::positive, scene.dt)) return fault_of_scene(scene);
  for (const int id : {link.id1, link.id2}) {
    if (Fault fault = fault_of_body(scene, id)) return fault;
  }
  return fault_of_values(scene, link);
}

void fail_strain(const yade::Scene& scene, int id, Real strain, Real expansion) {
  if (Fault fault = fault_of_body(scene, id)) throw_failure(*std::move(fault));
  throw_failure(failure(
      scene, Part::body, id, -1, "the thermal strain of ",
      wrong(strain, "", "above -1") + ", with thermalExpansion " + text_of(expansion) + " 1/K",
      {"no_length", "thermal strain", text_of(strain), "above -1"}));
}

void fail_answer(Real stiffness, const Vector3r& force, const yade::Scene& scene,
                 const yade::Interaction& contact) {
  record_failure({"law_not_finite", "force", text_of(force), "finite"},
                 "the law answers with a normal stiffness of " + text_of(stiffness) +
                     " N/m and a force of " + text_of(force) + " N, allowed is finite",
                 scene, contact);
}

void fail_force(const yade::Scene& scene, int id, const Vector3r& force) {
  if (Fault fault = fault_of_body(scene, id)) throw_failure(*std::move(fault));
  throw_failure(of_body(scene, id, "force", force, " N", range_text(ValueRange::finite)));
}

}  // namespace statejump::dem
