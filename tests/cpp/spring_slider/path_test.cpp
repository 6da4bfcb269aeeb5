// SPDX-License-Identifier: GPL-3.0-or-later
#include "statejump/spring_slider/path.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <random>
#include <tuple>
#include <utility>

#include "statejump/spring_slider/history.hpp"
#include "table1.hpp"

namespace statejump::spring_slider {
namespace {

struct Expected {
  EventKind kind;
  Stage before;
  Stage after;
  double temperature_change;
};

void expect_events(const Path& path, const std::vector<Expected>& expected) {
  ASSERT_EQ(path.events.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) {
    const Event& event = path.events[i];
    EXPECT_STREQ(to_string(event.kind), to_string(expected[i].kind)) << i;
    EXPECT_STREQ(to_string(event.stage_before), to_string(expected[i].before)) << i;
    EXPECT_STREQ(to_string(event.stage_after), to_string(expected[i].after)) << i;
    EXPECT_NEAR(event.temperature_change, expected[i].temperature_change,
                close(expected[i].temperature_change))
        << i;
  }
}

// ΔT at slip: closed-form root of E A (α l0 ΔT − x) = s f l0 (1 + α ΔT).
double root(double x, double s) {
  return (EA * x + s * f * l0) / (alpha * l0 * (EA - s * f));
}

TEST(SpringSliderPath, Table1MeetsItsClosedForms) {
  const Path path = solve(table1(), cycle());
  const double zero = c / (alpha * l0);
  expect_events(path, {{EventKind::first_slip, Stage::S1, Stage::S2, root(0.0, 1)},
                       {EventKind::stop_reached, Stage::S2, Stage::at_stop_plus, root(c, 1)},
                       {EventKind::stop_unloaded, Stage::at_stop_plus, Stage::S3, root(c, 1)},
                       {EventKind::force_sign_change, Stage::S3, Stage::S4, zero},
                       {EventKind::stop_left, Stage::S4, Stage::S5, root(c, -1)},
                       {EventKind::cycle_end, Stage::S5, Stage::S5, 0.0}});
  EXPECT_NEAR(path.state_jump(), f * l0 / EA, close(f * l0 / EA));
  // Published digits.
  EXPECT_NEAR(path.events[0].temperature_change, 2.035099, 5e-7);
  EXPECT_NEAR(path.events[1].temperature_change, 87.509255, 5e-7);
  EXPECT_NEAR(path.events[4].temperature_change, 83.431111, 5e-7);
  EXPECT_NEAR(path.state_jump(), 2.380952e-5, 5e-12);
  EXPECT_EQ(path.events[1].displacement, c);
  EXPECT_EQ(path.events[4].displacement, c);
  EXPECT_NEAR(path.events[1].axial_force, f, close(f));
  EXPECT_NEAR(path.events[4].axial_force, -f, close(f));
}

TEST(SpringSliderPath, EventsStandAtTheTimeOfTheirTemperature) {
  for (const thermal::Shape shape :
       {thermal::Shape::triangle, thermal::Shape::half_sine, thermal::Shape::sine}) {
    const Path path = solve(table1(), cycle(shape, 3, 0.7));
    double before = 0.0;
    for (const Event& event : path.events) {
      EXPECT_NEAR(path.program.temperature_change(event.time), event.temperature_change, 1e-11);
      EXPECT_GE(event.time, before);
      before = event.time;
    }
  }
}

TEST(SpringSliderPath, WideClearanceRunsTheFiveStages) {
  const Path path = solve(table1(2e-3), cycle());
  // Position at the peak: x = x_T − f l_T/(E A). It stays constant while the force changes from f
  // to −f.
  const double peak = l0 * alpha * 100.0 - f * l0 * (1.0 + alpha * 100.0) / EA;
  expect_events(path, {{EventKind::first_slip, Stage::S1, Stage::S2, root(0.0, 1)},
                       {EventKind::reversal, Stage::S2, Stage::S3, 100.0},
                       {EventKind::force_sign_change, Stage::S3, Stage::S4, peak / (alpha * l0)},
                       {EventKind::slip, Stage::S4, Stage::S5, root(peak, -1)},
                       {EventKind::cycle_end, Stage::S5, Stage::S5, 0.0}});
  EXPECT_NEAR(path.events[1].displacement, peak, close(peak));
  EXPECT_NEAR(path.state_jump(), f * l0 / EA, close(f * l0 / EA));
}

TEST(SpringSliderPath, JumpDoesNotDependOnThePath) {
  const double jump = f * l0 / EA;
  for (const double clearance : {1e-4, 5e-4, 2e-3}) {
    for (const double peak : {30.0, 100.0, 350.0}) {
      thermal::Program program = cycle();
      program.temperature_change_max = peak;
      EXPECT_NEAR(solve(table1(clearance), program).state_jump(), jump, close(jump));
    }
  }
  thermal::Program cold = cycle();
  cold.temperature_change_max = -100.0;
  EXPECT_NEAR(solve(table1(), cold).state_jump(), -jump, close(jump));
}

TEST(SpringSliderPath, PreloadReducesTheJump) {
  SpringSlider model = table1();
  const double kp = 1e5;
  model.preload_stiffness = kp;
  const Path path = solve(model, cycle());
  const auto preloaded_root = [&](double x, double s) {
    const double g = s * f + kp * x;
    return (EA * x + g * l0) / (alpha * l0 * (EA - g));
  };
  // The preload k_p c = 100 N keeps the link compressed. Its force never changes sign, so stage S4
  // is missing.
  expect_events(path,
                {{EventKind::first_slip, Stage::S1, Stage::S2, root(0.0, 1)},
                 {EventKind::stop_reached, Stage::S2, Stage::at_stop_plus, preloaded_root(c, 1)},
                 {EventKind::stop_unloaded, Stage::at_stop_plus, Stage::S3, preloaded_root(c, 1)},
                 {EventKind::stop_left, Stage::S3, Stage::S5, preloaded_root(c, -1)},
                 {EventKind::cycle_end, Stage::S5, Stage::S5, 0.0}});
  const double jump = f / (EA / l0 + kp);
  EXPECT_NEAR(path.state_jump(), jump, close(jump));
}

TEST(SpringSliderPath, PreloadForceSeatsTheBlockOnAStop) {
  // P = k c + 3 f presses the block on the stop at −c with 3 f. Heating unloads the stop until only
  // friction f remains. The block leaves the stop when the link's push exceeds the spring's pull by
  // f.
  SpringSlider model = table1();
  model.preload_force = EA / l0 * c + 3.0 * f;
  const auto loaded_root = [&](double x, double s) {
    const double g = s * f + model.preload_force;
    return (EA * x + g * l0) / (alpha * l0 * (EA - g));
  };
  const double hot = 150.0;
  const double peak = l0 * alpha * hot - (f + model.preload_force) * l0 * (1.0 + alpha * hot) / EA;
  thermal::Program program = cycle();
  program.temperature_change_max = hot;
  const Path path = solve(model, program);
  expect_events(path,
                {{EventKind::stop_unloaded, Stage::at_stop_minus, Stage::S1, loaded_root(-c, -1)},
                 {EventKind::first_slip, Stage::S1, Stage::S2, loaded_root(-c, 1)},
                 {EventKind::reversal, Stage::S2, Stage::S3, hot},
                 {EventKind::slip, Stage::S3, Stage::S5, loaded_root(peak, -1)},
                 {EventKind::stop_reached, Stage::S5, Stage::at_stop_minus, loaded_root(-c, -1)},
                 {EventKind::cycle_end, Stage::at_stop_minus, Stage::at_stop_minus, 0.0}});
  EXPECT_EQ(path.segments.front().start_displacement, -c);
  EXPECT_EQ(path.state_jump(), 0.0);
}

TEST(SpringSliderPath, StartsStuckOrWithoutFriction) {
  // With k_p and a preload force P < f, the block starts stuck with friction D = −P. After slipping
  // back, D = −f.
  SpringSlider model = table1();
  model.preload_stiffness = 1e5;
  model.preload_force = 2.0 / 3.0 * f;
  const double stiffness = EA / l0 + model.preload_stiffness;
  const Path stuck = solve(model, cycle());
  EXPECT_EQ(stuck.segments.front().start_displacement, 0.0);
  EXPECT_NEAR(stuck.state_jump(), (f - model.preload_force) / stiffness, close(c));
  EXPECT_NEAR(state_jump(model), stuck.state_jump(), close(c));
  model.start_friction = StartFriction::frictionless;
  const Path settled = solve(model, cycle());
  EXPECT_NEAR(settled.segments.front().start_displacement, -model.preload_force / stiffness,
              close(c));
  EXPECT_NEAR(settled.state_jump(), f / stiffness, close(c));
  EXPECT_EQ(state_jump(model), f / stiffness);
  // If P > f, the block slides until friction stops it. After the cycle it returns to that
  // position.
  model.start_friction = StartFriction::stuck;
  model.preload_force = 3.0 * f;
  const Path slid = solve(model, cycle());
  EXPECT_NEAR(slid.segments.front().start_displacement, -2.0 * f / stiffness, close(c));
  EXPECT_NEAR(slid.state_jump(), 0.0, close(c));
  // A force P in the opposite direction starts the block at the opposite limit. The two limits
  // differ by 2 f.
  model.preload_force = -3.0 * f;
  EXPECT_NEAR(solve(model, cycle()).state_jump(), 2.0 * f / stiffness, close(c));
  EXPECT_NEAR(state_jump(model), 2.0 * f / stiffness, close(c));
}

TEST(SpringSliderPath, WithoutFrictionAtTheStartAPreloadForceDoesNotChangeTheJump) {
  SpringSlider model = table1();
  model.start_friction = StartFriction::frictionless;
  model.preload_force = 0.5 * EA / l0 * c;
  const Path free = solve(model, cycle());
  EXPECT_NEAR(free.segments.front().start_displacement, -0.5 * c, close(c));
  EXPECT_NEAR(free.state_jump(), f * l0 / EA, close(c));
}

TEST(SpringSliderPath, WithoutFrictionNothingRemains) {
  SpringSlider model = table1();
  model.friction_force = 0.0;
  for (int i = 0; i < 40; ++i) {
    model.preload_stiffness = 1e4 * i;
    model.clearance_plus = model.clearance_minus = 1e-4 * (1 + i);
    for (const thermal::Shape shape : {thermal::Shape::half_sine, thermal::Shape::sine}) {
      thermal::Program program = cycle(shape, 2);
      program.temperature_change_max = 100.0 + 0.7 * i;
      const Path path = solve(model, program);
      EXPECT_EQ(path.state_jump(), 0.0);
      for (const Segment& segment : path.segments) {
        EXPECT_NE(segment.motion, BlockMotion::stick);  // no spurious stick segment from rounding
        EXPECT_EQ(segment.friction_dissipation, 0.0);
      }
    }
  }
}

TEST(SpringSliderPath, BelowTheFirstSlipNothingMoves) {
  thermal::Program program = cycle(thermal::Shape::sine, 2);
  program.temperature_change_max = 2.0;
  const Path path = solve(table1(), program);
  EXPECT_EQ(path.state_jump(), 0.0);
  for (const Segment& segment : path.segments) EXPECT_EQ(segment.stage, Stage::S1);
  for (const Event& event : path.events) EXPECT_EQ(event.kind, EventKind::cycle_end);
}

TEST(SpringSliderPath, TenCyclesRepeatBitForBit) {
  for (const thermal::Shape shape :
       {thermal::Shape::triangle, thermal::Shape::half_sine, thermal::Shape::sine}) {
    const Path path = solve(table1(), cycle(shape, 10));
    std::vector<std::vector<Segment>> by_cycle(10);
    for (const Segment& segment : path.segments) {
      by_cycle[static_cast<std::size_t>(segment.cycle)].push_back(segment);
    }
    for (std::size_t k = 2; k < 10; ++k) {
      ASSERT_EQ(by_cycle[k].size(), by_cycle[1].size());
      for (std::size_t i = 0; i < by_cycle[k].size(); ++i) {
        EXPECT_EQ(by_cycle[k][i].stage, by_cycle[1][i].stage);
        EXPECT_EQ(by_cycle[k][i].end_temperature_change, by_cycle[1][i].end_temperature_change);
        EXPECT_EQ(by_cycle[k][i].end_displacement, by_cycle[1][i].end_displacement);
      }
      EXPECT_EQ(path.jump_after_cycle(static_cast<int>(k) + 1), path.jump_after_cycle(2));
    }
    EXPECT_EQ(path.jump_after_cycle(1), path.jump_after_cycle(2));
    EXPECT_NE(refusal([&path] { path.jump_after_cycle(0); }), "");
    EXPECT_NE(refusal([&path] { path.jump_after_cycle(11); }), "");
  }
}

TEST(SpringSliderPath, DirectionsAreThoseOfSlideAndStop) {
  for (const Segment& segment : solve(table1(), cycle(thermal::Shape::sine, 2)).segments) {
    const double moved = segment.end_displacement - segment.start_displacement;
    int expected = 0;
    if (segment.motion == BlockMotion::slide) expected = moved > 0.0 ? 1 : -1;
    if (segment.motion == BlockMotion::stop) expected = segment.start_displacement > 0.0 ? 1 : -1;
    EXPECT_EQ(segment.direction, expected) << to_string(segment.stage);
  }
}

TEST(SpringSliderPath, SineVisitsBothStops) {
  const Path path = solve(table1(), cycle(thermal::Shape::sine));
  const double zero = c / (alpha * l0);
  expect_events(path, {{EventKind::first_slip, Stage::S1, Stage::S2, root(0.0, 1)},
                       {EventKind::stop_reached, Stage::S2, Stage::at_stop_plus, root(c, 1)},
                       {EventKind::stop_unloaded, Stage::at_stop_plus, Stage::S3, root(c, 1)},
                       {EventKind::force_sign_change, Stage::S3, Stage::S4, zero},
                       {EventKind::stop_left, Stage::S4, Stage::S5, root(c, -1)},
                       {EventKind::stop_reached, Stage::S5, Stage::at_stop_minus, root(-c, -1)},
                       {EventKind::stop_unloaded, Stage::at_stop_minus, Stage::S3, root(-c, -1)},
                       {EventKind::force_sign_change, Stage::S3, Stage::S4, -zero},
                       {EventKind::stop_left, Stage::S4, Stage::S2, root(-c, 1)},
                       {EventKind::cycle_end, Stage::S2, Stage::S2, 0.0}});
  EXPECT_NEAR(path.state_jump(), -f * l0 / EA, close(f * l0 / EA));
}

TEST(SpringSliderPath, TableOfATriangleIsTheTriangle) {
  // A table with many collinear points: events must not depend on the subdivision.
  const thermal::Program points =
      table({0.0, 0.1, 0.25, 0.5, 0.6, 0.9, 1.0}, {0.0, 20.0, 50.0, 100.0, 80.0, 20.0, 0.0});
  const Path expected = solve(table1(), cycle(thermal::Shape::triangle));
  const Path path = solve(table1(), points);
  ASSERT_EQ(path.events.size(), expected.events.size());
  for (std::size_t i = 0; i < path.events.size(); ++i) {
    EXPECT_EQ(path.events[i].kind, expected.events[i].kind);
    EXPECT_EQ(path.events[i].temperature_change, expected.events[i].temperature_change);
    EXPECT_NEAR(path.events[i].time, expected.events[i].time, 1e-15);
    EXPECT_EQ(path.events[i].displacement, expected.events[i].displacement);
  }
  EXPECT_EQ(path.segments.size(), expected.segments.size());
}

TEST(SpringSliderPath, ReloadingAStopAndHoldingKeepTheState) {
  // The block is pressed against the stop, unloaded without separation, pressed again, held, then
  // moved back.
  const thermal::Program points =
      table({0.0, 1.0, 2.0, 3.0, 4.0, 5.0}, {0.0, 95.0, 84.0, 95.0, 95.0, 0.0});
  const Path path = solve(table1(), points);
  std::vector<EventKind> kinds;
  for (const Event& event : path.events) kinds.push_back(event.kind);
  const std::vector<EventKind> expected{EventKind::first_slip,        EventKind::stop_reached,
                                        EventKind::stop_unloaded,     EventKind::force_sign_change,
                                        EventKind::force_sign_change, EventKind::stop_reached,
                                        EventKind::stop_unloaded,     EventKind::force_sign_change,
                                        EventKind::stop_left,         EventKind::cycle_end};
  EXPECT_EQ(kinds, expected);
  EXPECT_NEAR(path.state_jump(), f * l0 / EA, close(f * l0 / EA));
}

TEST(SpringSliderPath, ReusedPathEqualsAFreshOne) {
  Path path = solve(table1(2e-3), cycle(thermal::Shape::sine, 4));
  solve(table1(), cycle(), path);
  const Path fresh = solve(table1(), cycle());
  EXPECT_EQ(path.segments.size(), fresh.segments.size());
  EXPECT_EQ(path.events.size(), fresh.events.size());
  EXPECT_EQ(path.cycle_end_displacements, fresh.cycle_end_displacements);
}

TEST(SpringSliderPath, CyclesThatAreLeftOutAreComputed) {
  SpringSlider preloaded = table1(2e-3);
  preloaded.preload_stiffness = 3e5;
  for (const SpringSlider& model : {table1(), preloaded}) {
    const thermal::Program program = cycle(thermal::Shape::sine, 300, 0.7);
    const Path whole = solve(model, program);
    const Eigen::Vector4d times(0.3, 100.05, 100.0, 300.0 * 0.7);
    const Path path = solve(model, program, times);
    EXPECT_EQ(path.cycle_end_displacements, whole.cycle_end_displacements);
    EXPECT_EQ(path.largest_axial_force, whole.largest_axial_force);
    EXPECT_EQ(exceeded_euler_load(path), exceeded_euler_load(whole));
    const History some = sample(path, times);
    const History all = sample(whole, times);
    EXPECT_EQ(some.displacement, all.displacement);
    EXPECT_EQ(some.thermal_work, all.thermal_work);
    EXPECT_EQ(some.stage, all.stage);
    // The path stores seven of 300 cycles: the first two, 142 with its neighbours, and the last
    // two. Each equals that of the complete path.
    std::vector<int> kept;
    std::size_t at = 0;
    for (const Segment& segment : path.segments) {
      if (kept.empty() || kept.back() != segment.cycle) kept.push_back(segment.cycle);
      while (whole.segments[at].start_time != segment.start_time) ++at;
      EXPECT_EQ(segment.end_displacement, whole.segments[at].end_displacement);
      EXPECT_EQ(segment.thermal_work, whole.segments[at].thermal_work);
    }
    EXPECT_EQ(kept, (std::vector<int>{0, 1, 141, 142, 143, 298, 299}));
    EXPECT_NE(refusal([&path] { sample(path, Eigen::VectorXd::Constant(1, 50.0)); }), "");
    EXPECT_NE(refusal([&] { solve(model, program, Eigen::VectorXd::Constant(1, -1.0)); }), "");
    SpringSlider none = model;
    none.young_modulus = -1.0;
    EXPECT_NE(refusal([&] { solve(none, program, times); }), "");
    thermal::Program endless = program;
    endless.cycles = 0;
    EXPECT_NE(refusal([&] { solve(model, endless, times); }), "");
  }
}

TEST(SpringSliderPath, MemoryOfALongProgramIsThatOfTheTimes) {
  // The path stores equally many segments for any number of cycles, plus one end displacement per
  // cycle.
  const auto kept = [](int cycles) {
    const thermal::Program program = cycle(thermal::Shape::sine, cycles);
    const Eigen::Vector2d ends(0.0, program.duration());
    const Path path = solve(table1(), program, ends);
    EXPECT_EQ(path.cycle_end_displacements.size(), static_cast<std::size_t>(cycles));
    return std::array{path.segments.capacity(), path.events.capacity(), path.segments.size(),
                      path.events.size()};
  };
  EXPECT_EQ(kept(100), kept(2000));
}

TEST(SpringSliderPath, LargestForceIsThatOfAFineHistory) {
  SpringSlider preloaded = table1();
  preloaded.preload_stiffness = 3e5;
  for (const SpringSlider& model : {table1(), table1(2e-3), preloaded}) {
    for (const thermal::Shape shape : {thermal::Shape::triangle, thermal::Shape::sine}) {
      const Path path = solve(model, cycle(shape, 2));
      // 4000 samples per cycle include the crests of both shapes, where the force is largest during
      // stick and at stops. During slip it is largest at an event between two samples, up to 0.1 K
      // and 2 k c α away.
      const History h = sample(path, Eigen::VectorXd::LinSpaced(8001, 0.0, 2.0));
      const double sampled = h.axial_force.cwiseAbs().maxCoeff();
      EXPECT_LE(sampled, path.largest_axial_force + close(sampled));
      const double step = EA / l0 * alpha * l0 * 100.0 * 2.0 * 3.15 / 4000.0;
      EXPECT_GE(sampled, path.largest_axial_force - step);
    }
  }
}

/// Return mapping in steps of ΔT, as in finite-element codes. It shares no formula with solve(). At
/// fixed ΔT the problem is linear in x, so one correction is exact.
double return_mapping(const SpringSlider& model, double change, double x) {
  const double length = model.stress_free_length * (1.0 + model.thermal_expansion * change);
  const double stiffness = model.young_modulus * model.cross_section_area / length;
  const double trial = stiffness * (length - model.stress_free_length - x) - model.preload_force -
                       model.preload_stiffness * x;
  const double excess = std::abs(trial) - model.friction_force;
  if (excess > 0.0) x += std::copysign(excess, trial) / (stiffness + model.preload_stiffness);
  return std::min(std::max(x, -model.clearance_minus), model.clearance_plus);
}

/// Random numbers, the same in every run.
class Uniform {
 public:
  explicit Uniform(std::uint64_t seed) : random_(seed) {}
  double operator()(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random_);
  }

 private:
  std::mt19937_64 random_;
};

/// Times and temperature changes of a table with five random values and two plateaus.
std::pair<std::vector<double>, std::vector<double>> seven_changes(Uniform& uniform) {
  std::vector<double> times{0.0};
  std::vector<double> changes{0.0};
  for (int i = 1; i < 8; ++i) {
    times.push_back(i);
    changes.push_back(i % 4 == 3 ? changes.back() : uniform(-150.0, 150.0));
  }
  return {times, changes};
}

TEST(SpringSliderPath, EqualsSmallStepsForRandomModels) {
  Uniform uniform(20210211);
  for (int run = 0; run < 200; ++run) {
    SpringSlider model = table1();
    model.thermal_expansion = uniform(-3e-5, 3e-5);
    model.friction_force = run % 10 == 0 ? 0.0 : uniform(1.0, 200.0);
    model.clearance_plus = uniform(1e-4, 2e-3);
    model.clearance_minus = uniform(1e-4, 2e-3);
    model.preload_stiffness = run % 2 == 0 ? 0.0 : uniform(0.0, 2e6);
    // Preload forces up to the one that always keeps the block at a stop: 2 mm times 1.26e6 N/m.
    model.preload_force = run % 3 == 0 ? 0.0 : uniform(-3e3, 3e3);
    if (run % 4 < 2) model.start_friction = StartFriction::frictionless;
    const auto [times, changes] = seven_changes(uniform);
    const Path path = solve(model, table(times, changes));
    // Every reversal of the program is a step. Between them the mapping clamps x to monotone
    // bounds, so its result does not depend on the steps. Only rounding of l_T − l0 remains, an ulp
    // of 0.5 m in every step that slides.
    const int steps = 400;
    const double tolerance = 7 * steps * 2e-16;
    // The block starts in the middle or, without friction, in the equilibrium of the springs.
    SpringSlider before = model;
    if (model.start_friction == StartFriction::frictionless) before.friction_force = 0.0;
    double x = return_mapping(before, 0.0, 0.0);
    std::size_t at = 0;
    for (std::size_t i = 1; i < times.size(); ++i) {
      for (int step = 1; step <= steps; ++step) {
        const double part = static_cast<double>(step) / steps;
        const double change = changes[i - 1] + part * (changes[i] - changes[i - 1]);
        x = return_mapping(model, change, x);
        const double time = times[i - 1] + part;
        while (at + 1 < path.segments.size() && path.segments[at].end_time < time) ++at;
        ASSERT_NEAR(displacement(model, path.segments[at], change), x, tolerance)
            << "run " << run << " time " << time;
      }
    }
  }
}

TEST(SpringSliderPath, PlayOpensAtEveryReversal) {
  SpringSlider model = table1();
  const double w = 2e-4;
  model.play = w;
  const Path path = solve(model, cycle());
  // Without friction the link is unloaded: x = α l0 ΔT.
  const auto free = [](double x) { return x / (alpha * l0); };
  expect_events(path, {{EventKind::play_closed, Stage::in_play, Stage::S1, free(0.5 * w)},
                       {EventKind::first_slip, Stage::S1, Stage::S2, root(0.5 * w, 1)},
                       {EventKind::stop_reached, Stage::S2, Stage::at_stop_plus, root(c, 1)},
                       {EventKind::stop_unloaded, Stage::at_stop_plus, Stage::S3, root(c, 1)},
                       {EventKind::stop_left, Stage::S3, Stage::in_play, free(c)},
                       {EventKind::play_closed, Stage::in_play, Stage::S4, free(c - w)},
                       {EventKind::slip, Stage::S4, Stage::S5, root(c - w, -1)},
                       {EventKind::cycle_end, Stage::S5, Stage::S5, 0.0}});
  EXPECT_NEAR(path.state_jump(), f * l0 / EA, close(f * l0 / EA));
  EXPECT_EQ(path.segments.front().motion, BlockMotion::play);
}

TEST(SpringSliderPath, PlayWiderThanTheClearanceLeavesTheStopsFree) {
  SpringSlider model = table1();
  model.play = 3.0 * c;
  const Path path = solve(model, cycle());
  expect_events(path,
                {{EventKind::stop_reached, Stage::in_play, Stage::at_stop_plus, c / (alpha * l0)},
                 {EventKind::stop_unloaded, Stage::at_stop_plus, Stage::in_play, c / (alpha * l0)},
                 {EventKind::stop_left, Stage::in_play, Stage::in_play, c / (alpha * l0)},
                 {EventKind::cycle_end, Stage::in_play, Stage::in_play, 0.0}});
  EXPECT_NEAR(path.state_jump(), 0.0, 1e-18);
}

namespace {

/// State of a block with play after one step. Its position x follows from the middle of the play:
/// it is the position without friction if this lies within the play, otherwise an end of the play.
struct Played {
  double x;
  double middle;
};

Played moved_in_play(const SpringSlider& model, double change, double middle) {
  const double k = EA / (l0 * (1.0 + model.thermal_expansion * change));
  const double grown = model.thermal_expansion * l0 * change;
  const double soft = std::isinf(model.stop_stiffness) ? 0.0 : model.stop_stiffness;
  // Position at which friction carries the force `level`. It decreases as `level` grows.
  const auto at_load = [&](double level) {
    const double stiffness = k + model.preload_stiffness;
    const double x = (k * grown - model.preload_force - level) / stiffness;
    if (soft == 0.0) return std::clamp(x, -model.clearance_minus, model.clearance_plus);
    const double inside = std::clamp(x, -model.clearance_minus, model.clearance_plus);
    return inside + (x - inside) * stiffness / (stiffness + soft);
  };
  for (const int side : {1, -1}) {
    const double end = middle + 0.5 * side * model.play;
    if (side * (at_load(0.0) - end) <= 0.0) continue;
    const double slid = at_load(side * model.friction_force);
    if (side * (slid - end) <= 0.0) return {end, middle};
    return {slid, slid - 0.5 * side * model.play};
  }
  return {at_load(0.0), middle};
}

}  // namespace

TEST(SpringSliderPath, PlayEqualsSmallStepsForRandomModels) {
  Uniform uniform(20261127);
  for (int run = 0; run < 200; ++run) {
    SpringSlider model = table1();
    model.thermal_expansion = uniform(-3e-5, 3e-5);
    model.friction_force = uniform(1.0, 200.0);
    model.play = std::exp(uniform(std::log(1e-6), std::log(4e-3)));
    model.clearance_plus = uniform(1e-4, 2e-3);
    model.clearance_minus = uniform(1e-4, 2e-3);
    model.preload_stiffness = run % 2 == 0 ? 0.0 : uniform(0.0, 2e6);
    model.preload_force = run % 3 == 0 ? 0.0 : uniform(-3e3, 3e3);
    if (run % 5 < 2) model.stop_stiffness = uniform(1e4, 1e7);
    if (run % 4 < 2) model.start_friction = StartFriction::frictionless;
    const auto [times, changes] = seven_changes(uniform);
    const Path path = solve(model, table(times, changes));
    // The tolerance is twice that without play, because errors of x and of the middle of the play
    // accumulate.
    const int steps = 400;
    const double tolerance = 2 * 7 * steps * 2e-16;
    Played at = moved_in_play(model, 0.0, 0.0);
    if (model.start_friction == StartFriction::frictionless) {
      SpringSlider loose = model;
      loose.play = 100.0;
      at.x = at.middle = moved_in_play(loose, 0.0, 0.0).x;
    }
    EXPECT_NEAR(start_displacement(model), at.x, tolerance) << run;
    std::size_t segment = 0;
    for (std::size_t i = 1; i < times.size(); ++i) {
      for (int step = 1; step <= steps; ++step) {
        const double part = static_cast<double>(step) / steps;
        const double change = changes[i - 1] + part * (changes[i] - changes[i - 1]);
        at = moved_in_play(model, change, at.middle);
        const double time = times[i - 1] + part;
        while (segment + 1 < path.segments.size() && path.segments[segment].end_time < time) {
          ++segment;
        }
        ASSERT_NEAR(displacement(model, path.segments[segment], change), at.x, tolerance)
            << "run " << run << " time " << time;
      }
    }
    // Energy balance; works are accurate to 1e-15 of their size.
    const Eigen::VectorXd all = Eigen::VectorXd::LinSpaced(701, 0.0, 7.0);
    const History history = sample(path, all);
    const Eigen::ArrayXd stored = history.elastic_energy + history.preload_energy;
    const Eigen::ArrayXd left =
        history.thermal_work.array() - (stored - stored[0]) - history.friction_dissipation.array();
    const double largest = stored.abs().maxCoeff() + history.thermal_work.cwiseAbs().maxCoeff() +
                           history.friction_dissipation.maxCoeff();
    EXPECT_LE(left.abs().maxCoeff(), 1e-12 * largest) << run;
  }
}

TEST(SpringSliderPath, WarnsBeyondTheEulerLoad) {
  const std::optional<EulerLoadExceeded> loaded = exceeded_euler_load(solve(table1(), cycle()));
  ASSERT_TRUE(loaded);
  EXPECT_NEAR(loaded->axial_force, 213.7, 0.05);
  EXPECT_NEAR(loaded->clamped, 74.61, 0.005);
  EXPECT_NEAR(loaded->pinned, 74.61 / 4, 0.005);
  const std::optional<EulerLoadExceeded> free = exceeded_euler_load(solve(table1(2e-3), cycle()));
  ASSERT_TRUE(free);  // 30 N lie between the two Euler loads
  EXPECT_TRUE(free->pinned < free->axial_force && free->axial_force < free->clamped);
  SpringSlider slippery = table1(2e-3);
  slippery.friction_force = 10.0;
  EXPECT_FALSE(exceeded_euler_load(solve(slippery, cycle())));
}

TEST(SpringSliderPath, RefusesALinkOfNegativeLength) {
  SpringSlider model = table1();
  model.thermal_expansion = -0.02;
  EXPECT_NE(refusal([&model] { solve(model, cycle()); }), "");
}

TEST(SpringSliderPath, RefusesModelsAndProgramsOutOfRange) {
  SpringSlider soft = table1();
  soft.cross_section_area = -soft.cross_section_area;
  thermal::Program endless = cycle();
  endless.period = 0.0;
  for (const auto& [model, program, field] :
       {std::tuple{soft, cycle(), "cross_section_area"}, std::tuple{table1(), endless, "period"}}) {
    const auto all = [&m = model, &p = program] { solve(m, p); };
    const auto some = [&m = model, &p = program] { solve(m, p, Eigen::VectorXd::Zero(1)); };
    EXPECT_NE(refusal(all).find(field), std::string::npos) << refusal(all);
    EXPECT_NE(refusal(some).find(field), std::string::npos) << refusal(some);
  }
}

}  // namespace
}  // namespace statejump::spring_slider
