// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <boost/math/special_functions/lambert_w.hpp>
#include <boost/math/special_functions/log1p.hpp>
#include <boost/math/tools/toms748_solve.hpp>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>

#include "statejump/kernel/hertz.hpp"
#include "statejump/kernel/laws/parameters.hpp"
#include "statejump/kernel/require.hpp"

namespace statejump::kernel::laws {

/// Geometry of journal and bearing.
struct NormalGeometry {
  double journal_radius;  ///< R1 [m], > 0
  double bearing_radius;  ///< R2 [m], > R1, finite; clearance dR = R2 - R1
  double length;          ///< L [m], > 0, axial length of a line contact; point laws ignore it
  double clearance() const { return bearing_radius - journal_radius; }
};

/// Material of the pair; see elastic_pair().
struct NormalMaterial {
  double effective_young_modulus;  ///< E* [Pa], > 0
};

/// Output of a normal law at one penetration depth.
struct NormalState {
  double force;           ///< F [N], >= 0, compressive
  double stiffness;       ///< dF/d(delta) [N/m], >= 0
  double contact_width;   ///< contact radius (point) or half width (line) a [m], >= 0
  double elastic_energy;  ///< integral of F over delta [J], >= 0
};

/// Checks geometry and material. Call it whenever they are set, because the laws do not
/// check them.
/// @throws std::invalid_argument that names the field, its value and its range
inline void validate(const NormalGeometry& geometry, const NormalMaterial& material) {
  const auto positive = [](double value, const char* name, const char* range) {
    require(std::isfinite(value) && value > 0.0, name, value, range);
  };
  positive(geometry.journal_radius, "journal_radius", "(0, inf) m");
  require(std::isfinite(geometry.bearing_radius) && geometry.clearance() > 0.0, "bearing_radius",
          geometry.bearing_radius, "(journal_radius, inf) m");
  positive(geometry.length, "length", "(0, inf) m");
  positive(material.effective_young_modulus, "effective_young_modulus", "(0, inf) Pa");
}

/// Error for a penetration depth outside the range of a normal law, with its data as fields.
class DepthOutOfRange : public std::domain_error {
 public:
  /// @param law name of the law, @param depth [m], @param limit smallest depth that is not allowed
  ///     [m]
  DepthOutOfRange(std::string law, double depth, double limit)
      : std::domain_error(sentence(law, depth, limit)),
        law_(std::move(law)),
        depth_(depth),
        limit_(limit) {}
  const std::string& law() const { return law_; }
  double depth() const { return depth_; }
  double limit() const { return limit_; }

 private:
  static std::string sentence(const std::string& law, double depth, double limit) {
    char numbers[112];
    std::snprintf(numbers, sizeof numbers, ": penetration_depth = %.9g m, allowed is below %.9g m",
                  depth, limit);
    return law + numbers;
  }
  std::string law_;
  double depth_, limit_;
};

namespace detail {

constexpr double pi = 3.14159265358979323846;

[[noreturn, gnu::cold, gnu::noinline]] inline void refuse_depth(double depth, double limit,
                                                                const char* law) {
  throw DepthOutOfRange(law, depth, limit);
}

/// Rejects a depth outside a law's range, NaN included.
/// @throws DepthOutOfRange
inline void require_depth(double depth, double limit, const char* law) {
  if (!(depth < limit)) refuse_depth(depth, limit, law);
}

inline NormalState from_hertz(const HertzState& state) {
  return {state.force, state.stiffness, state.contact_radius, state.elastic_energy};
}

/// Line contact with delta = f/(pi E*) u, u = s + ln(4 pi E* dR/f), f = F/L. The constant s is -1
/// in Johnson's formula and +1 in ESDU's.
///
/// With y = delta/(4 dR) the relation is u e^-u = y e^-s. So u has the closed form -W(-y e^-s),
/// with the lower branch of Lambert's W, where u > 1. Then
///
///    dF/d(delta) = pi E* L/(u - 1)
///    integral of F d(delta) = F f/(4 pi E*) (2u - 1)
///
/// At u = 1 (delta = 4 dR e^(s-1)) F(delta) has its turning point, where the stiffness is infinite.
inline NormalState logarithmic_line_contact(double depth, const NormalGeometry& geometry,
                                            const NormalMaterial& material, double scaled_limit) {
  const double modulus = pi * material.effective_young_modulus;
  // With scaled_limit = 4 dR e^s, depth/scaled_limit < 1/e holds within the range of the law.
  const double argument = std::max(depth / scaled_limit, std::numeric_limits<double>::min());
  const double u = -boost::math::lambert_wm1(-argument);
  const double line_force = modulus * depth / u;
  const double force = line_force * geometry.length;
  const double radius = internal_effective_radius(geometry.journal_radius, geometry.bearing_radius);
  return {force, modulus * geometry.length / (u - 1.0),
          std::sqrt(4.0 * line_force * radius / modulus),
          0.25 * force * (line_force / modulus) * (2.0 * u - 1.0)};
}

}  // namespace detail

/// Hertz as printed in the paper, eqs (6) to (8): F = 4/3 E* sqrt(R) delta^1.5 with R = R1 R2/(R1 +
/// R2) [m], the effective radius of two balls in external contact. A pin in a hole needs R2 - R1
/// instead of R1 + R2, so with the data of Table 2 this law is ten times too soft. It is kept for
/// comparison with the paper. Limits: see hertz().
struct HertzPaper {
  static constexpr LawInfo info{
      "hertz_paper",
      "F = 4/3 E* sqrt(R1 R2/(R1 + R2)) delta^1.5",
      "Chen, Li, Tang, Wang, Mech. Sci. 12, 2021, eqs 6-8",
      "delta >= 0; a << R1; external radius, too soft for a pin in a hole",
      Trait::holds_static_load | Trait::point_contact,
      {}};
  static double largest_depth(const NormalGeometry&) {
    return std::numeric_limits<double>::infinity();
  }
  NormalState operator()(double depth, const NormalGeometry& geometry,
                         const NormalMaterial& material) const {
    detail::require_depth(depth, largest_depth(geometry), info.name);
    const double radius =
        geometry.journal_radius / (1.0 + geometry.journal_radius / geometry.bearing_radius);
    return detail::from_hertz(hertz(material.effective_young_modulus, radius, depth));
  }
};

/// Hertz with the curvature of a pin in a hole, R = R1 R2/(R2 - R1) [m]: F = 4/3 E* sqrt(R)
/// delta^1.5 (Johnson 1985, eqs 4.14, 4.22, 4.23). See hertz(), internal_effective_radius().
/// Limits: a point contact with a = sqrt(R delta) << R1, whereas a real cylinder in a bore touches
/// along a line.
struct HertzInternal {
  static constexpr LawInfo info{
      "hertz_internal",
      "F = 4/3 E* sqrt(R1 R2/(R2 - R1)) delta^1.5",
      "Johnson, Contact Mechanics, 1985, eqs 4.14, 4.22, 4.23",
      "delta >= 0; a << R1; point contact",
      Trait::holds_static_load | Trait::point_contact | Trait::accepts_bulging_wall,
      {}};
  static double largest_depth(const NormalGeometry&) {
    return std::numeric_limits<double>::infinity();
  }
  NormalState operator()(double depth, const NormalGeometry& geometry,
                         const NormalMaterial& material) const {
    detail::require_depth(depth, largest_depth(geometry), info.name);
    const double radius =
        internal_effective_radius(geometry.journal_radius, geometry.bearing_radius);
    return detail::from_hertz(hertz(material.effective_young_modulus, radius, depth));
  }
};

/// Johnson's line contact of a cylinder in a bore, length L, f = F/L:
///
///     delta = f/(pi E*) (ln(4 pi E* dR/f) - 1).
///
/// Each body contributes f (1 - nu^2)/(pi E) (2 ln(4 R_i/a) - 1), with depths measured from its
/// centre (Johnson 1985, eq. 5.57). With the half width of the Hertz line contact a^2 = 4 f R/(pi
/// E*), R = R1 R2/dR (eq. 4.43), the sum of both contributions is this formula. Pereira, Ramalho
/// and Ambrosio, Nonlinear Dyn. 63, 2011, use it in this form. Units: m, N, Pa.
/// Limits: F(delta) has a turning point at f = 4 pi E* dR/e^2, delta = 4 dR/e^2. From that depth on
/// the law reports an error. The half-plane assumption fails earlier: at the turning point a is
/// 1.47 R1. The law is valid for a << R1 and delta << dR; use `persson` for deeper contacts.
struct Johnson {
  static constexpr LawInfo info{
      "johnson",
      "delta = f/(pi E*) (ln(4 pi E* dR/f) - 1), f = F/L",
      "Johnson, Contact Mechanics, 1985, eqs 4.43, 5.57; Pereira, Ramalho, Ambrosio, Nonlinear "
      "Dyn. "
      "63, 2011",
      "0 <= delta < 4 dR/e^2 = 0.541 dR, error beyond; accurate for a << R1",
      Trait::holds_static_load | Trait::needs_axis,
      {&parameter::contact_length}};
  static double largest_depth(const NormalGeometry& geometry) {
    return 4.0 * std::exp(-2.0) * geometry.clearance();
  }
  NormalState operator()(double depth, const NormalGeometry& geometry,
                         const NormalMaterial& material) const {
    if (depth <= 0.0) return {0.0, 0.0, 0.0, 0.0};
    detail::require_depth(depth, largest_depth(geometry), info.name);
    return detail::logarithmic_line_contact(depth, geometry, material,
                                            4.0 * std::exp(-1.0) * geometry.clearance());
  }
};

/// Line contact after ESDU 78035 (Engineering Sciences Data Unit, 1978), as quoted by Flores,
/// Ambrosio, Claro and Lankarani, 2006, with sigma_i = (1 - nu_i^2)/(pi E_i):
///
///     delta = f (sigma1 + sigma2) (ln(4 dR/(f (sigma1 + sigma2))) + 1),   f = F/L,
///
/// that is delta = f/(pi E*) (ln(4 pi E* dR/f) + 1). Johnson's formula has -1 instead of +1, so
/// this contact is softer. Units: m, N, Pa. (Texts that define sigma without 1/pi print other
/// factors. The coefficient 1/(pi E*) of f ln f follows from elasticity, so it is used here.)
/// Limits: F(delta) has a turning point at f = 4 pi E* dR, delta = 4 dR. From that depth on the law
/// reports an error. At that point the half width a is 4 R1, so the half-plane assumption fails
/// much earlier: a < R1 requires f < pi E* dR/4.
struct Esdu78035 {
  static constexpr LawInfo info{
      "esdu_78035",
      "delta = f/(pi E*) (ln(4 pi E* dR/f) + 1), f = F/L",
      "ESDU 78035, 1978, quoted by Flores, Ambrosio, Claro, Lankarani, 2006",
      "0 <= delta < 4 dR, error beyond; accurate for a << R1",
      Trait::holds_static_load | Trait::needs_axis,
      {&parameter::contact_length}};
  static double largest_depth(const NormalGeometry& geometry) { return 4.0 * geometry.clearance(); }
  NormalState operator()(double depth, const NormalGeometry& geometry,
                         const NormalMaterial& material) const {
    if (depth <= 0.0) return {0.0, 0.0, 0.0, 0.0};
    detail::require_depth(depth, largest_depth(geometry), info.name);
    return detail::logarithmic_line_contact(depth, geometry, material,
                                            4.0 * std::exp(1.0) * geometry.clearance());
  }
};

namespace detail {

/// Persson's contact at t = tan(epsilon/2)^2. Line forces are in units of E* dR, depths in units of
/// dR.
struct PerssonPoint {
  double load_divisor;  ///< X; f = 2 pi t (1 + t)/X
  double compliance;    ///< C = pi d(delta)/df
  double offset;        ///< omega - 1; delta = C f/pi + omega - 1
};

/// Largest t, where X = 0. The load is infinite or the clearance zero, and epsilon = 84.83 degrees.
constexpr double persson_largest_t = 0.83461524547765723156;

inline PerssonPoint persson_point(double t) {
  const double l = boost::math::log1p(t);
  const double b2 = 1.0 + t;
  const double s = 1.0 + 2.0 * t;
  const double x = 2.0 - l - 2.0 * t * t;
  const double n = 2.0 + 5.0 * t + 2.0 * t * t - s * l;
  const double offset = (3.0 * t - 2.0 * t / b2 - 2.0 * t * t + s * l) / n;
  const double c = std::log(4.0 * b2 / t) - 2.0 - 0.5 * offset +
                   t * (2.0 + 2.5 * t + s * x / n) / (b2 * b2) + s * s * l / (b2 * n);
  return {x, c, offset};
}

}  // namespace detail

/// Persson's conformal contact of a disc in a hole of nearly its radius, in plane strain and
/// without the half-plane assumption. The contact may cover a large arc with half angle epsilon, t
/// = tan(epsilon/2)^2.
///
/// When the journal has moved by dR + delta, the gap is dR - (dR + delta) cos phi + u(phi). A
/// pressure sum p_n cos(n phi) opens u_n = (2R/E*) n/(n^2 - 1) p_n, n >= 2, and u_0 = (R/E*) p_0
/// (Michell's series for disc and hole, equal materials). Applying d^2/dphi^2 + 1 to the zero gap
/// on the arc gives a Cauchy singular equation in tan(phi/2). Its bounded solution is Persson's
/// load (1964; Ciavarella and Decuzzi, Int. J. Solids Struct. 38, 2001, elastic similarity)
///
///    f/(E* dR) = 2 pi t (1 + t)/X,   X = 2 - ln(1 + t) - 2 t^2,   f = F/L.
///
/// Depth: the first harmonic is a rigid translation, which a plane problem leaves undetermined (a
/// point load sinks infinitely deep in an infinite plane). This law chooses it such that at light
/// load the depth tends to Johnson's, delta -> f/(pi E*) (ln(4 pi E* dR/f) - 1). The reciprocal
/// theorem between the contact and its increment then gives, in units of dR,
///
///    delta = C f/(pi E* dR) + omega - 1,   C = pi E* d(delta)/df, where
///    N = 2 + 5t + 2t^2 - (1 + 2t) ln(1 + t)
///    omega - 1 = (3t - 2t/(1 + t) - 2t^2 + (1 + 2t) ln(1 + t))/N
///    C = ln(4(1 + t)/t) - 2 - (omega - 1)/2 + t (2 + 5t/2 + (1 + 2t) X/N)/(1 + t)^2
///        + (1 + 2t)^2 ln(1 + t)/((1 + t) N).
///
/// Boost's toms748 solves delta(t) = delta for t; no constant is fitted. The energy is half the
/// integral of p u:
/// 1/2 f (delta - dR (ln(1 + t) - t + t^2)/(t (1 + t))) L. The contact width is the arc R1 epsilon.
/// Units: m, N, Pa.
/// Limits: delta < R1, else an error; small strain; equal elastic constants of both bodies (only E*
/// enters); bearing much thicker than R2; the arc stays below 84.83 degrees.
struct Persson {
  static constexpr LawInfo info{
      "persson",
      "f = 2 pi E* dR t (1 + t)/(2 - ln(1 + t) - 2 t^2), t = tan(eps/2)^2, f = F/L; depth fixed to "
      "johnson at light load",
      "Persson, 1964; Ciavarella, Decuzzi, Int. J. Solids Struct. 38, 2001; depth derived here",
      "0 <= delta < R1, error beyond; equal materials, thick bearing, plane strain",
      Trait::holds_static_load | Trait::needs_axis,
      {&parameter::contact_length}};
  static double largest_depth(const NormalGeometry& geometry) { return geometry.journal_radius; }
  NormalState operator()(double depth, const NormalGeometry& geometry,
                         const NormalMaterial& material) const {
    if (depth <= 0.0) return {0.0, 0.0, 0.0, 0.0};
    detail::require_depth(depth, largest_depth(geometry), info.name);
    const double clearance = geometry.clearance();
    const double scaled = std::max(depth / clearance, 1e-290);
    // (C f/pi + omega - 1 - delta) X is smooth and has one sign change up to the largest arc
    const auto residue = [scaled](double t) {
      const detail::PerssonPoint p = detail::persson_point(t);
      return 2.0 * t * (1.0 + t) * p.compliance + p.load_divisor * (p.offset - scaled);
    };
    // lower end: t = delta/u with 1 < u < 800 while delta is small; the upper end holds for any
    // depth
    std::uintmax_t iterations = 200;
    const auto bracket = boost::math::tools::toms748_solve(
        residue, std::min(scaled, 0.1) / 800.0, std::min(scaled, detail::persson_largest_t),
        boost::math::tools::eps_tolerance<double>(52), iterations);
    const double t = 0.5 * (bracket.first + bracket.second);
    const detail::PerssonPoint p = detail::persson_point(t);
    // the force is computed from the depth, not from t, and thus well conditioned where X tends to
    // zero
    const double line_force = detail::pi * material.effective_young_modulus * clearance *
                              (scaled - p.offset) / p.compliance;
    const double force = line_force * geometry.length;
    const double spread = (boost::math::log1pmx(t) + t * t) / (t * (1.0 + t));
    return {force, detail::pi * material.effective_young_modulus * geometry.length / p.compliance,
            geometry.journal_radius * 2.0 * std::atan(std::sqrt(t)),
            0.5 * force * clearance * (scaled - spread)};
  }
};

}  // namespace statejump::kernel::laws
