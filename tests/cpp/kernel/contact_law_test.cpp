// SPDX-License-Identifier: GPL-3.0-or-later
#include "statejump/kernel/contact_law.hpp"
#include "statejump/kernel/stable_step.hpp"

#include <limits>
#include <stdexcept>

#include "../support/argument.hpp"
#include "support.hpp"

namespace statejump::kernel {
namespace {

using statejump::testing::Argument;
using statejump::testing::no_argument;
using statejump::testing::refused_argument;
using testing::expect_vector_near;
using testing::Random;

ContactParameters aluminium(double friction) {
  ContactParameters parameters;
  parameters.elastic = elastic_pair(70e9, 0.3, 70e9, 0.3);
  parameters.friction_coefficient = friction;
  parameters.effective_mass = 0.2;
  return parameters;
}

ContactKinematics kinematics(double depth, const Vector3& velocity, double time_step = 1e-6) {
  return {Vector3::UnitX(), depth, 0.255, velocity, time_step};
}

TEST(ContactLaw, PressesTheBodiesApart) {
  ContactHistory history;
  const ContactResponse response =
      hertz_mindlin(aluminium(0.3), kinematics(1e-6, Vector3::Zero()), history);
  // F = K delta^1.5 with K = 25896166508.62 N/m^1.5. The tolerance covers two roundings in R.
  EXPECT_NEAR(response.normal_force, 25.89616650862071, 1e-13 * 26);
  EXPECT_EQ(response.elastic_normal_force, response.normal_force);
  EXPECT_NEAR(response.normal_stiffness, 1.5 * response.normal_force / 1e-6, 1e-7);
  EXPECT_NEAR(response.normal_elastic_energy, 0.4 * response.normal_force * 1e-6, 1e-19);
  // k_t / k_n = 4 G*/E* at any depth
  EXPECT_NEAR(response.tangential_stiffness / response.normal_stiffness,
              4.0 * 7918552036.199095 / 38461538461.53846, 1e-14);
  EXPECT_EQ(response.force_on_1, Vector3(-response.normal_force, 0, 0));
  EXPECT_EQ(response.damping_dissipation, 0.0);
}

TEST(ContactLaw, GapGivesZero) {
  ContactParameters parameters = aluminium(0.3);
  parameters.normal_damping_ratio = parameters.tangential_damping_ratio = 0.5;
  for (const double depth : {0.0, -1e-9, -1e-3}) {
    ContactHistory history;
    const ContactResponse response =
        hertz_mindlin(parameters, kinematics(depth, Vector3(1, 2, 3)), history);
    EXPECT_EQ(response.normal_force, 0.0);
    EXPECT_EQ(response.normal_stiffness, 0.0);
    EXPECT_EQ(response.tangential_stiffness, 0.0);
    EXPECT_EQ(response.force_on_1, Vector3(Vector3::Zero()));
    EXPECT_EQ(response.friction_dissipation, 0.0);
    EXPECT_EQ(response.damping_dissipation, 0.0);
    EXPECT_EQ(history.tangential_force, Vector3(Vector3::Zero()));
  }
}

TEST(ContactLaw, NoFrictionIsExactlyZero) {
  ContactParameters parameters = aluminium(0.0);
  parameters.normal_damping_ratio = parameters.tangential_damping_ratio = 0.3;
  ContactHistory history;
  for (int i = 0; i < 10; ++i) {
    const ContactResponse response =
        hertz_mindlin(parameters, kinematics(1e-6, Vector3(0, 3, -2)), history);
    EXPECT_EQ(response.tangential_force, Vector3(Vector3::Zero()));
    EXPECT_EQ(response.tangential_elastic_energy, 0.0);
    EXPECT_EQ(response.friction_dissipation, 0.0);
  }
}

// Friction opposes the tangential velocity, never exceeds mu F_N, and ignores the normal velocity.
TEST(ContactLaw, FrictionOpposesTangentialVelocity) {
  ContactHistory history;
  const Vector3 velocity(0.5, 0.03, -0.04);
  ContactResponse response =
      hertz_mindlin(aluminium(0.3), kinematics(1e-6, velocity, 1e-9), history);
  EXPECT_FALSE(history.slipping);
  expect_vector_near(response.tangential_force,
                     -response.tangential_stiffness * 1e-9 * Vector3(0, 0.03, -0.04), 1e-14,
                     "spring");
  response = hertz_mindlin(aluminium(0.3), kinematics(1e-6, velocity, 1e-3), history);
  EXPECT_TRUE(history.slipping);
  expect_vector_near(response.tangential_force,
                     -0.3 * response.normal_force * Vector3(0, 0.6, -0.8), 1e-13, "Coulomb");
  expect_vector_near(response.force_on_1,
                     response.tangential_force - response.normal_force * Vector3::UnitX(), 1e-13,
                     "sum");
}

// Damping coefficient c = 2 zeta sqrt(m k). The normal force is clipped at zero, and the clipped
// total determines the Coulomb limit.
TEST(ContactLaw, NormalDamping) {
  ContactParameters parameters = aluminium(0.3);
  parameters.normal_damping_ratio = 0.1;
  const HertzState state = hertz(parameters.elastic.effective_young_modulus, 0.255, 1e-6);
  const double damping = 0.2 * std::sqrt(0.2 * state.stiffness);
  ContactHistory history;
  ContactResponse response =
      hertz_mindlin(parameters, kinematics(1e-6, Vector3(1e-3, 1, 0), 1e-3), history);
  EXPECT_NEAR(response.normal_force, state.force + damping * 1e-3, 1e-13);
  EXPECT_NEAR(response.damping_dissipation, damping * 1e-6 * 1e-3, 1e-18);
  EXPECT_NEAR(response.tangential_force.norm(), 0.3 * response.normal_force, 1e-13);
  EXPECT_EQ(response.elastic_normal_force, state.force);
  // pulled apart fast: no adhesion, hence no friction
  response = hertz_mindlin(parameters, kinematics(1e-6, Vector3(-10, 1, 0), 1e-3), history);
  EXPECT_EQ(response.normal_force, 0.0);
  EXPECT_EQ(response.tangential_force, Vector3(Vector3::Zero()));
  EXPECT_GT(response.damping_dissipation, 0.0);
}

TEST(ContactLaw, TangentialDamping) {
  ContactParameters parameters = aluminium(0.3);
  parameters.tangential_damping_ratio = 0.2;
  const ContactParameters undamped = aluminium(0.3);
  ContactHistory history;
  ContactHistory undamped_history;
  const double speed = 1e-4;
  ContactResponse response =
      hertz_mindlin(parameters, kinematics(1e-6, Vector3(0, speed, 0)), history);
  const ContactResponse spring =
      hertz_mindlin(undamped, kinematics(1e-6, Vector3(0, speed, 0)), undamped_history);
  const double damping = 0.4 * std::sqrt(0.2 * response.tangential_stiffness);
  EXPECT_NEAR(response.tangential_force.y(), spring.tangential_force.y() - damping * speed, 1e-14);
  EXPECT_NEAR(response.damping_dissipation, damping * speed * speed * 1e-6, 1e-20);
  // The history stores only the spring force.
  EXPECT_EQ(history.tangential_force, undamped_history.tangential_force);
  // Fast stick: the sum of spring and damper force is limited to Coulomb's limit; the remaining
  // damper force dissipates.
  response = hertz_mindlin(parameters, kinematics(1e-6, Vector3(0, 0.2, 0.1)), history);
  EXPECT_FALSE(history.slipping);
  EXPECT_NEAR(response.tangential_force.norm(), 0.3 * response.normal_force, 1e-13);
  EXPECT_GT(response.damping_dissipation, 0.0);
  // A lightly loaded contact is damped as well.
  ContactHistory light;
  response = hertz_mindlin(parameters, kinematics(1e-8, Vector3(0, speed, 0)), light);
  EXPECT_LT(0.3 * response.normal_force, 0.01);
  EXPECT_GT(response.damping_dissipation, 0.0);
  // Slipping: spring at the limit, no viscous part.
  response = hertz_mindlin(parameters, kinematics(1e-6, Vector3(0, 20, 10)), history);
  EXPECT_TRUE(history.slipping);
  EXPECT_EQ(response.tangential_force, history.tangential_force);
  EXPECT_EQ(response.damping_dissipation, 0.0);
}

// Random loading with all features active: limits and signs must hold in every step.
TEST(ContactLaw, InvariantsUnderRandomLoading) {
  Random random;
  ContactParameters parameters = aluminium(0.3);
  parameters.normal_damping_ratio = parameters.tangential_damping_ratio = 0.15;
  ContactHistory history;
  int sticking = 0;
  int clipped = 0;
  for (int i = 0; i < 5000; ++i) {
    const Vector3 normal = Vector3::UnitX();
    const ContactResponse response = hertz_mindlin(
        parameters, {normal, random.uniform(-1e-7, 2e-6), 0.255, random.vector(0.08), 2e-6},
        history);
    EXPECT_GE(response.normal_force, 0.0);
    EXPECT_LE(response.tangential_force.norm(),
              parameters.friction_coefficient * response.normal_force * (1 + 4e-16));
    EXPECT_NEAR(response.tangential_force.dot(normal), 0.0, 1e-15 * (1 + response.normal_force));
    EXPECT_GE(response.friction_dissipation, 0.0);
    EXPECT_GE(response.damping_dissipation, 0.0);
    EXPECT_GE(response.tangential_elastic_energy, 0.0);
    sticking += response.normal_force > 0 && !history.slipping;
    clipped += response.elastic_normal_force > 0 && response.normal_force == 0.0;
  }
  EXPECT_GT(sticking, 100);
  EXPECT_GT(clipped, 10);
}

// The response to rotated input is the rotated response.
TEST(ContactLaw, RotationInvariance) {
  Random random;
  ContactParameters parameters = aluminium(0.3);
  parameters.normal_damping_ratio = parameters.tangential_damping_ratio = 0.1;
  for (int i = 0; i < 50; ++i) {
    const Eigen::Matrix3d rotation = random.rotation();
    ContactHistory history;
    ContactHistory turned_history;
    const Vector3 normal = random.unit();
    for (int j = 0; j < 20; ++j) {
      const double depth = random.uniform(1e-7, 1e-6);
      const Vector3 velocity = random.vector(0.1);
      const ContactResponse response =
          hertz_mindlin(parameters, {normal, depth, 0.255, velocity, 1e-6}, history);
      const ContactResponse turned = hertz_mindlin(
          parameters, {rotation * normal, depth, 0.255, rotation * velocity, 1e-6}, turned_history);
      expect_vector_near(turned.force_on_1, rotation * response.force_on_1,
                         1e-12 * response.normal_force, "force");
      EXPECT_NEAR(turned.friction_dissipation, response.friction_dissipation,
                  1e-12 * (response.friction_dissipation + response.tangential_elastic_energy));
    }
  }
}

// Action and reaction at one point leave no net force and no net moment about any origin.
TEST(ContactLaw, WrenchBalances) {
  Random random;
  for (int i = 0; i < 100; ++i) {
    const Vector3 centre_1 = random.vector(1.0);
    const Vector3 centre_2 = random.vector(1.0);
    const Vector3 point = random.vector(1.0);
    const Vector3 force = random.vector(100.0);
    const Wrench wrench = contact_wrench(force, point - centre_1, point - centre_2);
    EXPECT_EQ(wrench.force_1, force);
    EXPECT_EQ(Vector3(wrench.force_1 + wrench.force_2), Vector3(Vector3::Zero()));
    expect_vector_near(wrench.torque_1, (point - centre_1).cross(force), 1e-13, "torque 1");
    const Vector3 moment = centre_1.cross(wrench.force_1) + wrench.torque_1 +
                           centre_2.cross(wrench.force_2) + wrench.torque_2;
    EXPECT_LE(moment.norm(), 1e-13 * force.norm()) << i;  // about ten roundings of |r||F| < 2|F|
  }
}

// Leapfrog integration of a mass under constant load on this contact, starting slightly off
// equilibrium. The small oscillation must decay by exp(-2 pi zeta/sqrt(1 - zeta^2)) per period.
TEST(ContactLaw, DampingRatioOfASmallOscillation) {
  ContactParameters parameters = aluminium(0.0);
  parameters.normal_damping_ratio = 0.05;
  const HertzState balance = hertz(parameters.elastic.effective_young_modulus, 0.255, 1e-6);
  const double dt = 0.01 * std::sqrt(parameters.effective_mass / balance.stiffness);
  double depth = 1.001e-6;  // amplitude 0.1 %: k varies by 0.05 %
  double speed = 0.0;
  double last_peak = 1e-9;
  double previous = depth;
  double before = depth;
  int peaks = 0;
  ContactHistory history;
  for (int i = 0; i < 4000; ++i) {
    const ContactResponse response = hertz_mindlin(
        parameters, {Vector3::UnitX(), depth, 0.255, Vector3(speed, 0, 0), dt}, history);
    speed += (balance.force - response.normal_force) / parameters.effective_mass * dt;
    before = previous;
    previous = depth;
    depth += speed * dt;
    if (previous > before && previous >= depth) {
      const double peak = previous - 1e-6;
      const double expected = std::exp(-2 * testing::pi * 0.05 / std::sqrt(1 - 0.0025));
      // the lagged velocity changes the damping ratio by the fraction omega dt/2 = 0.005; 1 % is
      // allowed
      EXPECT_NEAR(peak / last_peak, expected, 0.01 * expected);
      last_peak = peak;
      ++peaks;
    }
  }
  EXPECT_GE(peaks, 5);
}

// Leapfrog with a lagged damping force stays bounded below the critical step and diverges above it.
TEST(ContactLaw, CriticalTimeStepIsTheStabilityLimit) {
  const double mass = 0.3;
  for (const double stiffness : {0.0, 2e5, 4e7}) {
    for (const double damping : {0.0, 50.0, 2000.0}) {
      const double critical = critical_time_step(mass, stiffness, damping);
      if (stiffness == 0.0 && damping == 0.0) {
        EXPECT_EQ(critical, std::numeric_limits<double>::infinity());
        continue;
      }
      // The dashpot alone diverges most slowly: 1.02^1000 = 4e8. Below the critical step the
      // oscillation grows to at most 1/sqrt(1 - 0.99^2) = 7 times its initial amplitude.
      for (const double factor : {0.99, 1.01}) {
        const double dt = factor * critical;
        double x = 1.0;
        double v = 1.0 / dt;
        double largest = 0.0;
        for (int i = 0; i < 1000; ++i) {
          v += -(stiffness * x + damping * v) / mass * dt;
          x += v * dt;
          if (i > 900) largest = std::max(largest, std::abs(v) * dt);
        }
        if (factor < 1.0) {
          EXPECT_LT(largest, 100.0) << stiffness << " " << damping;
        } else {
          EXPECT_GT(largest, 1e6) << stiffness << " " << damping;
        }
      }
    }
  }
  EXPECT_NEAR(critical_time_step(0.3, 4e7), 2.0 * std::sqrt(0.3 / 4e7), 1e-19);
}

TEST(ContactLaw, ValidateNamesTheFieldAndItsRange) {
  const auto refused = [](const ContactParameters& parameters) {
    return refused_argument([&] { validate(parameters); });
  };
  ContactParameters parameters = aluminium(0.3);
  EXPECT_EQ(refused(parameters), no_argument);
  parameters.friction_coefficient = -0.1;
  EXPECT_EQ(refused(parameters), Argument("friction_coefficient", -0.1));
  parameters = aluminium(0.3);
  parameters.normal_damping_ratio = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(refused(parameters), Argument("normal_damping_ratio", NAN));
  parameters = aluminium(0.3);
  parameters.tangential_damping_ratio = -1.0;
  EXPECT_EQ(refused(parameters), Argument("tangential_damping_ratio", -1));
  parameters = aluminium(0.3);
  parameters.effective_mass = std::numeric_limits<double>::infinity();
  EXPECT_EQ(refused(parameters), Argument("effective_mass", HUGE_VAL));
  parameters = aluminium(0.3);
  parameters.elastic.effective_shear_modulus = 0.0;
  EXPECT_EQ(refused(parameters), Argument("effective_shear_modulus", 0));
  parameters = aluminium(0.3);
  parameters.elastic.effective_young_modulus = -1.0;
  EXPECT_EQ(refused(parameters), Argument("effective_young_modulus", -1));
}

}  // namespace
}  // namespace statejump::kernel
