// SPDX-License-Identifier: GPL-3.0-or-later
#include "prismatic.hpp"

#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include "blocked_motion.hpp"
#include "contact_parts.hpp"
#include "faults.hpp"
#include "ranges.hpp"
#include "statejump/stepper/checks.hpp"
#include "thermal.hpp"

namespace statejump::dem {
namespace {

// These names of O.energy are stored as strings, because the tracker needs a std::string in every
// step.
const std::string prismatic_elastic = "prismaticElastic";
const std::string prismatic_friction = "prismaticFriction";
const std::string prismatic_damping = "prismaticDamping";

constexpr auto part = Failure::Part::prismatic_joint;

[[noreturn, gnu::cold]] void fail(const yade::Scene& scene, const PrismaticJoint& joint,
                                  Failure failure) {
  // If a number of the joint or of its bodies is invalid, it is the cause and is reported instead.
  if (auto fault = fault_of_prismatic(scene, joint)) throw_failure(*std::move(fault));
  throw_failure(std::move(failure));
}

[[noreturn, gnu::cold]] void fail(const yade::Scene& scene, const PrismaticJoint& joint,
                                  const FailureDetail& detail, const std::string& before) {
  fail(scene, joint, failure(scene, part, joint.id1, joint.id2, before, "", detail));
}

}  // namespace

void PrismaticJoint::check() const {
  require_settable<stepper::Prismatic>(class_name, stepper::prismatic_quantities, *this);
  for (const auto& [name, value] :
       {std::pair{"clearanceMinus", clearanceMinus}, std::pair{"clearancePlus", clearancePlus}}) {
    if (!(value >= 0)) refuse(class_name, name, value, "0 or above [m]");
  }
  require_unit(class_name, "axis", axis);
  if (!stepper::is_finite(offset)) refuse(class_name, "offset", offset.norm(), "finite [m]");
}

void PrismaticJoints::action() {
  begin(*scene);
  for (const auto& joint : joints) {
    if (!joint) refuse({"holds_none", "PrismaticJoints.joints"});
    act(*joint);
  }
}

void PrismaticJoints::act(PrismaticJoint& joint) {
  const yade::State& one = *body_of(*scene, joint.id1, "PrismaticJoint.id1").state;
  const yade::State& two = *body_of(*scene, joint.id2, "PrismaticJoint.id2").state;
  if (joint.id1 == joint.id2) {
    refuse({"same_body", "PrismaticJoint.id2", std::to_string(joint.id2), "id1"});
  }
  if (stepper::has_friction_without_stiffness(joint) ||
      stepper::has_stop_without_stiffness(joint)) {
    fail(*scene, joint, {"stiffness_missing"}, "a stiffness is missing of ");
  }
  const Real inverse = inverse_mass(one) + inverse_mass(two);
  const stepper::PrismaticStep step = stepper::prismatic_step(
      joint,
      {one.se3.position - two.se3.position, one.vel - two.vel, inverse > 0 ? 1 / inverse : 0},
      scene->dt);
  if (!(scene->dt <= step.largest_step)) {
    fail(*scene, joint, unstable_time_step(*scene, part, joint.id1, joint.id2, step.largest_step));
  }
  if (!stepper::is_finite_fast(step.force)) {
    fail(*scene, joint, {"not_finite", "force"}, "the force is not finite of ");
  }
  scene->forces.addForce(joint.id1, step.force);
  scene->forces.addForce(joint.id2, -step.force);

  if (scene->trackEnergy) {
    scene->energy->add(step.elastic, prismatic_elastic, energy_ids_[0], true);
    scene->energy->add(step.friction, prismatic_friction, energy_ids_[1], false);
    scene->energy->add(step.damping, prismatic_damping, energy_ids_[2], false);
  }
}

}  // namespace statejump::dem
