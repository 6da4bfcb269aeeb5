#include "contact_parts.hpp"

#include <sstream>

#include "failure.hpp"
#include "statejump/kernel/contact_law.hpp"

namespace statejump::dem {

using yade::Real;

std::string where(const yade::Scene& scene, int id1, int id2, const std::string& more) {
  std::ostringstream text;
  text.precision(9);
  text << " (contact of bodies " << id1 << " and " << id2 << ", time " << scene.time << " s" << more
       << ")";
  return text.str();
}

void fail_closed(const char* inner, Real inner_radius, const char* outer, Real outer_radius,
                 const yade::Scene& scene, const yade::Interaction& contact) {
  std::ostringstream text;
  text.precision(9);
  text << "the clearance is closed: " << inner << " radius " << inner_radius << " m, " << outer
       << " radius " << outer_radius << " m at the current temperature"
       << where(scene, contact.id1, contact.id2);
  record_failure(text.str());
}

void fail_tilted(const yade::Scene& scene, const yade::Interaction& contact) {
  record_failure(
      "the axes of journal and bearing are tilted by more than maxTilt, and contact "
      "at the edges is not covered" +
      where(scene, contact.id1, contact.id2));
}

void fail_unstable(Real effective_mass, Real stiffness, const yade::Scene& scene,
                   const yade::Interaction& contact) {
  std::ostringstream text;
  text.precision(6);
  text << "the time step " << scene.dt << " s is above the stable one, "
       << kernel::critical_time_step(effective_mass, stiffness) << " s"
       << where(scene, contact.id1, contact.id2);
  record_failure(text.str());
}

}  // namespace statejump::dem
