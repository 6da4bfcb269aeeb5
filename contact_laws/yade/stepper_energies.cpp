// SPDX-License-Identifier: GPL-3.0-or-later
#include "stepper_energies.hpp"

#include <array>
#include <boost/python.hpp>
#include <cstddef>
#include <string>

namespace statejump::dem {
namespace {

namespace py = boost::python;
using yade::Real;

template <class Energies>
struct Entry {
  const char* name;
  Real Energies::*value;
};
template <class Energies, std::size_t size>
using Entries = std::array<Entry<Energies>, size>;

constexpr Entries<stepper::Energies, 13> growing = {
    {{"jointFriction", &stepper::Energies::joint_friction},
     {"jointDamping", &stepper::Energies::joint_damping},
     {"jointThermalWork", &stepper::Energies::joint_thermal_work},
     {"linkDamping", &stepper::Energies::link_damping},
     {"pinDamping", &stepper::Energies::pin_damping},
     {"linkThermalWork", &stepper::Energies::link_thermal_work},
     {"torsionFriction", &stepper::Energies::torsion_friction},
     {"prismaticFriction", &stepper::Energies::prismatic_friction},
     {"prismaticDamping", &stepper::Energies::prismatic_damping},
     {"beamDamping", &stepper::Energies::beam_damping},
     {"beamThermalWork", &stepper::Energies::beam_thermal_work},
     {"nonviscDamp", &stepper::Energies::numerical_damping},
     {"gravWork", &stepper::Energies::gravity_work}}};

constexpr Entries<stepper::StoredEnergies, 5> of_a_step = {
    {{"jointElastic", &stepper::StoredEnergies::joint},
     {"linkElastic", &stepper::StoredEnergies::link},
     {"torsionElastic", &stepper::StoredEnergies::torsion},
     {"prismaticElastic", &stepper::StoredEnergies::prismatic},
     {"beamElastic", &stepper::StoredEnergies::beam}}};

template <class Energies, std::size_t size>
Energies read(const yade::Scene& scene, const Entries<Energies, size>& entries) {
  const py::object items(py::object(scene.energy).attr("items")());
  Energies energies;
  for (py::ssize_t i = 0; i < py::len(items); ++i) {
    const py::object item(items[i]);
    const std::string name = py::extract<std::string>(item[0]);
    for (const auto& entry : entries) {
      if (name == entry.name) energies.*entry.value = py::extract<Real>(item[1]);
    }
  }
  return energies;
}

}  // namespace

stepper::Energies read_energies(const yade::Scene& scene) {
  return read(scene, growing);
}

stepper::StoredEnergies read_stored_energies(const yade::Scene& scene) {
  return read(scene, of_a_step);
}

void write_energies(const stepper::Energies& energies, const stepper::Energies& before,
                    const yade::Scene& scene) {
  py::object tracker(scene.energy);
  for (const auto& entry : growing) {
    if (energies.*entry.value != before.*entry.value) tracker[entry.name] = energies.*entry.value;
  }
}

std::vector<const char*> energy_names() {
  std::vector<const char*> names;
  for (const auto& entry : growing) names.push_back(entry.name);
  for (const auto& entry : of_a_step) names.push_back(entry.name);
  return names;
}

void append(const stepper::Energies& energies, const stepper::StoredEnergies& stored,
            std::vector<Real>& row) {
  for (const auto& entry : growing) row.push_back(energies.*entry.value);
  for (const auto& entry : of_a_step) row.push_back(stored.*entry.value);
}

}  // namespace statejump::dem
