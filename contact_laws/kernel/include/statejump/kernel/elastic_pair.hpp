// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>

#include "statejump/kernel/require.hpp"

namespace statejump::kernel {

/// Elastic constants of two isotropic bodies in contact.
///
/// Both half-spaces deform under the same traction, so their compliances add (Johnson, Contact
/// Mechanics, 1985, eqs 3.31 and 4.25; Mindlin 1949 for shear). The paper's eqs 7 and 8 are the
/// normal part:
///
///    1/E* = (1 - nu1^2)/E1 + (1 - nu2^2)/E2
///    1/G* = (2 - nu1)/G1  + (2 - nu2)/G2,     G = E / (2 (1 + nu))
///
/// G* enters Mindlin's tangential stiffness k_t = 8 G* a. It is not a mean of the two shear moduli:
/// for equal materials G* = G / (2 (2 - nu)).
struct ElasticPair {
  double effective_young_modulus;  ///< E* [Pa], > 0
  double effective_shear_modulus;  ///< G* [Pa], > 0
};

/// Combines the materials of two bodies.
/// @param young_modulus_1, young_modulus_2  E [Pa], > 0. One of them (not both) may be +infinity,
///     for a rigid body.
/// @param poisson_ratio_1, poisson_ratio_2  nu [-], in (-1, 0.5].
/// @throws std::invalid_argument that names the argument, its value and its range.
inline ElasticPair elastic_pair(double young_modulus_1, double poisson_ratio_1,
                                double young_modulus_2, double poisson_ratio_2) {
  const auto check_poisson = [&](double nu, const char* name) {
    require(nu > -1.0 && nu <= 0.5, name, nu, "(-1, 0.5]");
  };
  require(young_modulus_1 > 0.0, "young_modulus_1", young_modulus_1, "(0, inf] Pa");
  require(young_modulus_2 > 0.0, "young_modulus_2", young_modulus_2, "(0, inf] Pa");
  require(std::isfinite(young_modulus_1) || std::isfinite(young_modulus_2), "young_modulus_2",
          young_modulus_2, "(0, inf) Pa when body 1 is rigid");
  check_poisson(poisson_ratio_1, "poisson_ratio_1");
  check_poisson(poisson_ratio_2, "poisson_ratio_2");

  const auto normal_compliance = [](double e, double nu) { return (1.0 - nu * nu) / e; };
  const auto shear_compliance = [](double e, double nu) {
    return (2.0 - nu) * 2.0 * (1.0 + nu) / e;
  };
  return {1.0 / (normal_compliance(young_modulus_1, poisson_ratio_1) +
                 normal_compliance(young_modulus_2, poisson_ratio_2)),
          1.0 / (shear_compliance(young_modulus_1, poisson_ratio_1) +
                 shear_compliance(young_modulus_2, poisson_ratio_2))};
}

}  // namespace statejump::kernel
