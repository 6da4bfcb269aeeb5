// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cmath>

#include "statejump/kernel/laws/parameters.hpp"
#include "statejump/kernel/require.hpp"

namespace statejump::kernel::laws {

/// Input of an impact dissipation law.
struct ImpactParameters {
  double restitution = parameter::restitution.default_value;  ///< e [-], in [0, 1]; 1: no loss
  double impact_speed = 1.0;  ///< delta_dot_0 [m/s], > 0: approach speed when the contact began
};

/// Checks restitution e and impact speed. Call it whenever they are set. Some laws
/// reject e = 0, see restitution_of().
inline void validate(const ImpactParameters& impact) {
  check(parameter::restitution_from_zero, impact.restitution);
  require(std::isfinite(impact.impact_speed) && impact.impact_speed > 0.0, "impact_speed",
          impact.impact_speed, "(0, inf) m/s");
}

/// Normal force with hysteresis damping, F = F_elastic (1 + (chi/K) delta_dot) [N], clipped at 0:
/// the bodies never pull on each other. For F_elastic = K delta^n, F = K delta^n + chi delta^n
/// delta_dot. The clip is never active in a free impact, but it is in a joint that is pulled apart.
///
/// Restitution e' that results. The equation v dv/(1 + lambda v) = -(F_elastic/m) d(delta), lambda
/// = chi/K, has the same right side during approach and rebound. So for every elastic law the true
/// restitution e' solves, with a = lambda v0,
///
///    a - ln(1 + a) = -a e' - ln(1 - a e'),   e' = 1 - 2a/3 + ... for small a.
///
/// lankarani_nikravesh and hunt_crossley (a = 3/2 (1 - e) to first order) give e' = e only for e ->
/// 1. flores (a = 8/5 (1 - e)) gives e' = 1 - 16/15 (1 - e) for e -> 1, but e' -> 0 as e -> 0.
/// @param elastic_force [N], >= 0; @param damping_ratio chi/K [s/m]
/// @param penetration_rate delta_dot [m/s], positive while approaching
inline double damped_force(double elastic_force, double damping_ratio, double penetration_rate) {
  return elastic_force * std::max(0.0, 1.0 + damping_ratio * penetration_rate);
}

/// No dissipation: chi = 0.
struct NoDissipation {
  static constexpr LawInfo info{
      "none", "chi = 0", "-", "any e; the impact is elastic", Trait::holds_static_load, {}};
  double operator()(const ImpactParameters&) const { return 0.0; }
};

/// Lankarani and Nikravesh, J. Mech. Des. 112, 1990: chi/K = 3/4 (1 - e^2)/v0 [s/m]. The law was
/// derived for small losses; for e -> 0 the restitution that results is still 0.66. See
/// damped_force().
struct LankaraniNikravesh {
  static constexpr LawInfo info{"lankarani_nikravesh",
                                "chi = 3/4 K (1 - e^2)/v0",
                                "Lankarani, Nikravesh, J. Mech. Des. 112, 1990",
                                "0 < e <= 1, v0 > 0; returns the requested e only for e -> 1",
                                Trait::holds_static_load,
                                {&parameter::restitution, &parameter::smallest_impact_speed}};
  double operator()(const ImpactParameters& impact) const {
    const double e = impact.restitution;
    return 0.75 * (1.0 - e) * (1.0 + e) / impact.impact_speed;
  }
};

/// Hunt and Crossley, J. Appl. Mech. 42, 1975: chi/K = 3/2 (1 - e)/v0 [s/m]. The law was derived
/// for small losses; for e -> 0 the restitution that results is still 0.49. See damped_force().
struct HuntCrossley {
  static constexpr LawInfo info{"hunt_crossley",
                                "chi = 3/2 K (1 - e)/v0",
                                "Hunt, Crossley, J. Appl. Mech. 42, 1975",
                                "0 < e <= 1, v0 > 0; returns the requested e only for e -> 1",
                                Trait::holds_static_load,
                                {&parameter::restitution, &parameter::smallest_impact_speed}};
  double operator()(const ImpactParameters& impact) const {
    return 1.5 * (1.0 - impact.restitution) / impact.impact_speed;
  }
};

/// Flores, Machado, Silva and Martins, Multibody Syst. Dyn. 25, 2011: chi/K = 8/5 (1 - e)/(e v0)
/// [s/m]. The law is meant for the whole range of e. For e -> 1 the loss 1 - e' that results is
/// 16/15 of 1 - e. See damped_force().
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

/// Dissipation whose true restitution is exactly e: a = lambda v0 of damped_force() for e' = e,
///
///    a - ln(1 + a) = -a e - ln(1 - a e),   chi/K = a/v0.
///
/// With q = -ln(1 - a e), a = (1 - exp(-q))/e, Newton's method finds the nonzero root of a (1 + e)
/// - ln(1 + a) - q from above. The function is concave there, so the iteration does not overshoot.
/// Its initial q follows from a < 1/e for e <= 0.5 and from a e < 3/2 (1 - e) otherwise. No
/// constant is fitted.
///
/// e = 0 would need an infinite damper. The law replaces e < 1e-6 by 1e-6, which is its largest
/// error in e. For small e, a = 1/e and the force rises 1/e times as fast. An explicit integrator
/// then has to resolve a depth smaller by the factor e^0.4. Newton's method costs as much as many
/// time steps, so prepare() runs it once.
struct ExactRestitution {
  static constexpr LawInfo info{
      "exact_restitution",
      "chi = K a/v0, a - ln(1 + a) = -a e - ln(1 - a e)",
      "energy balance of F = K delta^n + chi delta^n d(delta)/dt, as in "
      "Hunt, Crossley, J. Appl. Mech. 42, 1975, without small losses",
      "0 <= e <= 1, v0 > 0; returns the requested e, to 1e-6",
      Trait::holds_static_load,
      {&parameter::restitution_from_zero, &parameter::smallest_impact_speed}};
  double operator()(const ImpactParameters& impact) const {
    const double e = std::max(impact.restitution, smallest);
    return (e == known_for_ ? known_ : coefficient(e)) / impact.impact_speed;
  }
  /// Computes the coefficient for this restitution e in advance. This reduces the cost and does not
  /// change results.
  void prepare(double restitution) {
    known_for_ = std::max(restitution, smallest);
    known_ = coefficient(known_for_);
  }
  /// a [-] for e in (0, 1].
  static double coefficient(double e) {
    if (e >= 1.0) return 0.0;
    double q = e > 0.5 ? -std::log1p(-1.5 * (1.0 - e)) : 1.0 + 1.0 / e - std::log1p(1.0 / e);
    for (int i = 0; i < 100; ++i) {
      const double a = -std::expm1(-q) / e;
      const double slope = std::exp(-q) / e * (1.0 + e - 1.0 / (1.0 + a)) - 1.0;
      const double change = (a * (1.0 + e) - std::log1p(a) - q) / slope;
      q -= change;
      if (!(std::abs(change) > 1e-14 * q)) break;
    }
    return -std::expm1(-q) / e;
  }

 private:
  static constexpr double smallest = 1e-6;
  double known_for_ = 1.0;  // e of the stored coefficient `known_`
  double known_ = 0.0;
};

}  // namespace statejump::kernel::laws
