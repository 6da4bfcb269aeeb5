// SPDX-License-Identifier: GPL-3.0-or-later
#include "statejump/linkage/model.hpp"

#include <cmath>
#include <string>

#include "statejump/kernel/elastic_pair.hpp"
#include "statejump/kernel/require.hpp"

#include "rates.hpp"

namespace statejump::linkage {

using Eigen::Vector2d;
using kernel::require;

namespace {

constexpr double pi = 3.14159265358979323846;

double cross(const Vector2d& a, const Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

void validate(const ThermalLink& link, const std::string& name) {
  const auto positive = [&name](double value, const char* field, const char* range) {
    require(std::isfinite(value) && value > 0.0, (name + field).c_str(), value, range);
  };
  positive(link.stress_free_length, ".stress_free_length", "finite, > 0 m");
  positive(link.mass, ".mass", "finite, > 0 kg");
  positive(link.young_modulus, ".young_modulus", "finite, > 0 Pa");
  positive(link.cross_section_area, ".cross_section_area", "finite, > 0 m^2");
  require(std::isfinite(link.thermal_expansion), (name + ".thermal_expansion").c_str(),
          link.thermal_expansion, "finite [1/K]");
  require(link.poisson_ratio > -1.0 && link.poisson_ratio <= 0.5, (name + ".poisson_ratio").c_str(),
          link.poisson_ratio, "(-1, 0.5]");
}

double axial_energy(const ThermalLink& link, double length, double temperature_change) {
  const double free =
      thermal::length(link.stress_free_length, link.thermal_expansion, temperature_change);
  const double stretch = length - free;
  return 0.5 * link.young_modulus * link.cross_section_area / free * stretch * stretch;
}

}  // namespace

void Linkage::validate() const {
  const auto non_negative = [](double value, const char* name, const char* range) {
    require(std::isfinite(value) && value >= 0.0, name, value, range);
  };
  require(std::isfinite(frame_length) && frame_length > 0.0, "frame_length", frame_length,
          "finite, > 0 m");
  linkage::validate(link_ab, "link_ab");
  linkage::validate(link_bc, "link_bc");
  const double sum = link_ab.stress_free_length + link_bc.stress_free_length;
  const double difference = std::abs(link_ab.stress_free_length - link_bc.stress_free_length);
  require(frame_length < sum && frame_length > difference, "frame_length", frame_length,
          "between the difference and the sum of the two link lengths [m], else the links cannot "
          "meet");
  require(std::isfinite(journal_radius) && journal_radius > 0.0, "journal_radius", journal_radius,
          "finite, > 0 m");
  require(std::isfinite(bearing_radius) && bearing_radius > journal_radius, "bearing_radius",
          bearing_radius, "finite, > journal_radius [m]");
  require(std::isfinite(journal_thermal_expansion), "journal_thermal_expansion",
          journal_thermal_expansion, "finite [1/K]");
  require(std::isfinite(bearing_thermal_expansion), "bearing_thermal_expansion",
          bearing_thermal_expansion, "finite [1/K]");
  kernel::laws::validate(law);
  non_negative(axial_damping_ratio, "axial_damping_ratio", "finite, >= 0");
  non_negative(pin_damping, "pin_damping", "finite, >= 0 N m s/rad");
  non_negative(torsion_stiffness, "torsion_stiffness", "finite, >= 0 N m/rad");
  require(std::isnan(torsion_free_angle) || (torsion_free_angle > 0.0 && torsion_free_angle < pi),
          "torsion_free_angle", torsion_free_angle, "(0, pi) rad, or NaN for the ideal position");
}

double Linkage::friction_coefficient() const {
  const bool none = has(law.friction, kernel::laws::Trait::frictionless);
  return none ? 0.0 : law.friction_parameters.friction_coefficient;
}

double Linkage::free_angle() const {
  if (!std::isnan(torsion_free_angle)) return torsion_free_angle;
  const double l1 = link_ab.stress_free_length;
  const double l2 = link_bc.stress_free_length;
  return std::acos((l1 * l1 + l2 * l2 - frame_length * frame_length) / (2.0 * l1 * l2));
}

Coordinates coordinates(const Linkage& model, const State& state) {
  const Vector2d c(model.frame_length, 0.0);
  const Vector2d& ab = state.bearing_centre;
  const Vector2d bc = state.journal_centre - c;
  return {0.5 * ab,
          c + 0.5 * bc,
          std::atan2(ab.y(), ab.x()),
          std::atan2(bc.y(), bc.x()),
          ab.norm(),
          bc.norm(),
          state.journal_centre - state.bearing_centre};
}

State initial_state(const Linkage& model, Start start, double temperature_rate,
                    const Vector2d& eccentricity) {
  model.validate();
  require(eccentricity.norm() <= model.radial_clearance(), "eccentricity", eccentricity.norm(),
          "0 to the clearance [m]: no penetration at the start");
  const double l1 = model.link_ab.stress_free_length;
  const double l2 = model.link_bc.stress_free_length;
  // The links form a triangle with w = AC − d; see joint_point().
  const Vector2d w = Vector2d(model.frame_length, 0.0) - eccentricity;
  const double length = w.norm();
  const double x = (length * length + (l1 - l2) * (l1 + l2)) / (2.0 * length);
  const double y = std::sqrt((l1 - x) * (l1 + x));
  const Vector2d along = w / length;
  State state;
  state.bearing_centre = x * along + y * Vector2d(-along.y(), along.x());
  state.journal_centre = state.bearing_centre + eccentricity;
  if (start == Start::matched) {
    const Vector2d c(model.frame_length, 0.0);
    state.bearing_velocity =
        model.link_ab.thermal_expansion * temperature_rate * state.bearing_centre;
    state.journal_velocity =
        model.link_bc.thermal_expansion * temperature_rate * (state.journal_centre - c);
  }
  return state;
}

Joint joint_state(const Linkage& model, const State& state, double temperature_change,
                  double temperature_rate) {
  using namespace detail;
  const Constants k = constants(model);
  const AllTerms::Vector y = pack<AllTerms>(state);
  const Temperature heat{temperature_change, temperature_rate};
  const Radii radii = radii_at(k, temperature_change);
  const ContactPoint at = contact_point<AllTerms>(k, y, heat, radii);
  Joint joint{at.depth, at.approach_speed, 0.0, 0.0, false};
  if (at.depth > 0.0) {
    const NormalForce normal = normal_force(k, at, radii, state.impact_speed);
    joint.normal_force = normal.force;
    if (k.friction_has_memory) {
      joint.tangential_force = state.contact.tangential_force.x();
      joint.slipping = state.contact.slipping;
    } else {
      kernel::ContactHistory none;
      const SpatialContact<AllTerms> spatial(y, at, radii, turn_rates<AllTerms>(k, y));
      const double speed = sliding_speed(k, spatial, at);
      joint.tangential_force = friction(k, normal, speed, none).force_on_1.x();
    }
  }
  return joint;
}

Energy energy(const Linkage& model, const State& state, double temperature_change) {
  const Coordinates q = coordinates(model, state);
  const detail::Constants k = detail::constants(model);
  const detail::Radii radii = detail::radii_at(k, temperature_change);
  const double depth = q.eccentricity.norm() - radii.clearance();
  const Vector2d bc = state.journal_centre - Vector2d(model.frame_length, 0.0);
  const double bend =
      std::atan2(cross(state.bearing_centre, bc), state.bearing_centre.dot(bc)) - k.free_angle;
  return {model.link_ab.mass / 6.0 * state.bearing_velocity.squaredNorm() +
              model.link_bc.mass / 6.0 * state.journal_velocity.squaredNorm(),
          axial_energy(model.link_ab, q.length_ab, temperature_change) +
              axial_energy(model.link_bc, q.length_bc, temperature_change),
          depth > 0.0 ? detail::normal_state(k, depth, radii).elastic_energy : 0.0,
          kernel::elastic_energy(state.contact), 0.5 * model.torsion_stiffness * bend * bend};
}

double first_contact_temperature(const Linkage& model) {
  model.validate();
  const double alpha = model.link_ab.thermal_expansion;
  require(model.link_bc.thermal_expansion == alpha, "link_bc.thermal_expansion",
          model.link_bc.thermal_expansion, "that of link_ab [1/K]");
  const double rate =
      alpha * model.frame_length - (model.bearing_radius * model.bearing_thermal_expansion -
                                    model.journal_radius * model.journal_thermal_expansion);
  return rate > 0.0 ? model.radial_clearance() / rate : std::numeric_limits<double>::infinity();
}

}  // namespace statejump::linkage
