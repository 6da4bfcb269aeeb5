// SPDX-License-Identifier: GPL-3.0-or-later
#include "thermal.hpp"

#include <sstream>
#include <stdexcept>
#include <string>
#include <unordered_set>
#include <utility>

#include "blocked_motion.hpp"
#include "contact_parts.hpp"
#include "failure.hpp"
#include "faults.hpp"
#include "ranges.hpp"
#include "shapes.hpp"
#include "statejump/stepper/checks.hpp"

namespace statejump::dem {
namespace {

// These names of O.energy are stored as strings, because the tracker needs a std::string in every
// step.
const std::string link_elastic = "linkElastic";
const std::string link_damping = "linkDamping";
const std::string link_thermal_work = "linkThermalWork";
const std::string pin_damping = "pinDamping";

// Throws if a number of the link or of its bodies is invalid.
void throw_fault(const yade::Scene& scene, const ThermalLink& link) {
  if (auto fault = fault_of_link(scene, link)) throw_failure(*std::move(fault));
}

[[gnu::cold, gnu::noinline]] void refuse_time_step(const yade::Scene& scene,
                                                   const ThermalLink& link, Real stable) {
  throw_fault(scene, link);
  throw_failure(unstable_time_step(scene, Failure::Part::link, link.id1, link.id2, stable));
}

// Throws because the ends coincide or their distance is not finite.
[[gnu::cold, gnu::noinline]] void fail_length(const yade::Scene& scene, const ThermalLink& link,
                                              Real length) {
  throw_fault(scene, link);
  const char* const what =
      length == 0 ? "the two ends coincide of " : "the positions have no finite distance of ";
  throw_failure(failure(scene, Failure::Part::link, link.id1, link.id2, what, "",
                        {length == 0 ? "ends_coincide" : "distance_not_finite"}));
}

// Throws the failure that the stress-free length at this temperature is not positive or the force
// is not finite.
[[gnu::cold, gnu::noinline]] void fail_force(const yade::Scene& scene, const ThermalLink& link,
                                             const stepper::LinkStep& step) {
  throw_fault(scene, link);
  std::ostringstream before;
  before.precision(9);
  FailureDetail detail;
  if (step.stress_free_length > 0) {
    detail = {"not_finite", "tension", text_of(step.tension), "finite"};
    before << "the tension is " << step.tension << " N, allowed is finite, of ";
  } else {
    detail = {"no_length", "stress-free length", text_of(step.stress_free_length), "above 0"};
    before << "the stress-free length is " << step.stress_free_length
           << " m, allowed is above 0, with thermalExpansion " << link.thermalExpansion
           << " 1/K of ";
  }
  throw_failure(failure(scene, Failure::Part::link, link.id1, link.id2, before.str(), "", detail));
}

}  // namespace

yade::Body& body_of(const yade::Scene& scene, int id, const char* who) {
  if (!scene.bodies->exists(id)) {
    refuse({"no_body", who, std::to_string(id)});
  }
  return *body_at(scene, static_cast<std::size_t>(id));
}

LinkEnds ends_of(const yade::Scene& scene, const ThermalLink& link) {
  yade::State& root = *body_of(scene, link.id1, "ThermalLink.id1").state;
  yade::State& tip = *body_of(scene, link.id2, "ThermalLink.id2").state;
  const stepper::Span span = stepper::span_of(root.se3.position, tip.se3.position);
  if (!span.is_proper()) fail_length(scene, link, span.length);
  return {root, tip, span};
}

Real LinkEnds::inverse_mass() const {
  return dem::inverse_mass(root) + dem::inverse_mass(tip);
}

void ThermalProgram::check() {
  thermal::Program program;
  program.shape = thermal::shape_of(shape);
  program.temperature_change_max = temperatureChangeMax;
  program.period = period;
  program.cycles = cycles;
  program.table_times = tableTimes;
  program.table_temperature_changes = tableTemperatureChanges;
  try {
    program.validate();
  } catch (const kernel::OutOfRange& refused) {
    keep({"not_allowed", std::string(class_name) + "." + refused.name(), refused.value(),
          refused.range(), refused.what()});
    throw;
  }
  program_ = program;
}

const thermal::Program& ThermalProgram::program() const {
  if (!program_) throw std::logic_error("ThermalProgram: construct it with its attributes");
  return *program_;
}

void ThermalExpansionEngine::collect_targets() {
  targets_.clear();
  std::unordered_set<const ThermalShape*> shapes;
  const auto add = [&](yade::Body& body, bool required) {
    auto* shape = dynamic_cast<ThermalShape*>(body.shape.get());
    const auto* material = dynamic_cast<const ThermalFrictMat*>(body.material.get());
    if (shape && material) {
      targets_.push_back(
          {static_cast<std::size_t>(body.id), shape, material, !shapes.insert(shape).second});
    } else if (required) {
      refuse({"no_thermal_body", "ThermalExpansionEngine.ids", std::to_string(body.id)});
    }
  };
  if (ids.empty()) {
    for (std::size_t i = 0; i < number_of_bodies(*scene); ++i) {
      if (const auto& body = body_at(*scene, i)) add(*body, false);
    }
  } else {
    for (const int id : ids) add(body_of(*scene, id, "ThermalExpansionEngine.ids"), true);
  }
  collected_ids_ = ids;
  number_of_bodies_ = number_of_bodies(*scene);
}

bool ThermalExpansionEngine::collected() const {
  if (number_of_bodies_ != number_of_bodies(*scene) || collected_ids_ != ids) return false;
  for (const Target& target : targets_) {
    const auto& body = body_at(*scene, target.id);
    if (!body || body->shape.get() != target.shape || body->material.get() != target.material) {
      return false;
    }
  }
  return true;
}

const std::vector<ThermalExpansionEngine::Target>& ThermalExpansionEngine::targets() {
  if (!collected()) collect_targets();
  return targets_;
}

void ThermalExpansionEngine::action() {
  begin(*scene);
  if (!program) refuse({"missing", "ThermalExpansionEngine.program"});
  temperatureChange = program->temperature_change(scene->time);
  for (const Target& target : targets()) {
    if (target.is_shared) continue;
    const Real strain = target.material->thermalExpansion * temperatureChange;
    if (!stepper::is_small_strain(strain) && !stepper::is_strain(strain)) {
      fail_strain(*scene, static_cast<int>(target.id), strain, target.material->thermalExpansion);
    }
    target.shape->thermalStrainRate = (strain - target.shape->thermalStrain) / scene->dt;
    target.shape->thermalStrain = strain;
  }
}

void ThermalLink::check() const {
  require_settable<stepper::Link>(class_name, stepper::link_quantities, *this);
}

void ThermalLinks::action() {
  begin(*scene);
  // Only a tip that rotates with its link needs the moments of this step. Summing them over threads
  // costs as much as the rest of this engine.
  bool needs_moments = false;
  for (const auto& link : links) {
    if (!link) refuse({"holds_none", "ThermalLinks.links"});
    needs_moments = needs_moments || link->tipTurnsWithLink;
  }
  // Reads all moments before adding the first force. After an addition, YADE requires another sum
  // over threads.
  moments_.assign(links.size(), Vector3r::Zero());
  if (needs_moments) {
    scene->forces.sync();
    for (std::size_t i = 0; i < links.size(); ++i) {
      if (links[i]->tipTurnsWithLink) moments_[i] = scene->forces.getTorque(links[i]->id2);
    }
  }
  for (std::size_t i = 0; i < links.size(); ++i) act(*links[i], moments_[i]);
}

void ThermalLinks::act(ThermalLink& link, const Vector3r& moment) {
  if (!link.program) refuse({"missing", "ThermalLink.program"});
  const LinkEnds ends = ends_of(*scene, link);
  const Real inverse = ends.inverse_mass();
  const stepper::LinkStep step = stepper::link_step(
      link, ends.span, ends.root.vel, ends.tip.vel, link.program->temperature_change(scene->time),
      [&] { return link.program->temperature_rate(scene->time); },
      stepper::damping_coefficient(link, inverse), scene->time);
  if (inverse > 0) {
    const Real stable = stepper::stable_step(step, inverse);
    if (!(scene->dt <= stable)) refuse_time_step(*scene, link, stable);
  }
  Vector3r force_on_tip = stepper::force_on_tip(step);
  if (!stepper::is_finite_fast(step, force_on_tip)) fail_force(*scene, link, step);
  if (link.tipTurnsWithLink) {
    yade::State& tip = ends.tip;
    if ((tip.blockedDOFs & all_rotations_blocked) != all_rotations_blocked) {
      refuse({"rotations_free", "ThermalLink.tipTurnsWithLink", std::to_string(link.id2)});
    }
    force_on_tip += stepper::rotate_tip(link, step, moment, tip.se3.orientation, tip.angVel);
  }
  scene->forces.addForce(link.id2, force_on_tip);
  scene->forces.addForce(link.id1, -force_on_tip);

  if (scene->trackEnergy) {
    Real softening = stepper::previous_softening(link);
    const stepper::LinkEnergy energy = stepper::energy(link, step, scene->dt, softening);
    scene->energy->add(energy.elastic, link_elastic, energy_ids_[0], true);
    scene->energy->add(energy.damping, link_damping, energy_ids_[1], false);
    scene->energy->add(energy.pin_damping, pin_damping, energy_ids_[3], false);
    if (energy.works) {
      scene->energy->add(energy.thermal_work, link_thermal_work, energy_ids_[2], false);
    }
  }
  stepper::keep(link, step, scene->time);
}

}  // namespace statejump::dem
