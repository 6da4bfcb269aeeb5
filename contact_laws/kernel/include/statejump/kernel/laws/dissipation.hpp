// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cmath>

#include "statejump/kernel/laws/parameters.hpp"
#include "statejump/kernel/require.hpp"

namespace statejump::kernel::laws {

/// What an impact dissipation law needs.
struct ImpactParameters {
  double restitution = parameter::restitution.standard;  ///< e [-], in (0, 1]; 1: no loss
  double impact_speed = 1.0;  ///< delta_dot_0 [m/s], > 0: approach speed when the contact begins
};

/// Checks an impact where it enters.
/// @throws std::invalid_argument that names the field, its value and its range
inline void validate(const ImpactParameters& impact) {
  check(parameter::restitution, impact.restitution);
  require(std::isfinite(impact.impact_speed) && impact.impact_speed > 0.0, "impact_speed",
          impact.impact_speed, "(0, inf) m/s");
}

/// Normal force with hysteresis damping, F = F_elastic (1 + (chi/K) delta_dot) [N], clipped at 0:
/// the bodies never pull on each other. For F_elastic = K delta^n this is K delta^n + chi delta^n
/// delta_dot. A free impact never reaches the clip; a joint pulled apart does.
///
/// What restitution comes out. v dv/(1 + lambda v) = -(F_elastic/m) d(delta), lambda = chi/K, has
/// the same right side going in and coming out, so for every elastic law the true restitution e'
/// solves, with a = lambda v0,
///
///     a - ln(1 + a) = -a e' - ln(1 - a e'),   e' = 1 - 2a/3 + ... for small a.
///
/// lankarani_nikravesh and hunt_crossley (a = 3/2 (1 - e) to first order) return e for e -> 1 only;
/// flores (a = 8/5 (1 - e)) returns 1 - 16/15 (1 - e) there, in exchange for e' -> 0 as e -> 0.
/// @param elastic_force [N], >= 0; @param damping_ratio chi/K [s/m]; @param penetration_rate
///        delta_dot [m/s], positive while approaching
inline double damped_force(double elastic_force, double damping_ratio, double penetration_rate) {
  return elastic_force * std::max(0.0, 1.0 + damping_ratio * penetration_rate);
}

/// No dissipation: chi = 0.
struct NoDissipation {
  static constexpr LawInfo info{
      "none", "chi = 0", "-", "any e; the impact is elastic", Trait::holds_static_load, {}};
  double operator()(const ImpactParameters&) const { return 0.0; }
};

/// Lankarani and Nikravesh, J. Mech. Des. 112, 1990: chi/K = 3/4 (1 - e^2)/v0 [s/m]. Derived for
/// small losses; for e -> 0 it still returns e' = 0.66. See damped_force().
struct LankaraniNikravesh {
  static constexpr LawInfo info{"lankarani_nikravesh",
                                "chi = 3/4 K (1 - e^2)/v0",
                                "Lankarani, Nikravesh, J. Mech. Des. 112, 1990",
                                "0 < e <= 1, v0 > 0; restitution as asked for e -> 1 only",
                                Trait::holds_static_load,
                                {&parameter::restitution, &parameter::smallest_impact_speed}};
  double operator()(const ImpactParameters& impact) const {
    const double e = impact.restitution;
    return 0.75 * (1.0 - e) * (1.0 + e) / impact.impact_speed;
  }
};

/// Hunt and Crossley, J. Appl. Mech. 42, 1975: chi/K = 3/2 (1 - e)/v0 [s/m]. Derived for small
/// losses; for e -> 0 it still returns e' = 0.49. See damped_force().
struct HuntCrossley {
  static constexpr LawInfo info{"hunt_crossley",
                                "chi = 3/2 K (1 - e)/v0",
                                "Hunt, Crossley, J. Appl. Mech. 42, 1975",
                                "0 < e <= 1, v0 > 0; restitution as asked for e -> 1 only",
                                Trait::holds_static_load,
                                {&parameter::restitution, &parameter::smallest_impact_speed}};
  double operator()(const ImpactParameters& impact) const {
    return 1.5 * (1.0 - impact.restitution) / impact.impact_speed;
  }
};

/// Flores, Machado, Silva and Martins, Multibody Syst. Dyn. 25, 2011: chi/K = 8/5 (1 - e)/(e v0)
/// [s/m]. Meant for the whole range of e; for e -> 1 the loss is 16/15 of that asked for. See
/// damped_force().
struct FloresDissipation {
  static constexpr LawInfo info{"flores",
                                "chi = 8/5 K (1 - e)/(e v0)",
                                "Flores, Machado, Silva, Martins, Multibody Syst. Dyn. 25, 2011",
                                "0 < e <= 1, v0 > 0; 1 - e' = 16/15 (1 - e) for e -> 1",
                                Trait::holds_static_load,
                                {&parameter::restitution, &parameter::smallest_impact_speed}};
  double operator()(const ImpactParameters& impact) const {
    return 1.6 * (1.0 - impact.restitution) / (impact.restitution * impact.impact_speed);
  }
};

}  // namespace statejump::kernel::laws
