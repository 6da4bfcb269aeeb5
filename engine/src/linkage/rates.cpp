// SPDX-License-Identifier: GPL-3.0-or-later
#include "rates.hpp"

namespace statejump::linkage::detail {

namespace {

LinkConstants constants(const ThermalLink& link, double pin_x, double ratio) {
  const double rigidity = link.young_modulus * link.cross_section_area;
  const double mass = link.mass / 3.0;
  return {pin_x,
          link.stress_free_length,
          link.stress_free_length * link.thermal_expansion,
          rigidity,
          1.0 / rigidity,
          1.0 / mass,
          2.0 * ratio * std::sqrt(rigidity / link.stress_free_length * mass)};
}

}  // namespace

Constants constants(const Linkage& m) {
  Constants k;
  k.ab = constants(m.link_ab, 0.0, m.axial_damping_ratio);
  k.bc = constants(m.link_bc, m.frame_length, m.axial_damping_ratio);
  k.pair = kernel::elastic_pair(m.link_bc.young_modulus, m.link_bc.poisson_ratio,
                                m.link_ab.young_modulus, m.link_ab.poisson_ratio);
  k.r1 = m.journal_radius;
  k.r2 = m.bearing_radius;
  k.r1_rate = k.r1 * m.journal_thermal_expansion;
  k.r2_rate = k.r2 * m.bearing_thermal_expansion;
  k.law = m.law;
  prepare(k.law.dissipation, k.law.restitution);
  k.pin_damping = m.pin_damping;
  k.torsion = m.torsion_stiffness;
  k.free_angle = m.free_angle();
  k.friction = m.friction_coefficient() > 0.0;
  k.friction_has_memory = k.friction && has(m.law.friction, kernel::laws::Trait::has_memory);
  k.dissipation = damping_ratio(m.law, m.law.smallest_impact_speed) > 0.0;
  k.couples = k.friction || k.pin_damping > 0.0 || k.torsion > 0.0;
  k.expanding = k.r1_rate != 0.0 || k.r2_rate != 0.0;
  return k;
}

double radii_energy_rate(const Constants& k, double depth, double temperature_change) {
  constexpr double half = 0.01;
  const auto stored = [&](double change) {
    return normal_state(k, depth, radii_at(k, change)).elastic_energy;
  };
  return (stored(temperature_change + half) - stored(temperature_change - half)) / (2.0 * half);
}

}  // namespace statejump::linkage::detail
