// SPDX-License-Identifier: GPL-3.0-or-later
#include "statejump/kernel/laws/driven_contact.hpp"

#include <pybind11/eigen.h>
#include <pybind11/stl.h>

#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "../bindings.hpp"
#include "statejump/kernel/laws/registry.hpp"

namespace py = pybind11;

namespace statejump::bindings {

namespace laws = kernel::laws;

namespace {

/// Builds a contact with the given law, found by its kind and name. Its other laws are Hertz's
/// contact, no dissipation, and Mindlin's friction.
laws::JointLaw law_among_defaults(const std::string& kind, const std::string& name) {
  laws::JointLaw law;
  law.friction = laws::MindlinFriction{};
  if (kind == "normal") {
    law.normal = laws::normal_law(name);
  } else if (kind == "dissipation") {
    law.dissipation = laws::dissipation_law(name);
  } else if (kind == "friction") {
    law.friction = laws::friction_law(name);
  } else {
    throw kernel::OutOfRange("kind", kind, "one of normal, dissipation, friction");
  }
  return law;
}

/// A column of a path, or nothing.
using Column = std::optional<Eigen::VectorXd>;

py::dict drive_contact(const std::string& kind, const std::string& name,
                       double effective_young_modulus, double effective_shear_modulus,
                       double effective_radius, double radial_clearance, double contact_length,
                       const laws::FrictionParameters& friction, double restitution,
                       double smallest_impact_speed, const Eigen::VectorXd& normal,
                       bool normal_is_force, const Eigen::VectorXd& along, bool along_is_force,
                       const Column& across, const Column& time) {
  laws::DrivenContact contact{
      law_among_defaults(kind, name),
      {effective_young_modulus, effective_shear_modulus},
      laws::driven_geometry(effective_radius, radial_clearance, contact_length)};
  contact.law.friction_parameters = friction;
  contact.law.restitution = restitution;
  contact.law.smallest_impact_speed = smallest_impact_speed;
  contact.law.contact_length = contact_length;
  laws::validate(contact);
  prepare(contact.law.dissipation, restitution);

  const Eigen::Index count = normal.size();
  laws::DrivenState state;
  std::string problem;
  std::vector<laws::DrivenState> states;
  if (count > 0 && !along_is_force) state.slide_x = along[0];
  if (count > 0 && across) state.slide_y = (*across)[0];
  for (Eigen::Index i = 0; i < count && problem.empty(); ++i) {
    laws::DrivenTarget target;
    (normal_is_force ? target.normal_force.emplace() : target.depth) = normal[i];
    (along_is_force ? target.tangential_force.emplace() : target.slide_x) = along[i];
    if (across) target.slide_y = (*across)[i];
    if (time && i > 0) target.duration = (*time)[i] - (*time)[i - 1];
    try {
      state = laws::drive(contact, state, target);
      states.push_back(state);
    } catch (const std::domain_error& error) {
      problem = error.what();
    }
  }
  py::dict result;
  result["problem"] = problem;
  const auto add = [&](const char* column, auto&& value) {
    Eigen::VectorXd values(static_cast<Eigen::Index>(states.size()));
    for (std::size_t i = 0; i < states.size(); ++i) {
      values[static_cast<Eigen::Index>(i)] = static_cast<double>(value(states[i]));
    }
    result[column] = values;
  };
  using State = laws::DrivenState;
  add("penetration_depth_m", [](const State& s) { return s.depth; });
  add("slide_x_m", [](const State& s) { return s.slide_x; });
  add("slide_y_m", [](const State& s) { return s.slide_y; });
  add("normal_force_N", [](const State& s) { return s.normal_force; });
  add("tangential_force_x_N", [](const State& s) { return s.tangential_force_x; });
  add("tangential_force_y_N", [](const State& s) { return s.tangential_force_y; });
  add("normal_elastic_energy_J", [](const State& s) { return s.normal_elastic_energy; });
  add("tangential_elastic_energy_J", [](const State& s) { return s.tangential_elastic_energy; });
  add("friction_dissipation_J", [](const State& s) { return s.friction_dissipation; });
  add("damping_dissipation_J", [](const State& s) { return s.damping_dissipation; });
  add("slipping", [](const State& s) { return s.history.slipping; });
  add("memory_points", [](const State& s) { return s.history.memory.size(); });
  add("merged_force_N", [](const State& s) { return s.history.memory.merged(); });
  return result;
}

}  // namespace

void bind_driven_contact(py::module_& module) {
  module.def(
      "drive_contact",
      [](const std::string& kind, const std::string& name, double young, double shear,
         double radius, double clearance, double length, double friction_coefficient, double v0,
         double v1, double restitution, double smallest_impact_speed, const Eigen::VectorXd& normal,
         bool normal_is_force, const Eigen::VectorXd& along, bool along_is_force,
         const Column& across, const Column& time) {
        return drive_contact(kind, name, young, shear, radius, clearance, length,
                             {friction_coefficient, v0, v1}, restitution, smallest_impact_speed,
                             normal, normal_is_force, along, along_is_force, across, time);
      },
      py::kw_only(), py::arg("kind"), py::arg("name"), py::arg("effective_young_modulus_Pa"),
      py::arg("effective_shear_modulus_Pa"), py::arg("effective_radius_m"),
      py::arg("radial_clearance_m"), py::arg("contact_length_m"), py::arg("friction_coefficient"),
      py::arg("v0_m_per_s"), py::arg("v1_m_per_s"), py::arg("restitution"),
      py::arg("smallest_impact_speed_m_per_s"), py::arg("normal"), py::arg("normal_is_force"),
      py::arg("along"), py::arg("along_is_force"), py::arg("across_m") = std::nullopt,
      py::arg("time_s") = std::nullopt,
      "Leads one contact along straight steps with one law of the catalogue (kind normal,\n"
      "dissipation or friction); the others are hertz_internal, no dissipation and mindlin. The\n"
      "contact is made at the first point. normal: penetration depths [m], or forces [N];\n"
      "along: slides [m] of body 1 against 2, or forces [N], positive along the slide that\n"
      "causes them; across_m: slides across. Returns a dict of arrays, a value for each point,\n"
      "and 'problem': '', or why the point after the last value cannot be reached. Raises\n"
      "ValueError for a parameter outside its range.");
}

}  // namespace statejump::bindings
