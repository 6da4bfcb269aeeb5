// SPDX-License-Identifier: GPL-3.0-or-later
#include "statejump/spring_slider/history.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "table1.hpp"

namespace statejump::spring_slider {
namespace {

Eigen::VectorXd grid(const Path& path, Eigen::Index n) {
  return Eigen::VectorXd::LinSpaced(n, 0.0, path.program.duration());
}

std::vector<Path> paths() {
  SpringSlider preloaded = table1();
  preloaded.preload_stiffness = 3e5;
  SpringSlider pulled = table1();
  pulled.preload_force = 200.0;
  SpringSlider settled = pulled;
  settled.start_friction = StartFriction::frictionless;
  SpringSlider seated = preloaded;
  seated.preload_force = -2e3;
  SpringSlider frictionless = table1();
  frictionless.friction_force = 0.0;
  SpringSlider shrinking = table1();
  shrinking.thermal_expansion = -alpha;
  std::vector<Path> result;
  for (const thermal::Shape shape :
       {thermal::Shape::triangle, thermal::Shape::half_sine, thermal::Shape::sine}) {
    for (const SpringSlider& model :
         {table1(), table1(2e-3), preloaded, pulled, settled, seated, frictionless, shrinking}) {
      result.push_back(solve(model, cycle(shape, 3, 0.7)));
    }
  }
  return result;
}

TEST(SpringSliderHistory, ForcesBalanceWithinTheirLimits) {
  for (const Path& path : paths()) {
    const SpringSlider& model = path.model;
    const History h = sample(path, grid(path, 5000));
    for (Eigen::Index i = 0; i < h.time.size(); ++i) {
      const double sum = h.axial_force[i] - model.preload_force -
                         model.preload_stiffness * h.displacement[i] + h.friction_force[i] +
                         h.stop_force[i];
      ASSERT_NEAR(sum, 0.0, 1e-12 + 1e-15 * std::abs(model.preload_force));
      ASSERT_LE(std::abs(h.friction_force[i]), model.friction_force + 1e-10);
      ASSERT_LE(h.displacement[i], model.clearance_plus);
      ASSERT_GE(h.displacement[i], -model.clearance_minus);
      // A stop only pushes, and only if the block touches it. The tolerance 1e-10 N is k = 1.3e6
      // N/m times the rounding of the event's ΔT, 1e-13 K or 1e-18 m, and more near a flat crest.
      if (h.stop_force[i] < -1e-10) {
        ASSERT_EQ(h.displacement[i], model.clearance_plus);
      }
      if (h.stop_force[i] > 1e-10) {
        ASSERT_EQ(h.displacement[i], -model.clearance_minus);
      }
      // The axial force obeys the link's law at the reported state.
      ASSERT_NEAR(h.axial_force[i], axial_force(model, h.temperature_change[i], h.displacement[i]),
                  1e-11);
    }
  }
}

TEST(SpringSliderHistory, EnergyBalances) {
  for (const Path& path : paths()) {
    const History h = sample(path, grid(path, 5000));
    const Eigen::VectorXd residue =
        h.thermal_work - h.elastic_energy - h.preload_energy - h.friction_dissipation;
    // All terms are sums of a few dozen products with relative accuracy 1e-15. The largest term is
    // the elastic energy at the stop or the friction work. The tolerance is 1e-13 of it. The
    // smallest term that could be missing, ½ (E A/l_T²)(x − x_T)² l̇_T, is 1e-5 of it.
    const double scale = std::max({h.friction_dissipation.maxCoeff(), h.elastic_energy.maxCoeff(),
                                   h.preload_energy.maxCoeff()});
    EXPECT_LE(residue.cwiseAbs().maxCoeff(), 1e-13 * scale);
    EXPECT_GE((h.friction_dissipation.tail(4999) - h.friction_dissipation.head(4999)).minCoeff(),
              -1e-16);
  }
}

TEST(SpringSliderHistory, FrictionWorkOfTable1) {
  // The block slides from 0 to the clearance c and back to the position x = jump.
  const Path path = solve(table1(), cycle());
  const History h = sample(path, grid(path, 2));
  const double jump = f * l0 / EA;
  const double work = f * (c + c - jump);
  EXPECT_NEAR(h.friction_dissipation[1], work, close(work));
  const double stored = 0.5 * f * jump;
  EXPECT_NEAR(h.elastic_energy[1], stored, close(stored));
  EXPECT_NEAR(h.thermal_work[1], work + stored, close(work + stored));
}

TEST(SpringSliderHistory, StopForceAtThePeak) {
  const History h = sample(solve(table1(), cycle()), Eigen::VectorXd::Constant(1, 0.5));
  const double k = EA / (l0 * (1.0 + alpha * 100.0));
  const double force = k * (l0 * alpha * 100.0 - c);
  EXPECT_NEAR(force, 214.0, 0.5);
  EXPECT_NEAR(h.axial_force[0], force, close(force));
  EXPECT_EQ(h.friction_force[0], -f);
  EXPECT_NEAR(h.stop_force[0], -(force - f), close(force));
  EXPECT_EQ(h.stage[0], Stage::at_stop_plus);
}

TEST(SpringSliderHistory, DoesNotDependOnTheGrid) {
  for (const Path& path : paths()) {
    const Eigen::VectorXd times = grid(path, 1001);
    const History whole = sample(path, times);
    for (const Eigen::Index i : {1000, 0, 517, 3, 998, 250}) {  // out of order, one by one
      const History one = sample(path, times.segment(i, 1));
      EXPECT_EQ(one.displacement[0], whole.displacement[i]);
      EXPECT_EQ(one.thermal_work[0], whole.thermal_work[i]);
      EXPECT_EQ(one.stage[0], whole.stage[static_cast<std::size_t>(i)]);
    }
    const History reversed = sample(path, times.reverse());
    EXPECT_EQ(reversed.axial_force.reverse(), whole.axial_force);
  }
}

TEST(SpringSliderHistory, StaysWithinTheSegmentAtAnEvent) {
  // Event times are rounded. At a rounded time the state must not be one from before the event.
  for (const Path& path : paths()) {
    for (const Segment& segment : path.segments) {
      const History h = sample(path, Eigen::VectorXd::Constant(1, segment.start_time));
      const auto [lowest, highest] =
          std::minmax(segment.start_temperature_change, segment.end_temperature_change);
      EXPECT_EQ(h.stage[0], segment.stage);
      EXPECT_GE(h.temperature_change[0], lowest);
      EXPECT_LE(h.temperature_change[0], highest);
    }
  }
}

TEST(SpringSliderHistory, EndsExactlyAndHolds) {
  const Path path = solve(table1(), cycle(thermal::Shape::half_sine, 3, 0.7));
  const Eigen::Vector3d times(path.program.duration(), 100.0, 0.0);
  const History h = sample(path, times);
  EXPECT_EQ(h.displacement[0], path.state_jump());
  EXPECT_EQ(h.temperature_change[0], 0.0);
  EXPECT_EQ(h.displacement[1], path.state_jump());
  EXPECT_EQ(h.displacement[2], 0.0);
  EXPECT_EQ(h.stage[2], Stage::S1);
}

TEST(SpringSliderHistory, RefusesTimesThatAreNone) {
  const Path path = solve(table1(), cycle());
  for (const double time :
       {-1e-9, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    EXPECT_NE(refusal([&] { sample(path, Eigen::VectorXd::Constant(1, time)); }), "");
  }
  EXPECT_EQ(sample(path, Eigen::VectorXd()).time.size(), 0);
}

}  // namespace
}  // namespace statejump::spring_slider
