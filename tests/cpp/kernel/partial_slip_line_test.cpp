// SPDX-License-Identifier: GPL-3.0-or-later
// Compares force and derivatives of a step in one direction with partial_slip_step().
#include "statejump/kernel/partial_slip_line.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "partial_slip_histories.hpp"

namespace statejump::kernel {
namespace {

using testing::gross;
using testing::limit;
using testing::Random;
using testing::random_history;
using testing::stiffness;

TEST(PartialSlipLine, IsForceAndDerivativesOfTheStep) {
  Random random;
  int slipping = 0;
  int grown = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    const PartialSlipMemory memory = random_history(random, trial % 9);
    const double depth = random.uniform(0.2e-6, 2.5e-6);
    const double slide = random.uniform(-2.0, 2.0) * random.uniform(0.0, 1.0) * gross(depth);
    const double k = stiffness(depth);
    const double most = limit(depth);
    const auto force = [&](double at_k, double at_limit, double at_slide) {
      PartialSlipMemory after = memory;
      return partial_slip_step(at_k, at_limit, {at_slide, 0.0}, after).force.a;
    };
    const PartialSlipLine line = partial_slip_line(k, most, slide, memory);
    PartialSlipMemory after = memory;
    const PartialSlipResponse step = partial_slip_step(k, most, {slide, 0.0}, after);
    // The law detects slip with a tolerance of 1e-15 of the bound, in each of at most 50 pieces.
    ASSERT_NEAR(line.force, step.force.a, 1e-13 * most) << trial;
    EXPECT_EQ(std::abs(line.centre) > line.bound * (1.0 + 1e-12), step.slipping) << trial;
    slipping += step.slipping;
    grown += k > memory.edge();
    // Central differences with h. The displacement U is continuous between pieces, so the second
    // derivative is bounded, except for square roots at the contact's centre (error sqrt(h)).
    // Rounding of the force, over h, is added.
    const double h = 1e-5;
    const double rounding = 4e-15 * most;
    const auto near = [&](double exact, double plus, double minus, double span, double scale,
                          const char* what) {
      EXPECT_NEAR(exact, (plus - minus) / (2.0 * span),
                  0.5 * std::sqrt(h) * scale + rounding / span)
          << what << " of trial " << trial;
    };
    const double ds = h * gross(depth);
    near(line.by_slide, force(k, most, slide + ds), force(k, most, slide - ds), ds, k, "slide");
    const double dl = h * most;
    near(line.by_limit, force(k, most + dl, slide), force(k, most - dl, slide), dl, 1.0, "limit");
    const double dk = h * k;
    near(line.by_stiffness, force(k + dk, most, slide), force(k - dk, most, slide), dk, most / k,
         "stiffness");
  }
  EXPECT_GT(slipping, 200);
  EXPECT_GT(grown, 400);
}

TEST(PartialSlipLine, AtABoundThatWasMetRingsStick) {
  // After gross slip and one step without slide, all annuli stick at first, in either direction.
  PartialSlipMemory memory;
  const double k = stiffness(1e-6);
  const double most = limit(1e-6);
  partial_slip_step(k, most, {0.0, 0.0}, memory);
  partial_slip_step(k, most, {-2.0 * gross(1e-6), 0.0}, memory);
  const PartialSlipLine line = partial_slip_line(k, most, 0.0, memory);
  EXPECT_NEAR(line.force, -most, 1e-14 * most);
  EXPECT_NEAR(line.by_slide, k, 1e-14 * k);
  EXPECT_NEAR(line.by_limit, 0.0, 1e-14);
  EXPECT_NEAR(line.centre, -line.bound, 1e-14 * line.bound);
}

TEST(PartialSlipLine, CountsPiecesThatStickAndSlip) {
  // A contact that never slipped: under a slide, the rim slips in its direction and the centre
  // sticks.
  PartialSlipMemory memory;
  const double k = stiffness(1e-6);
  const double most = limit(1e-6);
  partial_slip_step(k, most, {0.0, 0.0}, memory);
  const double slide = 0.25 * gross(1e-6);
  const auto counts = [](const PartialSlipLine& line) {
    return std::array{line.stuck, line.plus, line.minus};
  };
  EXPECT_EQ(counts(partial_slip_line(k, most, slide, memory)), (std::array{1, 1, 0}));
  EXPECT_EQ(counts(partial_slip_line(k, most, -slide, memory)), (std::array{1, 0, 1}));
  EXPECT_EQ(counts(partial_slip_line(k, most, 0.0, memory)), (std::array{1, 0, 0}));
  EXPECT_EQ(counts(partial_slip_line(k, most, 2.0 * gross(1e-6), memory)), (std::array{0, 1, 0}));
}

TEST(PartialSlipLine, WithoutContactOrFrictionAllIsZero) {
  for (const auto& [k, most] : {std::pair{0.0, 1.0}, std::pair{1e7, 0.0}, std::pair{-1.0, -1.0}}) {
    const PartialSlipLine line = partial_slip_line(k, most, 1e-6, {});
    EXPECT_EQ(line.force, 0.0);
    EXPECT_EQ(line.by_slide, 0.0);
    EXPECT_EQ(line.by_limit, 0.0);
  }
}

}  // namespace
}  // namespace statejump::kernel
