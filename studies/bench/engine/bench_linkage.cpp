// SPDX-License-Identifier: GPL-3.0-or-later
// Rib of the umbrella antenna: 100 000 steps of the frictionless case, compared with a bare loop of
// the same arithmetic; cost of friction and of the adaptive method.
#include <benchmark/benchmark.h>

#include <string>

#include "bare_linkage.hpp"
#include "statejump/linkage/run.hpp"

namespace {

using namespace statejump;

constexpr int steps = 100000;

linkage::Linkage rib(const std::string& friction = "none") {
  linkage::Linkage model;
  model.frame_length = 0.12;
  model.link_ab = {0.050, 0.5, 70e9, 9e-6, 23.75e-6, 0.3};
  model.link_bc = {0.100, 1.0, 70e9, 9e-6, 23.75e-6, 0.3};
  model.journal_radius = 5e-3;
  model.bearing_radius = 5.1e-3;
  model.law.friction = kernel::laws::friction_law(friction);
  model.law.friction_parameters = {0.3, 1e-5, 1e-4};
  return model;
}

thermal::Program cycle() {
  thermal::Program program;
  program.shape = thermal::Shape::triangle;
  program.temperature_change_max = 100.0;
  program.period = 1.0;
  return program;
}

void per_step(benchmark::State& state, long taken) {
  state.counters["ns_per_step"] = benchmark::Counter(
      static_cast<double>(taken) * 1e-9,
      benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

void bare_loop(benchmark::State& state) {
  const linkage::Linkage model = rib();
  const linkage::State start = initial_state(model, linkage::Start::rest, 0.0);
  for (auto _ : state)
    benchmark::DoNotOptimize(linkage::bench::bare_run(model, start, 100.0, 1.0, steps));
  per_step(state, steps);
}
BENCHMARK(bare_loop)->Unit(benchmark::kMillisecond);

void engine(benchmark::State& state, const char* friction) {
  const linkage::Linkage model = rib(friction);
  const linkage::State start = initial_state(model, linkage::Start::rest, 0.0);
  const thermal::Program program = cycle();
  for (auto _ : state) benchmark::DoNotOptimize(simulate(model, program, start, {steps, 0}));
  per_step(state, steps);
}
BENCHMARK_CAPTURE(engine, frictionless, "none")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(engine, ambrosio, "ambrosio")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(engine, mindlin, "mindlin")->Unit(benchmark::kMillisecond);

void adaptive(benchmark::State& state) {
  const linkage::Linkage model = rib();
  const linkage::State start = initial_state(model, linkage::Start::rest, 0.0);
  const thermal::Program program = cycle();
  for (auto _ : state) {
    benchmark::DoNotOptimize(simulate_adaptive(model, program, start, {1e-8, 0}));
  }
}
BENCHMARK(adaptive)->Unit(benchmark::kMillisecond);

}  // namespace
