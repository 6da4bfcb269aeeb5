// SPDX-License-Identifier: GPL-3.0-or-later
// Compares force and derivatives of a step in the plane with the law along one direction, with a
// row of annuli and with partial_slip_step().
#include "statejump/kernel/partial_slip_plane.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "partial_slip_histories.hpp"

namespace statejump::kernel {
namespace {

using testing::gross;
using testing::limit;
using testing::pi;
using testing::Random;
using testing::random_history;
using testing::stiffness;

Tangent along(double angle, double size) {
  return {size * std::cos(angle), size * std::sin(angle)};
}
double apart(const Tangent& a, const Tangent& b) {
  return (a - b).norm();
}

TEST(PartialSlipPlane, AlongOneDirectionItIsTheLine) {
  Random random;
  for (int trial = 0; trial < 1000; ++trial) {
    const double angle = random.uniform(-pi, pi);
    Random same = random;
    const PartialSlipMemory turned =
        random_history(random, trial % 9, [&](double slide) { return along(angle, slide); });
    const PartialSlipMemory straight = random_history(same, trial % 9, [](double slide) {
      return Tangent{slide, 0.0};
    });
    const double depth = random.uniform(0.2e-6, 2.5e-6);
    const double slide = random.uniform(-2.0, 2.0) * random.uniform(0.0, 1.0) * gross(depth);
    const double k = stiffness(depth);
    const double most = limit(depth);
    const PartialSlipLine line = partial_slip_line(k, most, slide, straight);
    const PartialSlipPlane plane = partial_slip_plane(k, most, along(angle, slide), turned);
    // Rounding of the direction, in about fifty pieces.
    ASSERT_LT(apart(plane.force, along(angle, line.force)), 1e-13 * most) << trial;
    EXPECT_LT(apart(plane.by_limit, along(angle, line.by_limit)), 1e-10) << trial;
    EXPECT_LT(apart(plane.by_stiffness, along(angle, line.by_stiffness)), 1e-10 * most / k);
    const Tangent with = along(angle, 1.0);
    const Tangent by_slide = with.a * plane.by_slide_a + with.b * plane.by_slide_b;
    // Rounding by ε moves the end of a piece by √ε.
    EXPECT_LT(apart(by_slide, along(angle, line.by_slide)), 1e-6 * k) << trial;
    EXPECT_LT(apart(plane.centre, along(angle, line.centre)),
              1e-13 * std::abs(line.centre) + 1e-22);
  }
}

/// Reference force of `rings` annuli whose displacements return radially to their bounds. Annuli
/// that enter or leave the contact need only the points of the memory as state.
Tangent of_rings(double k, double most, const Tangent& slide, const PartialSlipMemory& memory,
                 int rings) {
  const double slope = 1.5 * most / (k * k * k);
  Tangent sum{};
  for (int i = 0; i < rings; ++i) {
    const double x = k * (i + 0.5) / rings;
    Tangent u{};
    double share = 1.0;
    for (int j = 1; j < memory.size(); ++j) {
      const auto [xa, ua] = memory[j - 1];
      const auto [xb, ub] = memory[j];
      if (x >= xa && x < xb) u = ua + ((x * x - xa * xa) / (xb * xb - xa * xa)) * (ub - ua);
    }
    const double old = memory.edge();
    if (x > old) share = (k * k - x * x) / (k * k - old * old);
    u = u + share * slide;
    const double bound = slope * (k * k - x * x);
    sum = sum + (k / rings * std::min(1.0, bound / u.norm())) * u;
  }
  return sum;
}

TEST(PartialSlipPlane, IsARowOfRingsAndTheStepToItsChords) {
  Random random;
  double square = 0.0;
  double most_off = 0.0;
  constexpr int trials = 400;
  for (int trial = 0; trial < trials; ++trial) {
    const PartialSlipMemory memory = random_history(
        random, trial % 12, [&](double slide) { return along(random.uniform(-pi, pi), slide); });
    const double depth = random.uniform(0.3e-6, 2.5e-6);
    const double k = stiffness(depth);
    const double most = limit(depth);
    const Tangent slide = along(random.uniform(-pi, pi), random.uniform(0.05, 2.0) * gross(depth));
    const PartialSlipPlane plane = partial_slip_plane(k, most, slide, memory);
    // Error of the midpoint rule. Where |U| is near zero, its direction changes within few annuli.
    const double off = apart(plane.force, of_rings(k, most, slide, memory, 4000)) / most;
    EXPECT_LT(off, 1e-4) << trial;
    square += off * off / trials;
    PartialSlipMemory after = memory;
    most_off = std::max(most_off,
                        apart(plane.force, partial_slip_step(k, most, slide, after).force) / most);
  }
  EXPECT_LT(std::sqrt(square), 1e-5);
  EXPECT_LT(most_off, 1e-3);
}

TEST(PartialSlipPlane, DerivativesAreThoseOfTheForce) {
  Random random;
  for (int trial = 0; trial < 500; ++trial) {
    const PartialSlipMemory memory = random_history(
        random, trial % 9, [&](double slide) { return along(random.uniform(-pi, pi), slide); });
    const double depth = random.uniform(0.3e-6, 2.5e-6);
    const double k = stiffness(depth);
    const double most = limit(depth);
    const Tangent slide = along(random.uniform(-pi, pi), random.uniform(0.05, 2.0) * gross(depth));
    const PartialSlipPlane plane = partial_slip_plane(k, most, slide, memory);
    const auto force = [&](double at_k, double at_limit, const Tangent& at_slide) {
      return partial_slip_plane(at_k, at_limit, at_slide, memory).force;
    };
    // Central differences: second derivatives are bounded except for square roots. Quadrature
    // errors are added, because the quadrature points move with the pieces.
    const double h = 1e-5;
    const double rounding = 4e-15 * most;
    const auto near = [&](const Tangent& exact, const Tangent& plus, const Tangent& minus,
                          double span, double scale, const char* what) {
      EXPECT_LT(apart(exact, (0.5 / span) * (plus - minus)),
                0.5 * std::sqrt(h) * scale + 2.0 * rounding / span)
          << what << " of trial " << trial;
    };
    const double ds = h * gross(depth);
    const Tangent da{ds, 0.0};
    const Tangent db{0.0, ds};
    near(plane.by_slide_a, force(k, most, slide + da), force(k, most, slide - da), ds, k,
         "slide a");
    near(plane.by_slide_b, force(k, most, slide + db), force(k, most, slide - db), ds, k,
         "slide b");
    const double dl = h * most;
    near(plane.by_limit, force(k, most + dl, slide), force(k, most - dl, slide), dl, 1.0, "limit");
    const double dk = h * k;
    near(plane.by_stiffness, force(k + dk, most, slide), force(k - dk, most, slide), dk, most / k,
         "stiffness");
  }
}

TEST(PartialSlipPlane, WithoutContactOrFrictionAllIsZero) {
  for (const auto& [k, most] : {std::pair{0.0, 1.0}, std::pair{1e7, 0.0}, std::pair{-1.0, -1.0}}) {
    const PartialSlipPlane plane = partial_slip_plane(k, most, {1e-6, 1e-6}, {});
    EXPECT_EQ(plane.force.squared() + plane.by_slide_a.squared() + plane.by_limit.squared(), 0.0);
  }
}

}  // namespace
}  // namespace statejump::kernel
