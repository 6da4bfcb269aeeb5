// SPDX-License-Identifier: GPL-3.0-or-later
// Fast checks of every step. Whether the steps are made in batches or one by one, a run must end
// before the same step.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "scenes.hpp"

namespace statejump::stepper {
namespace {

constexpr double none = std::numeric_limits<double>::quiet_NaN();

/// Number of steps that succeed one by one, without batches, and leave a finite state.
long steps_alone(Scene scene, const Scene::CreatePhysics& make, long most) {
  long made = 0;
  while (made < most && scene.run(1, make) == 1 && scene.has_finite_state()) ++made;
  return made;
}

/// @return number of steps of a single run; the test requires the same number with and without AVX2
long steps_of_a_run(const Scene& scene, const Scene::CreatePhysics& make, long most) {
  Scene narrow = scene, wide = scene;
  narrow.uses_avx2 = false;
  const long made = narrow.run(most, make);
  EXPECT_EQ(wide.run(most, make), made);
  return made;
}

TEST(Questions, BatchesAreNeverMoreLenientThanOneByOne) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> exponent(-12, 3), off(-40, 40);
  int plain = 0;
  for (int i = 0; i < 100'000; ++i) {
    const ContactPhysics physics = scenes::physics(std::pow(10, exponent(random)));
    const double step = std::pow(10, 0.5 * exponent(random));
    const double largest = stable_stiffness(physics, step);
    // Next to the limit, where rounding decides.
    const double limit = 4 * physics.effectiveMass / (step * step);
    const double stiffness = limit * (1 + off(random) * std::numeric_limits<double>::epsilon());
    if (stiffness < largest) {
      ++plain;
      EXPECT_TRUE(is_stable_stiffness(stiffness, physics, step));
    }
    EXPECT_LT(0.999 * limit, largest);
    EXPECT_GT(1.001 * limit, largest);
  }
  EXPECT_GT(plain, 10'000);
}

TEST(Questions, ChangesBelowTheBoundOfARunLeaveEveryLength) {
  std::mt19937_64 random(4);
  std::uniform_real_distribution<double> exponent(-12, 3), off(-40, 40);
  int plain = 0;
  Link link;
  link.stressFreeLength = 0.5;
  for (int i = 0; i < 100'000; ++i) {
    const double expansion = std::pow(10, exponent(random));
    const double bound = safe_temperature_change(expansion);
    const double change = (1 + off(random) * std::numeric_limits<double>::epsilon()) / expansion;
    if (change < bound) {
      ++plain;
      link.thermalExpansion = -expansion;
      EXPECT_TRUE(is_strain(-expansion * change));
      EXPECT_GT(stress_free_length(link, change), 0);
    }
    EXPECT_LT(0.999 / expansion, bound);
    EXPECT_GT(1.001 / expansion, bound);
    EXPECT_EQ(safe_temperature_change(-expansion), bound);
  }
  EXPECT_GT(plain, 10'000);
  for (const double wrong : {none, HUGE_VAL, -HUGE_VAL})
    EXPECT_EQ(safe_temperature_change(wrong), 0);
}

TEST(Questions, NoStiffnessIsPlainForNumbersThatAreNone) {
  for (const auto& quantity : contact_quantities<ContactPhysics>) {
    for (const double wrong : {none, -1.0, HUGE_VAL}) {
      ContactPhysics physics = scenes::physics(scenes::mass);
      physics.*quantity.value = wrong;
      EXPECT_TRUE(std::isnan(stable_stiffness(physics, 1e-6))) << quantity.name;
    }
  }
  for (const double step : {0.0, -1e-6, none}) {
    EXPECT_TRUE(std::isnan(stable_stiffness(scenes::physics(scenes::mass), step))) << step;
  }
}

TEST(Questions, BatchesEndBeforeTheStepThatIsTooLongForAContact) {
  // Each journal moves deeper than its load would press it. Its mass is too small for the contact
  // stiffness at that depth.
  Scene scene = scenes::crowd(6, 0.4, scenes::pressed() - 2e-7);
  scene.newton.damping = 0;
  scene.prepare();
  const Scene::CreatePhysics make = scenes::maker(7.2e-6);
  const long alone = steps_alone(scene, make, 1000);
  EXPECT_GT(alone, 3);
  EXPECT_LT(alone, 1000);
  EXPECT_EQ(steps_of_a_run(scene, make, 1000), alone);
}

TEST(Questions, NoStepIsMadeWithAYoungModulusThatIsNone) {
  for (const double wrong : {none, -70e9}) {
    Scene scene = scenes::crowd(6, 0.4);
    scene.prepare();
    ASSERT_EQ(scene.run(10, scenes::maker()), 10);
    scene.contacts[3].physics.effectiveYoungModulus = wrong;
    scene.prepare();
    Scene batched = scene;
    const long made = batched.run(10, scenes::maker());
    EXPECT_TRUE(made == 0 || !batched.has_finite_state());
    EXPECT_EQ(steps_alone(scene, scenes::maker(), 10), 0);
  }
}

double time_of(const Scene& scene, long step) {
  return static_cast<double>(step) * scene.time_step;
}

/// Relative shortening of the link per kelvin. No step has exactly the length 0, where the force
/// would be infinite.
constexpr double shrinks = 0.9;  // [1/K]

/// A crowd of joints with an additional link whose length becomes negative within a few steps.
Scene shrinking(bool moves) {
  Scene scene = scenes::held_crowd(5);
  scene.programs.front().temperature_change_max = 1e6;
  for (Heater::Target& target : scene.heaters.front().targets) target.expansion = 0;
  auto& places = std::get<Links>(scene.stages.front()).links;
  for (LinkEntry& each : places) each.link.thermalExpansion = 0;
  LinkEntry more = places[2];
  more.link.thermalExpansion = -shrinks;
  more.link.youngModulus = 1e3;
  more.link.dampingRatio = 0.9;
  if (!moves) more.link.id2 = places[3].link.id1;
  places.push_back(more);
  scene.prepare();
  return scene;
}

TEST(Questions, ARunEndsBeforeALinkLosesItsLength) {
  for (const bool moves : {true, false}) {
    SCOPED_TRACE(moves ? "its tip moves" : "both ends rest");
    const Scene scene = shrinking(moves);
    const auto length = [&](long step) {
      return 1 - shrinks * scene.programs.front().temperature_change(time_of(scene, step));
    };
    long expected = 0;
    while (length(expected) > 0) ++expected;
    ASSERT_LT(length(expected), -0.01);
    ASSERT_GT(expected, 2);
    EXPECT_EQ(steps_alone(scene, scenes::maker(), 100), expected);
    EXPECT_EQ(steps_of_a_run(scene, scenes::maker(), 100), expected);
  }
}

TEST(Questions, AForceOfALinkThatIsNoneIsSeenWhereverItActs) {
  for (const bool moves : {true, false}) {
    SCOPED_TRACE(moves ? "its tip moves" : "both ends rest");
    Scene scene = shrinking(moves);
    std::get<Links>(scene.stages.front()).links.back().link.dampingRatio = 0;
    std::get<Links>(scene.stages.front()).links.back().link.crossSectionArea = none;
    scene.prepare();
    EXPECT_EQ(steps_alone(scene, scenes::maker(), 100), 0);
    const long made = scene.run(100, scenes::maker());
    EXPECT_TRUE(made == 0 || !scene.has_finite_state());
  }
}

TEST(Questions, ARunEndsBeforeAStrainLeavesNoLength) {
  for (const std::size_t target : {0U, 1U}) {
    Scene scene = scenes::crowd(3);
    scene.programs.front().temperature_change_max = 1e6;
    for (Heater::Target& each : scene.heaters.front().targets) each.expansion = 0;
    scene.heaters.front().targets[target].expansion = none;
    scene.prepare();
    EXPECT_EQ(steps_of_a_run(scene, scenes::maker(), 100), 0);
    // A strain of a body that touches nothing.
    scene.strains.emplace_back();
    scene.heaters.front().targets[target] = {2, -1};
    scene.prepare();
    long expected = 0;
    while (scene.programs.front().temperature_change(time_of(scene, expected)) < 1) ++expected;
    EXPECT_EQ(steps_of_a_run(scene, scenes::maker(), 100), expected);
  }
}

}  // namespace
}  // namespace statejump::stepper
