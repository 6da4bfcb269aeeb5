// SPDX-License-Identifier: GPL-3.0-or-later
// Subscenes in several threads give the same bits as the whole scene in one thread.
//
// The thread sanitizer misses a race if it no longer remembers the first access. So its tests make
// few steps, and two deliberate races must be found (trials:
// docs/validation/reliability_methods.md).
#include "statejump/stepper/partition.hpp"

#include <gtest/gtest.h>
#include <omp.h>

#include <atomic>
#include <cstdlib>
#include <optional>
#include <vector>

#include "scenes.hpp"

namespace statejump::stepper {
namespace {

constexpr int joints = 100;  // four subscenes

/// Journals that fall through their clearances, each in its own direction.
Scene falling() {
  Scene scene = scenes::held_crowd(joints, 0.9 * scenes::clearance);
  scene.prepare();
  return scene;
}

std::optional<ContactPhysics> aluminium() {
  return scenes::physics(scenes::mass);
}

std::vector<double> numbers(const Scene& scene) {
  std::vector<double> found{scene.time, static_cast<double>(scene.iteration)};
  const auto add = [&](const Vector3& v) { found.insert(found.end(), v.data(), v.data() + 3); };
  for (const Body& body : scene.bodies) {
    add(body.motion.position);
    add(body.motion.velocity);
  }
  for (const Contact& contact : scene.contacts) {
    found.push_back(contact.real);
    add(contact.physics.normalForce);
    add(contact.physics.shearForce);
  }
  for (const LinkEntry& place : std::get<Links>(scene.stages[0]).links) {
    found.push_back(place.link.axialForce);
  }
  return found;
}

TEST(Partition, AnyNumberOfThreadsGivesTheBitsOfTheWhole) {
  constexpr long steps = 2000;
  Scene whole = falling();
  int alone = 0;
  const auto make_alone = [&](std::size_t) { return ++alone, aluminium(); };
  ASSERT_EQ(whole.run(steps, make_alone), steps);
  const std::vector<double> expected = numbers(whole);
  ASSERT_GE(alone, joints);  // all joints have touched
  const int before = omp_get_max_threads();
  for (const int threads : {1, 2, 4}) {
    omp_set_num_threads(threads);
    Scene scene = falling();
    Partition partition(scene);
    ASSERT_EQ(partition.size(), 4U);
    std::atomic<int> made = 0;
    const auto make = [&](std::size_t) {
      // relaxed: does not order threads, which would hide races
      made.fetch_add(1, std::memory_order_relaxed);
      return aluminium();
    };
    ASSERT_EQ(partition.run(steps, make), steps);
    partition.collect(scene);
    EXPECT_EQ(numbers(scene), expected) << threads << " threads";
    EXPECT_EQ(made, alone);
  }
  omp_set_num_threads(before);
}

constexpr long few = 20;

/// Makes few steps, so that the sanitizer still remembers all accesses.
/// @param make as for Scene::run(); called in the first step
void step_side_by_side(const Scene::CreatePhysics& make) {
  omp_set_num_threads(4);
  for (int i = 0; i < 5; ++i) {
    Scene scene = scenes::held_crowd(joints);
    scene.prepare();
    Partition partition(scene);
    ASSERT_EQ(partition.run(few, make), few);
    partition.collect(scene);
  }
}

TEST(Partition, FewStepsSideBySide) {
  step_side_by_side([](std::size_t) { return aluminium(); });
}

#ifdef __SANITIZE_THREAD__
constexpr bool looks_for_races = true;
#elif defined(__has_feature)
constexpr bool looks_for_races = __has_feature(thread_sanitizer);
#else
constexpr bool looks_for_races = false;
#endif

/// Makes steps with a data race. The sanitizer then ends this process with its own exit status.
void race(const Scene::CreatePhysics& make) {
  step_side_by_side(make);
  std::exit(0);
}

TEST(PartsDeathTest, TheThreadSanitizerSeesARaceOfEveryContact) {
  if (!looks_for_races) GTEST_SKIP() << "compiled without the thread sanitizer";
  testing::GTEST_FLAG(death_test_style) = "threadsafe";
  int made = 0;
  const auto counts = [&](std::size_t) { return ++made, aluminium(); };
  EXPECT_EXIT(race(counts), testing::ExitedWithCode(66), "data race");
}

TEST(PartsDeathTest, TheThreadSanitizerSeesARaceOfOneAccessInEachPart) {
  if (!looks_for_races) GTEST_SKIP() << "compiled without the thread sanitizer";
  testing::GTEST_FLAG(death_test_style) = "threadsafe";
  std::size_t last = 0;
  const auto writes = [&](std::size_t contact) {
    if (contact % (joints / 4) == 0) last = contact;
    return aluminium();
  };
  EXPECT_EXIT(race(writes), testing::ExitedWithCode(66), "data race");
}

TEST(Partition, ReturnsTheFewestStepsOfAnySubscene) {
  Scene scene = falling();
  // The last journal has no material, so its subscene stops before the journal touches its bearing.
  Partition partition(scene);
  const auto make = [](std::size_t contact) {
    return contact + 1 == joints ? std::nullopt : aluminium();
  };
  Scene alone = falling();
  const long expected = alone.run(2000, make);
  EXPECT_LT(expected, 2000);
  EXPECT_EQ(partition.run(2000, make), expected);
}

}  // namespace
}  // namespace statejump::stepper
