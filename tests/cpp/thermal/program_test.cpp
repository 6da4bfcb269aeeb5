// SPDX-License-Identifier: GPL-3.0-or-later
#include "statejump/thermal/program.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <numbers>

#include "support/argument.hpp"
#include "support/expect.hpp"
#include "thermal/programs.hpp"

namespace statejump::thermal {
namespace {

using testing::Argument;
using testing::close;
using testing::no_argument;
using testing::refused_argument;

constexpr Shape analytic_shapes[] = {Shape::triangle, Shape::half_sine, Shape::sine};

TEST(Program, FollowsItsFormulaInEveryCycle) {
  const Program triangle = cycle(Shape::triangle, 3, 0.7);
  const Program half_sine = cycle(Shape::half_sine, 3, 0.7);
  const Program sine = cycle(Shape::sine, 3, 0.7);
  for (int k = 0; k < 3; ++k) {
    for (double phase = 0.01; phase < 1.0; phase += 0.07) {
      const double t = (k + phase) * 0.7;
      const double pi = std::numbers::pi;
      // Allowed: rounding of t, a few ulps of 3 cycles, times the steepest slope of the program.
      EXPECT_NEAR(triangle.temperature_change(t), 100.0 * (1.0 - std::abs(2.0 * phase - 1.0)),
                  1e-12);
      EXPECT_NEAR(half_sine.temperature_change(t), 100.0 * std::sin(pi * phase), 1e-12);
      EXPECT_NEAR(sine.temperature_change(t), 100.0 * std::sin(2.0 * pi * phase), 2e-12);
    }
  }
}

TEST(Program, ReturnsToExactlyZeroAfterEveryCycle) {
  for (const Shape shape : analytic_shapes) {
    for (const double period : {1.0, 0.1, 0.7, 5400.0 / 7.0}) {
      const Program program = cycle(shape, 1000, period);
      for (int k = 0; k <= 1000; ++k) {
        ASSERT_EQ(program.temperature_change(k * period), 0.0) << to_string(shape) << k;
      }
      EXPECT_EQ(program.temperature_change(1001.5 * period), 0.0);
      EXPECT_EQ(program.temperature_change(-period), 0.0);
    }
  }
}

TEST(Program, TellsTheCyclesApartOnEitherSideOfTheirEnd) {
  // For some of these times, t/period is rounded across the end of a cycle. A wrong cycle would
  // give a temperature change below the start or the rate of the wrong flank.
  for (const double period : {0.1, 0.7, 1.1, 5400.0 / 7.0, 1.0 / 49.0, 93.3}) {
    const Program triangle = cycle(Shape::triangle, 5000, period);
    const Program half_sine = cycle(Shape::half_sine, 5000, period);
    for (int k = 1; k < 5000; ++k) {
      const double end = k * period;
      const double before = std::nextafter(end, 0.0);
      ASSERT_GT(half_sine.temperature_change(before), 0.0) << period << " " << k;
      ASSERT_GT(triangle.temperature_change(before), 0.0) << period << " " << k;
      ASSERT_LT(triangle.temperature_rate(before), 0.0) << period << " " << k;
      ASSERT_GT(triangle.temperature_rate(end), 0.0) << period << " " << k;
      ASSERT_EQ(triangle.temperature_change(end), 0.0) << period << " " << k;
    }
  }
}

TEST(Program, ReachesItsMaximumExactly) {
  EXPECT_EQ(cycle(Shape::triangle).temperature_change(0.5), 100.0);
  EXPECT_EQ(cycle(Shape::half_sine).temperature_change(0.5), 100.0);
  EXPECT_EQ(cycle(Shape::sine).temperature_change(0.25), 100.0);
  EXPECT_EQ(cycle(Shape::sine).temperature_change(0.5), 0.0);
  EXPECT_EQ(cycle(Shape::sine).temperature_change(0.75), -100.0);
}

TEST(Program, RateIsTheSlopeOfTheChange) {
  const Program points = table({0.0, 0.3, 0.5, 1.0}, {0.0, 40.0, 40.0, -10.0});
  // Central differences: error h² dddT/6 <= 1e-10·100(2π)³/6 plus rounding 1e-14/h.
  const double h = 1e-5;
  for (const Program& program : {cycle(Shape::triangle), cycle(), cycle(Shape::sine), points}) {
    for (double t = 0.011; t < 1.0; t += 0.03) {
      const double slope =
          (program.temperature_change(t + h) - program.temperature_change(t - h)) / (2.0 * h);
      EXPECT_NEAR(program.temperature_rate(t), slope, 1e-6) << to_string(program.shape) << t;
    }
    EXPECT_EQ(program.temperature_rate(-0.1), 0.0);
    EXPECT_EQ(program.temperature_rate(1.0), 0.0);
  }
}

TEST(Program, TableHoldsItsLastValue) {
  const Program points = table({0.0, 1.0, 3.0}, {0.0, 40.0, 10.0});
  EXPECT_EQ(points.temperature_change(1.0), 40.0);
  EXPECT_EQ(points.temperature_change(2.0), 25.0);
  EXPECT_EQ(points.temperature_change(3.0), 10.0);
  EXPECT_EQ(points.temperature_change(7.0), 10.0);
}

TEST(Program, BranchesJoinAndInvert) {
  const Program points = table({0.0, 0.3, 0.5, 1.0}, {0.0, 40.0, 40.0, 0.0});
  for (const Program& program : {cycle(Shape::triangle, 3, 0.7), cycle(Shape::half_sine, 3, 0.7),
                                 cycle(Shape::sine, 3, 0.7), points}) {
    double time = 0.0;
    double change = 0.0;
    for (const thermal::Branch& branch : monotone_branches(program)) {
      EXPECT_EQ(branch.start_time, time);
      EXPECT_EQ(branch.start, change);
      EXPECT_EQ(time_at(branch, branch.start), branch.start_time);
      for (double part = 0.02; part < 1.0; part += 0.06) {
        const double wanted = branch.start + part * (branch.end - branch.start);
        const double at = time_at(branch, wanted);
        EXPECT_GE(at, branch.start_time);
        EXPECT_LE(at, branch.end_time);
        // Allowed: dT/dt <= 900 K/s times the rounding of t.
        EXPECT_NEAR(program.temperature_change(at), wanted, 1e-12);
      }
      if (branch.end != branch.start) {
        EXPECT_EQ(time_at(branch, branch.end), branch.end_time);
      }
      time = branch.end_time;
      change = branch.end;
    }
    EXPECT_EQ(time, program.duration());
  }
}

TEST(Program, LengthComesFromTheTotalChange) {
  EXPECT_EQ(thermal::length(0.5, 2.3e-5, 0.0), 0.5);
  EXPECT_DOUBLE_EQ(thermal::length(0.5, 2.3e-5, -200.0), 0.4977);
}

TEST(Program, RefusesWhatIsOutOfRange) {
  const auto refused_by = [](auto change) {
    Program program = cycle();
    change(program);
    return refused_argument([&program] { program.validate(); });
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(refused_by([](Program&) {}), no_argument);
  EXPECT_EQ(refused_by([](Program& p) { p.period = -1.0; }), Argument("period", -1));
  EXPECT_NE(refused_by([&](Program& p) { p.period = nan; }), no_argument);
  EXPECT_EQ(refused_by([](Program& p) { p.cycles = 0; }), Argument("cycles", 0));
  EXPECT_NE(refused_by([&](Program& p) { p.temperature_change_max = nan; }), no_argument);
  EXPECT_NE(refused_by([](Program& p) { p.table_times = {0.0, 1.0}; }), no_argument);
  const auto refused = [](const Program& program) {
    return refused_argument([&program] { program.validate(); });
  };
  EXPECT_EQ(refused(table({0.0, 1.0}, {0.0, 5.0})), no_argument);
  EXPECT_EQ(refused(table({0.0, 1.0, 1.0}, {0.0, 5.0, 0.0})), Argument("table_times[2]", 1));
  EXPECT_NE(refused(table({0.5, 1.0}, {0.0, 5.0})), no_argument);
  EXPECT_NE(refused(table({0.0, 1.0}, {0.0, nan})), no_argument);
  EXPECT_NE(refused(table({0.0, 1.0}, {1.0, 5.0})), no_argument);
  EXPECT_NE(refused(table({0.0, 1.0}, {0.0})), no_argument);
  EXPECT_NE(refused(table({0.0}, {0.0})), no_argument);
  Program open = table({0.0, 1.0}, {0.0, 5.0});
  open.cycles = 2;
  EXPECT_EQ(refused(open), Argument("table_temperature_changes[1]", 5));
  Program late = table({0.0, 1.0}, {0.0, 5.0});
  late.period = 2.0;
  EXPECT_NE(refused(late), no_argument);
  EXPECT_NE(refused_argument([] { shape_of("square"); }), no_argument);
  EXPECT_EQ(shape_of("half_sine"), Shape::half_sine);
}

}  // namespace
}  // namespace statejump::thermal
