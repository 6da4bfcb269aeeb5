// SPDX-License-Identifier: GPL-3.0-or-later
// Oblique impact of a sphere on a wall, compared with published numbers: tests 4 and 5 of Chung and
// Ooi (Granul. Matter 13, 2011, 643-656). Their figures were read to about 0.5 % of the scales.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "statejump/kernel/hertz.hpp"
#include "statejump/kernel/laws/joint_law.hpp"

namespace statejump::kernel::laws {
namespace {

struct Sphere {
  double young, poisson, density, radius;  // [Pa], [-], [kg/m^3], [m]
  double friction, restitution;            // [-]
};

struct Rebound {
  double normal, tangential;  // velocities of the centre [m/s]
  double contact_point;       // velocity of the contact point along the wall [m/s]
  double angular;             // [rad/s]; negative, because the wall decelerates the contact point
  double dissipated, lost;    // loss by friction; loss of kinetic energy [J]
};

/// Leapfrog integration of a sphere that hits a rigid wall, from first touch to separation.
Rebound rebound(const Sphere& sphere, const std::string& friction, double normal, double tangential,
                int steps = 20000) {
  JointLaw law;
  law.friction = friction_law(friction);
  law.friction_parameters.friction_coefficient = sphere.friction;
  law.restitution = sphere.restitution;
  law.dissipation = dissipation_law("exact_restitution");
  // against a rigid wall only the sphere's elastic constants count
  const double shear = sphere.young / (2.0 * (1.0 + sphere.poisson));
  const ElasticPair pair{sphere.young / (1.0 - sphere.poisson * sphere.poisson),
                         shear / (2.0 - sphere.poisson)};
  const double mass =
      4.0 / 3.0 * 3.14159265358979323846 * std::pow(sphere.radius, 3.0) * sphere.density;
  const double inertia = 0.4 * mass * sphere.radius * sphere.radius;
  const double stiffness = hertz_stiffness(pair.effective_young_modulus, sphere.radius);
  const double deepest = std::pow(1.25 * mass * normal * normal / stiffness, 0.4);
  const double step = 2.94 * deepest / normal / steps;  // fraction of Hertz's contact time
  const double ratio = damping_ratio(law, normal);
  Rebound at{normal, tangential, tangential, 0.0, 0.0, 0.0};
  ContactHistory history;
  double depth = 0.0;
  do {
    depth += step * at.normal;
    const HertzState elastic = hertz(pair.effective_young_modulus, sphere.radius, depth);
    const double force = damped_force(elastic.force, ratio, at.normal);
    const FrictionResponse answer =
        evaluate(law.friction, law.friction_parameters,
                 {force, tangential_stiffness(pair, elastic.stiffness),
                  Vector3(at.contact_point, 0.0, 0.0), step, Vector3::UnitZ()},
                 history);
    const double along = answer.force_on_1.x();
    at.normal -= step * force / mass;
    at.tangential += step * along / mass;
    at.angular += step * along * sphere.radius / inertia;
    at.contact_point = at.tangential + at.angular * sphere.radius;
    at.dissipated += answer.dissipation;
  } while (depth > 0.0);
  at.normal = -at.normal;
  const auto kinetic = [&](double n, double t, double w) {
    return 0.5 * mass * (n * n + t * t) + 0.5 * inertia * w * w;
  };
  at.lost = kinetic(normal, tangential, 0.0) - kinetic(at.normal, at.tangential, at.angular);
  return at;
}

const char* const compared_laws[] = {"mindlin", "mindlin_deresiewicz"};

struct Reading {
  double at, value;
};

/// Readings of Kharaz, Gorham and Salman (Powder Technol. 120, 2001) over the angle of incidence
/// [degrees]: tangential restitution here, then spin after the impact [rad/s], then rebound angle
/// of the contact point [degrees].
const std::vector<Reading> measured_restitution{
    {2.24, 0.797},  {4.22, 0.746},  {9.84, 0.675},  {20.22, 0.599}, {30.36, 0.690},
    {39.54, 0.774}, {49.60, 0.848}, {71.07, 0.937}, {79.23, 0.970}, {85.17, 0.979}};
const std::vector<Reading> measured_spin{
    {5.90, -134.9},  {10.87, -261.2}, {21.12, -573.7}, {31.14, -612.2}, {38.95, -595.1},
    {50.24, -449.5}, {60.10, -375.7}, {69.96, -243.0}, {78.56, -142.4}, {84.32, -70.6}};
const std::vector<Reading> measured_angle{
    {2.10, 0.77},   {3.94, 0.77},   {9.72, -1.06},  {20.31, -8.53}, {30.16, -2.55}, {39.12, 9.91},
    {49.51, 30.02}, {59.90, 49.95}, {70.46, 66.90}, {78.86, 78.87}, {84.78, 85.68}};

/// 5 mm spheres of aluminium oxide at 3.9 m/s on a thick anvil, which the test treats as rigid
/// (test 4).
const Sphere aluminium_oxide{380e9, 0.23, 4000.0, 2.5e-3, 0.092, 0.98};

template <class Answer>
double root_mean_square(const std::vector<Reading>& readings, const std::string& law,
                        double largest_angle, const Answer& answer) {
  double sum = 0.0;
  int count = 0;
  for (const Reading& each : readings) {
    if (each.at > largest_angle) continue;
    const double angle = each.at * 3.14159265358979323846 / 180.0;
    const Rebound found =
        rebound(aluminium_oxide, law, 3.9 * std::cos(angle), 3.9 * std::sin(angle));
    const double off = answer(found, 3.9 * std::sin(angle)) - each.value;
    sum += off * off;
    ++count;
  }
  return std::sqrt(sum / count);
}

double restitution_of(const Rebound& after, double tangential) {
  return after.tangential / tangential;
}
double spin_of(const Rebound& after, double) {
  return after.angular;
}
double angle_of(const Rebound& after, double) {
  return std::atan2(after.contact_point, after.normal) * 180.0 / 3.14159265358979323846;
}

TEST(ObliqueImpact, MeasuredReboundOfAluminiumOxide) {
  for (const char* law : compared_laws) {
    for (const double largest : {28.0, 90.0}) {
      std::printf("%-20s up to %2.0f deg, rms: restitution %.4f, spin %.1f rad/s, angle %.2f deg\n",
                  law, largest,
                  root_mean_square(measured_restitution, law, largest, restitution_of),
                  root_mean_square(measured_spin, law, largest, spin_of),
                  root_mean_square(measured_angle, law, largest, angle_of));
    }
  }
  const char* law = "mindlin_deresiewicz";
  EXPECT_LE(root_mean_square(measured_restitution, law, 90.0, restitution_of), 0.02);
  EXPECT_LE(root_mean_square(measured_spin, law, 90.0, spin_of), 25.0);  // of 612 rad/s
  EXPECT_LE(root_mean_square(measured_angle, law, 90.0, angle_of), 1.5);
}

/// Finite elements of Wu, quoted for test 5: steel spheres with a normal speed of 5 m/s. Each
/// reading is the tangential velocity of the contact point before and after the impact, both
/// divided by mu times the normal speed.
const std::vector<Reading> elements_contact_point{
    {0.272, -0.027}, {0.586, -0.027}, {0.876, -0.080}, {1.190, -0.213}, {1.553, -0.373},
    {1.915, -0.627}, {2.314, -0.947}, {2.785, -1.253}, {3.317, -1.520}, {3.970, -1.720},
    {4.755, -1.707}, {5.758, -1.200}, {7.124, 0.133},  {9.118, 2.147},  {12.356, 5.427}};
const std::vector<Reading> elements_spin{
    {0.318, -0.187}, {0.595, -0.406}, {0.890, -0.665}, {1.185, -0.982}, {1.532, -1.355},
    {1.896, -1.793}, {2.277, -2.321}, {2.763, -2.856}, {3.301, -3.441}, {3.890, -4.041},
    {4.688, -4.569}, {5.659, -4.941}, {7.029, -4.941}, {9.040, -4.972}, {12.335, -4.970}};

const Sphere steel{208e9, 0.3, 7850.0, 0.1, 0.3, 1.0};

TEST(ObliqueImpact, FiniteElementsOfASteelSphere) {
  double rms[2][2];  // contact point and spin, for the simple spring and for partial slip
  for (int i = 0; i < 2; ++i) {
    const char* law = compared_laws[i];
    double point = 0.0;
    double spin = 0.0;
    for (const Reading& each : elements_contact_point) {
      const double scale = steel.friction * 5.0;
      const double off =
          rebound(steel, law, 5.0, each.at * scale).contact_point / scale - each.value;
      point += off * off / static_cast<double>(elements_contact_point.size());
    }
    for (const Reading& each : elements_spin) {
      const double scale = steel.friction * 5.0;
      const double off =
          rebound(steel, law, 5.0, each.at * scale).angular * steel.radius / scale - each.value;
      spin += off * off / static_cast<double>(elements_spin.size());
    }
    rms[i][0] = std::sqrt(point);
    rms[i][1] = std::sqrt(spin);
    std::printf("%-20s rms over mu v_n: contact point %.3f, spin %.3f\n", law, rms[i][0],
                rms[i][1]);
  }
  // tolerance of a few hundredths for mesh and reading errors; the simple spring has four times the
  // error
  EXPECT_LE(rms[1][0], 0.08);
  EXPECT_LE(rms[1][1], 0.06);
  EXPECT_GE(rms[0][0], 4.0 * rms[1][0]);
}

/// Maw, Barber and Fawcett (Wear 38, 1976), with psi = v_t/(mu kappa v_n), kappa = E*/(4 G*) and
/// chi = 7/(4 kappa) for a sphere. For psi_1 >= 4 chi - 1 the sphere slides throughout and psi_2 =
/// psi_1 - 4 chi. For psi_1 < 1 it sticks from first touch.
TEST(ObliqueImpact, BoundsOfGrossSlip) {
  const double kappa = (2.0 - steel.poisson) / (2.0 * (1.0 - steel.poisson));
  const double chi = 7.0 / (4.0 * kappa);
  const double scale = steel.friction * kappa * 5.0;
  const auto leaves_with = [&](double psi) {
    return rebound(steel, "mindlin_deresiewicz", 5.0, psi * scale, 40000).contact_point / scale;
  };
  const double bound = 4.0 * chi - 1.0;
  for (const double beyond : {0.02, 0.5, 3.0}) {
    EXPECT_NEAR(leaves_with(bound + beyond), bound + beyond - 4.0 * chi, 2e-3) << beyond;
  }
  // below the bound, the friction force decreases before the end and removes less momentum
  EXPECT_GT(leaves_with(bound - 0.3), bound - 0.3 - 4.0 * chi + 5e-3);
  // the lost kinetic energy equals the friction loss, which slip annuli at the rim cause in this
  // impact
  const Rebound gentle = rebound(steel, "mindlin_deresiewicz", 5.0, 0.5 * scale, 40000);
  EXPECT_GT(gentle.dissipated, 0.0);
  EXPECT_NEAR(gentle.lost, gentle.dissipated, 2e-3 * gentle.dissipated + 1e-7 * 0.5 * 25.0);
}

}  // namespace
}  // namespace statejump::kernel::laws
