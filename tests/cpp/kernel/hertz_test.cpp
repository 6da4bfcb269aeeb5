// SPDX-License-Identifier: GPL-3.0-or-later
#include "statejump/kernel/hertz.hpp"

#include <limits>
#include <stdexcept>

#include "../support/argument.hpp"
#include "statejump/kernel/elastic_pair.hpp"
#include "statejump/kernel/mindlin.hpp"
#include "support.hpp"

namespace statejump::kernel {
namespace {

using statejump::testing::Argument;
using statejump::testing::refused_argument;
using testing::pi;

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double nan = std::numeric_limits<double>::quiet_NaN();
// Two ways to evaluate the same product differ by about ten roundings of 1.1e-16.
constexpr double rounding = 2e-15;

// Table 2 of the paper with R1 = 5 mm and c = 0.1 mm. Expected values are computed in 40-digit
// arithmetic.
TEST(Hertz, PaperTable2Stiffness) {
  const ElasticPair pair = elastic_pair(70e9, 0.3, 70e9, 0.3);
  EXPECT_NEAR(pair.effective_young_modulus, 38461538461.538461538, rounding * 3.9e10);
  EXPECT_NEAR(pair.effective_shear_modulus, 7918552036.1990950226, rounding * 8e9);
  // Rounding of radii of 5.1e-3 m causes an error of R2 - R1 of 4e-19 m, 4e-15 of c = 1e-4 m. The
  // relative error of K is half of this.
  EXPECT_NEAR(internal_effective_radius(5e-3, 5.1e-3), 0.255, 1e-14 * 0.255);
  EXPECT_NEAR(
      hertz_stiffness(pair.effective_young_modulus, internal_effective_radius(5e-3, 5.1e-3)),
      25896166508.620712701, 1e-14 * 2.6e10);
}

// Different materials, R = 12.3 mm, delta = 3.7 um. Expected values are computed in 40-digit
// arithmetic, the stiffness as derivative and the energy as integral of K delta^1.5.
TEST(Hertz, UnlikeMaterialsAgainstHighPrecision) {
  const ElasticPair pair = elastic_pair(70e9, 0.3, 210e9, 0.28);
  const HertzState state = hertz(pair.effective_young_modulus, 0.0123, 3.7e-6);
  EXPECT_NEAR(pair.effective_young_modulus, 57509037134.40683536, rounding * 5.8e10);
  EXPECT_NEAR(pair.effective_shear_modulus, 11889125413.288645319, rounding * 1.2e10);
  EXPECT_NEAR(state.force, 60.524327801566351496, rounding * 61);
  EXPECT_NEAR(state.stiffness, 24536889.649283656012, rounding * 2.5e7);
  EXPECT_NEAR(state.contact_radius, 0.0002133307291507719007, rounding * 2.2e-4);
  EXPECT_NEAR(state.elastic_energy, 0.000089576005146318200214, rounding * 9e-5);
  EXPECT_NEAR(mindlin_stiffness(pair.effective_shear_modulus, state.contact_radius),
              20290526.347054712236, rounding * 2.1e7);
  EXPECT_NEAR(hertz_stiffness(pair.effective_young_modulus, 0.0123) * std::pow(3.7e-6, 1.5),
              state.force, rounding * 61);
}

// Independent derivation from Hertz's pressure p0 sqrt(1 - r^2/a^2). Its integral is the force.
// Boussinesq's point load, 1/(pi E*) 1/r, integrated over this pressure, gives the surface
// displacements at the centre and at the edge. The difference of both displacements is the
// flattened parabola a^2/(2R); the displacement at the centre is delta.
TEST(Hertz, FollowsFromPressureAndBoussinesq) {
  const double young = 5.7e10;
  const double p0 = 8.3e8;
  const double a = 2.1e-4;
  const int n = 400;
  double force = 0.0;
  double centre = 0.0;
  for (int i = 0; i < n; ++i) {  // r = a sin(psi): smooth, so the midpoint rule converges as 1/n^2
    const double psi = (i + 0.5) * 0.5 * pi / n;
    const double r = a * std::sin(psi);
    const double p = p0 * std::cos(psi);
    const double dr = a * std::cos(psi) * 0.5 * pi / n;
    force += p * 2.0 * pi * r * dr;
    centre += 2.0 / young * p * dr;  // 1/(pi E*) p/r 2 pi r dr
  }
  double edge = 0.0;
  for (int i = 0; i < n; ++i) {  // chords through an edge point at angle phi to the inward radius
    const double phi = -0.5 * pi + (i + 0.5) * pi / n;
    const double chord = 2.0 * a * std::cos(phi);
    for (int j = 0; j < n; ++j) {  // s = L (1 - cos(psi))/2, p = p0/a sqrt(s (L - s))
      const double psi = (j + 0.5) * pi / n;
      const double p = p0 / a * 0.5 * chord * std::sin(psi);
      const double ds = 0.5 * chord * std::sin(psi) * pi / n;
      edge += p * ds / (pi * young) * pi / n;
    }
  }
  const double radius = a * a / (2.0 * (centre - edge));
  const HertzState state = hertz(young, radius, centre);
  // The midpoint rule is exact for the periodic integrands (centre, edge). The relative error of
  // the force is (pi/2/n)^2/24 * [f'] / integral = 6.4e-7 * 3.
  EXPECT_NEAR(state.force, force, 3e-6 * force);
  EXPECT_NEAR(state.contact_radius, a, 1e-12 * a);
}

// Cerruti's tangential point load, integrated over the no-slip traction q0/sqrt(1 - r^2/a^2) for
// each body, must give k_t = 8 G* a, also for different materials.
TEST(Hertz, MindlinStiffnessFollowsFromCerruti) {
  const double a = 3e-4;
  const double q0 = 1e7;
  const double e[2] = {70e9, 210e9};
  const double nu[2] = {0.3, 0.2};
  const int n = 64;
  double displacement = 0.0;
  for (int body = 0; body < 2; ++body) {
    const double shear = e[body] / (2.0 * (1.0 + nu[body]));
    for (int i = 0; i < n; ++i) {
      const double phi = (i + 0.5) * 2.0 * pi / n;
      const double kernel =
          ((1.0 - nu[body]) + nu[body] * std::cos(phi) * std::cos(phi)) / (2.0 * pi * shear);
      // With r = a sin(psi), q dr = q0 a d(psi), whose integral over psi is q0 a pi/2.
      displacement += kernel * q0 * a * 0.5 * pi * 2.0 * pi / n;
    }
  }
  const double force = 2.0 * pi * a * a * q0;
  const double shear_modulus = elastic_pair(e[0], nu[0], e[1], nu[1]).effective_shear_modulus;
  // The periodic midpoint rule integrates cos^2 exactly. The tolerance covers rounding of 64
  // additions.
  EXPECT_NEAR(mindlin_stiffness(shear_modulus, a), force / displacement,
              1e-13 * force / displacement);
}

TEST(Hertz, StiffnessIsTheDerivativeAndEnergyTheIntegral) {
  const double young = 3.8e10;
  const double radius = 0.255;
  for (double depth = 1e-9; depth < 1e-4; depth *= 3.0) {
    const double h = 1e-4 * depth;  // central difference: error h^2 F'''/6 = 1e-8 * 1/24 relative
    const double slope =
        (hertz(young, radius, depth + h).force - hertz(young, radius, depth - h).force) / (2 * h);
    const double power = (hertz(young, radius, depth + h).elastic_energy -
                          hertz(young, radius, depth - h).elastic_energy) /
                         (2 * h);
    const HertzState state = hertz(young, radius, depth);
    EXPECT_NEAR(state.stiffness, slope, 2e-9 * slope);
    EXPECT_NEAR(state.force, power, 2e-9 * power);
  }
}

TEST(Hertz, GrowsWithDepthAndIsZeroInAGap) {
  HertzState last = hertz(3.8e10, 0.255, 0.0);
  EXPECT_EQ(last.force, 0.0);
  for (double depth = 1e-12; depth < 1e-4; depth *= 1.5) {
    const HertzState state = hertz(3.8e10, 0.255, depth);
    EXPECT_GT(state.force, last.force);
    EXPECT_GT(state.stiffness, last.stiffness);
    EXPECT_GT(state.elastic_energy, last.elastic_energy);
    last = state;
  }
  const HertzState gap = hertz(3.8e10, 0.255, -1e-6);
  EXPECT_EQ(gap.force, 0.0);
  EXPECT_EQ(gap.stiffness, 0.0);
  EXPECT_EQ(gap.contact_radius, 0.0);
  EXPECT_EQ(gap.elastic_energy, 0.0);
}

TEST(Hertz, LimitsOfTheEffectiveRadius) {
  EXPECT_EQ(internal_effective_radius(5e-3, infinity), 5e-3);
  EXPECT_NEAR(internal_effective_radius(5e-3, 5e6), 5e-3, 2e-9 * 5e-3);  // 1 + R1/R2
  // A wall that bulges towards the journal acts as a second ball in external contact: R = R1 R2/(R1
  // + R2).
  EXPECT_NEAR(internal_effective_radius(1e-3, -3e-3), 0.75e-3, 1e-14 * 0.75e-3);
  EXPECT_THROW(internal_effective_radius(5e-3, 5e-3), std::invalid_argument);
  EXPECT_THROW(internal_effective_radius(5e-3, 4e-3), std::invalid_argument);
  EXPECT_THROW(internal_effective_radius(0.0, 4e-3), std::invalid_argument);
  EXPECT_THROW(internal_effective_radius(nan, 4e-3), std::invalid_argument);
  EXPECT_THROW(internal_effective_radius(5e-3, nan), std::invalid_argument);
}

TEST(Hertz, ElasticPairRefusesBadMaterials) {
  EXPECT_DOUBLE_EQ(elastic_pair(0.5, 0.3, 0.5, 0.3).effective_young_modulus, 0.25 / 0.91);  // soft
  EXPECT_THROW(elastic_pair(0.0, 0.3, 70e9, 0.3), std::invalid_argument);
  EXPECT_THROW(elastic_pair(70e9, 0.3, 0.0, 0.3), std::invalid_argument);
  EXPECT_THROW(elastic_pair(70e9, 0.3, -1.0, 0.3), std::invalid_argument);
  EXPECT_THROW(elastic_pair(nan, 0.3, 70e9, 0.3), std::invalid_argument);
  EXPECT_THROW(elastic_pair(infinity, 0.3, infinity, 0.3), std::invalid_argument);
  EXPECT_THROW(elastic_pair(70e9, 0.51, 70e9, 0.3), std::invalid_argument);
  EXPECT_THROW(elastic_pair(70e9, 0.3, 70e9, -1.0), std::invalid_argument);
  EXPECT_THROW(elastic_pair(70e9, nan, 70e9, 0.3), std::invalid_argument);
  const auto refused = [] { elastic_pair(70e9, 0.3, -1.5, 0.3); };
  EXPECT_EQ(refused_argument(refused), Argument("young_modulus_2", -1.5));
  // A rigid body does not yield, so E* = E/(1 - nu^2), twice that of two equal bodies.
  EXPECT_NEAR(elastic_pair(70e9, 0.3, infinity, 0.3).effective_young_modulus, 70e9 / 0.91,
              rounding * 77e9);
}

}  // namespace
}  // namespace statejump::kernel
