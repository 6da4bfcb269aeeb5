// SPDX-License-Identifier: GPL-3.0-or-later
#include <pybind11/eigen.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <string>
#include <variant>
#include <vector>

#include "bindings.hpp"
#include "statejump/kernel/elastic_pair.hpp"
#include "statejump/kernel/hertz.hpp"
#include "statejump/kernel/laws/registry.hpp"
#include "statejump/kernel/mindlin.hpp"
#include "statejump/kernel/stable_step.hpp"
#include "statejump/law_loader/load.hpp"

namespace py = pybind11;

namespace statejump::bindings {

namespace laws = kernel::laws;

namespace {

using Kind = std::variant<laws::NormalLaw, laws::DissipationLaw, laws::FrictionLaw,
                          laws::TangentialVelocityLaw>;

/// A default law of the kind with that name.
Kind law_kind(const std::string& name) {
  if (name == "normal") return laws::NormalLaw{};
  if (name == "dissipation") return laws::DissipationLaw{};
  if (name == "friction") return laws::FrictionLaw{};
  if (name == "tangential_velocity") return laws::TangentialVelocityLaw{};
  throw kernel::OutOfRange("kind", name,
                           "one of normal, dissipation, friction, tangential_velocity");
}

std::vector<laws::LawInfo> infos(const std::string& kind) {
  return std::visit([]<class Law>(const Law&) { return laws::law_infos<Law>(); }, law_kind(kind));
}

py::dict to_dict(const laws::LawParameter& parameter) {
  py::dict result;
  result["name"] = parameter.name;
  result["unit"] = parameter.unit;
  result["low"] = parameter.low;
  result["high"] = parameter.high;
  result["low_excluded"] = parameter.low_excluded;
  result["default"] = parameter.default_value;
  result["meaning"] = parameter.meaning;
  result["source"] = parameter.source;
  return result;
}

py::dict to_dict(const laws::LawInfo& info) {
  py::dict result;
  result["name"] = info.name;
  result["formula"] = info.formula;
  result["source"] = info.source;
  result["range"] = info.range;
  using laws::Trait;
  result["holds_static_load"] = info.has(Trait::holds_static_load);
  result["frictionless"] = info.has(Trait::frictionless);
  result["has_memory"] = info.has(Trait::has_memory);
  result["needs_axis"] = info.has(Trait::needs_axis);
  result["accepts_bulging_wall"] = info.has(Trait::accepts_bulging_wall);
  result["point_contact"] = info.has(Trait::point_contact);
  result["needs_point_contact"] = info.has(Trait::needs_point_contact);
  py::list parameters;
  for (const laws::LawParameter* parameter : info.parameters) {
    if (parameter) parameters.append(to_dict(*parameter));
  }
  result["parameters"] = parameters;
  return result;
}

py::dict normal_force(const std::string& name, const Eigen::VectorXd& depth, double journal_radius,
                      double bearing_radius, double length, double effective_young_modulus) {
  const laws::NormalLaw law = laws::normal_law(name);
  const laws::NormalGeometry geometry{journal_radius, bearing_radius, length};
  const laws::NormalMaterial material{effective_young_modulus};
  laws::validate(geometry, material);
  const Eigen::Index count = depth.size();
  Eigen::VectorXd force(count), stiffness(count), width(count), energy(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const laws::NormalState state = laws::evaluate(law, depth[i], geometry, material);
    force[i] = state.force;
    stiffness[i] = state.stiffness;
    width[i] = state.contact_width;
    energy[i] = state.elastic_energy;
  }
  py::dict result;
  result["force_N"] = force;
  result["stiffness_N_per_m"] = stiffness;
  result["contact_width_m"] = width;
  result["elastic_energy_J"] = energy;
  return result;
}

double largest_depth(const std::string& name, double journal_radius, double bearing_radius) {
  const laws::NormalGeometry geometry{journal_radius, bearing_radius, 1.0};
  laws::validate(geometry, {1.0});
  return laws::largest_depth(laws::normal_law(name), geometry);
}

std::vector<std::string> names(const std::string& kind) {
  return std::visit([]<class Law>(const Law&) { return laws::law_names<Law>(); }, law_kind(kind));
}

const char* name_of(laws::LawKind kind) {
  switch (kind) {
    case laws::LawKind::normal:
      return "normal";
    case laws::LawKind::dissipation:
      return "dissipation";
    case laws::LawKind::friction:
      return "friction";
    case laws::LawKind::tangential_velocity:
      return "tangential_velocity";
  }
  return "";
}

py::dict inspect(const std::string& file) {
  const laws::LoadedLaw law = law_loader::inspect(file);
  py::dict result;
  result["kind"] = law.name.empty() ? "" : name_of(law.kind);
  result["name"] = law.name;
  result["problem"] = law.problem;
  return result;
}

std::string problem(const std::string& kind, const std::string& name) {
  return std::visit([&]<class Law>(const Law&) { return laws::law_problem<Law>(name); },
                    law_kind(kind));
}

double damping_ratio(const std::string& name, double restitution, double impact_speed) {
  const laws::ImpactParameters impact{restitution, impact_speed};
  laws::validate(impact);
  const laws::DissipationLaw law = laws::dissipation_law(name);
  laws::check(laws::restitution_of(law), restitution);
  return laws::damping_ratio(law, impact);
}

py::dict hertz_contact(double force, double effective_radius, double young_modulus_1,
                       double poisson_ratio_1, double young_modulus_2, double poisson_ratio_2) {
  kernel::require(force >= 0.0, "force", force, "[0, inf) N");
  kernel::require(effective_radius > 0.0, "effective_radius", effective_radius, "(0, inf) m");
  const kernel::ElasticPair pair =
      kernel::elastic_pair(young_modulus_1, poisson_ratio_1, young_modulus_2, poisson_ratio_2);
  const double depth = kernel::hertz_depth(pair.effective_young_modulus, effective_radius, force);
  const kernel::HertzState state =
      kernel::hertz(pair.effective_young_modulus, effective_radius, depth);
  py::dict result;
  result["depth_m"] = depth;
  result["normal_stiffness_N_per_m"] = state.stiffness;
  result["tangential_stiffness_N_per_m"] =
      kernel::mindlin_stiffness(pair.effective_shear_modulus, state.contact_radius);
  return result;
}

/// Each module has its own table of loaded laws. The second module loads the laws of the first when
/// it is imported.
void load_user_laws(const std::string& engine) {
  law_loader::load_user_laws();
  const py::dict modules = py::module_::import("sys").attr("modules");
  if (const py::str name(more_name(engine)); modules.contains(name)) {
    modules[name].attr("_load_user_laws")();
  }
}

}  // namespace

void bind_laws(py::module_& module) {
  law_loader::load_user_laws();
  module.def("law_names", &names, py::arg("kind"),
             "Names of the laws of a kind ('normal', 'dissipation', 'friction' or\n"
             "'tangential_velocity'), in the order of the catalogue, loaded ones after them.");
  const auto engine = module.attr("__name__").cast<std::string>();
  module.def(
      "load_user_laws", [engine] { load_user_laws(engine); },
      "Loads laws of one's own that are not loaded yet, from the folders of\n"
      "$STATEJUMP_LAWS and ${XDG_DATA_HOME:-~/.local/share}/statejump/laws.");
  module.def("user_law_folders", &law_loader::folders, "Folders that are searched for them.");
  module.def("user_law_problems", &law_loader::problems,
             "A sentence for each shared object there that cannot be used.");
  module.def("law_problem", &problem, py::arg("kind"), py::arg("name"),
             "Why the loaded law of that name cannot be used; '': it can, or there is none.");
  module.def("inspect_user_law", &inspect, py::arg("file"),
             "What a shared object holds, as a dict kind, name and problem; kind and name are ''\n"
             "if it holds no law, problem is '' if it can be used.");
  module.def("kernel_hash", &law_loader::kernel_hash, "Hash of the kernel headers of this build.");
  module.def(
      "laws",
      [](const std::string& kind) {
        py::list result;
        for (const laws::LawInfo& info : infos(kind)) result.append(to_dict(info));
        return result;
      },
      py::arg("kind"),
      "What the laws of a kind say of themselves: a list of dicts name, formula, source, range,\n"
      "the traits holds_static_load, frictionless, has_memory, needs_axis (line contacts and the\n"
      "velocity 'paper': neither in a socket nor on a flat face), accepts_bulging_wall,\n"
      "point_contact and needs_point_contact, and parameters, those that the law reads: a list of "
      "dicts name, unit, low,\n"
      "high, low_excluded, default, meaning, source.");
  module.def("normal_force", &normal_force, py::arg("name"), py::arg("depth_m"),
             py::arg("journal_radius_m"), py::arg("bearing_radius_m"), py::arg("length_m"),
             py::arg("effective_young_modulus_Pa"),
             "A normal law over penetration depths: a dict of arrays force_N, stiffness_N_per_m,\n"
             "contact_width_m (radius of a point contact, half width of a line) and\n"
             "elastic_energy_J. Raises ValueError for a depth outside the law's range.");
  module.def("largest_depth_m", &largest_depth, py::arg("name"), py::arg("journal_radius_m"),
             py::arg("bearing_radius_m"),
             "First penetration depth [m] that a normal law refuses; inf if none.");
  module.def("damping_ratio_s_per_m", &damping_ratio, py::arg("name"), py::arg("restitution"),
             py::arg("impact_speed_m_per_s"),
             "chi/K [s/m] of a dissipation law: F = F_elastic max(0, 1 + chi/K d(delta)/dt).");
  module.def(
      "effective_young_modulus_Pa",
      [](double young_1, double poisson_1, double young_2, double poisson_2) {
        return kernel::elastic_pair(young_1, poisson_1, young_2, poisson_2).effective_young_modulus;
      },
      py::arg("young_modulus_1_Pa"), py::arg("poisson_ratio_1"), py::arg("young_modulus_2_Pa"),
      py::arg("poisson_ratio_2"), "E* [Pa], 1/E* = (1 - nu1^2)/E1 + (1 - nu2^2)/E2.");
  module.def("hertz_contact", &hertz_contact, py::arg("force_N"), py::arg("effective_radius_m"),
             py::arg("young_modulus_1_Pa"), py::arg("poisson_ratio_1"),
             py::arg("young_modulus_2_Pa"), py::arg("poisson_ratio_2"),
             "Hertz's point contact at a force, as a dict depth_m, normal_stiffness_N_per_m and\n"
             "tangential_stiffness_N_per_m (of full stick).");
  module.def(
      "critical_time_step_s", py::vectorize(&kernel::critical_time_step), py::arg("mass_kg"),
      py::arg("stiffness_sum_N_per_m"), py::arg("damping_sum_N_s_per_m") = 0.0,
      "Largest stable step [s] of the DEM's leapfrog for an oscillator, 4 m/(c + sqrt(c^2 +\n"
      "4 m k)); inf when nothing acts. Numbers or arrays; with mass 1 the sums may be per mass.");
}

}  // namespace statejump::bindings
