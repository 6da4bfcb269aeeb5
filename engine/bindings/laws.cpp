// SPDX-License-Identifier: GPL-3.0-or-later
#include <pybind11/eigen.h>
#include <pybind11/stl.h>

#include <string>
#include <variant>
#include <vector>

#include "bindings.hpp"
#include "statejump/kernel/elastic_pair.hpp"
#include "statejump/kernel/laws/registry.hpp"

namespace py = pybind11;

namespace statejump::bindings {

namespace laws = kernel::laws;

namespace {

using Kind = std::variant<laws::NormalLaw, laws::DissipationLaw, laws::FrictionLaw,
                          laws::TangentialVelocityLaw>;

/// A default law of the kind of that name.
Kind law_kind(const std::string& name) {
  if (name == "normal") return laws::NormalLaw{};
  if (name == "dissipation") return laws::DissipationLaw{};
  if (name == "friction") return laws::FrictionLaw{};
  if (name == "tangential_velocity") return laws::TangentialVelocityLaw{};
  throw py::value_error("kind = '" + name +
                        "', allowed is one of normal, dissipation, friction, tangential_velocity");
}

std::vector<laws::LawInfo> infos(const std::string& kind) {
  return std::visit([]<class Law>(const Law&) { return laws::law_infos<Law>(); }, law_kind(kind));
}

py::dict to_dict(const laws::LawInfo& info) {
  py::dict result;
  result["name"] = info.name;
  result["formula"] = info.formula;
  result["source"] = info.source;
  result["range"] = info.range;
  result["holds_static_load"] = info.holds_static_load;
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

double damping_ratio(const std::string& name, double restitution, double impact_speed) {
  const laws::ImpactParameters impact{restitution, impact_speed};
  laws::validate(impact);
  return laws::damping_ratio(laws::dissipation_law(name), impact);
}

}  // namespace

void bind_laws(py::module_& module) {
  module.def(
      "law_names",
      [](const std::string& kind) {
        std::vector<std::string> names;
        for (const laws::LawInfo& info : infos(kind)) names.emplace_back(info.name);
        return names;
      },
      py::arg("kind"),
      "Names of the laws of a kind ('normal', 'dissipation', 'friction' or\n"
      "'tangential_velocity'), in the order of the catalogue.");
  module.def(
      "laws",
      [](const std::string& kind) {
        py::list result;
        for (const laws::LawInfo& info : infos(kind)) result.append(to_dict(info));
        return result;
      },
      py::arg("kind"),
      "What the laws of a kind say of themselves: a list of dicts name, formula, source, range,\n"
      "holds_static_load.");
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
}

}  // namespace statejump::bindings
