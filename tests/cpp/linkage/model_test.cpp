// SPDX-License-Identifier: GPL-3.0-or-later
#include "statejump/linkage/model.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include "support/argument.hpp"
#include "umbrella.hpp"

namespace statejump::linkage {
namespace {

using statejump::testing::Argument;
using statejump::testing::refused_argument;

constexpr double degree = 3.14159265358979323846 / 180.0;

TEST(Linkage, StandsWhereTheProjectSays) {
  const Linkage model = umbrella();
  const State state = initial_state(model, Start::rest, 0.0);
  const Coordinates q = coordinates(model, state);
  // Half a unit of the last published digit.
  EXPECT_NEAR(state.bearing_centre.x(), 28.750e-3, 5e-9);
  EXPECT_NEAR(state.bearing_centre.y(), 40.907670e-3, 5e-10);
  EXPECT_NEAR(q.theta2, 54.900368 * degree, 5e-7 * degree);
  EXPECT_NEAR(q.theta4, 155.853152 * degree, 5e-7 * degree);
  EXPECT_NEAR(q.length_ab, 0.050, 1e-16);
  EXPECT_NEAR(q.length_bc, 0.100, 1e-16);
  EXPECT_NEAR(model.free_angle(), q.theta4 - q.theta2, 1e-14);
  EXPECT_EQ(q.eccentricity.norm(), 0.0);
  EXPECT_NEAR(q.centroid_bc.x(), 0.5 * (0.120 + 28.750e-3), 5e-9);
  EXPECT_LT(energy(model, state, 0.0).sum(), 1e-20);
}

TEST(Linkage, FirstContactInClosedForm) {
  EXPECT_NEAR(first_contact_temperature(umbrella(0.05e-3)), 17.5439, 5e-5);
  EXPECT_NEAR(first_contact_temperature(umbrella(0.20e-3)), 70.1754, 5e-5);
  Linkage grows = umbrella();
  grows.journal_thermal_expansion = grows.bearing_thermal_expansion = alpha;
  // α ΔT a = c (1 + α ΔT)
  EXPECT_NEAR(first_contact_temperature(grows), 1e-4 / (alpha * (frame - 1e-4)), 1e-9);
  grows.bearing_thermal_expansion = 1e-2;
  EXPECT_TRUE(std::isinf(first_contact_temperature(grows)));
}

TEST(Linkage, RefusesWhatIsOutOfRange) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double inf = std::numeric_limits<double>::infinity();
  struct Field {
    const char* name;
    double& (*of)(Linkage&);
    std::vector<double> refused;
    const char* range;
  };
  const std::vector<Field> fields = {
      {"frame_length",
       [](Linkage& m) -> double& { return m.frame_length; },
       {0.0, -1.0, nan, inf},
       "finite, > 0 m"},
      {"frame_length",
       [](Linkage& m) -> double& { return m.frame_length; },
       {0.05, 0.2, 0.16},
       "between the difference and the sum"},
      {"link_ab.stress_free_length",
       [](Linkage& m) -> double& { return m.link_ab.stress_free_length; },
       {0.0, -0.05, nan, inf},
       "finite, > 0 m"},
      {"link_bc.mass",
       [](Linkage& m) -> double& { return m.link_bc.mass; },
       {0.0, -1.0, nan, inf},
       "finite, > 0 kg"},
      {"link_ab.young_modulus",
       [](Linkage& m) -> double& { return m.link_ab.young_modulus; },
       {0.0, -1.0, nan, inf},
       "finite, > 0 Pa"},
      {"link_bc.cross_section_area",
       [](Linkage& m) -> double& { return m.link_bc.cross_section_area; },
       {0.0, -1.0, nan, inf},
       "finite, > 0 m^2"},
      {"link_ab.thermal_expansion",
       [](Linkage& m) -> double& { return m.link_ab.thermal_expansion; },
       {nan, inf, -inf},
       "finite [1/K]"},
      {"link_bc.poisson_ratio",
       [](Linkage& m) -> double& { return m.link_bc.poisson_ratio; },
       {-1.0, 0.51, nan},
       "(-1, 0.5]"},
      {"journal_radius",
       [](Linkage& m) -> double& { return m.journal_radius; },
       {0.0, -1.0, nan},
       "finite, > 0 m"},
      {"bearing_radius",
       [](Linkage& m) -> double& { return m.bearing_radius; },
       {0.005, 0.004, nan, inf},
       "finite, > journal_radius [m]"},
      {"journal_thermal_expansion",
       [](Linkage& m) -> double& { return m.journal_thermal_expansion; },
       {nan, inf},
       "finite [1/K]"},
      {"bearing_thermal_expansion",
       [](Linkage& m) -> double& { return m.bearing_thermal_expansion; },
       {nan, inf},
       "finite [1/K]"},
      {"axial_damping_ratio",
       [](Linkage& m) -> double& { return m.axial_damping_ratio; },
       {-0.1, nan, inf},
       "finite, >= 0"},
      {"pin_damping",
       [](Linkage& m) -> double& { return m.pin_damping; },
       {-0.1, nan, inf},
       "finite, >= 0 N m s/rad"},
      {"torsion_stiffness",
       [](Linkage& m) -> double& { return m.torsion_stiffness; },
       {-0.1, nan, inf},
       "finite, >= 0 N m/rad"},
      {"torsion_free_angle",
       [](Linkage& m) -> double& { return m.torsion_free_angle; },
       {0.0, -1.0, 4.0, 180.0 * degree},
       "(0, pi) rad"},
  };
  for (const Field& field : fields) {
    for (const double value : field.refused) {
      Linkage model = umbrella();
      field.of(model) = value;
      const Argument refused = refused_argument([&] { model.validate(); });
      EXPECT_EQ(refused, Argument(field.name, value));
      EXPECT_EQ(refused.range.find(field.range), 0u) << refused;
    }
  }
}

TEST(Linkage, TakesWhatIsJustInRange) {
  Linkage model = umbrella();
  for (const double angle : {1e-3, 3.14}) {
    model.torsion_free_angle = angle;
    EXPECT_NO_THROW(model.validate());
    EXPECT_EQ(model.free_angle(), angle);
  }
  for (const double ratio : {-0.999, 0.5}) {
    model.link_ab.poisson_ratio = ratio;
    EXPECT_NO_THROW(model.validate());
  }
  for (const double length : {0.0501, 0.1499}) {
    model.frame_length = length;
    EXPECT_NO_THROW(model.validate());
  }
}

TEST(Linkage, CoordinatesByHand) {
  Linkage model = umbrella();
  State state;
  state.bearing_centre = {0.03, 0.04};
  state.journal_centre = {0.06, 0.08};  // 0.1 m from C
  const Coordinates q = coordinates(model, state);
  EXPECT_EQ(q.centroid_ab, Eigen::Vector2d(0.015, 0.02));
  EXPECT_NEAR((q.centroid_bc - Eigen::Vector2d(0.09, 0.04)).norm(), 0.0, 1e-17);
  EXPECT_NEAR(q.length_ab, 0.05, 1e-17);
  EXPECT_NEAR(q.length_bc, 0.1, 1e-16);
  EXPECT_NEAR(std::tan(q.theta2), 4.0 / 3.0, 1e-15);
  EXPECT_NEAR(std::tan(q.theta4), -4.0 / 3.0, 1e-15);
  EXPECT_NEAR((q.eccentricity - Eigen::Vector2d(0.03, 0.04)).norm(), 0.0, 1e-17);
}

TEST(Linkage, MatchedStartGrowsWithTheLinks) {
  Linkage model = umbrella();
  model.link_bc.thermal_expansion = 2.0 * alpha;
  const State state = initial_state(model, Start::matched, 200.0);
  // Thermal velocity along each link: expansion coefficient times length times heating rate.
  EXPECT_NEAR(state.bearing_velocity.norm(), alpha * 200.0 * 0.05, 1e-18);
  EXPECT_NEAR(state.bearing_velocity.dot(state.bearing_centre), alpha * 200.0 * 0.0025, 1e-19);
  const Eigen::Vector2d bc = state.journal_centre - Eigen::Vector2d(frame, 0.0);
  EXPECT_NEAR(state.journal_velocity.dot(bc), 2.0 * alpha * 200.0 * 0.01, 1e-19);
  EXPECT_NEAR(state.journal_velocity.norm(), 2.0 * alpha * 200.0 * 0.1, 1e-18);
}

TEST(Linkage, StartAtAnEccentricityLeavesTheLinksUnstrained) {
  const Linkage model = umbrella();
  const Eigen::Vector2d d(6e-5, -8e-5);
  const State state = initial_state(model, Start::rest, 0.0, d);
  const Coordinates q = coordinates(model, state);
  EXPECT_NEAR((q.eccentricity - d).norm(), 0.0, 1e-17);
  EXPECT_NEAR(q.length_ab, 0.05, 1e-16);
  EXPECT_NEAR(q.length_bc, 0.1, 1e-16);
  EXPECT_GT(state.bearing_centre.y(), 0.0);
  EXPECT_THROW(initial_state(model, Start::rest, 0.0, 1.001 * d), std::invalid_argument);
}

TEST(Linkage, JointThatIsApartCarriesNothing) {
  Linkage model = umbrella();
  model.law.friction = kernel::laws::MindlinFriction{};
  model.law.friction_parameters.friction_coefficient = 0.3;
  model.journal_radius = 0.5;  // a clearance without rounding error
  model.bearing_radius = 1.0;
  State state;
  state.bearing_centre = {0.0, 0.04};
  state.contact.tangential_force = {0.5, 0.0, 0.0};
  state.contact.slipping = true;
  for (const double apart : {0.25, 0.5}) {  // 0.5: contact with zero depth
    state.journal_centre = {apart, 0.04};
    state.journal_velocity = {3.0, 7.0};
    const Joint joint = joint_state(model, state, 0.0, 0.0);
    EXPECT_EQ(joint.penetration_depth, apart - 0.5);
    EXPECT_EQ(joint.approach_speed, 3.0);
    EXPECT_EQ(joint.normal_force, 0.0);
    EXPECT_EQ(joint.tangential_force, 0.0);
    EXPECT_FALSE(joint.slipping);
    EXPECT_EQ(energy(model, state, 0.0).contact, 0.0);
  }
}

TEST(Linkage, EnergyByHand) {
  Linkage model = umbrella();
  model.torsion_stiffness = 2.0;
  model.torsion_free_angle = 1.5;
  State state;
  state.bearing_centre = {0.03, 0.04};  // unstrained, at the angle acos(0.6)
  state.journal_centre = {0.03, 0.04};
  state.bearing_velocity = {3.0, 4.0};
  state.journal_velocity = {0.0, 2.0};
  const double bc = std::hypot(0.09, 0.04);
  Energy found = energy(model, state, 0.0);
  EXPECT_NEAR(found.kinetic, 0.5 * (0.5 / 3.0 * 25.0 + 1.0 / 3.0 * 4.0), 1e-14);
  EXPECT_NEAR(found.axial, 0.5 * 6.3e5 / 0.1 * std::pow(bc - 0.1, 2), 1e-13);
  const double flare = std::atan2(0.04, -0.09) - std::atan2(0.04, 0.03);
  EXPECT_NEAR(found.torsion, std::pow(flare - 1.5, 2), 1e-14);
  // Heated by 50 K at fixed ends, AB is compressed by its own thermal expansion.
  found = energy(model, state, 50.0);
  const double ab = 0.05 * (1.0 + alpha * 50.0), other = 0.1 * (1.0 + alpha * 50.0);
  EXPECT_NEAR(found.axial,
              0.5 * 6.3e5 * (std::pow(0.05 - ab, 2) / ab + std::pow(bc - other, 2) / other), 1e-13);
}

}  // namespace
}  // namespace statejump::linkage
