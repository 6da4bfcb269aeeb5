// SPDX-License-Identifier: GPL-3.0-or-later
#include "state_recorder.hpp"

#include <algorithm>
#include <initializer_list>
#include <stdexcept>
#include <string>

#include "interpreter.hpp"
#include "joint.hpp"
#include "ranges.hpp"
#include "stepper_energies.hpp"

namespace statejump::dem {
namespace {

// Columns per object of each type.
constexpr std::size_t body_width = 9, contact_width = 12, link_width = 4, spring_width = 3,
                      joint_width = 3, beam_width = 12, rotation_width = 9;

std::uint64_t key_of(int one, int other) {
  const auto [low, high] = std::minmax(one, other);
  return static_cast<std::uint64_t>(static_cast<std::uint32_t>(high)) << 32 |
         static_cast<std::uint32_t>(low);
}

void put(Real* place, std::initializer_list<Vector3r> vectors) {
  for (const Vector3r& vector : vectors) {
    for (int k = 0; k < 3; ++k) *place++ = vector[k];
  }
}

template <class Object>
void require_objects(const std::vector<yade::shared_ptr<Object>>& list, const char* attribute) {
  if (std::any_of(list.begin(), list.end(), [](const auto& one) { return !one; })) {
    refuse({"holds_none", std::string(StateRecorder::class_name) + "." + attribute});
  }
}

}  // namespace

void StateRecorder::check() {
  if (iterPeriod < 1) refuse(class_name, "iterPeriod", iterPeriod, "1 or above [-]");
  if (contacts.size() % 2 != 0) {
    refuse({"odd_ids", std::string(class_name) + ".contacts"});
  }
  require_objects(links, "links");
  require_objects(springs, "springs");
  require_objects(joints, "joints");
  require_objects(beams, "beams");
  columns_.clear();
  for (std::size_t i = 0; i < contacts.size(); i += 2) {
    if (!columns_.emplace(key_of(contacts[i], contacts[i + 1]), i / 2).second) {
      refuse({"contact_twice", std::string(class_name) + ".contacts",
              std::to_string(contacts[i]) + " and " + std::to_string(contacts[i + 1])});
    }
  }
  rows_.clear();  // discard samples: the number of columns has changed
}

std::size_t StateRecorder::width() const {
  return 1 + energy_names().size() + 3 + body_width * bodies.size() +
         contact_width * columns_.size() + link_width * links.size() +
         spring_width * springs.size() + joint_width * joints.size() + beam_width * beams.size() +
         rotation_width * rotations.size();
}

boost::python::list StateRecorder::scalars() const {
  boost::python::list names;
  names.append("time");
  for (const char* name : energy_names()) names.append(name);
  for (const char* name : {"touching", "stranger1", "stranger2"}) names.append(name);
  return names;
}

void StateRecorder::sample(const yade::Scene& of, const Sums& sums) {
  rows_.push_back(of.time);
  append(sums.energies, sums.stored, rows_);
  const std::size_t strangers = rows_.size();
  rows_.insert(rows_.end(), {0, -1, -1});
  for (const int id : bodies) {
    const yade::State& state = *body_of(of, id, "StateRecorder.bodies").state;
    Vector3r force = sums.force(static_cast<std::size_t>(id));
    for (int k = 0; k < 3; ++k) {
      if (state.blockedDOFs & (1U << k)) force[k] = 0;
    }
    rows_.resize(rows_.size() + body_width);
    put(rows_.data() + rows_.size() - body_width, {state.se3.position, state.vel, force});
  }
  add_contacts(of, strangers);
  for (const auto& link : links) {
    rows_.insert(rows_.end(), {link->axialForce, link->temperatureChange, link->previousExtension,
                               link->previousStressFreeLength});
  }
  for (const auto& spring : springs) {
    rows_.insert(rows_.end(), {spring->angle, spring->moment, spring->frictionMoment});
  }
  for (const auto& joint : joints) {
    rows_.insert(rows_.end(), {joint->slide, joint->frictionForce, joint->stopForce});
  }
  for (const auto& beam : beams) {
    rows_.resize(rows_.size() + beam_width);
    put(rows_.data() + rows_.size() - beam_width,
        {beam->force1, beam->moment1, beam->force2, beam->moment2});
  }
  for (const int id : rotations) {
    const yade::State& state = *body_of(of, id, "StateRecorder.rotations").state;
    Vector3r torque = sums.torque(static_cast<std::size_t>(id));
    for (int k = 0; k < 3; ++k) {
      if (state.blockedDOFs & (8U << k)) torque[k] = 0;
    }
    rows_.resize(rows_.size() + rotation_width);
    put(rows_.data() + rows_.size() - rotation_width,
        {stepper::rotation_vector(state.se3.orientation), state.angVel, torque});
  }
}

void StateRecorder::add_contacts(const yade::Scene& of, std::size_t strangers) {
  const std::size_t first = rows_.size();
  rows_.resize(first + contact_width * columns_.size());
  for (std::size_t i = 0; i < number_of_interactions(of); ++i) {
    const yade::Interaction& contact = interaction_at(of, i);
    if (!contact.isReal()) continue;
    ++rows_[strangers];
    const auto place = columns_.find(key_of(contact.id1, contact.id2));
    if (place == columns_.end()) {
      if (rows_[strangers + 1] < 0) {
        rows_[strangers + 1] = contact.id1;
        rows_[strangers + 2] = contact.id2;
      }
      continue;
    }
    const auto* geometry = dynamic_cast<const JointGeom*>(contact.geom.get());
    const auto* physics = dynamic_cast<const JointPhys*>(contact.phys.get());
    if (!geometry || !physics) {
      refuse({"no_joint_contact", class_name,
              std::to_string(contact.id1) + " and " + std::to_string(contact.id2)});
    }
    Real* row = rows_.data() + first + contact_width * place->second;
    *row++ = 1;
    *row++ = geometry->penetrationDepth;
    *row++ = physics->slipping ? 1 : 0;
    put(row, {geometry->normal, physics->normalForce, physics->shearForce});
  }
}

void StateRecorder::action() {
  if (!samples(scene->iter)) return;
  scene->forces.sync();
  const Interpreter lock;
  stepper::Energies energies;
  stepper::StoredEnergies stored;
  if (scene->trackEnergy) {
    energies = read_energies(*scene);
    stored = read_stored_energies(*scene);
  }
  sample(
      *scene,
      {energies, stored,
       [this](std::size_t id) { return Vector3r(scene->forces.getForce(static_cast<int>(id))); },
       [this](std::size_t id) { return Vector3r(scene->forces.getTorque(static_cast<int>(id))); }});
}

boost::python::object StateRecorder::take() {
  namespace py = boost::python;
  const py::object taken(py::handle<>(
      PyBytes_FromStringAndSize(reinterpret_cast<const char*>(rows_.data()),
                                static_cast<Py_ssize_t>(rows_.size() * sizeof(Real)))));
  rows_.clear();
  return taken;
}

}  // namespace statejump::dem
