// SPDX-License-Identifier: GPL-3.0-or-later
// Sliders with partial slip in a truss.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "heated_bar.hpp"
#include "statejump/truss/path.hpp"

namespace statejump::truss {
namespace {

using testing::heated_bar;

constexpr double friction = 100.0, stiffness = 2e7;
/// Slide at which gross slip begins [m].
constexpr double gross = 1.5 * friction / stiffness;
/// The solver solves closures to 1e-13 of the largest displacement and forces to 1e-12 of the
/// largest force.
constexpr double rounding = 1e-11 * friction;

Slider rubbing() {
  Slider made;
  made.name = std::string("S");
  made.first = 1;
  made.friction_force = friction;
  made.tangential_stiffness = stiffness;
  made.partial_slip = 1;
  return made;
}

double slide(const Model& model, const State& state) {
  return output(model, state, 0, "slide_m")[0];
}
double force(const Model& model, const State& state) {
  return output(model, state, 0, "slider_force_N")[0];
}

/// Cattaneo and Mindlin: force of first loading [N].
double first_loading(double slide) {
  return friction * (1.0 - std::pow(1.0 - std::min(slide / gross, 1.0), 1.5));
}

/// Heat [J] of a cycle between the forces -T and T (Mindlin and Deresiewicz 1953), with t = T/f and
/// 8 G* a = k_t.
double heat_of_cycle(double t) {
  return 7.2 * friction * friction / stiffness *
         (1.0 - std::pow(1.0 - t, 5.0 / 3.0) -
          5.0 * t / 6.0 * (1.0 + std::pow(1.0 - t, 2.0 / 3.0)));
}

double residue(const State& state) {
  return state.thermal_work - state.elastic_energy - state.joint_dissipation.sum();
}

TEST(TrussPartialSlip, LoadingUnloadingReloadingAreTheClosedForms) {
  for (const double largest : {0.5, 5.0, 20.0}) {
    const Model model = heated_bar(rubbing(), largest, 3);
    for (const int increments : {1, 7, 50}) {
      Options options;
      options.increments_per_branch = increments;
      const Path path = solve(model, options);
      double slides[2] = {0.0, 0.0};  // slides at the last reversals: cold, hot
      double forces[2] = {0.0, 0.0};
      int half = 0;
      const auto which = [](int branch) { return static_cast<std::size_t>(branch % 2); };
      for (std::size_t i = 0; i < path.states.size(); ++i) {
        const State& state = path.states[i];
        const double s = slide(model, state);
        const int now = std::min(5, static_cast<int>(2.0 * state.time - 1e-12));
        if (now != half) {
          slides[which(now)] = slide(model, path.states[i - 1]);
          forces[which(now)] = force(model, path.states[i - 1]);
          half = now;
        }
        const bool cools = half % 2 == 1;
        const double way = cools ? 1.0 : -1.0;
        const double back = 0.5 * way * (slides[which(half)] - s);
        // Masing's rule; inside a loop until it joins the previous branch.
        const double expected =
            half == 0 ? first_loading(s) : forces[which(half)] - 2.0 * way * first_loading(back);
        EXPECT_NEAR(force(model, state), expected, rounding)
            << largest << " K, " << increments << " increments, t = " << state.time;
      }
      EXPECT_EQ(half, 5);
      const bool slides_all = largest > 7.4;
      const auto slipped = [](const State& state) { return is_slip(state.joint_status[0]); };
      EXPECT_EQ(std::any_of(path.states.begin(), path.states.end(), slipped), slides_all);
      // Partial slip causes no events. Gross slip begins once per branch.
      EXPECT_EQ(path.events.empty(), !slides_all);
    }
  }
}

TEST(TrussPartialSlip, HeatOfACycleIsThatOfMindlinAndDeresiewicz) {
  double before = 0.0;
  for (const double largest : {8.0, 4.0, 2.0, 1.0, 0.5, 0.25}) {
    const Model model = heated_bar(rubbing(), largest, 3);
    const Path path = solve(model);
    double low = 0.0;
    double high = 0.0;
    for (const State& state : path.states) {
      if (state.time < 1.4) continue;
      low = std::min(low, force(model, state));
      high = std::max(high, force(model, state));
    }
    const double t = 0.5 * (high - low) / friction;
    const double heat =
        path.cycle_ends[3].joint_dissipation[0] - path.cycle_ends[2].joint_dissipation[0];
    // Rounding: the closed form is a difference of terms of order 1 that equals t³/36.
    EXPECT_NEAR(heat, heat_of_cycle(t), (1e-10 + 1e-14 / (t * t * t)) * heat) << largest;
    // Heat of a cycle for small t: 2 T³/(9 k_t f). The error is of the next power of t.
    EXPECT_NEAR(heat, 2.0 / 9.0 * std::pow(t, 3) * friction * friction / stiffness, t * heat);
    if (before > 0.0 && t < 0.1) {
      EXPECT_NEAR(before / heat, 8.0, 8.0 * t);
    }
    before = heat;
  }
}

TEST(TrussPartialSlip, EnergyIsKeptToSecondOrderInTheIncrement) {
  const Model model = heated_bar(rubbing(), 20.0, 2);
  for (const int increments : {25, 50, 100, 200}) {
    Options options;
    options.increments_per_branch = increments;
    const State end = solve(model, options).states.back();
    const double left = std::abs(residue(end)) / end.joint_dissipation.sum();
    // Energy residue: rates jump within an increment when gross slip begins. This leaves 0.4/n² to
    // 0.8/n² for n increments.
    EXPECT_LT(left, 1.0 / increments / increments) << increments;
  }
}

TEST(TrussPartialSlip, ManyTimesTheFrictionIsTheSpring) {
  // Slide under a force T: s = T/k (1 + t/6 + ...), t = T/f. If f doubles, its excess over T/k
  // halves.
  Slider spring = rubbing();
  spring.partial_slip = 0;
  double before = 0.0;
  for (const double times : {10.0, 20.0, 40.0}) {
    Slider slider = rubbing();
    slider.friction_force = spring.friction_force = times * friction;
    const Model slips = heated_bar(slider, 5.0, 1);
    const Model bends = heated_bar(spring, 5.0, 1);
    const auto top = [&](const Model& model) {
      double most = 0.0;
      for (const State& state : solve(model).states) {
        most = std::max(most, slide(model, state));
      }
      return most;
    };
    const double bent = top(bends);
    const double more = top(slips) / bent - 1.0;
    const double t = stiffness * bent / slider.friction_force;
    // The bar (1.26e6 N/m) takes part of the additional compliance, so only the fraction
    // 2e7/2.126e7 of the excess remains.
    EXPECT_NEAR(more, t / 6.0 * 2e7 / 2.126e7, t * t) << times;
    if (before > 0.0) {
      EXPECT_NEAR(before / more, 2.0, 2.0 * t);
    }
    before = more;
  }
}

TEST(TrussPartialSlip, StiffContactsAndSlidesToTheEndAreCoulombs) {
  Slider coulomb = rubbing();
  coulomb.partial_slip = 0;
  coulomb.tangential_stiffness = std::numeric_limits<double>::infinity();
  const auto jump = [](const Slider& slider, double largest) {
    const Model model = heated_bar(slider, largest, 1);
    return slide(model, solve(model).states.back());
  };
  // The cycle ends in gross slip, so the earlier stick phase has no effect.
  EXPECT_NEAR(jump(rubbing(), 40.0), jump(coulomb, 40.0), 1e-10 * jump(coulomb, 40.0));
  // In this cycle the joint still sticks at the end. The error is its elastic deflection,
  // proportional to 1/k_t.
  double before = 0.0;
  for (const double k : {2e8, 2e9, 2e10}) {
    Slider slider = rubbing();
    slider.tangential_stiffness = k;
    const double off = std::abs(jump(slider, 10.0) - jump(coulomb, 10.0));
    EXPECT_LT(off, 3.0 * friction / k);
    if (before > 0.0) {
      EXPECT_NEAR(before / off, 10.0, 1.0);
    }
    before = off;
  }
}

TEST(TrussPartialSlip, AStopTakesWhatIsBeyondFriction) {
  Slider slider = rubbing();
  slider.clearance_plus = 4e-5;
  const Model model = heated_bar(slider, 20.0, 2);
  Options options;
  options.increments_per_branch = 200;
  const Path path = solve(model, options);
  bool stopped = false;
  for (const State& state : path.states) {
    const double s = slide(model, state);
    EXPECT_LE(s, slider.clearance_plus + 1e-18);
    if (state.joint_status[0] != JointStatus::stop_plus) {
      EXPECT_LE(std::abs(force(model, state)), friction + rounding);
      continue;
    }
    stopped = true;
    // The block arrives at the stop in gross slip, rests there and leaves with the same friction
    // force.
    EXPECT_GE(force(model, state), friction - rounding);
  }
  EXPECT_TRUE(stopped);
  const State& end = path.states.back();
  EXPECT_LT(std::abs(residue(end)), 2.0 / 200.0 / 200.0 * end.joint_dissipation.sum());
}

TEST(TrussPartialSlip, WithoutFrictionOrStiffnessItIsRefused) {
  for (const bool of_friction : {true, false}) {
    Slider slider = rubbing();
    if (of_friction) {
      slider.friction_force = 0.0;
    } else {
      slider.tangential_stiffness = std::numeric_limits<double>::infinity();
    }
    EXPECT_THROW(heated_bar(slider, 5.0, 1).validate(), std::invalid_argument);
  }
  Slider twice = rubbing();
  twice.partial_slip = 2;
  EXPECT_THROW(heated_bar(twice, 5.0, 1).validate(), std::invalid_argument);
}

}  // namespace
}  // namespace statejump::truss
