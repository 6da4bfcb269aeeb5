// SPDX-License-Identifier: GPL-3.0-or-later
// The frictionless rib in one hand-written Runge-Kutta loop, as a reference for the cost of the
// engine's general ODE. No energies, no samples, no events, no choice of laws.
#pragma once

#include <cmath>

#include "statejump/linkage/model.hpp"

namespace statejump::linkage::bench {

struct BareResult {
  double state[8];  ///< tips of AB and BC, then their velocities
};

/// Runs a temperature change 0 → `peak` K → 0 over `duration` [s] in `steps` steps, from the given
/// state.
inline BareResult bare_run(const linkage::Linkage& m, const linkage::State& start, double peak,
                           double duration, int steps) {
  const double ea1 = m.link_ab.young_modulus * m.link_ab.cross_section_area;
  const double ea2 = m.link_bc.young_modulus * m.link_bc.cross_section_area;
  const double l1 = m.link_ab.stress_free_length, l2 = m.link_bc.stress_free_length;
  const double s1 = l1 * m.link_ab.thermal_expansion, s2 = l2 * m.link_bc.thermal_expansion;
  const double w1 = 3.0 / m.link_ab.mass, w2 = 3.0 / m.link_bc.mass;
  const double pin = m.frame_length;
  const double c = m.bearing_radius - m.journal_radius;
  const double e1 =
      m.link_ab.young_modulus / (1.0 - m.link_ab.poisson_ratio * m.link_ab.poisson_ratio);
  const double e2 =
      m.link_bc.young_modulus / (1.0 - m.link_bc.poisson_ratio * m.link_bc.poisson_ratio);
  const double hertz =
      4.0 / 3.0 * (e1 * e2 / (e1 + e2)) * std::sqrt(m.journal_radius * m.bearing_radius / c);
  const double h = duration / steps;
  const double rate = 2.0 * peak / duration;

  BareResult y{{start.bearing_centre.x(), start.bearing_centre.y(), start.journal_centre.x(),
                start.journal_centre.y(), start.bearing_velocity.x(), start.bearing_velocity.y(),
                start.journal_velocity.x(), start.journal_velocity.y()}};
  const auto rates = [&](const double* s, double heat, double* f) {
    const double f1 = l1 + s1 * heat, f2 = l2 + s2 * heat;
    const double r1 = std::sqrt(s[0] * s[0] + s[1] * s[1]);
    const double bx = s[2] - pin;
    const double r2 = std::sqrt(bx * bx + s[3] * s[3]);
    const double p1 = ea1 / f1 * (f1 - r1) / r1;
    const double p2 = ea2 / f2 * (f2 - r2) / r2;
    double x1 = p1 * s[0], y1 = p1 * s[1], x2 = p2 * bx, y2 = p2 * s[3];
    const double dx = s[2] - s[0], dy = s[3] - s[1];
    const double squared = dx * dx + dy * dy;
    if (squared > c * c) {
      const double distance = std::sqrt(squared);
      const double depth = distance - c;
      const double push = hertz * depth * std::sqrt(depth) / distance;
      x1 += push * dx;
      y1 += push * dy;
      x2 -= push * dx;
      y2 -= push * dy;
    }
    f[0] = s[4];
    f[1] = s[5];
    f[2] = s[6];
    f[3] = s[7];
    f[4] = x1 * w1;
    f[5] = y1 * w1;
    f[6] = x2 * w2;
    f[7] = y2 * w2;
  };
  double k1[8], k2[8], k3[8], k4[8], s[8];
  for (int n = 0; n < steps; ++n) {
    const double t = n * h;
    const bool heating = 2 * n < steps;
    const double a = heating ? rate * t : rate * (duration - t);
    const double b = heating ? a + 0.5 * rate * h : a - 0.5 * rate * h;
    const double e = heating ? a + rate * h : a - rate * h;
    rates(y.state, a, k1);
    for (int i = 0; i < 8; ++i) s[i] = y.state[i] + 0.5 * h * k1[i];
    rates(s, b, k2);
    for (int i = 0; i < 8; ++i) s[i] = y.state[i] + 0.5 * h * k2[i];
    rates(s, b, k3);
    for (int i = 0; i < 8; ++i) s[i] = y.state[i] + h * k3[i];
    rates(s, e, k4);
    for (int i = 0; i < 8; ++i) {
      y.state[i] += h / 6.0 * (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]);
    }
  }
  return y;
}

}  // namespace statejump::linkage::bench
