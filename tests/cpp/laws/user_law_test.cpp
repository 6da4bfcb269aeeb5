// SPDX-License-Identifier: GPL-3.0-or-later
// Laws accessed through a table of functions, as in shared objects; here built in this file.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include "statejump/kernel/laws/joint_response.hpp"

namespace statejump::kernel::laws {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
const NormalGeometry joint{5e-3, 5.1e-3, 0.01};
const NormalMaterial aluminium{70e9 / (2.0 * 0.91)};

/// Hertz law that throws for depths below 1 um.
struct Moody {
  static constexpr LawInfo info{
      "moody", "F", "the tests", "any", Trait::holds_static_load | Trait::needs_axis, {}};
  static double largest_depth(const NormalGeometry& geometry) { return geometry.clearance(); }
  NormalState operator()(double depth, const NormalGeometry& geometry,
                         const NormalMaterial& material) const {
    if (depth > 0.0 && depth < 1e-7) return {nan, 0.0, 0.0, 0.0};
    if (depth > 0.0 && depth < 1e-6) throw std::runtime_error("not today");
    return HertzInternal{}(depth, geometry, material);
  }
};

/// The catalogue plus a usable and an unusable law, as the loader would register them.
class UserLawTest : public ::testing::Test {
 protected:
  UserLawTest() {
    LoadedLaw law;
    law.kind = LawKind::normal;
    law.name = Moody::info.name;
    law.origin = "moody.so";
    law.info = Moody::info;
    law.table = user_law_table<Moody>("no hash");
    loaded_laws().push_back(law);
    law.name = "stale";
    law.table = nullptr;
    law.problem = "stale.so was compiled long ago";
    loaded_laws().push_back(law);
  }
  ~UserLawTest() override { loaded_laws().clear(); }
};

NormalLaw moody() {
  return normal_law("moody");
}

TEST_F(UserLawTest, IsFoundByItsNameAndCarriesItsTraits) {
  const NormalLaw law = moody();
  EXPECT_STREQ(law_info(law).name, "moody");
  EXPECT_TRUE(has(law, Trait::needs_axis));
  EXPECT_FALSE(has(law, Trait::point_contact));
  EXPECT_EQ(law_names<NormalLaw>().back(), "stale");
  EXPECT_STREQ(law_infos<NormalLaw>().back().name, "moody");
  EXPECT_EQ(names_with<NormalLaw>(Trait::needs_axis, false), "'hertz_paper' or 'hertz_internal'");
}

TEST_F(UserLawTest, AnswersAsItsTypeToTheLastBit) {
  for (const double depth : {-1e-6, 0.0, 1e-6, 3e-6, 9e-5}) {
    const NormalState own = evaluate(normal_law("hertz_internal"), depth, joint, aluminium);
    const NormalState loaded = evaluate(moody(), depth, joint, aluminium);
    EXPECT_EQ(loaded.force, own.force) << depth;
    EXPECT_EQ(loaded.stiffness, own.stiffness) << depth;
    EXPECT_EQ(loaded.contact_width, own.contact_width) << depth;
    EXPECT_EQ(loaded.elastic_energy, own.elastic_energy) << depth;
  }
}

std::string complaint(double depth) {
  try {
    evaluate(moody(), depth, joint, aluminium);
  } catch (const std::domain_error& error) {
    return error.what();
  }
  return "";
}

TEST_F(UserLawTest, WrongAnswersAndExceptionsNameTheLaw) {
  EXPECT_EQ(complaint(5e-8), "moody (moody.so): returned force = nan");
  EXPECT_EQ(complaint(5e-7), "moody (moody.so): not today");
  for (const double depth : {1e-3, nan}) {
    try {
      evaluate(moody(), depth, joint, aluminium);
      FAIL() << "accepted";
    } catch (const DepthOutOfRange& refused) {
      EXPECT_EQ(refused.law(), "moody");
      EXPECT_TRUE(refused.depth() == depth || (std::isnan(refused.depth()) && std::isnan(depth)));
      // The limit is a fraction of the joint's clearance, whose rounding is that of the radii.
      EXPECT_NEAR(refused.limit(), 1e-4,
                  joint.bearing_radius * std::numeric_limits<double>::epsilon());
      EXPECT_EQ(std::string(refused.what()).find("moody: penetration_depth = "), 0u);
    }
  }
}

TEST_F(UserLawTest, OneThatCannotBeUsedSaysWhy) {
  try {
    normal_law("stale");
    FAIL();
  } catch (const UnusableLaw& refused) {
    EXPECT_EQ(refused.name(), "stale");
    EXPECT_EQ(refused.reason(), law_problem<NormalLaw>("stale"));
    EXPECT_NE(refused.reason(), "");
  }
  EXPECT_EQ(law_problem<NormalLaw>("moody"), "");
}

struct Doubling {
  static constexpr LawInfo info{"doubling", "chi", "the tests", "any", Trait::holds_static_load,
                                {}};
  double operator()(const ImpactParameters& impact) const { return 2.0 * impact.restitution; }
};

struct Sticky {
  static constexpr LawInfo info{"sticky", "F", "the tests", "any", Trait::has_memory, {}};
  static double largest_slope(const FrictionParameters&, double normal_force) {
    return normal_force;
  }
  FrictionResponse operator()(const FrictionParameters& parameters,
                              const FrictionKinematics& kinematics, ContactHistory& history) const {
    return MindlinFriction{}(parameters, kinematics, history);
  }
};

struct Slow {
  static constexpr LawInfo info{"slow", "v", "the tests", "any", Trait::holds_static_load, {}};
  Vector3 velocity(const JointContact& contact, const BodyMotion&, const BodyMotion&,
                   const Vector3&) const {
    return 0.5 * contact.relative_velocity;
  }
  Wrench wrench(const JointContact&, const Vector3& force, const Vector3&) const {
    return {0.5 * force, Vector3::Zero(), -0.5 * force, Vector3::Zero()};
  }
};

template <class Law>
LoadedLaw loaded() {
  LoadedLaw law;
  law.name = Law::info.name;
  law.info = Law::info;
  law.table = user_law_table<Law>("");
  law.kind = law.table->kind;
  return law;
}

TEST(UserLaws, EveryKindGoesThroughItsTable) {
  const LoadedLaw chi = loaded<Doubling>();
  EXPECT_EQ(chi.kind, LawKind::dissipation);
  EXPECT_EQ(damping_ratio(DissipationLaw(UserDissipationLaw(chi)), {0.7, 0.1}), 1.4);

  const LoadedLaw sticky = loaded<Sticky>();
  EXPECT_EQ(sticky.kind, LawKind::friction);
  const FrictionLaw friction = UserFrictionLaw(sticky);
  const FrictionParameters parameters{0.3, 0.0, 1e-3};
  ContactHistory one;
  ContactHistory two;
  const FrictionKinematics kinematics{100.0, 1e7, Vector3(1e-3, 0.0, 0.0), 1e-4, Vector3::UnitZ()};
  const FrictionResponse own = MindlinFriction{}(parameters, kinematics, one);
  const FrictionResponse through = evaluate(friction, parameters, kinematics, two);
  EXPECT_EQ(through.force_on_1, own.force_on_1);
  EXPECT_EQ(two.tangential_force, one.tangential_force);
  EXPECT_EQ(largest_slope(friction, parameters, 7.0), 7.0);

  const LoadedLaw slow = loaded<Slow>();
  EXPECT_EQ(slow.kind, LawKind::tangential_velocity);
  const UserVelocityLaw velocity(slow);
  JointContact contact{};
  contact.relative_velocity = Vector3(1.0, 2.0, 3.0);
  EXPECT_EQ(velocity.velocity(contact, {}, {}, Vector3::Zero()), Vector3(0.5, 1.0, 1.5));
  EXPECT_EQ(velocity.wrench(contact, Vector3(2.0, 0.0, 0.0), Vector3::Zero()).force_2,
            Vector3(-1.0, 0.0, 0.0));
}

// ---- laws that return one invalid number, selected by an input

/// Replaces `entry` by `wrong` (NaN) if `at` is the index that the input selects.
void spoil(double wanted, int at, double& entry, double wrong = nan) {
  if (wanted == at) entry = wrong;
}

struct WrongNormal {
  static constexpr LawInfo info{"wrong_normal",           "F", "the tests", "any",
                                Trait::holds_static_load, {}};
  static double largest_depth(const NormalGeometry&) { return 1.0; }
  NormalState operator()(double, const NormalGeometry& geometry, const NormalMaterial&) const {
    NormalState answer{1.0, 1.0, 1.0, 1.0};
    const double wanted = geometry.length;
    double* const entries[] = {&answer.force, &answer.stiffness, &answer.contact_width,
                               &answer.elastic_energy};
    for (int i = 0; i < 4; ++i) {
      spoil(wanted, i, *entries[i]);
      spoil(wanted, 4 + i, *entries[i], -1.0);
    }
    return answer;
  }
};

struct WrongDissipation {
  static constexpr LawInfo info{"wrong_chi", "chi", "the tests", "any", Trait::holds_static_load,
                                {}};
  double operator()(const ImpactParameters& impact) const { return impact.restitution; }
};

struct WrongFriction {
  static constexpr LawInfo info{"wrong_friction", "F", "the tests", "any", Trait::has_memory, {}};
  static double largest_slope(const FrictionParameters&, double normal_force) {
    return normal_force;
  }
  FrictionResponse operator()(const FrictionParameters&, const FrictionKinematics& kinematics,
                              ContactHistory& history) const {
    FrictionResponse answer{Vector3::Ones(), 1.0, -1.0};
    const double wanted = kinematics.time_step;
    for (int i = 0; i < 3; ++i) {
      spoil(wanted, i, answer.force_on_1[i]);
      spoil(wanted, 3 + i, history.tangential_force[i]);
    }
    spoil(wanted, 6, answer.elastic_energy);
    spoil(wanted, 7, answer.dissipation);
    spoil(wanted, 8, history.tangential_stiffness);
    spoil(wanted, 9, history.tangential_stiffness, -1.0);
    return answer;
  }
};

struct WrongVelocity {
  static constexpr LawInfo info{"wrong_velocity",         "v", "the tests", "any",
                                Trait::holds_static_load, {}};
  Vector3 velocity(const JointContact& contact, const BodyMotion&, const BodyMotion&,
                   const Vector3&) const {
    Vector3 answer = Vector3::Zero();
    for (int i = 0; i < 3; ++i) spoil(contact.eccentricity, i, answer[i]);
    return answer;
  }
  Wrench wrench(const JointContact& contact, const Vector3&, const Vector3&) const {
    Wrench answer{Vector3::Zero(), Vector3::Zero(), Vector3::Zero(), Vector3::Zero()};
    for (int i = 0; i < 3; ++i) {
      spoil(contact.eccentricity, i, answer.force_1[i]);
      spoil(contact.eccentricity, 3 + i, answer.torque_1[i]);
      spoil(contact.eccentricity, 6 + i, answer.force_2[i]);
      spoil(contact.eccentricity, 9 + i, answer.torque_2[i]);
    }
    return answer;
  }
};

template <class Ask>
std::string refused(Ask&& ask) {
  try {
    ask();
  } catch (const std::domain_error& error) {
    return error.what();
  }
  return "";
}

TEST(UserLaws, EveryNumberOfAnAnswerIsLookedAt) {
  const LoadedLaw normal = loaded<WrongNormal>();
  const char* const of_normal[] = {"force", "stiffness", "contact_width", "elastic_energy"};
  for (int i = 0; i < 9; ++i) {
    const std::string said = refused([&] {
      UserNormalLaw{normal}(1e-6, {5e-3, 5.1e-3, static_cast<double>(i)}, aluminium);
    });
    if (i == 8) {
      EXPECT_EQ(said, "");
    } else {
      EXPECT_NE(
          said.find(std::string("returned ") + of_normal[i % 4] + (i < 4 ? " = nan" : " = -1")),
          std::string::npos)
          << i << said;
    }
  }

  const LoadedLaw chi = loaded<WrongDissipation>();
  for (const double wrong : {nan, -1e-9, std::numeric_limits<double>::infinity()}) {
    EXPECT_NE(refused([&] { UserDissipationLaw{chi}({wrong, 0.1}); }), "") << wrong;
  }
  EXPECT_EQ(UserDissipationLaw{chi}({0.0, 0.1}), 0.0);

  const LoadedLaw friction = loaded<WrongFriction>();
  for (int i = 0; i < 11; ++i) {
    ContactHistory history;
    const FrictionKinematics kinematics{100.0, 1e7, Vector3::Zero(), static_cast<double>(i),
                                        Vector3::UnitZ()};
    const std::string said = refused([&] { UserFrictionLaw{friction}({}, kinematics, history); });
    EXPECT_EQ(said.empty(), i == 10) << i << said;  // a negative dissipation is allowed
  }
  EXPECT_NE(refused([&] { UserFrictionLaw{friction}.largest_slope({}, -1.0); }), "");

  const LoadedLaw velocity = loaded<WrongVelocity>();
  for (int i = 0; i < 13; ++i) {
    JointContact contact{};
    contact.eccentricity = i;
    const std::string of_velocity =
        refused([&] { UserVelocityLaw{velocity}.velocity(contact, {}, {}, Vector3::Zero()); });
    EXPECT_EQ(of_velocity.empty(), i >= 3) << i;
    const std::string of_wrench = refused(
        [&] { UserVelocityLaw{velocity}.wrench(contact, Vector3::Zero(), Vector3::Zero()); });
    EXPECT_EQ(of_wrench.empty(), i == 12) << i;
  }
}

// Fields that a loader checks before it uses a table.
TEST(UserLaws, TableSaysWhatItIs) {
  const UserLawTable& table = *user_law_table<Doubling>("a hash");
  EXPECT_EQ(table.version, user_law_version);
  EXPECT_EQ(table.kind, LawKind::dissipation);
  EXPECT_STREQ(table.name, "doubling");
  EXPECT_STREQ(table.kernel, "a hash");
  EXPECT_EQ(table.info, &Doubling::info);
  // The number encodes sizes as digits of base 31, modulo 2^32. This loop starts at the last digit.
  std::uint32_t expected = 0;
  std::uint32_t weight = 1;
  for (const std::size_t size :
       {sizeof(Wrench), sizeof(Vector3), sizeof(BodyMotion), sizeof(JointContact),
        sizeof(ContactHistory), sizeof(FrictionResponse), sizeof(FrictionKinematics),
        sizeof(FrictionParameters), sizeof(ImpactParameters), sizeof(NormalState),
        sizeof(NormalMaterial), sizeof(NormalGeometry), sizeof(LawParameter), sizeof(LawInfo),
        sizeof(UserLawTable)}) {
    expected += weight * static_cast<std::uint32_t>(size);
    weight *= 31U;
  }
  EXPECT_EQ(table.sizes, expected);
}

}  // namespace
}  // namespace statejump::kernel::laws
