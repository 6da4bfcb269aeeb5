// SPDX-License-Identifier: GPL-3.0-or-later
#include "beam.hpp"

#include <cmath>
#include <string>
#include <utility>

#include "blocked_motion.hpp"
#include "faults.hpp"
#include "ranges.hpp"
#include "statejump/stepper/checks.hpp"

namespace statejump::dem {
namespace {

// These names of O.energy are stored as strings, because the tracker needs a std::string in every
// step.
const std::string beam_elastic = "beamElastic";
const std::string beam_damping = "beamDamping";
const std::string beam_thermal_work = "beamThermalWork";

constexpr auto beam_part = Failure::Part::beam;

[[noreturn, gnu::cold]] void fail(const yade::Scene& scene, const BeamBond& bond, Failure failure) {
  // If a number of the bond or of its bodies is invalid, it is the cause and is reported instead.
  if (auto fault = fault_of_beam(scene, bond)) throw_failure(*std::move(fault));
  throw_failure(std::move(failure));
}

[[noreturn, gnu::cold]] void fail(const yade::Scene& scene, const BeamBond& bond,
                                  const FailureDetail& detail, const std::string& before,
                                  const std::string& after = "") {
  fail(scene, bond, failure(scene, beam_part, bond.id1, bond.id2, before, after, detail));
}

// Throws if the state is outside the range of the theory.
void check_step(const yade::Scene& scene, const BeamBond& bond, const stepper::BondStep& step) {
  if (!(step.stress_free_length > 0)) {
    fail(scene, bond,
         {"no_length", "stress-free length", text_of(step.stress_free_length), "above 0"},
         "the stress-free length is " + text_of(step.stress_free_length) +
             " m, allowed is above 0, of ");
  }
  if (!stepper::is_finite_fast(step.force) || !stepper::is_finite_fast(step.moment1) ||
      !stepper::is_finite_fast(step.moment2)) {
    fail(scene, bond, {"not_finite", "force"}, "the force is not finite of ");
  }
  if (step.buckles) {
    fail(scene, bond, {"beam_buckles", "axial force", text_of(bond.force2[0])},
         "the axial force " + text_of(bond.force2[0]) +
             " N exceeds the buckling load with released ends of ");
  }
  if (!(step.largest_rotation <= kernel::BeamStep::largest_rotation)) {
    fail(scene, bond, {"beam_rotation", "rotation", text_of(step.largest_rotation), "at most 1"},
         "an end rotates by " + text_of(step.largest_rotation) +
             " rad relative to the beam, allowed is at most 1, of ");
  }
  if (!(scene.dt <= step.stable_step)) {
    fail(scene, bond, unstable_time_step(scene, beam_part, bond.id1, bond.id2, step.stable_step));
  }
}

}  // namespace

void BeamBond::check() {
  require_settable<stepper::BeamBond>(class_name, stepper::beam_quantities, *this);
  for (const auto& [name, value] : {std::pair{"shearStiffnessY", shearStiffnessY},
                                    std::pair{"shearStiffnessZ", shearStiffnessZ}}) {
    if (!(value > 0)) refuse(class_name, name, value, "above 0 [N]");
  }
  for (const auto& [name, letters] :
       {std::pair{"released1", released1}, std::pair{"released2", released2}}) {
    if (!stepper::are_releases(letters)) refuse(class_name, name, letters, "letters of 'xXYZ'");
  }
  for (const auto& [name, axis] : {std::pair{"axisX", axisX}, std::pair{"axisY", axisY}}) {
    if (!axis.isZero(0)) require_unit(class_name, name, axis);
  }
  if (!(std::abs(axisX.dot(axisY)) <= 1e-9)) {
    refuse(class_name, "axisY", axisX.dot(axisY), "across axisX: their product 0 [-]");
  }
  for (const auto& [name, offset] :
       {std::pair{"offset1", offset1}, std::pair{"offset2", offset2}}) {
    if (!stepper::is_finite(offset)) refuse(class_name, name, offset.norm(), "finite [m]");
  }
  placed_.reset();
}

const kernel::PlacedBeam& BeamBond::beam(const yade::State& one, const Vector3r& along) {
  if (placed_) return *placed_;
  if (axisX.isZero(0)) axisX = one.se3.orientation.conjugate() * along.normalized();
  const Real tilt = axisX.dot(axisY);
  if (!(std::abs(tilt) <= 1e-9) || axisY.isZero(0)) {
    refuse(class_name, "axisY", tilt, "a unit vector across the beam: product with axisX 0 [-]");
  }
  placed_ = stepper::placed(*this);
  return *placed_;
}

stepper::Mobility mobility_of(const yade::State& state) {
  Real smallest = 0;
  for (int i = 0; i < 3; ++i) {
    const bool blocked = (state.blockedDOFs & (8U << i)) != 0;
    if (blocked || !(state.inertia[i] > 0)) continue;
    if (smallest == 0 || state.inertia[i] < smallest) smallest = state.inertia[i];
  }
  return {inverse_mass(state), smallest > 0 ? 1 / smallest : 0};
}

void BeamBonds::action() {
  begin(*scene);
  for (const auto& bond : bonds) {
    if (!bond) refuse({"holds_none", "BeamBonds.bonds"});
    act(*bond);
  }
}

void BeamBonds::act(BeamBond& bond) {
  if (!bond.program) refuse({"missing", "BeamBond.program"});
  const yade::State& one = *body_of(*scene, bond.id1, "BeamBond.id1").state;
  const yade::State& two = *body_of(*scene, bond.id2, "BeamBond.id2").state;
  if (bond.id1 == bond.id2) {
    refuse({"same_body", "BeamBond.id2", std::to_string(bond.id2), "id1"});
  }
  const Vector3r along = two.se3.position + two.se3.orientation * bond.offset2 - one.se3.position -
                         one.se3.orientation * bond.offset1;
  const Real length = along.norm();
  if (!(length > 0) || !std::isfinite(length)) {
    fail(*scene, bond, {length == 0 ? "ends_coincide" : "distance_not_finite"},
         length == 0 ? "the two ends coincide of " : "the positions have no finite distance of ");
  }
  const Real gradient =
      bond.gradientProgram ? bond.gradientProgram->temperature_change(scene->time) : 0;
  const stepper::BondStep step = stepper::bond_step(
      bond, bond.beam(one, along),
      {one.se3.position, one.vel, one.angVel, one.se3.orientation, mobility_of(one)},
      {two.se3.position, two.vel, two.angVel, two.se3.orientation, mobility_of(two)},
      bond.program->temperature_change(scene->time), gradient, scene->time);
  check_step(*scene, bond, step);
  scene->forces.addForce(bond.id2, step.force);
  scene->forces.addForce(bond.id1, -step.force);
  scene->forces.addTorque(bond.id1, step.moment1);
  scene->forces.addTorque(bond.id2, step.moment2);

  if (scene->trackEnergy) {
    scene->energy->add(step.elastic, beam_elastic, energy_ids_[0], true);
    if (step.works) {
      scene->energy->add(step.damping, beam_damping, energy_ids_[1], false);
      scene->energy->add(step.thermal_work, beam_thermal_work, energy_ids_[2], false);
    }
  }
}

}  // namespace statejump::dem
