#include "thermal.hpp"

#include <cmath>
#include <limits>
#include <sstream>

#include "failure.hpp"
#include "joint.hpp"
#include "ranges.hpp"
#include "shapes.hpp"

namespace statejump::dem {
namespace {

constexpr unsigned int all_translations_blocked = 7;
constexpr unsigned int all_rotations_blocked = 56;

yade::Body& body_of(const yade::Scene& scene, int id, const char* who) {
  if (!scene.bodies->exists(id)) {
    throw std::invalid_argument(std::string(who) + ": there is no body " + std::to_string(id));
  }
  return *body_at(scene, static_cast<std::size_t>(id));
}

bool fixed(const yade::State& state) {
  return (state.blockedDOFs & all_translations_blocked) == all_translations_blocked;
}

Real inverse_mass(const yade::State& state) {
  return fixed(state) || !(state.mass > 0) ? 0 : 1 / state.mass;
}

// c = 2 zeta sqrt(k m) with the spring at the reference temperature.
Real damping_coefficient(const ThermalLink& link, const yade::State& root, const yade::State& tip) {
  const Real inverse = inverse_mass(root) + inverse_mass(tip);
  if (!(link.dampingRatio > 0) || !(inverse > 0)) return 0;
  const Real stiffness = link.youngModulus * link.crossSectionArea / link.stressFreeLength;
  return 2 * link.dampingRatio * std::sqrt(stiffness / inverse);
}

}  // namespace

void ThermalProgram::check() {
  kernel::ThermalProgram program;
  program.shape = kernel::thermal_shape(shape);
  program.temperature_change_max = temperatureChangeMax;
  program.period = period;
  program.cycles = cycles;
  program.table_times = tableTimes;
  program.table_temperature_changes = tableTemperatureChanges;
  program.validate();
  program_ = program;
}

const kernel::ThermalProgram& ThermalProgram::program() const {
  if (!program_) throw std::logic_error("ThermalProgram: construct it with its attributes");
  return *program_;
}

void ThermalExpansionEngine::collect_targets() {
  targets_.clear();
  const auto add = [&](yade::Body& body, bool required) {
    auto shape = boost::dynamic_pointer_cast<ThermalShape>(body.shape);
    auto material = boost::dynamic_pointer_cast<ThermalFrictMat>(body.material);
    if (shape && material) {
      targets_.push_back({static_cast<std::size_t>(body.id), shape, material});
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
    if (!body || body->shape != target.shape || body->material != target.material) return false;
  }
  return true;
}

void ThermalExpansionEngine::action() {
  throw_recorded_failure();
  if (!program) throw std::invalid_argument("ThermalExpansionEngine.program is missing");
  if (!collected()) collect_targets();
  temperatureChange = program->temperature_change(scene->time);
  for (const Target& target : targets_) {
    target.shape->thermalStrain = target.material->thermalExpansion * temperatureChange;
  }
}

void ThermalLink::check() const {
  require_not_negative(class_name, "youngModulus", youngModulus, "[Pa]");
  require_not_negative(class_name, "crossSectionArea", crossSectionArea, "[m2]");
  require_not_negative(class_name, "stressFreeLength", stressFreeLength, "[m]");
  require_not_negative(class_name, "dampingRatio", dampingRatio, "[-]");
}

void ThermalLinks::action() {
  throw_recorded_failure();
  scene->forces.sync();
  for (const auto& link : links) {
    if (!link) throw std::invalid_argument("ThermalLinks.links holds None");
    act(*link);
  }
}

// With extension e = L - l_T the tension is N = k_T e + c (L' - l_T'), k_T = E A / l_T, and
//   N L' = d(k_T e^2 / 2)/dt + c (L' - l_T')^2 + [N + k_T e^2 / (2 l_T)] l_T',
// so the thermal work on the link is -integral of [N + k_T e^2 / (2 l_T)] dl_T.
void ThermalLinks::act(ThermalLink& link) {
  yade::State& root = *body_of(*scene, link.id1, "ThermalLink.id1").state;
  yade::State& tip = *body_of(*scene, link.id2, "ThermalLink.id2").state;
  if (!link.program) throw std::invalid_argument("ThermalLink.program is missing");
  require_positive("ThermalLink", "stressFreeLength", link.stressFreeLength, "[m]");

  const Vector3r between = tip.se3.position - root.se3.position;
  const Real length = between.norm();
  if (!(length > 0)) throw std::runtime_error("ThermalLink: the two ends coincide");
  const Vector3r direction = between / length;
  const Vector3r relative_velocity = tip.vel - root.vel;
  const Real length_rate = relative_velocity.dot(direction);

  link.temperatureChange = link.program->temperature_change(scene->time);
  const Real stress_free_length =
      link.stressFreeLength * (1 + link.thermalExpansion * link.temperatureChange);
  const Real stress_free_rate =
      link.stressFreeLength * link.thermalExpansion * link.program->temperature_rate(scene->time);
  const Real stiffness = link.youngModulus * link.crossSectionArea / stress_free_length;
  const Real damping = damping_coefficient(link, root, tip);
  const Real extension = length - stress_free_length;
  const Real extension_rate = length_rate - stress_free_rate;
  const Real tension = stiffness * extension + damping * extension_rate;
  link.axialForce = -tension;

  const Real inverse = inverse_mass(root) + inverse_mass(tip);
  if (inverse > 0 && scene->dt > kernel::critical_time_step(1 / inverse, stiffness, damping)) {
    std::ostringstream text;
    text.precision(6);
    text << "the time step " << scene->dt << " s is above the stable one of the link between "
         << "bodies " << link.id1 << " and " << link.id2 << ", "
         << kernel::critical_time_step(1 / inverse, stiffness, damping) << " s";
    throw std::runtime_error(text.str());
  }

  Vector3r force_on_tip = -tension * direction;
  if (link.tipTurnsWithLink) {
    if ((tip.blockedDOFs & all_rotations_blocked) != all_rotations_blocked) {
      throw std::invalid_argument("ThermalLink.tipTurnsWithLink: block the rotations of body " +
                                  std::to_string(link.id2) + " (blockedDOFs containing 'XYZ')");
    }
    // A couple of forces +-(M x u) / L carries the moment M of the step's contacts, its part along
    // the link excepted: u L x (M x u) / L = M - (M.u) u.
    const Vector3r moment = scene->forces.getTorque(link.id2);
    force_on_tip += moment.cross(direction) / length;
    if (link.tipDirection.isZero()) {
      link.tipDirection = tip.se3.orientation.conjugate() * direction;
    }
    const Vector3r pointing = tip.se3.orientation * link.tipDirection;
    tip.se3.orientation =
        (yade::Quaternionr::FromTwoVectors(pointing, direction) * tip.se3.orientation).normalized();
    tip.angVel = direction.cross(relative_velocity) / length;
  }
  scene->forces.addForce(link.id2, force_on_tip);
  scene->forces.addForce(link.id1, -force_on_tip);

  if (scene->trackEnergy) {
    const Real elastic = 0.5 * stiffness * extension * extension;
    scene->energy->add(elastic, "linkElastic", energy_ids_[0], true);
    scene->energy->add(damping * extension_rate * extension_rate * scene->dt, "linkDamping",
                       energy_ids_[1], false);
    if (link.previousStressFreeLength > 0) {
      const Real previous_elastic = 0.5 * link.youngModulus * link.crossSectionArea /
                                    link.previousStressFreeLength * link.previousExtension *
                                    link.previousExtension;
      const Real mean_tension = 0.5 * (tension + link.previousTension);
      const Real mean_softening =
          0.5 * (elastic / stress_free_length + previous_elastic / link.previousStressFreeLength);
      scene->energy->add(
          -(mean_tension + mean_softening) * (stress_free_length - link.previousStressFreeLength),
          "linkThermalWork", energy_ids_[2], false);
    }
  }
  link.previousTension = tension;
  link.previousExtension = extension;
  link.previousStressFreeLength = stress_free_length;
}

double stable_time_step(const yade::Scene& scene) {
  const std::size_t count = number_of_bodies(scene);
  std::vector<Real> stiffness(count, 0);
  std::vector<Real> damping(count, 0);
  const auto touch = [&](int id1, int id2, Real k, Real c) {
    for (const int id : {id1, id2}) {
      stiffness[static_cast<std::size_t>(id)] += k;
      damping[static_cast<std::size_t>(id)] += c;
    }
  };
  for (std::size_t i = 0; i < number_of_interactions(scene); ++i) {
    const yade::Interaction& contact = interaction_at(scene, i);
    if (!contact.isReal()) continue;
    const auto* physics = dynamic_cast<const JointPhys*>(contact.phys.get());
    if (!physics) continue;
    const Real normal_damping =
        2 * physics->normalDampingRatio * std::sqrt(physics->effectiveMass * physics->kn);
    const Real tangential_damping =
        2 * physics->tangentialDampingRatio * std::sqrt(physics->effectiveMass * physics->ks);
    touch(contact.id1, contact.id2, physics->kn + physics->ks, normal_damping + tangential_damping);
  }
  for (const auto& engine : scene.engines) {
    const auto* group = dynamic_cast<const ThermalLinks*>(engine.get());
    if (!group) continue;
    for (const auto& link : group->links) {
      if (!link) continue;
      const yade::State& root = *body_of(scene, link->id1, "ThermalLink.id1").state;
      const yade::State& tip = *body_of(scene, link->id2, "ThermalLink.id2").state;
      touch(link->id1, link->id2,
            link->youngModulus * link->crossSectionArea / link->stressFreeLength,
            damping_coefficient(*link, root, tip));
    }
  }
  double smallest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < count; ++i) {
    const auto& body = body_at(scene, i);
    if (!body) continue;
    const yade::State& state = *body->state;
    if (!(inverse_mass(state) > 0)) continue;
    // Against a fixed body the row sum is exact; between free bodies it doubles.
    smallest = std::min(smallest,
                        kernel::critical_time_step(state.mass, 2 * stiffness[i], 2 * damping[i]));
  }
  return smallest;
}

}  // namespace statejump::dem
