// SPDX-License-Identifier: GPL-3.0-or-later
#include "statejump/kernel/laws/joint_response.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <string>

namespace statejump::kernel::laws {
namespace {

constexpr double eps = std::numeric_limits<double>::epsilon();

/// Journal in a bearing with data of the paper's Table 2, in a random state of contact.
struct RandomJoint {
  std::mt19937_64 generator{7};
  double uniform(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(generator);
  }
  Vector3 vector(double size) {
    return {uniform(-size, size), uniform(-size, size), uniform(-size, size)};
  }
  JointKinematics next() {
    const double r1 = 5e-3;
    const double r2 = uniform(5.05e-3, 5.2e-3);
    const double direction = uniform(0.0, 6.28);
    const double offset = r2 - r1 + uniform(-1e-6, 5e-6);
    const BodyMotion journal{offset * Vector3(std::cos(direction), std::sin(direction), 0.0),
                             vector(0.1), Vector3(0.0, 0.0, uniform(-20.0, 20.0))};
    const BodyMotion bearing{Vector3::Zero(), vector(0.1), Vector3(0.0, 0.0, uniform(-20.0, 20.0))};
    const Vector3 axis = Vector3::UnitZ();
    return {revolute_contact(journal, r1, bearing, r2, axis),
            {r1, r2, 0.01},
            journal,
            bearing,
            axis,
            uniform(1e-3, 0.1),
            0.0,
            1e-6};
  }
};

ContactParameters aluminium(double normal_damping, double tangential_damping) {
  return {elastic_pair(70e9, 0.3, 70e9, 0.3), 0.3, normal_damping, tangential_damping, 0.02};
}

JointLaw law_of(const char* normal, const char* dissipation, const char* friction,
                const char* velocity, double restitution = 0.8) {
  JointLaw law = joint_law({normal, dissipation, friction, velocity});
  law.restitution = restitution;
  validate(law);
  return law;
}

// The default law uses k_t = 4 (G*/E*) 2 E* a, hertz_mindlin() 8 G* a, with different rounding.
TEST(JointResponse, DefaultLawsAreHertzMindlin) {
  const JointLaw law = law_of("hertz_internal", "none", "mindlin", "material");
  RandomJoint joint;
  int touching = 0;
  int slipping = 0;
  int sticking_damped = 0;
  for (int i = 0; i < 2000; ++i) {
    const ContactParameters parameters = aluminium(i % 2 ? 0.1 : 0.0, i % 3 ? 0.2 : 0.0);
    const JointKinematics at = joint.next();
    ContactHistory history;
    history.tangential_force =
        joint.uniform(-10.0, 10.0) * cross(Vector3::UnitZ(), at.contact.normal);
    history.tangential_stiffness = joint.uniform(1e6, 1e8);
    ContactHistory expected_history = history;
    const ContactResponse expected =
        hertz_mindlin(parameters, contact_kinematics(at.contact, at.time_step), expected_history);
    const JointResponse found = joint_response(law, parameters, at, history);
    touching += expected.normal_force > 0.0;
    slipping += expected_history.slipping;
    sticking_damped += i % 3 && !expected_history.slipping && expected.normal_force > 0.0;

    const double force =
        20.0 * eps *
        (10.0 + expected.normal_force + expected.tangential_stiffness * 0.3 * at.time_step);
    EXPECT_EQ(history.slipping, expected_history.slipping);
    EXPECT_DOUBLE_EQ(found.contact.normal_force, expected.normal_force);
    EXPECT_DOUBLE_EQ(found.contact.tangential_stiffness, expected.tangential_stiffness);
    EXPECT_LT((found.contact.force_on_1 - expected.force_on_1).norm(), force);
    EXPECT_LT((history.tangential_force - expected_history.tangential_force).norm(), force);
    EXPECT_DOUBLE_EQ(found.contact.normal_elastic_energy, expected.normal_elastic_energy);
    const double energy = force * 1e-5;  // lengths of 10 um: depth, slide of a step, F/k_t
    EXPECT_NEAR(found.contact.tangential_elastic_energy, expected.tangential_elastic_energy,
                energy);
    EXPECT_NEAR(found.contact.friction_dissipation, expected.friction_dissipation, energy);
    EXPECT_NEAR(found.contact.damping_dissipation, expected.damping_dissipation, energy);
    const Wrench wrench = contact_wrench(expected.force_on_1, at.contact.arm_1, at.contact.arm_2);
    EXPECT_LT((found.wrench.force_2 - wrench.force_2).norm(), force);
    EXPECT_LT((found.wrench.torque_1 - wrench.torque_1).norm(), 0.01 * force);
    EXPECT_LT((found.wrench.torque_2 - wrench.torque_2).norm(), 0.01 * force);
  }
  EXPECT_GT(touching, 1000);
  EXPECT_GT(slipping, 200);
  EXPECT_GT(sticking_damped, 50);
}

// If the unit of force is 2^40 times as large, every law returns the same result to the last bit.
// Hence no law compares a force, stiffness or energy with a fixed nonzero threshold.
TEST(JointResponse, UnitOfForceDoesNotMatter) {
  const double unit = std::ldexp(1.0, -40);
  for (const std::string& normal : law_names<NormalLaw>()) {
    for (const std::string& friction : law_names<FrictionLaw>()) {
      for (const char* dissipation : {"none", "flores"}) {
        JointLaw law = joint_law({normal, dissipation, friction, "material"});
        law.restitution = 0.8;
        if (!incompatibility(law).empty()) continue;
        RandomJoint joint;
        int damped = 0;
        for (int i = 0; i < 200; ++i) {
          ContactParameters parameters = aluminium(i % 2 ? 0.1 : 0.0, 0.2);
          ContactParameters small = parameters;
          small.elastic.effective_young_modulus *= unit;
          small.elastic.effective_shear_modulus *= unit;
          small.effective_mass *= unit;
          JointKinematics at = joint.next();
          at.time_step = 1e-9;  // too short to slip
          ContactHistory history;
          ContactHistory small_history;
          for (int step = 0; step < 3; ++step) {
            const JointResponse found = joint_response(law, parameters, at, history);
            const JointResponse same = joint_response(law, small, at, small_history);
            ASSERT_EQ(same.contact.normal_force, unit * found.contact.normal_force) << normal;
            ASSERT_EQ(same.contact.force_on_1, unit * found.contact.force_on_1)
                << normal << " " << friction;
            ASSERT_EQ(same.contact.damping_dissipation, unit * found.contact.damping_dissipation);
            ASSERT_EQ(small_history.slipping, history.slipping);
            damped += !history.slipping && found.contact.tangential_force.norm() > 0.0;
          }
        }
        if (friction == "mindlin") {
          EXPECT_GT(damped, 50);
        }
      }
    }
  }
}

// For all laws, the bodies lose the energy that the contact receives: the wrench on the bodies has
// the same power as the contact force at the velocity used by friction.
TEST(JointResponse, VelocityAndWrenchBelongTogether) {
  RandomJoint joint;
  const ContactParameters parameters = aluminium(0.0, 0.0);
  for (const char* velocity : {"material", "paper"}) {
    const JointLaw law = law_of("johnson", "flores", "ambrosio", velocity);
    double lost = 0.0;
    for (int i = 0; i < 500; ++i) {
      const JointKinematics at = joint.next();
      ContactHistory history;
      const JointResponse found = joint_response(law, parameters, at, history);
      const Wrench& w = found.wrench;
      const double power =
          w.force_1.dot(at.motion_1.velocity) + w.torque_1.dot(at.motion_1.angular_velocity) +
          w.force_2.dot(at.motion_2.velocity) + w.torque_2.dot(at.motion_2.angular_velocity);
      const ContactResponse& c = found.contact;
      const double approach = (at.motion_1.velocity - at.motion_2.velocity).dot(at.contact.normal);
      const double expected = -c.elastic_normal_force * approach -
                              (c.friction_dissipation + c.damping_dissipation) / at.time_step;
      EXPECT_NEAR(power, expected, 1e-12 * (1.0 + std::abs(expected) + c.normal_force)) << velocity;
      EXPECT_GE(c.friction_dissipation, 0.0);
      EXPECT_GE(c.damping_dissipation, 0.0);
      lost += c.friction_dissipation;
    }
    EXPECT_GT(lost, 0.0);
  }
}

// The force is F (1 + (chi/K) v); chi uses the impact speed of the contact, but at least
// smallest_impact_speed.
TEST(JointResponse, DissipationUsesTheImpactSpeed) {
  JointLaw law = law_of("hertz_internal", "hunt_crossley", "none", "material");
  law.smallest_impact_speed = 0.02;
  const ContactParameters parameters = aluminium(0.0, 0.0);
  RandomJoint joint;
  for (int i = 0; i < 200; ++i) {
    JointKinematics at = joint.next();
    if (at.contact.penetration_depth <= 0.0) continue;
    for (const double impact : {0.05, 1e-9, -0.3}) {
      at.impact_speed = impact;
      ContactHistory history;
      const JointResponse found = joint_response(law, parameters, at, history);
      const double v = at.contact.relative_velocity.dot(at.contact.normal);
      const double ratio = 1.5 * (1.0 - 0.8) / (impact == 0.05 ? 0.05 : 0.02);
      const double elastic = found.contact.elastic_normal_force;
      EXPECT_NEAR(found.contact.normal_force, elastic * std::max(0.0, 1.0 + ratio * v),
                  1e-13 * elastic * (1.0 + ratio));
      EXPECT_NEAR(found.dissipation_slope, ratio * elastic, 1e-14 * ratio * elastic);
    }
  }
}

// Tangential damping belongs to a sticking spring. Laws without a spring have no damping force.
TEST(JointResponse, TangentialDampingNeedsTheSpring) {
  RandomJoint joint;
  JointKinematics at = joint.next();
  while (at.contact.penetration_depth < 1e-6) at = joint.next();
  for (const char* friction : {"none", "ambrosio"}) {
    const JointLaw law = law_of("hertz_internal", "none", friction, "material");
    ContactHistory history;
    const JointResponse plain = joint_response(law, aluminium(0.0, 0.0), at, history);
    const JointResponse damped = joint_response(law, aluminium(0.0, 0.5), at, history);
    EXPECT_EQ(plain.contact.tangential_force, damped.contact.tangential_force) << friction;
    EXPECT_EQ(damped.contact.damping_dissipation, 0.0);
    EXPECT_EQ(damped.contact.tangential_stiffness, 0.0);
  }
  const JointLaw ambrosio = law_of("hertz_internal", "none", "ambrosio", "material");
  ContactHistory history;
  const JointResponse found = joint_response(ambrosio, aluminium(0.0, 0.0), at, history);
  EXPECT_DOUBLE_EQ(found.friction_slope, 0.3 * found.contact.normal_force / 1e-3);
}

// Hertz: V = 2/5 K delta^2.5, so dV/dR = V/(2 R) for the effective radius R. At a flat wall R = R1.
TEST(RadiusEnergyChange, HertzInClosedForm) {
  const NormalMaterial material{38e9};
  const double depth = 2e-6;
  const NormalLaw law = HertzInternal{};
  const NormalGeometry before{5e-3, 5.1e-3, 0.01};
  const NormalGeometry after{5e-3 * (1 + 2e-9), 5.1e-3 * (1 + 1e-9), 0.01};
  const double energy = evaluate(law, depth, before, material).elastic_energy;
  // relative change of the effective radius: dR1/R1 + dR2/R2 - d(R2 - R1)/(R2 - R1)
  const double relative = 2e-9 + 1e-9 - (5.1e-12 - 10e-12) / 1e-4;
  EXPECT_NEAR(radius_energy_change(law, material, depth, before, after), 0.5 * energy * relative,
              // the relative radius change of 1e-9 itself has a relative rounding error of 2e-7
              2e-7 * 0.5 * energy * relative);
  const double infinity = std::numeric_limits<double>::infinity();
  const NormalGeometry wall{0.05, infinity, 0.01};
  const NormalGeometry grown{0.05 * (1 + 1e-8), infinity, 0.01};
  const double flat = evaluate(law, depth, wall, material).elastic_energy;
  EXPECT_NEAR(radius_energy_change(law, material, depth, wall, grown), 0.5 * flat * 1e-8,
              1e-7 * 0.5 * flat * 1e-8);
  EXPECT_EQ(radius_energy_change(law, material, depth, wall, wall), 0.0);
  EXPECT_EQ(radius_energy_change(law, material, -depth, wall, grown), 0.0);
}

// The change is evaluated at the mean radii, so swapping the radii changes only its sign.
TEST(RadiusEnergyChange, TurnsItsSignWithTheChange) {
  const NormalMaterial material{38e9};
  const double infinity = std::numeric_limits<double>::infinity();
  const NormalGeometry one{5e-3, 5.1e-3, 0.01};
  for (const NormalGeometry& other :
       {NormalGeometry{5.001e-3, 5.1e-3, 0.01}, NormalGeometry{5e-3, 5.101e-3, 0.01},
        NormalGeometry{5.001e-3, 5.103e-3, 0.01}}) {
    const double there = radius_energy_change(HertzInternal{}, material, 2e-6, one, other);
    const double back = radius_energy_change(HertzInternal{}, material, 2e-6, other, one);
    // Both directions evaluate the same difference. V is rounded, relative to a step of 1e-5.
    EXPECT_NEAR(there, -back, 1e-10 * std::abs(there));
    EXPECT_NE(there, 0.0);
  }
  const NormalGeometry wall{0.05, infinity, 0.01};
  const NormalGeometry grown{0.051, infinity, 0.01};
  const double there = radius_energy_change(HertzInternal{}, material, 2e-6, wall, grown);
  EXPECT_NEAR(there, -radius_energy_change(HertzInternal{}, material, 2e-6, grown, wall),
              1e-10 * there);
}

// For any law, radius_energy_change() minus F times the change of clearance is the total change of
// V at fixed eccentricity.
TEST(RadiusEnergyChange, ClosesAFiniteChangeForEveryLaw) {
  const NormalMaterial material{38e9};
  for (const std::string& name : law_names<NormalLaw>()) {
    const NormalLaw law = normal_law(name);
    const int steps = 200;
    const auto geometry = [&](int i) {
      const double change = 20.0 * i / steps;
      return NormalGeometry{5e-3 * (1 + 23e-6 * change), 5.1e-3 * (1 + 10e-6 * change), 0.01};
    };
    const double eccentricity = 1.02e-4;
    const auto state = [&](int i) {
      return evaluate(law, eccentricity - geometry(i).clearance(), geometry(i), material);
    };
    double work = 0.0;
    for (int i = 0; i < steps; ++i) {
      const NormalGeometry before = geometry(i);
      const NormalGeometry after = geometry(i + 1);
      work -=
          0.5 * (state(i).force + state(i + 1).force) * (after.clearance() - before.clearance());
      for (const NormalGeometry& at : {before, after}) {
        work +=
            0.5 * radius_energy_change(law, material, eccentricity - at.clearance(), before, after);
      }
    }
    const double expected = state(steps).elastic_energy - state(0).elastic_energy;
    EXPECT_GT(expected, 0.1 * state(0).elastic_energy);
    // Trapezoidal rule with h/delta = 0.3/200: the error V''' h^3/12 per step sums to
    // (h/delta)^2/12 of the change.
    EXPECT_NEAR(work, expected, 1e-6 * expected) << name;
  }
}

// A bore that shrinks onto a pin at rest causes an impact like a moving pin: the depth grows at
// -dc/dt.
TEST(JointResponse, DissipationSeesTheRateOfTheDepth) {
  const JointLaw law = law_of("hertz_internal", "hunt_crossley", "none", "material");
  RandomJoint joint;
  JointKinematics moving = joint.next();
  while (moving.contact.penetration_depth <= 0.0) moving = joint.next();
  const double closing = 0.02;
  const auto with = [&](double approach, double clearance_rate) {
    JointKinematics at = moving;
    at.motion_1.velocity = approach * at.contact.normal;
    at.motion_2.velocity = Vector3::Zero();
    at.motion_1.angular_velocity = at.motion_2.angular_velocity = Vector3::Zero();
    at.contact.relative_velocity = at.motion_1.velocity;
    at.clearance_rate = clearance_rate;
    ContactHistory history;
    return joint_response(law, aluminium(0.0, 0.0), at, history);
  };
  const JointResponse bodies = with(closing, 0.0);
  const JointResponse hole = with(0.0, -closing);
  EXPECT_DOUBLE_EQ(hole.contact.normal_force, bodies.contact.normal_force);
  EXPECT_DOUBLE_EQ(hole.contact.damping_dissipation, bodies.contact.damping_dissipation);
  EXPECT_GT(hole.dissipation_force, 0.0);
  // No approach: the hole grows as fast as the pin moves.
  EXPECT_NEAR(with(closing, closing).contact.normal_force, bodies.contact.elastic_normal_force,
              1e-12 * bodies.contact.normal_force);
}

}  // namespace
}  // namespace statejump::kernel::laws
