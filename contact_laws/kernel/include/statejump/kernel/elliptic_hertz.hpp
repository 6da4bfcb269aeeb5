// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <boost/math/special_functions/ellint_rd.hpp>
#include <boost/math/special_functions/ellint_rf.hpp>
#include <boost/math/tools/roots.hpp>
#include <cmath>
#include <cstdint>
#include <utility>

#include "statejump/kernel/require.hpp"

namespace statejump::kernel {

/// Principal curvatures of the gap between two touching surfaces, and their directions.
///
/// The gap is 1/2 (larger x^2 + smaller y^2): Johnson's A and B (Contact Mechanics, 1985, eq. 4.3)
/// are half of `larger` and `smaller`.
struct RelativeCurvature {
  double larger;   ///< [1/m]; the short semi-axis of the contact has this direction
  double smaller;  ///< [1/m]; the long semi-axis of the contact has this direction
  double angle;    ///< of `larger` [rad], from direction 1 of body 1 to direction 1 of body 2
};

/// Adds the curvatures of two bodies (Johnson 1985, eq. 4.4).
/// @param curvature_11, curvature_12 principal curvatures of body 1 [1/m], convex positive. A
///        journal of radius R1 has 1/R1 and 0, a bore of radius R2 has -1/R2 and 0.
/// @param curvature_21, curvature_22 principal curvatures of body 2 [1/m]
/// @param angle from the first principal direction of body 1 to that of body 2 [rad]
inline RelativeCurvature relative_curvature(double curvature_11, double curvature_12,
                                            double curvature_21, double curvature_22,
                                            double angle) {
  const double sum = curvature_11 + curvature_12 + curvature_21 + curvature_22;
  const double difference_1 = curvature_11 - curvature_12;
  const double difference_2 = curvature_21 - curvature_22;
  const double along = difference_1 + difference_2 * std::cos(2.0 * angle);
  const double across = difference_2 * std::sin(2.0 * angle);
  const double difference = std::hypot(along, across);
  return {0.5 * (sum + difference), 0.5 * (sum - difference), 0.5 * std::atan2(across, along)};
}

/// Largest ratio of the two curvatures that elliptic_shape() accepts. A contact with a larger ratio
/// is a line.
constexpr double largest_curvature_ratio = 1e10;

/// Contact ellipse for given relative curvatures. Its shape holds for every depth, because both
/// semi-axes grow as the square root of the depth.
struct EllipticShape {
  double long_axis;   ///< a / sqrt(delta) [m^0.5], a the longer semi-axis
  double short_axis;  ///< b / sqrt(delta) [m^0.5]
  double stiffness;   ///< F / (E* delta^1.5) [m^0.5]; 4/3 sqrt(R) for a circle
};

/// Computes the shape of the contact ellipse (Johnson 1985, section 4.2(b)).
///
/// A pressure p0 sqrt(1 - x^2/a^2 - y^2/b^2) gives the displacement (L - M x^2 - N y^2)/(pi E*)
/// (eqs 4.26), with k'^2 = b^2/a^2, k^2 = 1 - k'^2 and the complete elliptic integrals K, D, B,
/// D = (K - E)/k^2 and B = K - D:
///
///     L = pi p0 b K,    M = pi p0 b D/a^2,    N = pi p0 b B/b^2
///
/// L must equal delta; M and N must equal half the curvatures:
///
///     larger/smaller = B/(k'^2 D)          (eq. 4.28)
///     a^2 = 2 delta D/(smaller K)
///     F = 2/3 pi a b p0 = 2/3 pi E* a delta/K
///
/// Boost.Math computes K and D as Carlson's R_F(0, k'^2, 1) and R_D(0, k'^2, 1)/3. The difference K
/// - D suffers no cancellation, neither near the circle nor near the line. TOMS 748 finds ln(b/a)
/// in about ten evaluations of 0.2 us, so call this once per pair of curvatures, not in every step.
/// @throws std::invalid_argument unless 0 < larger < inf and larger/1e10 <= smaller <= larger
/// Limits: those of hertz(), and a well below the longer radius 1/smaller.
inline EllipticShape elliptic_shape(const RelativeCurvature& curvature) {
  const double larger = curvature.larger, smaller = curvature.smaller;
  require(larger > 0.0 && std::isfinite(larger), "larger relative curvature", larger,
          "(0, inf) 1/m: the journal must be more curved than the bore");
  require(smaller > 0.0 && smaller * largest_curvature_ratio >= larger,
          "smaller relative curvature", smaller,
          "[larger/1e10, larger] 1/m: below, the surfaces touch along a line, which is a matter of "
          "the line contact laws");
  require(smaller <= larger, "smaller relative curvature", smaller, "(0, larger] 1/m");
  constexpr double pi = 3.141592653589793238462643;
  const double ratio = std::log(larger / smaller);
  const auto integrals = [](double squared) {
    const double k = boost::math::ellint_rf(0.0, squared, 1.0);
    const double d = boost::math::ellint_rd(0.0, squared, 1.0) / 3.0;
    return std::pair<double, double>(k, d);
  };
  // Decreases with log_axes; zero at log_axes = ln(b/a).
  const auto residual = [&](double log_axes) {
    const auto [k, d] = integrals(std::exp(2.0 * log_axes));
    return std::log((k - d) / d) - 2.0 * log_axes - ratio;
  };
  double log_axes = 0.0;
  // Near the circle ln(b/a) = -2/3 ratio + O(ratio^3). The bracket uses D >= B, and D < 26 B
  // down to the smallest b/a.
  if (ratio > 1e-7) {
    const double high = -0.5 * ratio;
    const double low = -ratio - 2.0;
    std::uintmax_t evaluations = 100;
    const auto found = boost::math::tools::toms748_solve(
        residual, low, high, boost::math::tools::eps_tolerance<double>(52), evaluations);
    log_axes = 0.5 * (found.first + found.second);
  } else {
    log_axes = -2.0 / 3.0 * ratio;
  }
  const double axes = std::exp(log_axes);
  const auto [k, d] = integrals(axes * axes);
  const double long_axis = std::sqrt(2.0 * d / (smaller * k));
  return {long_axis, axes * long_axis, 2.0 / 3.0 * pi * long_axis / k};
}

/// Elastic normal contact with an elliptic area at one penetration depth.
struct EllipticHertzState {
  double force;           ///< F [N], >= 0, compressive
  double stiffness;       ///< dF/d(delta) [N/m], >= 0
  double long_axis;       ///< a [m], >= 0
  double short_axis;      ///< b [m], >= 0
  double elastic_energy;  ///< integral of F over delta [J], >= 0
};

/// Hertz contact of two surfaces with any curvatures: F = E* stiffness delta^1.5. The cost is one
/// square root.
/// @param effective_young_modulus E* [Pa], > 0
/// @param shape from elliptic_shape()
/// @param penetration_depth delta [m]; <= 0 is a gap and gives zeros. Arguments are not checked.
/// Limits: those of hertz().
inline EllipticHertzState elliptic_hertz(double effective_young_modulus, const EllipticShape& shape,
                                         double penetration_depth) {
  if (penetration_depth <= 0.0) return {0.0, 0.0, 0.0, 0.0, 0.0};
  const double root = std::sqrt(penetration_depth);
  const double stiffness = 1.5 * effective_young_modulus * shape.stiffness * root;
  const double force = stiffness * penetration_depth / 1.5;
  return {force, stiffness, shape.long_axis * root, shape.short_axis * root,
          0.4 * force * penetration_depth};
}

}  // namespace statejump::kernel
