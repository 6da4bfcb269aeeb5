// SPDX-License-Identifier: GPL-3.0-or-later
#include "thermal.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <sstream>
#include <unordered_set>
#include <utility>

#include "blocked_motion.hpp"
#include "bore.hpp"
#include "contact_parts.hpp"
#include "failure.hpp"
#include "faults.hpp"
#include "joint.hpp"
#include "prismatic.hpp"
#include "ranges.hpp"
#include "shapes.hpp"
#include "statejump/kernel/stable_step.hpp"
#include "statejump/stepper/checks.hpp"
#include "torsion.hpp"

namespace statejump::dem {
namespace {

// Names in O.energy; stored as strings, because the tracker takes strings in every step.
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
  std::ostringstream before, after;
  before.precision(6);
  after.precision(6);
  before << "the time step " << scene.dt << " s is above the stable one of ";
  after << ", " << stable << " s";
  throw_failure({Failure::Part::link, link.id1, link.id2, before.str(), after.str(), scene.time,
                 stable, when(scene)});
}

// Ends coincide, or their distance is not finite.
[[gnu::cold, gnu::noinline]] void fail_length(const yade::Scene& scene, const ThermalLink& link,
                                              Real length) {
  throw_fault(scene, link);
  const char* const what =
      length == 0 ? "the two ends coincide of " : "the positions have no finite distance of ";
  throw_failure({Failure::Part::link, link.id1, link.id2, what, "", scene.time,
                 std::numeric_limits<Real>::quiet_NaN(), when(scene)});
}

// The temperature gives the link no positive length, or its force is not finite.
[[gnu::cold, gnu::noinline]] void fail_force(const yade::Scene& scene, const ThermalLink& link,
                                             const stepper::LinkStep& step) {
  throw_fault(scene, link);
  std::ostringstream before;
  before.precision(9);
  if (step.stress_free_length > 0) {
    before << "the tension is " << step.tension << " N, allowed is finite, of ";
  } else {
    before << "the stress-free length is " << step.stress_free_length
           << " m, allowed is above 0, with thermalExpansion " << link.thermalExpansion
           << " 1/K of ";
  }
  throw_failure({Failure::Part::link, link.id1, link.id2, before.str(), "", scene.time,
                 std::numeric_limits<Real>::quiet_NaN(), when(scene)});
}

}  // namespace

yade::Body& body_of(const yade::Scene& scene, int id, const char* who) {
  if (!scene.bodies->exists(id)) {
    throw std::invalid_argument(std::string(who) + ": there is no body " + std::to_string(id));
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
  program.validate();
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
      throw std::invalid_argument("ThermalExpansionEngine.ids: body " + std::to_string(body.id) +
                                  " needs a ThermalShape and a ThermalFrictMat");
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
  if (!program) throw std::invalid_argument("ThermalExpansionEngine.program is missing");
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
  // Only a tip that rotates with its link needs the moments of the step. The sum over threads would
  // cost as much as the rest of this engine.
  bool needs_moments = false;
  for (const auto& link : links) {
    if (!link) throw std::invalid_argument("ThermalLinks.links holds None");
    needs_moments = needs_moments || link->tipTurnsWithLink;
  }
  // All moments are read before the first force, because adding one makes YADE require another sum.
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
  if (!link.program) throw std::invalid_argument("ThermalLink.program is missing");
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
      throw std::invalid_argument("ThermalLink.tipTurnsWithLink: block the rotations of body " +
                                  std::to_string(link.id2) + " (blockedDOFs containing 'XYZ')");
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

namespace {

// Acceleration of a body by a unit force with the given arm [1/kg]: along the force, and through
// the rotation if the body may rotate. Zero for an arm that does not rotate it.
Real mobility(const yade::State& state, Real arm_squared) {
  Real smallest_inertia = 0;
  for (int i = 0; i < 3; ++i) {
    const bool free = !(state.blockedDOFs & (8u << i));
    if (free && state.inertia[i] > 0 &&
        (smallest_inertia == 0 || state.inertia[i] < smallest_inertia)) {
      smallest_inertia = state.inertia[i];
    }
  }
  return inverse_mass(state) + (smallest_inertia > 0 ? arm_squared / smallest_inertia : 0);
}

}  // namespace

// Let s be the stretch of a spring of stiffness k between two bodies. Then s^2 <= 2 (s1^2 + s2^2)
// and s_i^2 <= mobility_i * 2 * (kinetic energy per unit rate squared). So the largest eigenvalue
// is at most the largest sum of 2 k mobility over the springs of one body.
double stable_time_step(const yade::Scene& scene) {
  const std::size_t count = number_of_bodies(scene);
  std::vector<Real> stiffness(count, 0);  // per mass
  std::vector<Real> damping(count, 0);    // per mass
  const auto touch = [&](int id, Real mobility_of_body, Real k, Real c) {
    stiffness[static_cast<std::size_t>(id)] += mobility_of_body * k;
    damping[static_cast<std::size_t>(id)] += mobility_of_body * c;
  };
  const auto touch_at = [&](const yade::Interaction& contact, const JointGeom& geometry,
                            const JointPhys& physics) {
    const Real normal_damping =
        kernel::viscous_damping(physics.normalDampingRatio, physics.effectiveMass, physics.kn) +
        physics.dissipationSlope;
    const Real tangential_damping =
        kernel::viscous_damping(physics.tangentialDampingRatio, physics.effectiveMass, physics.ks) +
        physics.frictionSlope;
    for (const int id : {contact.id1, contact.id2}) {
      const yade::State& state = *body_of(scene, id, "stable_time_step").state;
      const Vector3r arm = geometry.contactPoint - state.se3.position;
      touch(id, mobility(state, arm.cross(geometry.normal).squaredNorm()), physics.kn,
            normal_damping);
      touch(id, mobility(state, arm.squaredNorm()), physics.ks, tangential_damping);
    }
  };
  for (std::size_t i = 0; i < number_of_interactions(scene); ++i) {
    const yade::Interaction& contact = interaction_at(scene, i);
    if (!contact.isReal()) continue;
    if (const auto* pair = dynamic_cast<const BoreGeom*>(contact.geom.get())) {
      const auto* all = dynamic_cast<const BorePhys*>(contact.phys.get());
      for (std::size_t k = 0; all && k < std::min(pair->contacts.size(), all->contacts.size());
           ++k) {
        if (pair->contacts[k]->penetrationDepth > 0) {
          touch_at(contact, *pair->contacts[k], *all->contacts[k]);
        }
      }
      continue;
    }
    const auto* physics = dynamic_cast<const JointPhys*>(contact.phys.get());
    const auto* geometry = dynamic_cast<const JointGeom*>(contact.geom.get());
    if (physics && geometry) touch_at(contact, *geometry, *physics);
  }
  for (const auto& engine : scene.engines) {
    if (const auto* group = dynamic_cast<const ThermalLinks*>(engine.get())) {
      for (const auto& link : group->links) {
        if (!link) continue;
        const yade::State& root = *body_of(scene, link->id1, "ThermalLink.id1").state;
        const yade::State& tip = *body_of(scene, link->id2, "ThermalLink.id2").state;
        const Real length = link->stressFreeLength;
        const Real k = link->youngModulus * link->crossSectionArea / length;
        const Real c = stepper::damping_coefficient(*link, inverse_mass(root) + inverse_mass(tip)) +
                       link->pinDamping / (length * length);
        touch(link->id1, inverse_mass(root), k, c);
        touch(link->id2, inverse_mass(tip), k, c);
      }
    } else if (const auto* springs = dynamic_cast<const TorsionSprings*>(engine.get())) {
      for (const auto& spring : springs->springs) {
        if (!spring || !spring->link1 || !spring->link2) continue;
        // The angle is the sum of up to four displacements over their lengths. So its square is at
        // most the number of moving ends times the sum of the squares; the common factor 2 is
        // applied later.
        const std::array<LinkEnds, 2> links = {ends_of(scene, *spring->link1),
                                               ends_of(scene, *spring->link2)};
        int moving = 0;
        for (const LinkEnds& ends : links) {
          moving += (inverse_mass(ends.root) > 0) + (inverse_mass(ends.tip) > 0);
        }
        for (int i = 0; i < 2; ++i) {
          const ThermalLink& link = i == 0 ? *spring->link1 : *spring->link2;
          const Real k = 0.5 * moving * stepper::largest_stiffness(*spring) /
                         (links[i].span.length * links[i].span.length);
          touch(link.id1, inverse_mass(links[i].root), k, 0);
          touch(link.id2, inverse_mass(links[i].tip), k, 0);
        }
      }
    } else if (const auto* joints = dynamic_cast<const PrismaticJoints*>(engine.get())) {
      for (const auto& joint : joints->joints) {
        if (!joint) continue;
        const Real one = inverse_mass(*body_of(scene, joint->id1, "PrismaticJoint.id1").state);
        const Real two = inverse_mass(*body_of(scene, joint->id2, "PrismaticJoint.id2").state);
        const Real k = stepper::largest_stiffness(*joint);
        const Real c = one + two > 0 ? stepper::largest_damping(*joint, 1 / (one + two)) : 0;
        touch(joint->id1, one, k, c);
        touch(joint->id2, two, k, c);
      }
    }
  }
  double smallest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < count; ++i) {
    smallest = std::min(smallest, kernel::critical_time_step(1, 2 * stiffness[i], 2 * damping[i]));
  }
  return smallest;
}

}  // namespace statejump::dem
