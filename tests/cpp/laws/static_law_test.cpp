// SPDX-License-Identifier: GPL-3.0-or-later
#include "statejump/kernel/laws/static_law.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <random>
#include <type_traits>

#include "statejump/kernel/laws/joint_response.hpp"

namespace statejump::kernel::laws {
namespace {

bool is_known(const JointLaw& law) {
  return with_precompiled_law(
      law, [](const auto& one) { return !std::is_same_v<std::decay_t<decltype(one)>, JointLaw>; });
}

template <class Value>
bool same_bits(const Value& one, const Value& other) {
  return std::memcmp(&one, &other, sizeof one) == 0;
}

TEST(KnownLaw, IsTakenWhereAllFourLawsAre) {
  EXPECT_TRUE(is_known(joint_law({"hertz_internal", "none", "mindlin", "material"})));
  EXPECT_FALSE(is_known(joint_law({"hertz_paper", "none", "mindlin", "material"})));
  EXPECT_FALSE(is_known(joint_law({"hertz_internal", "hunt_crossley", "mindlin", "material"})));
  EXPECT_FALSE(is_known(joint_law({"hertz_internal", "none", "ambrosio", "material"})));
  EXPECT_FALSE(is_known(joint_law({"hertz_internal", "none", "mindlin", "paper"})));
}

TEST(KnownLaw, HasTheParametersOfTheLaw) {
  JointLaw law = joint_law({"hertz_internal", "none", "mindlin", "material"});
  law.friction_parameters = {0.1, 0.2, 0.3};
  law.restitution = 0.4;
  law.smallest_impact_speed = 0.5;
  law.contact_length = 0.6;
  with_precompiled_law(law, [&](const auto& one) {
    EXPECT_TRUE(same_bits(one.friction_parameters, law.friction_parameters));
    EXPECT_EQ(one.restitution, 0.4);
    EXPECT_EQ(one.smallest_impact_speed, 0.5);
    EXPECT_EQ(one.contact_length, 0.6);
  });
}

// Static and dynamic laws must agree to the last bit for open, sticking and slipping contacts,
// during loading and unloading, with and without dashpots.
TEST(KnownLaw, AnswersWithTheBitsOfTheLaw) {
  const JointLaw law = joint_law({"hertz_internal", "none", "mindlin", "material"});
  std::mt19937_64 generator{7};
  const auto uniform = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(generator);
  };
  const auto vector = [&](double size) {
    return Vector3(uniform(-size, size), uniform(-size, size), uniform(-size, size));
  };
  int touching = 0, slipping = 0;
  for (int i = 0; i < 2000; ++i) {
    const double r1 = 5e-3, r2 = uniform(5.05e-3, 5.2e-3);
    const double direction = uniform(0.0, 6.28), offset = r2 - r1 + uniform(-1e-6, 5e-6);
    const BodyMotion journal{offset * Vector3(std::cos(direction), std::sin(direction), 0.0),
                             vector(0.1), Vector3(0.0, 0.0, uniform(-20.0, 20.0))};
    const BodyMotion bearing{Vector3::Zero(), vector(0.1), Vector3(0.0, 0.0, uniform(-20.0, 20.0))};
    const JointKinematics at{revolute_contact(journal, r1, bearing, r2, Vector3::UnitZ()),
                             {r1, r2, 0.01},
                             journal,
                             bearing,
                             Vector3::UnitZ(),
                             uniform(1e-3, 0.1),
                             uniform(-1e-3, 1e-3),
                             1e-6};
    const ContactParameters parameters{elastic_pair(70e9, 0.3, 70e9, 0.3), 0.3, i % 2 ? 0.1 : 0.0,
                                       i % 3 ? 0.2 : 0.0, 0.02};
    ContactHistory history;
    history.tangential_force = uniform(-10.0, 10.0) * cross(Vector3::UnitZ(), at.contact.normal);
    history.tangential_stiffness = uniform(1e6, 1e8);
    ContactHistory known_history = history;
    const JointResponse expected = joint_response(law, parameters, at, history);
    with_precompiled_law(law, [&](const auto& known) {
      EXPECT_TRUE(same_bits(joint_response(known, parameters, at, known_history), expected));
    });
    EXPECT_TRUE(same_bits(known_history.tangential_force, history.tangential_force));
    EXPECT_EQ(known_history.tangential_stiffness, history.tangential_stiffness);
    EXPECT_EQ(known_history.slipping, history.slipping);
    touching += expected.contact.normal_force > 0.0;
    slipping += history.slipping;
  }
  EXPECT_GT(touching, 1000);
  EXPECT_GT(slipping, 200);
}

}  // namespace
}  // namespace statejump::kernel::laws
