// SPDX-License-Identifier: GPL-3.0-or-later
#include "statejump/rest_set/rest_set.hpp"
#include "../support/argument.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <functional>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

namespace statejump::rest_set {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using statejump::testing::Argument;
using statejump::testing::refused_argument;

constexpr double pi = 3.14159265358979323846;
constexpr double c = 1e-4;

Vector2d at(double angle, double size = 7.0) {
  return {size * std::cos(angle), size * std::sin(angle)};
}

TEST(RestInSlot, SegmentOrStop) {
  const RestStudy study = rest_in_slot(
      c, {{1.0, 0.0, -10.0}, {5.0, 0.0, -10.0}, {-5.0, 3.0, 4.0}, {3.0, -6.0, 8.0}}, 0.3);
  EXPECT_DOUBLE_EQ(study.each[0].length, 2.0 * c);
  EXPECT_DOUBLE_EQ(study.each[0].diameter, 2.0 * c);
  EXPECT_EQ(study.each[0].parts[0].points,
            (std::vector<Vector3d>{Vector3d(-c, 0, 0), Vector3d(c, 0, 0)}));
  ASSERT_EQ(study.each[1].parts.size(), 1u);
  EXPECT_EQ(study.each[1].length, 0.0);
  EXPECT_EQ(study.each[1].parts[0].representative, Vector3d(c, 0, 0));
  EXPECT_EQ(study.each[2].parts[0].representative, Vector3d(-c, 0, 0));
  EXPECT_DOUBLE_EQ(study.each[3].diameter, 2.0 * c);  // at the limit: 3 = 0.3 * 10
  EXPECT_DOUBLE_EQ(study.any.length, 2.0 * c);
  EXPECT_TRUE(study.all.parts.empty());
  const RestStudy ends = rest_in_slot(c, {{1, 0, 0}, {-1, 0, 0}}, 0.3);
  EXPECT_EQ(ends.any.parts.size(), 2u);
  EXPECT_DOUBLE_EQ(ends.any.diameter, 2.0 * c);
  EXPECT_EQ(ends.any.length, 0.0);
  // A force perpendicular to the slot makes every position a rest position, even without friction.
  EXPECT_DOUBLE_EQ(rest_in_slot(c, {{0, 0, -1}}, 0.0).any.diameter, 2.0 * c);
}

TEST(RestInBearing, ArcOfHalfAngleAtanMu) {
  for (const double mu : {0.01, 0.3, 1.0, 5.0}) {
    for (const double direction : {-3.0, 0.0, 1.0, pi}) {
      const RestSet set = rest_in_bearing(c, {at(direction)}, mu).any;
      ASSERT_EQ(set.parts.size(), 1u);
      EXPECT_NEAR(set.parts[0].angle, 2.0 * std::atan(mu), 1e-14);
      EXPECT_NEAR(set.length, 2.0 * c * std::atan(mu), 1e-18);
      EXPECT_NEAR(set.diameter, 2.0 * c * std::sin(std::atan(mu)), 1e-18);
      EXPECT_NEAR((set.farthest[0] - set.farthest[1]).norm(), set.diameter, 1e-18);
      const Vector3d middle = set.parts[0].representative;
      EXPECT_NEAR((middle.head<2>() - c * at(direction, 1.0)).norm(), 0.0, 1e-18);
      for (const Vector3d& p : set.parts[0].points) {
        const double angle = std::acos(p.head<2>().normalized().dot(at(direction, 1.0)));
        EXPECT_LE(angle, std::atan(mu) + 1e-7);
      }
    }
  }
}

TEST(RestInBearing, WithoutFrictionOnePoint) {
  const RestSet set = rest_in_bearing(c, {at(2.0)}, 0.0).any;
  ASSERT_EQ(set.parts.size(), 1u);
  EXPECT_EQ(set.length, 0.0);
  EXPECT_EQ(set.diameter, 0.0);
  EXPECT_EQ(set.parts[0].points.size(), 1u);
}

TEST(RestInBearing, TwoForcesAtBeta) {
  const double mu = 0.3, phi = std::atan(mu);
  for (const double direction : {0.0, 2.0, 3.0, -3.1}) {
    for (const double beta : {0.1, 0.5, 0.58, 0.59, 2.0, pi}) {
      const RestStudy study = rest_in_bearing(c, {at(direction), at(direction + beta)}, mu);
      const double common = std::max(0.0, 2.0 * phi - beta);
      EXPECT_NEAR(study.all.length, c * common, 1e-18);
      EXPECT_NEAR(study.all.diameter, 2.0 * c * std::sin(0.5 * common), 1e-18);
      EXPECT_EQ(study.all.parts.size(), common > 0.0 ? 1u : 0u);
      EXPECT_NEAR(study.any.length, c * (4.0 * phi - common), 1e-18);
      EXPECT_EQ(study.any.parts.size(), common > 0.0 ? 1u : 2u);
      EXPECT_NEAR(study.any.diameter, 2.0 * c * std::sin(0.5 * std::min(pi, beta + 2.0 * phi)),
                  1e-18);
    }
  }
}

TEST(RestInBearing, FarthestOfThreeArcs) {
  // The second and third arc are 2.5 rad apart, all other pairs less.
  const RestStudy study = rest_in_bearing(c, {at(1.0), at(3.0), at(5.5)}, 0.05);
  EXPECT_EQ(study.any.parts.size(), 3u);
  EXPECT_NEAR(study.any.diameter, 2.0 * c * std::sin(1.25 + std::atan(0.05)), 1e-18);
}

TEST(RestInBearing, ForcesAllAround) {
  std::vector<Vector2d> forces;
  for (int i = 0; i < 12; ++i) forces.push_back(at(2.0 * pi * i / 12));
  const RestStudy study = rest_in_bearing(c, forces, 0.3);  // 0.291 > pi / 12
  ASSERT_EQ(study.any.parts.size(), 1u);
  EXPECT_NEAR(study.any.length, 2.0 * pi * c, 1e-15);
  EXPECT_NEAR(study.any.diameter, 2.0 * c, 1e-18);
  // The farthest points of this closed circle are half a turn apart, not at the ends of an arc of a
  // full turn.
  EXPECT_NEAR(study.any.parts[0].diameter, 2.0 * c, 1e-18);
  EXPECT_TRUE(study.all.parts.empty());
  // With this friction a single arc exceeds half a turn.
  const double mu = std::tan(1.8 * pi / 4);
  EXPECT_NEAR(rest_in_bearing(c, {at(0.3)}, mu).any.parts[0].diameter,
              2.0 * c * std::sin(1.8 * pi / 4), 1e-18);
  const RestSet wide = rest_in_bearing(c, {at(0.3), at(1.3)}, mu).any;
  ASSERT_EQ(wide.parts.size(), 1u);
  EXPECT_NEAR(wide.parts[0].angle, 0.9 * pi + 1.0, 1e-14);
  EXPECT_NEAR(wide.parts[0].diameter, 2.0 * c, 1e-18);
}

TEST(RestInSocket, Cap) {
  for (const double mu : {1e-3, 0.3, 2.0}) {
    const RestSet set = rest_in_socket(c, {{1.0, -2.0, 0.5}}, mu).any;
    const double phi = std::atan(mu);
    ASSERT_EQ(set.parts.size(), 1u);
    EXPECT_NEAR(set.parts[0].angle, 2.0 * phi, 1e-15);
    EXPECT_NEAR(set.area / (4.0 * pi * c * c * std::pow(std::sin(0.5 * phi), 2)), 1.0, 1e-14);
    EXPECT_NEAR(set.diameter, 2.0 * c * std::sin(phi), 1e-18);
    EXPECT_NEAR((set.farthest[0] - set.farthest[1]).norm(), set.diameter, 1e-18);
    EXPECT_NEAR(set.farthest[0].norm(), c, 1e-18);
  }
  EXPECT_EQ(rest_in_socket(c, {{0, 0, 1}}, 0.0).any.area, 0.0);
  EXPECT_EQ(rest_in_socket(c, {{0, 0, 1}, {0, 0, 3}}, 0.0).all.parts.size(), 0u + 1u);
  EXPECT_EQ(rest_in_socket(c, {{0, 0, 1}, {0, 1, 3}}, 0.0).all.parts.size(), 0u);
  EXPECT_EQ(rest_in_socket(c, {{0, 0, 1}, {0, 1, 3}}, 0.0).any.parts.size(), 2u);
}

/// Area of the intersection of two caps on the unit sphere, with angular radius a and angular
/// distance g.
double two_caps(double a, double g) {
  // Area by spherical excess: two sectors minus the kite between cap axes and corners of the lens.
  const double half = std::acos(std::tan(0.5 * g) / std::tan(a));          // at the axis
  const double corner = 2.0 * std::asin(std::sin(0.5 * g) / std::sin(a));  // at the corner
  const double sectors = 2.0 * half * 2.0 * (1.0 - std::cos(a));
  return sectors - (2.0 * (2.0 * half) + 2.0 * corner - 2.0 * pi);
}

TEST(RestInSocket, TwoForcesAtBeta) {
  const double mu = 0.5, phi = std::atan(mu);
  for (const double beta : {0.01, 0.3, 0.9}) {
    const RestStudy study =
        rest_in_socket(c, {{0, 0, 2}, {3 * std::sin(beta), 0, 3 * std::cos(beta)}}, mu);
    const double common = two_caps(phi, beta) * c * c;
    const double cap = study.each[0].area;
    EXPECT_NEAR(study.all.area, common, 1e-13 * cap);
    EXPECT_NEAR(study.any.area, 2.0 * cap - common, 1e-13 * cap);
    // The corners of the lens are its farthest points. Their distance has a closed form.
    const double corner = std::acos(std::cos(phi) / std::cos(0.5 * beta));
    EXPECT_NEAR(study.all.diameter, 2.0 * c * std::sin(corner), 1e-17);
    EXPECT_NEAR(study.any.diameter, 2.0 * c * std::sin(0.5 * beta + phi), 1e-17);
    EXPECT_EQ(study.any.parts.size(), 1u);
  }
  const RestStudy apart = rest_in_socket(c, {{0, 0, 1}, {1, 0, 0}}, mu);
  EXPECT_TRUE(apart.all.parts.empty());
  EXPECT_EQ(apart.any.parts.size(), 2u);
  EXPECT_NEAR(apart.any.area, 2.0 * apart.each[0].area, 1e-20);
  // Each part is a separate cap, whose size does not depend on the other one.
  for (const RestComponent& part : apart.any.parts) {
    EXPECT_NEAR(part.angle, 2.0 * phi, 1e-15);
    EXPECT_NEAR(part.diameter, 2.0 * c * std::sin(phi), 1e-18);
  }
}

TEST(RestInSocket, ManyForcesAgainstCounting) {
  // Two cases: a ring of caps, whose union has a hole, and three close caps that all intersect.
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  std::vector<Vector3d> ring, near = {{0.1, 0, 1}, {-0.1, 0.12, 1}, {0.02, -0.15, 1}};
  for (int i = 0; i < 10; ++i)
    ring.push_back({std::cos(0.2 * pi * i), std::sin(0.2 * pi * i), 0.9});
  for (const auto& forces : {ring, near}) {
    const RestStudy study = rest_in_socket(1.0, forces, 0.4);
    int any = 0, all = 0;
    const int n = 400000;
    for (int i = 0; i < n; ++i) {
      const Vector3d x = Vector3d(normal(random), normal(random), normal(random)).normalized();
      int held = 0;
      for (const Vector3d& f : forces) {
        held += std::atan2(f.cross(x).norm(), f.dot(x)) <= std::atan(0.4);
      }
      any += held > 0;
      all += held == static_cast<int>(forces.size());
    }
    EXPECT_NEAR(study.any.area, 4.0 * pi * any / n, 0.02);
    EXPECT_NEAR(study.all.area, 4.0 * pi * all / n, 0.01);
    EXPECT_EQ(study.any.parts.size(), 1u);
  }
}

TEST(RestInBore, Band) {
  const double mu = 0.3, b = 3e-4;
  for (const double t : {0.0, 0.1, -0.29}) {
    const RestSet set = rest_in_bore(c, b, {{6.0, 8.0, 10.0 * t}}, mu).any;
    ASSERT_EQ(set.parts.size(), 1u);
    const double half = std::acos(std::sqrt((1.0 + t * t) / (1.0 + mu * mu)));
    EXPECT_NEAR(set.area, 2.0 * b * c * 2.0 * half, 1e-20);
  }
  // For a force perpendicular to the axis, the friction of the rims themselves extends the arcs on
  // the rims.
  const RestSet across = rest_in_bore(c, b, {{1.0, 0.0, 0.0}}, mu).any;
  EXPECT_NEAR(across.parts[0].area, 4.0 * b * c * std::atan(mu), 1e-20);
  EXPECT_GE(across.diameter, std::hypot(2.0 * c * std::sin(std::atan(mu)), 2.0 * b));
  ASSERT_EQ(across.parts[0].rims.size(), 2u);
  double beyond = 0.0;
  for (const auto& rim : across.parts[0].rims) {
    ASSERT_GE(rim.size(), 2u);
    // The points lie on the arc. Chords of 1/60 rad are shorter than the arc by a factor of 2e-5 at
    // most.
    double along = 0.0;
    for (std::size_t i = 1; i < rim.size(); ++i) along += (rim[i] - rim[i - 1]).norm();
    const double turned = 2.0 * std::asin(0.5 * (rim.back() - rim.front()).norm() / c);
    EXPECT_NEAR(along, c * turned, 1e-4 * c * turned);
    beyond += c * (turned - 2.0 * std::atan(mu));
    const double height = rim.front().z();
    EXPECT_EQ(std::abs(height), b);
    for (const Vector3d& point : rim) {
      EXPECT_EQ(point.z(), height);
      EXPECT_NEAR(point.head<2>().norm(), c, 1e-19);
    }
    // At least as wide as the arc of the wall.
    EXPECT_GE((rim.back() - rim.front()).norm(), 2.0 * c * std::sin(std::atan(mu)) - 1e-19);
  }
  EXPECT_NEAR(across.length, beyond, 1e-14 * c);
  EXPECT_EQ(across.parts[0].rims[0][0].z(), -across.parts[0].rims[1][0].z());
}

/// Returns whether F is the sum of two forces within two friction cones, found by trying many
/// combinations.
bool by_trial(const Vector3d& f, const Vector3d& a, const Vector3d& b, double mu) {
  const Vector3d w = a.cross(b);
  for (int i = 0; i <= 60; ++i) {
    for (int j = 0; j <= 60; ++j) {
      for (int k = 1; k <= 60; ++k) {
        const double n = 0.05 * k * f.norm(), r = n * mu * j / 60.0, angle = 2.0 * pi * i / 60.0;
        const Vector3d rest = f - n * a - r * (std::cos(angle) * b + std::sin(angle) * w);
        const double normal = rest.dot(b);
        if (normal >= 0.0 && (rest - normal * b).norm() <= mu * normal) return true;
      }
    }
  }
  return false;
}

TEST(RestInBore, RimByTrial) {
  const double mu = 0.4, b = 2e-4;
  for (const double fz : {-0.2, 0.3, 0.9, 1.5}) {
    const Vector3d force(1.0, 0.0, fz);
    const RestSet set = rest_in_bore(c, b, {force}, mu).any;
    ASSERT_EQ(set.parts.size(), 1u);
    // The angle of a part is that of its widest arc, which lies on the rim that F points to.
    const double half = 0.5 * set.parts[0].angle;
    const double sign = fz > 0 ? 1.0 : -1.0;
    const auto held = [&](double phi) {
      const Vector3d e(std::cos(phi), std::sin(phi), 0.0);
      return by_trial(force, e, sign * Vector3d::UnitZ(), mu);
    };
    EXPECT_TRUE(held(half - 0.08)) << fz;
    EXPECT_FALSE(held(half + 0.02)) << fz;
  }
}

TEST(RestInBore, Shoulder) {
  const double b = 2e-4;
  const RestSet pushed = rest_in_bore(c, b, {{0.1, 0.0, 1.0}}, 0.3).any;
  ASSERT_EQ(pushed.parts.size(), 1u);
  EXPECT_NEAR(pushed.area, pi * c * c, 1e-22);
  EXPECT_NEAR(pushed.diameter, 2.0 * c, 1e-18);
  // Without friction, a force with radial and axial components has one rest position, the corner.
  const RestSet corner = rest_in_bore(c, b, {{1.0, 0.0, 1.0}}, 0.0).any;
  ASSERT_EQ(corner.parts.size(), 1u);
  EXPECT_EQ(corner.area + corner.length + corner.diameter, 0.0);
  EXPECT_NEAR((corner.parts[0].representative - Vector3d(c, 0, b)).norm(), 0.0, 1e-18);
  // Without friction, a force perpendicular to the axis has a line of rest positions, as long as
  // the bore.
  const RestSet line = rest_in_bore(c, b, {{1.0, 0.0, 0.0}}, 0.0).any;
  ASSERT_EQ(line.parts.size(), 1u);
  EXPECT_NEAR(line.length, 2.0 * b, 1e-18);
  EXPECT_NEAR(line.diameter, 2.0 * b, 1e-18);
  EXPECT_EQ(line.area, 0.0);
}

TEST(RestInBore, TwoForces) {
  const double mu = 0.3, phi = std::atan(mu), b = 2e-4, beta = 0.2;
  const RestStudy study =
      rest_in_bore(c, b, {{1.0, 0.0, 0.0}, {std::cos(beta), std::sin(beta), 0.0}}, mu);
  EXPECT_NEAR(study.all.area, 2.0 * b * c * (2.0 * phi - beta), 1e-20);
  EXPECT_NEAR(study.any.area, 2.0 * b * c * (2.0 * phi + beta), 1e-20);
}

TEST(RestSets, Refusals) {
  const Argument none("size of forces[1]", 0);
  EXPECT_EQ(refused_argument([] { rest_in_bearing(c, {at(0), {0, 0}}, 0.3); }), none);
  EXPECT_EQ(refused_argument([] { rest_in_slot(c, {{1, 0, 0}, {0, 0, 0}}, 0.3); }), none);
  EXPECT_EQ(refused_argument([] { rest_in_bore(c, c, {{1, 0, 0}, {0, 0, 0}}, 0.3); }), none);
  EXPECT_EQ(refused_argument([] { rest_in_socket(c, {{1, 0, 0}, {0, 0, 0}}, 0.3); }), none);
  for (const std::function<void()>& call :
       std::vector<std::function<void()>>{[] {
                                            rest_in_slot(c, {{1, 0, 0}}, -0.1);
                                          },
                                          [] { rest_in_bearing(c, {at(0)}, -0.1); },
                                          [] {
                                            rest_in_socket(c, {{1, 0, 0}}, -0.1);
                                          },
                                          [] {
                                            rest_in_bore(c, c, {{1, 0, 0}}, -0.1);
                                          }}) {
    EXPECT_EQ(refused_argument(call), Argument("mu", -0.1));
  }
  EXPECT_EQ(refused_argument([] {
              rest_in_socket(0.0, {{1, 0, 0}}, 0.1);
            }),
            Argument("clearance", 0));
  EXPECT_EQ(refused_argument([] {
              rest_in_bore(c, -1.0, {{1, 0, 0}}, 0.1);
            }),
            Argument("axial_play", -1));
  EXPECT_EQ(refused_argument([] { rest_in_bearing(c, {}, 0.1); }), Argument("number of forces", 0));
  EXPECT_EQ(refused_argument([] {
              rest_in_bearing(c, {{NAN, 0}}, 0.1);
            }),
            Argument("size of forces[0]", NAN));
}

}  // namespace
}  // namespace statejump::rest_set
