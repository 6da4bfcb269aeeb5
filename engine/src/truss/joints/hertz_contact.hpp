// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cmath>

#include "numerics/hertz.hpp"

namespace statejump::truss::detail {

/// A function of the normal force, with its derivative.
struct ByNormal {
  double value;
  double slope;
};

/// Contact of two round parts after Hertz and Mindlin: F_N = K δ^1.5 and k_t = 8 G* √(R δ).
/// Infinite stiffnesses mean a rigid contact.
struct HertzContact {
  double hertz_stiffness;    ///< K [N/m^1.5]
  double mindlin_stiffness;  ///< 8 G* √R [N/m^1.5]
  double radial_clearance;   ///< [m]

  /// Normal force at which the depth is a millionth of the clearance [N]. Below this force the law
  /// is linear. Otherwise a contact that just closes would have an infinite compliance, and
  /// Newton's method would not converge.
  double least_force() const { return hertz_stiffness * std::pow(1e-6 * radial_clearance, 1.5); }

  /// Depth under a normal force [m].
  ByNormal depth(double normal_force) const {
    if (std::isinf(hertz_stiffness)) return {0.0, 0.0};
    const double least = least_force();
    const double depth = numerics::hertz_depth(hertz_stiffness, std::max(normal_force, least));
    if (normal_force < least) return {depth * (normal_force / least), depth / least};
    return {depth, 2.0 / 3.0 * depth / normal_force};
  }

  /// 1/k_t of a sticking contact [m/N]; 0: rigid.
  ByNormal tangential_compliance(double normal_force) const {
    if (std::isinf(mindlin_stiffness)) return {0.0, 0.0};
    const double least = least_force();
    const double loaded = std::max(normal_force, least);
    const double compliance =
        1.0 / numerics::mindlin_stiffness(mindlin_stiffness, depth(loaded).value);
    // k_t is proportional to the cube root of the force.
    return {compliance, normal_force > least ? -compliance / (3.0 * normal_force) : 0.0};
  }

  /// Elastic energy of the indentation [J].
  double energy(double normal_force) const {
    if (std::isinf(hertz_stiffness)) return 0.0;
    const double linear = std::min(normal_force, least_force());
    return 0.4 * normal_force * depth(normal_force).value  // 2/5 K δ^5/2
           + 0.1 * linear * depth(linear).value;
  }
};

/// Heat of micro-slip at the rim of a sticking contact [J]: work of friction minus the change of
/// stored energy. The force changes from F at compliance C to F' at C'. Loading: slide ΔF (C +
/// C')/2, heat (F² + F'²) (C − C')/4. Unloading: slide F' C' − F C, heat F·F' (C' − C)/2.
/// @param before_squared, product, squared F², F·F', F'² [N²]
inline double rim_slip(double before_squared, double compliance_before, double product,
                       double squared, double compliance) {
  if (compliance_before == 0.0) return 0.0;
  if (compliance == 0.0) return 0.5 * compliance_before * before_squared;
  if (compliance > compliance_before) return 0.5 * product * (compliance - compliance_before);
  return 0.25 * (before_squared + squared) * (compliance_before - compliance);
}

}  // namespace statejump::truss::detail
