// SPDX-License-Identifier: GPL-3.0-or-later
// Cost per joint and step without YADE: the stepper's arrays compared with a bare leapfrog loop of
// the same kernel; chains, and the rib of an umbrella.
#include <benchmark/benchmark.h>

#include "bare_loop.hpp"
#include "scenes.hpp"
#include "statejump/stepper/partition.hpp"

namespace {

using namespace statejump;
using stepper::Scene;

void per_joint_and_step(benchmark::State& state, long joints, long steps) {
  state.counters["ns_per_joint_and_step"] = benchmark::Counter(
      static_cast<double>(joints * steps) * 1e-9,
      benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

long steps_for(long joints) {
  return std::max(100L, 200'000 / joints);
}

void bare_loop(benchmark::State& state) {
  const long joints = state.range(0), steps = steps_for(joints);
  stepper::bench::BareLoop loop(stepper::scenes::crowd(static_cast<std::size_t>(joints)),
                                stepper::scenes::physics(stepper::scenes::mass));
  for (auto _ : state) loop.run(steps);
  per_joint_and_step(state, joints, steps);
}

void step(benchmark::State& state, Scene scene, long joints) {
  const long steps = steps_for(joints);
  scene.prepare();
  stepper::Partition partition(scene);
  const Scene::CreatePhysics make = stepper::scenes::maker();
  for (auto _ : state) {
    if (partition.run(steps, make) != steps) state.SkipWithError("a step could not be made");
  }
  per_joint_and_step(state, joints, steps);
}

void crowd(benchmark::State& state) {
  step(state, stepper::scenes::crowd(static_cast<std::size_t>(state.range(0))), state.range(0));
}

// Contacts by a friction law by name that stick, after a ringing start.
void stuck(benchmark::State& state, const char* law_of_friction) {
  const long joints = state.range(0);
  Scene scene = stepper::scenes::crowd(static_cast<std::size_t>(joints));
  stepper::NamedLaw law;
  law.law.friction = kernel::laws::friction_law(law_of_friction);
  scene.law = law;
  scene.prepare();
  const Scene::CreatePhysics make = stepper::scenes::maker();
  if (scene.run(1500, make) != 1500) state.SkipWithError("a step could not be made");
  step(state, scene, joints);
}

void chain(benchmark::State& state) {
  step(state, stepper::scenes::chain(static_cast<std::size_t>(state.range(0))), state.range(0));
}

void rib(benchmark::State& state) {
  step(state, stepper::scenes::rib(), 1);
}

BENCHMARK(bare_loop)->Arg(1)->Arg(100)->Arg(10'000);
BENCHMARK(crowd)->Arg(1)->Arg(100)->Arg(10'000);
BENCHMARK_CAPTURE(stuck, mindlin, "mindlin")->Arg(1)->Arg(100)->Arg(10'000);
BENCHMARK_CAPTURE(stuck, mindlin_deresiewicz, "mindlin_deresiewicz")->Arg(1)->Arg(100)->Arg(10'000);
BENCHMARK(chain)->Arg(1'000);
BENCHMARK(rib);

}  // namespace
