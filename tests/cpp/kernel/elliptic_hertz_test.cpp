// SPDX-License-Identifier: GPL-3.0-or-later
#include "statejump/kernel/elliptic_hertz.hpp"

#include <stdexcept>

#include "../support/argument.hpp"
#include "statejump/kernel/elastic_pair.hpp"
#include "statejump/kernel/hertz.hpp"
#include "support.hpp"

namespace statejump::kernel {
namespace {

using statejump::testing::Argument;
using statejump::testing::no_argument;
using statejump::testing::refused_argument;
using testing::pi;

/// Complete elliptic integrals of modulus k, b/a = k', by the arithmetic-geometric mean (Abramowitz
/// and Stegun 17.6) in long double. This algorithm is independent of Boost's.
struct Agm {
  long double k, e;
  explicit Agm(long double complement) {
    long double a = 1, b = complement, power = 1;
    long double sum = 1 - complement * complement;
    while (std::abs(a - b) > 1e-17L * a) {
      const long double next = 0.5L * (a + b);
      const long double c = 0.5L * (a - b);
      b = std::sqrt(a * b);
      a = next;
      power *= 2;
      sum += power * c * c;
    }
    k = 3.14159265358979323846264338327950288L / (2 * a);
    e = k * (1 - 0.5L * sum);
  }
};

struct Reference {
  double axes, long_axis, stiffness;
};

/// Johnson's eqs 4.26 to 4.28 as printed, solved by bisection.
Reference reference(long double larger, long double smaller) {
  long double low = 1e-9L, high = 1 - 1e-9L;
  for (int i = 0; i < 200; ++i) {
    const long double axes = std::sqrt(low * high);
    const Agm agm(axes);
    const long double ratio = (agm.e / (axes * axes) - agm.k) / (agm.k - agm.e);
    (ratio > larger / smaller ? low : high) = axes;
  }
  const Agm agm(low);
  const long double e2 = 1 - low * low;
  const long double long_axis = std::sqrt(2 * (agm.k - agm.e) / (e2 * smaller * agm.k));
  const long double stiffness =
      2.0L / 3.0L * 3.14159265358979323846264338327950288L * long_axis / agm.k;
  return {static_cast<double>(low), static_cast<double>(long_axis), static_cast<double>(stiffness)};
}

TEST(EllipticHertz, AgreesWithJohnsonByArithmeticGeometricMean) {
  for (const double ratio : {1.01, 1.5, 2.0, 10.0, 51.0, 1e3, 1e5}) {
    const double larger = 3.9;
    const EllipticShape shape = elliptic_shape({larger, larger / ratio, 0});
    const Reference expected = reference(larger, static_cast<long double>(larger / ratio));
    // Near the circle the reference loses digits: at ratio 1.01, K - E is 1e-2 of K and has an
    // error of 1e-16.
    EXPECT_NEAR(shape.short_axis / shape.long_axis, expected.axes, 1e-12 * expected.axes);
    EXPECT_NEAR(shape.long_axis, expected.long_axis, 1e-12 * expected.long_axis);
    EXPECT_NEAR(shape.stiffness, expected.stiffness, 1e-12 * expected.stiffness);
  }
}

// Timoshenko and Goodier, Theory of Elasticity, section 140: a = m (3F/(4 E* (A + B)))^(1/3), b the
// same with n instead of m, cos(theta) = (B - A)/(A + B), A + B = (larger + smaller)/2. The printed
// third decimal is off by up to 2: at 70 degrees n is printed as 0.802, but is 0.7999, which the
// arithmetic-geometric mean confirms.
TEST(EllipticHertz, TableOfTimoshenkoAndGoodier) {
  const double table[][3] = {{30, 2.731, 0.493}, {40, 2.136, 0.567}, {50, 1.754, 0.641},
                             {60, 1.486, 0.717}, {70, 1.284, 0.802}, {80, 1.128, 0.893},
                             {90, 1.0, 1.0}};
  for (const auto& row : table) {
    const double cosine = std::cos(row[0] * pi / 180);
    const double larger = 1 + cosine, smaller = 1 - cosine;  // A + B = 1
    const EllipticShape shape = elliptic_shape({larger, std::min(smaller, larger), 0});
    const EllipticHertzState state = elliptic_hertz(1.0, shape, 1e-3);
    const double unit = std::cbrt(0.75 * state.force);
    EXPECT_NEAR(state.long_axis / unit, row[1], 2.5e-3) << row[0];
    EXPECT_NEAR(state.short_axis / unit, row[2], 2.5e-3) << row[0];
  }
}

TEST(EllipticHertz, CircleIsHertz) {
  for (const double radius : {1e-3, 0.255, 12.0})
    for (const double off : {0.0, 1e-15, 1e-9, 3e-8}) {
      const double curvature = 1 / radius;
      const EllipticShape shape = elliptic_shape({curvature, curvature / (1 + off), 0});
      for (const double depth : {1e-9, 1e-6, 1e-4}) {
        const EllipticHertzState state = elliptic_hertz(3.8e10, shape, depth);
        const HertzState circle = hertz(3.8e10, radius, depth);
        // Reference: circle of the mean curvature. To first order the ellipse differs by a quarter
        // of the axis ratio's deviation from 1.
        const double tolerance = 1e-12 + off;
        EXPECT_NEAR(state.force, circle.force, tolerance * circle.force);
        EXPECT_NEAR(state.stiffness, circle.stiffness, tolerance * circle.stiffness);
        EXPECT_NEAR(state.long_axis, circle.contact_radius, tolerance * circle.contact_radius);
        EXPECT_NEAR(state.short_axis, circle.contact_radius, tolerance * circle.contact_radius);
        EXPECT_NEAR(state.elastic_energy, circle.elastic_energy, tolerance * circle.elastic_energy);
      }
    }
}

// The result is continuous where the series replaces the root finder.
TEST(EllipticHertz, SeriesAndRootFinderMeet) {
  const EllipticShape below = elliptic_shape({1.0, std::exp(-0.99999e-7), 0});
  const EllipticShape above = elliptic_shape({1.0, std::exp(-1.00001e-7), 0});
  EXPECT_NEAR(below.stiffness, above.stiffness, 1e-11);
  EXPECT_NEAR(below.long_axis / below.short_axis, above.long_axis / above.short_axis, 1e-11);
}

TEST(EllipticHertz, StiffnessIsTheDerivativeAndEnergyTheIntegral) {
  const EllipticShape shape = elliptic_shape({200.0, 3.9, 0});
  EllipticHertzState last = elliptic_hertz(3.8e10, shape, 0.0);
  EXPECT_EQ(last.force, 0.0);
  EXPECT_EQ(elliptic_hertz(3.8e10, shape, -1e-6).stiffness, 0.0);
  for (double depth = 1e-9; depth < 1e-4; depth *= 3) {
    const double h = 1e-4 * depth;
    const EllipticHertzState up = elliptic_hertz(3.8e10, shape, depth + h);
    const EllipticHertzState down = elliptic_hertz(3.8e10, shape, depth - h);
    const EllipticHertzState state = elliptic_hertz(3.8e10, shape, depth);
    EXPECT_NEAR(state.stiffness, (up.force - down.force) / (2 * h), 2e-9 * state.stiffness);
    EXPECT_NEAR(state.force, (up.elastic_energy - down.elastic_energy) / (2 * h),
                2e-9 * state.force);
    EXPECT_GT(state.force, last.force);
    EXPECT_GT(state.stiffness, last.stiffness);
    EXPECT_GT(state.long_axis, state.short_axis);
    last = state;
  }
}

// A smaller second curvature makes the contact stiffer and more elongated.
TEST(EllipticHertz, MonotonicInTheRatio) {
  EllipticShape last = elliptic_shape({1.0, 1.0, 0});
  for (double ratio = 1.3; ratio < largest_curvature_ratio; ratio *= 1.3) {
    const EllipticShape shape = elliptic_shape({1.0, 1.0 / ratio, 0});
    EXPECT_GT(shape.stiffness, last.stiffness) << ratio;
    EXPECT_GT(shape.long_axis, last.long_axis) << ratio;
    EXPECT_LT(shape.short_axis / shape.long_axis, last.short_axis / last.long_axis) << ratio;
    last = shape;
  }
}

TEST(EllipticHertz, RelativeCurvatures) {
  // Journal in a bore: parallel axes give a line contact, perpendicular axes the curvatures 1/R1
  // and -1/R2.
  const RelativeCurvature line = relative_curvature(200, 0, -196, 0, 0);
  EXPECT_DOUBLE_EQ(line.larger, 4);
  EXPECT_DOUBLE_EQ(line.smaller, 0);
  EXPECT_DOUBLE_EQ(line.angle, 0);
  const RelativeCurvature crossed = relative_curvature(200, 0, -196, 0, pi / 2);
  EXPECT_DOUBLE_EQ(crossed.larger, 200);
  EXPECT_DOUBLE_EQ(crossed.smaller, -196);
  // Compare with the eigenvalues of the sum of the curvature tensors.
  testing::Random random;
  for (int i = 0; i < 200; ++i) {
    const double k[4] = {random.uniform(-9, 9), random.uniform(-9, 9), random.uniform(-9, 9),
                         random.uniform(-9, 9)};
    const double angle = random.uniform(-4, 4);
    const Eigen::Rotation2Dd turn(angle);
    Eigen::Matrix2d first = Eigen::Vector2d(k[0], k[1]).asDiagonal();
    Eigen::Matrix2d second = Eigen::Vector2d(k[2], k[3]).asDiagonal();
    const Eigen::Matrix2d sum =
        first + turn.toRotationMatrix() * second * turn.toRotationMatrix().transpose();
    const RelativeCurvature c = relative_curvature(k[0], k[1], k[2], k[3], angle);
    const Eigen::Vector2d way(std::cos(c.angle), std::sin(c.angle));
    EXPECT_NEAR((sum * way - c.larger * way).norm(), 0, 1e-13 * 40);
    EXPECT_NEAR(c.larger + c.smaller, sum.trace(), 1e-13);
    EXPECT_NEAR(c.larger * c.smaller, sum.determinant(), 1e-12);
  }
}

Argument refused(double larger, double smaller) {
  return refused_argument([&] { elliptic_shape({larger, smaller, 0}); });
}

TEST(EllipticHertz, RefusesLinesAndConformingSurfaces) {
  const std::string smaller = "smaller relative curvature";
  for (const double line : {0.0, 3.9e-10, -1.0}) {
    EXPECT_EQ(refused(4, line), Argument(smaller, line));
    EXPECT_EQ(refused(4, line).range.find("[larger/1e10, larger] 1/m"), 0u);
  }
  EXPECT_EQ(refused(4, 5), Argument(smaller, 5));
  EXPECT_EQ(refused(4, 5).range, "(0, larger] 1/m");
  EXPECT_EQ(refused(-1, -2), Argument("larger relative curvature", -1));
  EXPECT_FALSE(refused(std::nan(""), 1) == no_argument);
  EXPECT_FALSE(refused(1, std::nan("")) == no_argument);
  EXPECT_EQ(refused(4, 4e-10), no_argument);
}

}  // namespace
}  // namespace statejump::kernel
