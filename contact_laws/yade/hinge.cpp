// SPDX-License-Identifier: GPL-3.0-or-later
#include "hinge.hpp"

#include <cmath>
#include <string>

#include "faults.hpp"
#include "ranges.hpp"
#include "statejump/kernel/stable_step.hpp"
#include "statejump/stepper/checks.hpp"
#include "thermal.hpp"

namespace statejump::dem {
namespace {

const std::string hinge_elastic = "torsionElastic";
const std::string hinge_friction = "torsionFriction";
constexpr Real half_turn = 3.14159265358979323846;
constexpr auto hinge_part = Failure::Part::hinge;

stepper::HingeBody body_at_hinge(const yade::Scene& scene, int id, const char* who) {
  const yade::State& state = *body_of(scene, id, who).state;
  auto& forces = const_cast<yade::ForceContainer&>(scene.forces);  // its getters are not const
  return {state.se3.position,
          state.vel,
          state.angVel,
          forces.getForce(id),
          forces.getTorque(id),
          state.se3.orientation,
          state.mass,
          state.inertia[0],
          state.blockedDOFs};
}

[[noreturn, gnu::cold]] void fail(const yade::Scene& scene, const HingeBond& hinge,
                                  Failure failure) {
  if (auto fault = fault_of_hinge(scene, hinge)) throw_failure(*std::move(fault));
  throw_failure(std::move(failure));
}

}  // namespace

void HingeBond::check() const {
  require_settable<stepper::Torsion>(class_name, stepper::torsion_quantities, *this);
  if (!(freeAngle > -half_turn && freeAngle <= half_turn)) {
    refuse(class_name, "freeAngle", freeAngle, "in (-pi, pi] [rad]");
  }
  require_unit(class_name, "axis", axis);
}

void HingeBonds::action() {
  begin(*scene);
  scene->forces.sync();
  // Reads all bodies before adding the first force. After an addition, YADE requires another sum
  // over threads.
  bodies_.clear();
  for (const auto& hinge : hinges) {
    if (!hinge) refuse({"holds_none", "HingeBonds.hinges"});
    if (hinge->id1 == hinge->id2) {
      refuse({"same_body", "HingeBond.id2", std::to_string(hinge->id2), "id1"});
    }
    bodies_.push_back(body_at_hinge(*scene, hinge->id1, "HingeBond.id1"));
    bodies_.push_back(body_at_hinge(*scene, hinge->id2, "HingeBond.id2"));
  }
  for (std::size_t i = 0; i < hinges.size(); ++i) {
    act(*hinges[i], bodies_[2 * i], bodies_[2 * i + 1]);
  }
}

void HingeBonds::act(HingeBond& hinge, stepper::HingeBody& one, stepper::HingeBody& two) {
  if (!stepper::can_hold(one, two, one.orientation * hinge.axis)) {
    refuse({"rotations_held", "HingeBond.id2", std::to_string(hinge.id2)});
  }
  if (stepper::has_friction_without_stiffness(hinge)) {
    fail(*scene, hinge,
         failure(*scene, hinge_part, hinge.id1, hinge.id2, "a stiffness is missing of ", "",
                 {"stiffness_missing"}));
  }
  const std::array<Vector3r, 4> before = {one.force, one.torque, two.force, two.torque};
  const Vector3r axis = stepper::hold_together(one, two, hinge.axis);
  const stepper::TorsionEnergy energy = stepper::hinge_law(hinge, one, two, axis);
  one.torque += hinge.moment * axis;
  two.torque -= hinge.moment * axis;
  const Real inverse = (one.inertia > 0 ? 1 / one.inertia : 0) + (two.inertia > 0 ? 1 / two.inertia : 0);
  if (inverse > 0) {
    const Real stable = kernel::critical_time_step(1 / inverse, stepper::largest_stiffness(hinge));
    if (!(scene->dt <= stable)) {
      fail(*scene, hinge, unstable_time_step(*scene, hinge_part, hinge.id1, hinge.id2, stable));
    }
  }
  if (!std::isfinite(hinge.moment) || !stepper::is_finite_fast(one.force)) {
    fail(*scene, hinge,
         failure(*scene, hinge_part, hinge.id1, hinge.id2, "the moment is not finite of ", "",
                 {"not_finite", "moment"}));
  }
  const std::array<const stepper::HingeBody*, 2> held = {&one, &two};
  const std::array<int, 2> ids = {hinge.id1, hinge.id2};
  for (std::size_t i = 0; i < 2; ++i) {
    yade::State& state = *body_of(*scene, ids[i], "HingeBond").state;
    state.se3.position = held[i]->position;
    state.se3.orientation = held[i]->orientation;
    state.vel = held[i]->velocity;
    state.angVel = held[i]->spin;
    scene->forces.addForce(ids[i], held[i]->force - before[2 * i]);
    scene->forces.addTorque(ids[i], held[i]->torque - before[2 * i + 1]);
  }
  if (scene->trackEnergy) {
    scene->energy->add(energy.elastic, hinge_elastic, elastic_id_, true);
    if (hinge.frictionLimit > 0) {
      scene->energy->add(energy.friction, hinge_friction, friction_id_, false);
    }
  }
}

}  // namespace statejump::dem
