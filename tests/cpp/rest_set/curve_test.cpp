// SPDX-License-Identifier: GPL-3.0-or-later
#include "statejump/rest_set/curve.hpp"
#include "../support/argument.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <functional>
#include <stdexcept>
#include <string>
#include <utility>

namespace statejump::rest_set {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using statejump::testing::Argument;
using statejump::testing::refused_argument;

constexpr double pi = 3.14159265358979323846;
constexpr double c = 1e-4;

std::vector<Curve> circle(int cells) {
  return implicit_curves([](const Vector2d& p) { return p.squaredNorm() - c * c; },
                         [](const Vector2d& p) -> Vector2d { return 2.0 * p; },
                         Vector2d(-1.3e-4, -1.2e-4), Vector2d(1.25e-4, 1.4e-4), cells);
}

double angle_to(const Vector3d& p, double direction) {
  return std::abs(std::remainder(std::atan2(p.y(), p.x()) - direction, 2.0 * pi));
}

TEST(RestOnCurve, ImplicitCircleIsTheClearanceCircle) {
  const auto curves = circle(40);
  ASSERT_EQ(curves.size(), 1u);
  ASSERT_TRUE(curves[0].closed);
  for (const double mu : {0.001, 0.3, 3.0}) {
    for (const double direction : {0.0, 0.7, 3.1, -2.0}) {
      const Vector2d force(std::cos(direction), std::sin(direction));
      const RestSet set = rest_on_curves(curves, {5.0 * force}, mu).any;
      ASSERT_EQ(set.parts.size(), 1u);
      const RestComponent& part = set.parts[0];
      EXPECT_NEAR(angle_to(part.points.front(), direction), std::atan(mu), 1e-12);
      EXPECT_NEAR(angle_to(part.points.back(), direction), std::atan(mu), 1e-12);
      for (const Vector3d& point : part.points) EXPECT_EQ(point.z(), 0.0);
      EXPECT_NEAR(set.length / (2.0 * c * std::atan(mu)), 1.0, 1e-5);
      EXPECT_NEAR(set.diameter / (2.0 * c * std::sin(std::atan(mu))), 1.0, 1e-11);
    }
  }
}

TEST(RestOnCurve, LengthIsOfFourthOrder) {
  double before = 0.0;
  std::printf("cells  relative error of the arc's length\n");
  for (const int cells : {10, 20, 40, 80, 160}) {
    const double length = rest_on_curves(circle(cells), {Vector2d(1.0, 0.3)}, 1.0).any.length;
    const double error = std::abs(length / (0.5 * pi * c) - 1.0);
    std::printf("%5d  %.3e\n", cells, error);
    if (before > 1e-12) {
      EXPECT_LT(error, before / 10.0);
    }
    before = error;
  }
}

TEST(RestOnCurve, WithoutFrictionIsolatedPoints) {
  const auto curves = circle(40);
  for (const double direction : {0.0, 1.0, 0.5 * pi, 4.0}) {
    const Vector2d force(std::cos(direction), std::sin(direction));
    const RestSet set = rest_on_curves(curves, {force}, 0.0).any;
    ASSERT_EQ(set.parts.size(), 1u) << direction;
    EXPECT_EQ(set.length, 0.0);
    EXPECT_NEAR(angle_to(set.parts[0].representative, direction), 0.0, 1e-12);
  }
}

TEST(RestOnCurve, ThreeNodes) {
  // The normal N rotates by 2 pi / 3 between nodes, also across the angle pi.
  Curve coarse;
  coarse.closed = true;
  coarse.at = [](double t) {
    const double angle = 2.0 * pi * t / 3.0;
    const Vector2d e(std::cos(angle), std::sin(angle));
    return CurvePoint{c * e, -e};
  };
  for (int i = 0; i < 3; ++i) coarse.nodes.push_back(coarse.at(i));
  for (int i = 0; i < 40; ++i) {
    const double direction = 0.16 * i - pi;
    const Vector2d force(std::cos(direction), std::sin(direction));
    const RestSet set = rest_on_curves({coarse}, {force}, 8.0).any;
    ASSERT_EQ(set.parts.size(), 1u) << direction;
    EXPECT_NEAR(angle_to(set.parts[0].points.front(), direction), std::atan(8.0), 1e-12);
    EXPECT_NEAR(angle_to(set.parts[0].points.back(), direction), std::atan(8.0), 1e-12);
  }
}

TEST(RestOnCurve, TwoForces) {
  const auto curves = circle(60);
  const double phi = std::atan(0.3);
  for (const double beta : {0.2, 0.5, 0.7}) {
    const RestStudy study = rest_on_curves(curves, {{1, 0}, {std::cos(beta), std::sin(beta)}}, 0.3);
    const double common = std::max(0.0, 2.0 * phi - beta);
    EXPECT_NEAR(study.all.length, c * common, 1e-6 * c);
    EXPECT_NEAR(study.any.length, c * (4.0 * phi - common), 1e-5 * c);
    EXPECT_EQ(study.any.parts.size(), common > 0.0 ? 1u : 2u);
  }
}

/// Number of parts and length of the rest set of a lobed bore under `force`, counted in fine steps.
std::pair<int, double> counted(double eps, const Vector2d& force, double mu) {
  const int n = 200000;
  const Curve curve = lobed_curve(c, eps, 3);
  int parts = 0;
  double length = 0.0;
  bool before = false;
  Vector2d last = curve.at(-1e-9 + 720).position;
  for (int i = 0; i <= n; ++i) {
    const CurvePoint p = curve.at(720.0 * i / n);
    const double across = std::abs(p.normal.x() * force.y() - p.normal.y() * force.x());
    const bool now = across <= mu * -p.normal.dot(force);
    if (now && !before && i > 0) ++parts;
    if (now && i > 0) length += (p.position - last).norm();
    last = p.position;
    before = now;
  }
  return {parts, length};
}

TEST(RestOnCurve, LobedBore) {
  // Bore 1 + 9 eps cos 3 theta: convex up to eps = 0.1, where the crests are just flat.
  const Vector2d to_crest(-1.0, 0.0);
  for (const double eps : {0.05, 0.1, 0.2, 0.3}) {
    for (const double mu : {0.02, 0.1, 0.5}) {
      const RestSet set = rest_on_curves({lobed_curve(c, eps, 3)}, {to_crest}, mu).any;
      const auto [parts, length] = counted(eps, to_crest, mu);
      EXPECT_EQ(static_cast<int>(set.parts.size()), parts) << eps << " " << mu;
      // Counting locates both ends of a part to one step of about 4e-9 m.
      EXPECT_NEAR(set.length, length, 8e-9 * parts) << eps << " " << mu;
      std::printf("eps %.2f mu %.2f: %zu parts, length %.4f um, diameter %.4f um\n", eps, mu,
                  set.parts.size(), 1e6 * set.length, 1e6 * set.diameter);
    }
  }
  EXPECT_EQ(rest_on_curves({lobed_curve(c, 0.2, 3)}, {to_crest}, 0.02).any.parts.size(), 3u);
  EXPECT_EQ(rest_on_curves({lobed_curve(c, 0.2, 3)}, {to_crest}, 0.0).any.parts.size(), 3u);
  EXPECT_EQ(rest_on_curves({lobed_curve(c, 0.2, 3)}, {to_crest}, 0.5).any.parts.size(), 1u);
}

TEST(RestOnCurve, LobedCurveIsClosed) {
  // Without lobes the curve is a closed circle. Its first and last node is the point that the force
  // presses on.
  const Curve curve = lobed_curve(c, 0.0, 1);
  EXPECT_TRUE(curve.closed);
  const RestSet set = rest_on_curves({curve}, {Vector2d(1.0, 0.0)}, 0.3).any;
  ASSERT_EQ(set.parts.size(), 1u);
  EXPECT_NEAR(set.length, 2.0 * c * std::atan(0.3), 1e-9 * c);
}

TEST(RestOnCurve, FarthestPairOfOppositeArcsIsADiameter) {
  // The farthest pair of points lies between nodes, so the search along both arcs has to find it.
  const auto curves = circle(11);
  for (const double direction : {0.1, 0.7, 1.3}) {
    const Vector2d force(std::cos(direction), std::sin(direction));
    const RestSet set = rest_on_curves(curves, {force, -force}, 0.4).any;
    EXPECT_NEAR(set.diameter, 2.0 * c, 1e-10 * c);
    EXPECT_NEAR((set.farthest[0] - set.farthest[1]).norm(), set.diameter, 1e-14 * c);
  }
}

TEST(RestOnCurve, LobedCurveAsImplicitFunction) {
  const double eps = 0.2;
  const auto gamma = [eps](const Vector2d& p) {
    return p.norm() - c * (1.0 + eps * std::cos(3.0 * std::atan2(p.y(), p.x())));
  };
  const auto gradient = [eps](const Vector2d& p) -> Vector2d {
    const double r = p.norm(), slope = 3.0 * c * eps * std::sin(3.0 * std::atan2(p.y(), p.x()));
    return p / r + slope / (r * r) * Vector2d(-p.y(), p.x());
  };
  const auto curves =
      implicit_curves(gamma, gradient, Vector2d(-1.5e-4, -1.5e-4), Vector2d(1.5e-4, 1.5e-4), 200);
  ASSERT_EQ(curves.size(), 1u);
  const RestSet one = rest_on_curves(curves, {Vector2d(-1.0, 0.1)}, 0.05).any;
  const RestSet two = rest_on_curves({lobed_curve(c, eps, 3)}, {Vector2d(-1.0, 0.1)}, 0.05).any;
  ASSERT_EQ(one.parts.size(), two.parts.size());
  EXPECT_NEAR(one.length, two.length, 1e-6 * c);
  EXPECT_NEAR(one.diameter, two.diameter, 1e-10 * c);
}

TEST(RestOnCurve, CurveThatLeavesTheBox) {
  // The domain is y > 0 above a floor. Under a downward force every point of the floor is a rest
  // position.
  const auto floor = implicit_curves([](const Vector2d& p) { return -p.y(); },
                                     [](const Vector2d&) -> Vector2d {
                                       return {0.0, -1.0};
                                     },
                                     Vector2d(-1.0, -0.7), Vector2d(2.0, 1.0), 30);
  ASSERT_EQ(floor.size(), 1u);
  EXPECT_FALSE(floor[0].closed);
  EXPECT_NEAR(rest_on_curves(floor, {Vector2d(0.1, -1.0)}, 0.2).any.length, 3.0, 1e-12);
  EXPECT_TRUE(rest_on_curves(floor, {Vector2d(0.3, -1.0)}, 0.2).any.parts.empty());
  EXPECT_TRUE(rest_on_curves(floor, {Vector2d(0.0, 1.0)}, 0.2).any.parts.empty());
}

TEST(RestOnCurve, CurveThatComesBackToTheSideItEntersByIsOnePiece) {
  // Parabola x = y² with the free side to the right. The curve enters and leaves the box at x = 1;
  // its middle is farthest from that side.
  const auto curves = implicit_curves([](const Vector2d& p) { return p.y() * p.y() - p.x(); },
                                      [](const Vector2d& p) -> Vector2d {
                                        return {-1.0, 2.0 * p.y()};
                                      },
                                      Vector2d(-0.53, -2.0), Vector2d(1.0, 2.0), 80);
  ASSERT_EQ(curves.size(), 1u);
  EXPECT_FALSE(curves[0].closed);
  for (const CurvePoint* end : {&curves[0].nodes.front(), &curves[0].nodes.back()}) {
    EXPECT_NEAR(end->position.x(), 1.0, 1e-12);
    EXPECT_NEAR(std::abs(end->position.y()), 1.0, 1e-12);
  }
}

TEST(RestOnCurve, PointsOfTheGridOnTheCurveAreOneNodeEach) {
  // The line is a diagonal through grid points. There the roots on both grid lines are the same
  // point.
  const auto curves = implicit_curves([](const Vector2d& p) { return p.x() - p.y(); },
                                      [](const Vector2d&) -> Vector2d {
                                        return {1.0, -1.0};
                                      },
                                      Vector2d(-1.0, -1.0), Vector2d(1.0, 1.0), 10);
  ASSERT_EQ(curves.size(), 1u);
  EXPECT_EQ(curves[0].nodes.size(), 11u);
}

TEST(JournalInProfile, RoundBoreGivesTheClearanceCircle) {
  const Curve curve = journal_in_profile([](double) { return 5.1e-3; }, 5e-3);
  for (const CurvePoint& p : curve.nodes) {
    EXPECT_NEAR(p.position.norm(), c, 1e-15);
    EXPECT_NEAR((p.normal + p.position.normalized()).norm(), 0.0, 1e-9);
  }
  const RestSet set = rest_on_curves({curve}, {Vector2d(1.0, 2.0)}, 0.3).any;
  EXPECT_NEAR(set.length, 2.0 * c * std::atan(0.3), 1e-9 * c);
}

TEST(JournalInProfile, LobesOfTheWall) {
  // If lobes are small compared with the radius, the centre's curve has the profile of the wall, to
  // first order.
  const double lobe = 1e-5;
  const auto rho = [lobe](double theta) { return 5.1e-3 + lobe * std::cos(3.0 * theta); };
  const Curve curve = journal_in_profile(rho, 5e-3);
  for (const CurvePoint& p : curve.nodes) {
    // No overlap anywhere, contact somewhere.
    double gap = 1.0;
    for (int i = 0; i < 20000; ++i) {
      const double theta = 2.0 * pi * i / 20000;
      const Vector2d wall = rho(theta) * Vector2d(std::cos(theta), std::sin(theta));
      gap = std::min(gap, (wall - p.position).norm() - 5e-3);
    }
    EXPECT_GT(gap, -1e-14);
    EXPECT_LT(gap, 1e-9);
  }
}

TEST(JournalInProfile, ShiftedRoundBore) {
  // For a circular bore about (d, 0), the centre's curve is the clearance circle about (d, 0).
  const double R = 5.1e-3, d = 3e-5;
  const auto rho = [=](double theta) {
    return d * std::cos(theta) + std::sqrt(R * R - std::pow(d * std::sin(theta), 2));
  };
  const Curve curve = journal_in_profile(rho, 5e-3);
  for (const CurvePoint& p : curve.nodes) {
    const Vector2d from = p.position - Vector2d(d, 0.0);
    EXPECT_NEAR(from.norm(), c, 1e-14);
    EXPECT_NEAR((p.normal + from.normalized()).norm(), 0.0, 1e-6);
  }
}

TEST(RestOnCurve, Refusals) {
  const auto one = [](const Vector2d&) { return 1.0; };
  const auto flat = [](const Vector2d&) -> Vector2d { return {0.0, 0.0}; };
  const Vector2d low(-1, -1), high(1, 1);
  EXPECT_EQ(refused_argument([&] { implicit_curves(one, flat, low, high, 10); }),
            Argument("number of curves gamma = 0 in the box", 0));
  EXPECT_EQ(refused_argument([&] { implicit_curves(one, flat, high, low, 10); }),
            Argument("high - low", -2));
  EXPECT_EQ(refused_argument([&] { implicit_curves(one, flat, low, high, 3); }),
            Argument("cells", 3));
  EXPECT_EQ(refused_argument([&] {
              implicit_curves([](const Vector2d& p) { return p.x(); }, flat, low, high, 11);
            }),
            Argument("size of the gradient of gamma on the curve", 0));
  EXPECT_EQ(refused_argument([&] { lobed_curve(c, 1.0, 3); }), Argument("amplitude", 1));
  EXPECT_EQ(refused_argument([&] { journal_in_profile([](double) { return 4e-3; }, 5e-3); }),
            Argument("rho(0.000000)", 0.004));
  for (const double radius : {-1.0, HUGE_VAL}) {
    EXPECT_EQ(refused_argument([&] { journal_in_profile([&](double) { return radius; }, 5e-3); }),
              Argument("rho(0.000000)", radius));
  }
  // The message names the angle at which the condition fails: a quarter turn.
  const auto dented = [](double theta) { return theta < 1.57 ? 5.1e-3 : 4e-3; };
  EXPECT_EQ(refused_argument([&] { journal_in_profile(dented, 5e-3); }),
            Argument("rho(1.570796)", 4e-3));
  EXPECT_EQ(refused_argument([&] {
              rest_on_curves({lobed_curve(c, 0.1, 3)}, {{0, 0}}, 0.1);
            }),
            Argument("size of forces[0]", 0));
}

}  // namespace
}  // namespace statejump::rest_set
