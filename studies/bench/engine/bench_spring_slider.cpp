// SPDX-License-Identifier: GPL-3.0-or-later
#include <benchmark/benchmark.h>

#include "statejump/spring_slider/history.hpp"

namespace {

using namespace statejump;
using namespace statejump::spring_slider;

SpringSlider table1() {
  SpringSlider model;
  model.young_modulus = 70e9;
  model.cross_section_area = 9e-6;
  model.stress_free_length = 0.5;
  model.thermal_expansion = 23.4e-6;
  model.friction_force = 30.0;
  model.clearance_minus = 1e-3;
  model.clearance_plus = 1e-3;
  return model;
}

thermal::Program program(thermal::Shape shape, int cycles) {
  thermal::Program result;
  result.shape = shape;
  result.temperature_change_max = 100.0;
  result.cycles = cycles;
  return result;
}

/// Solves one full cycle of Table 1 with all events, into a new Path each time.
void solve_fresh(benchmark::State& state) {
  const SpringSlider model = table1();
  const auto cycle = program(thermal::Shape::half_sine, 1);
  for (auto _ : state) {
    const Path path = solve(model, cycle);
    benchmark::DoNotOptimize(path.events.data());
  }
}
BENCHMARK(solve_fresh);

/// The same, reusing one Path, as a campaign does.
void solve_reused(benchmark::State& state) {
  const SpringSlider model = table1();
  const auto cycle = program(thermal::Shape::half_sine, 1);
  Path path;
  for (auto _ : state) {
    solve(model, cycle, path);
    benchmark::DoNotOptimize(path.events.data());
  }
}
BENCHMARK(solve_reused);

/// Sine with both stops; time per call, of `range` cycles.
void solve_cycles(benchmark::State& state) {
  const SpringSlider model = table1();
  const auto cycles = program(thermal::Shape::sine, static_cast<int>(state.range(0)));
  Path path;
  for (auto _ : state) {
    solve(model, cycles, path);
    benchmark::DoNotOptimize(path.events.data());
  }
  state.SetItemsProcessed(state.iterations() * state.range(0));
}
BENCHMARK(solve_cycles)->Arg(1)->Arg(10)->Arg(1000);

/// Samples of one cycle; items are samples.
void sample_cycle(benchmark::State& state) {
  const Path path = solve(table1(), program(thermal::Shape::half_sine, 1));
  const Eigen::VectorXd times = Eigen::VectorXd::LinSpaced(state.range(0), 0.0, 1.0);
  for (auto _ : state) {
    const History history = sample(path, times);
    benchmark::DoNotOptimize(history.displacement.data());
  }
  state.SetItemsProcessed(state.iterations() * state.range(0));
}
BENCHMARK(sample_cycle)->Arg(1000);

}  // namespace
