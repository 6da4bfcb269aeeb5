// SPDX-License-Identifier: GPL-3.0-or-later
#include "torsion.hpp"

#include <cmath>
#include <sstream>
#include <utility>

#include "blocked_motion.hpp"
#include "contact_parts.hpp"
#include "failure.hpp"
#include "faults.hpp"
#include "ranges.hpp"
#include "statejump/kernel/stable_step.hpp"
#include "statejump/stepper/checks.hpp"

namespace statejump::dem {
namespace {

const std::string torsion_elastic = "torsionElastic";
const std::string torsion_friction = "torsionFriction";
constexpr Real pi = 3.14159265358979323846;

// Throws if a number of the spring is invalid.
void throw_fault(const yade::Scene& scene, const TorsionSpring& spring) {
  if (auto fault = fault_of_spring(scene, spring)) throw_failure(*std::move(fault));
}

void require_planar(const yade::Scene& scene, const ThermalLink& link, const stepper::Span& span,
                    const Vector3r& axis) {
  if (stepper::is_planar(span, axis)) return;
  std::ostringstream after;
  after.precision(9);
  after << (axis == Vector3r::UnitZ() ? " leaves the x-y plane, z component of its direction "
                                      : " leaves the plane across the axis, component of its "
                                        "direction along it ")
        << span.direction.dot(axis) << ", allowed is at most " << stepper::largest_tilt;
  throw_failure(failure(scene, Failure::Part::link, link.id1, link.id2,
                        "TorsionSpring: ", after.str(), {"leaves_plane"}));
}

}  // namespace

void TorsionSpring::check() const {
  require_settable<stepper::Torsion>(class_name, stepper::torsion_quantities, *this);
  if (!(freeAngle > -pi && freeAngle <= pi)) {
    refuse(class_name, "freeAngle", freeAngle, "in (-pi, pi] [rad]");
  }
  require_unit(class_name, "axis", axis);
}

void TorsionSprings::action() {
  begin(*scene);
  for (const auto& spring : springs) {
    if (!spring) refuse({"holds_none", "TorsionSprings.springs"});
    act(*spring);
  }
}

void TorsionSprings::act(TorsionSpring& spring) {
  if (!spring.link1) refuse({"missing", "TorsionSpring.link1"});
  if (!spring.link2) refuse({"missing", "TorsionSpring.link2"});
  const LinkEnds first = ends_of(*scene, *spring.link1);
  const LinkEnds second = ends_of(*scene, *spring.link2);
  require_planar(*scene, *spring.link1, first.span, spring.axis);
  require_planar(*scene, *spring.link2, second.span, spring.axis);

  if (stepper::has_friction_without_stiffness(spring)) throw_fault(*scene, spring);
  const stepper::TorsionEnergy energy = stepper::torsion_step(spring, first.span, second.span);
  const Real inverse = stepper::inverse_inertia(first.span, first.inverse_mass()) +
                       stepper::inverse_inertia(second.span, second.inverse_mass());
  if (inverse > 0) {
    const Real stable = kernel::critical_time_step(1 / inverse, stepper::largest_stiffness(spring));
    if (!(scene->dt <= stable)) {
      throw_fault(*scene, spring);
      throw_failure(unstable_time_step(*scene, Failure::Part::torsion_spring, spring.link1->id2,
                                       spring.link2->id2, stable));
    }
  }

  if (!std::isfinite(spring.moment)) {
    throw_fault(*scene, spring);
    throw_failure(failure(*scene, Failure::Part::torsion_spring, spring.link1->id2,
                          spring.link2->id2, "the moment is not finite of ", "",
                          {"not_finite", "moment"}));
  }
  const auto add_couple = [&](const ThermalLink& link, const LinkEnds& ends, Real moment) {
    const Vector3r force = stepper::couple(ends.span, spring.axis, moment);
    scene->forces.addForce(link.id2, force);
    scene->forces.addForce(link.id1, -force);
  };
  add_couple(*spring.link1, first, spring.moment);
  add_couple(*spring.link2, second, -spring.moment);

  if (scene->trackEnergy) {
    scene->energy->add(energy.elastic, torsion_elastic, elastic_id_, true);
    if (spring.frictionLimit > 0) {
      scene->energy->add(energy.friction, torsion_friction, friction_id_, false);
    }
  }
}

}  // namespace statejump::dem
