// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact_parts.hpp"

#include <set>
#include <sstream>

#include "failure.hpp"
#include "statejump/kernel/stable_step.hpp"
#include "thermal.hpp"

namespace statejump::dem {

using yade::Real;

std::string when(const yade::Scene& scene) {
  std::ostringstream text;
  text.precision(9);
  text << "time " << scene.time << " s";
  std::set<Real> changes;
  for (const auto& engine : scene.engines) {
    if (const auto* heater = dynamic_cast<const ThermalExpansionEngine*>(engine.get())) {
      changes.insert(heater->temperatureChange);
    } else if (const auto* group = dynamic_cast<const ThermalLinks*>(engine.get())) {
      for (const auto& link : group->links) {
        if (link && link->program && link->thermalExpansion != 0) {
          changes.insert(link->program->temperature_change(scene.time));
        }
      }
    }
  }
  const char* before = changes.size() > 1 ? ", temperature changes " : ", temperature change ";
  for (const Real change : changes) {
    text << before << change << " K";
    before = ", ";
  }
  return text.str();
}

void fail_closed(const char* inner, Real inner_radius, const char* outer, Real outer_radius,
                 const yade::Scene& scene, const yade::Interaction& contact) {
  std::ostringstream text;
  text.precision(9);
  text << "the clearance is closed: " << inner << " radius " << inner_radius << " m, " << outer
       << " radius " << outer_radius << " m at the current temperature";
  record_failure(
      {"clearance_closed", inner, text_of(inner_radius), "below " + text_of(outer_radius)},
      text.str(), scene, contact);
}

void fail_inside(Real distance, Real radius_1, Real radius_2, const yade::Scene& scene,
                 const yade::Interaction& contact) {
  std::ostringstream text;
  text.precision(9);
  text << "the centre of one ball lies inside the other: the centres are " << distance
       << " m apart, the radii " << radius_1 << " m and " << radius_2
       << " m at the current temperature";
  record_failure({"centre_inside", "distance", text_of(distance)}, text.str(), scene, contact);
}

void fail_tilted(const yade::Scene& scene, const yade::Interaction& contact) {
  record_failure({"tilted", "maxTilt"},
                 "the axes of journal and bearing are tilted by more than maxTilt, and contact "
                 "at the edges is not covered",
                 scene, contact);
}

void fail_unstable(Real effective_mass, Real stiffness, const yade::Scene& scene,
                   const yade::Interaction& contact) {
  const Real stable = kernel::critical_time_step(effective_mass, stiffness);
  std::ostringstream text;
  text.precision(6);
  text << "the time step " << scene.dt << " s is above the stable one, " << stable << " s";
  record_failure(failure(scene, Failure::Part::contact, contact.id1, contact.id2, text.str(), "",
                         {"time_step_unstable", "O.dt", text_of(scene.dt)}, stable));
}

}  // namespace statejump::dem
