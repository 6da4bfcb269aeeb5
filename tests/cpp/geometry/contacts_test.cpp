// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/Geometry>
#include <algorithm>

#include "statejump/kernel/joint_kinematics.hpp"
#include "support.hpp"

namespace statejump::geometry {
namespace {

using testing::bearing_radius;
using testing::journal_radius;
using testing::pi;
using testing::Random;
using testing::round_bore;
using testing::Vector3d;

const Vector3d z_axis = Vector3d::UnitZ();

BoreShape lobed(int harmonic, double amplitude, double phase) {
  BoreShape shape = round_bore();
  shape.lobes = {{harmonic, amplitude, phase}};
  return shape;
}

/// Local minima of the distance between a centre and the section of a shape, by brute force.
std::vector<double> brute_minima(const BoreShape& shape, const Vector3d& centre) {
  const int count = 20000;
  const auto distance = [&](double theta) {
    const double r = bore_radius(shape, theta, centre.z());
    return std::hypot(r * std::cos(theta) - centre.x(), r * std::sin(theta) - centre.y());
  };
  std::vector<double> minima;
  const double step = 2 * pi / count;
  for (int i = 0; i < count; ++i) {
    const double a = distance((i - 1) * step), b = distance(i * step), c = distance((i + 1) * step);
    if (b < a && b <= c) {
      const double shift = 0.5 * (a - c) / (a - 2 * b + c);
      minima.push_back(distance((i + shift) * step));
    }
  }
  std::sort(minima.begin(), minima.end());
  return minima;
}

TEST(BoreContacts, RoundBoreIsTheAnalyticJoint) {
  const BoreMesh mesh(bore_triangles(round_bore(), 200, 10));
  Random random;
  for (int i = 0; i < 500; ++i) {
    const double eccentricity = random.uniform(0.5e-4, 1.2e-4), angle = random.uniform(-4, 4);
    const Vector3d centre(eccentricity * std::cos(angle), eccentricity * std::sin(angle),
                          random.uniform(-4.9e-3, 4.9e-3));
    const kernel::BodyMotion journal{centre, Vector3d::Zero(), Vector3d::Zero()};
    const kernel::BodyMotion bearing{Vector3d::Zero(), Vector3d::Zero(), Vector3d::Zero()};
    const auto exact =
        kernel::revolute_contact(journal, journal_radius, bearing, bearing_radius, z_axis);
    const auto found =
        mesh.contacts(centre, i % 2 ? z_axis : Vector3d(-3 * z_axis), journal_radius, 6e-5);
    ASSERT_EQ(found.size(), 1u) << i;
    EXPECT_NEAR(found[0].depth, exact.penetration_depth, 1e-12);
    EXPECT_NEAR((found[0].normal - exact.normal).norm(), 0, 1e-5);
    EXPECT_NEAR(found[0].section_curvature, -1 / bearing_radius, 1e-5 / bearing_radius);
    // The radius is larger at both ends, so the wall is convex along the axis.
    EXPECT_NEAR(found[0].axial_curvature, 0, 1e-5 / bearing_radius);
    EXPECT_EQ(found[0].previous, -1);
    EXPECT_TRUE(mesh.contacts(centre, z_axis, journal_radius, 0).empty() ==
                (exact.penetration_depth <= 0));
  }
}

TEST(BoreContacts, ConcentricJournalInARoundBoreTouchesOnce) {
  const BoreMesh mesh(bore_triangles(round_bore(), 200, 10));
  EXPECT_TRUE(mesh.contacts(Vector3d::Zero(), z_axis, journal_radius, 0.99e-4).empty());
  EXPECT_EQ(mesh.contacts(Vector3d::Zero(), z_axis, journal_radius, 1.01e-4).size(), 1u);
}

TEST(BoreContacts, ThreeLobesTouchThrice) {
  const BoreMesh mesh(bore_triangles(lobed(3, 1e-5, 0.3), 240, 10));
  // The smallest radius R - a occurs at three angles.
  const double smallest = bearing_radius - 1e-5;
  EXPECT_TRUE(mesh.contacts(Vector3d::Zero(), z_axis, smallest - 1e-8, 0).empty());
  const auto found = mesh.contacts(Vector3d::Zero(), z_axis, smallest + 1e-7, 0);
  ASSERT_EQ(found.size(), 3u);
  for (const auto& contact : found) {
    EXPECT_NEAR(contact.depth, 1e-7, 1e-11);
    const double angle = std::atan2(contact.point.y(), contact.point.x()) - 0.3;
    EXPECT_NEAR(std::cos(3 * angle), -1, 1e-9);
    // Wall r = R + a cos(3t): curvature (r - 9 a)/r^2 at the minimum of r; concave, so it is
    // negative here.
    const double r = smallest;
    EXPECT_NEAR(contact.section_curvature, -(r - 9e-5) / (r * r), 1e-4 / r);
  }
}

TEST(BoreContacts, AllMinimaOfLobedBoresAreFound) {
  Random random;
  int several = 0;
  for (const int harmonic : {2, 3, 4, 5, 9}) {
    const BoreShape shape = lobed(harmonic, 1e-5, 0.3);
    const BoreMesh mesh(bore_triangles(shape, 360, 8));
    for (int i = 0; i < 100; ++i) {
      const double eccentricity = random.uniform(0, 3e-5), angle = random.uniform(-4, 4);
      const Vector3d centre(eccentricity * std::cos(angle), eccentricity * std::sin(angle), 1e-3);
      const auto expected = brute_minima(shape, centre);
      const double gap = 1e-3;
      auto found = mesh.contacts(centre, z_axis, journal_radius, gap);
      // Two minima that are about to merge may count as one, because the rise between them is below
      // the prominence.
      ASSERT_EQ(found.size(), expected.size()) << harmonic << " " << i;
      several += found.size() > 1;
      for (std::size_t k = 0; k < found.size(); ++k)
        EXPECT_NEAR(journal_radius - found[k].depth, expected[k], 1e-10);
    }
  }
  EXPECT_GT(several, 200);
}

TEST(BoreContacts, TwoContactsAndTheirContinuation) {
  const BoreShape shape = lobed(3, 1e-5, 0.3);
  const BoreMesh mesh(bore_triangles(shape, 240, 10));
  // A journal that is pressed towards the widest point of a lobe touches both flanks.
  const Vector3d way(std::cos(0.3), std::sin(0.3), 0);
  std::vector<BoreContact> last;
  for (int step = 0; step < 50; ++step) {
    const Vector3d side(-way.y(), way.x(), 0);
    const Vector3d centre = 0.985e-4 * way + (step - 25) * 2e-8 * side;
    const auto found = mesh.contacts(centre, z_axis, journal_radius, 2e-5, last);
    ASSERT_EQ(found.size(), brute_minima(shape, centre).size());
    if (step > 0)
      for (const auto& contact : found) {
        ASSERT_GE(contact.previous, 0);
        EXPECT_LT((contact.point - last[contact.previous].point).norm(), 2e-4);
      }
    last = found;
  }
}

TEST(BoreContacts, TiltedJournalInATaperedBoreSeesItsSection) {
  BoreShape shape = round_bore();
  shape.crown = 5e-5;
  const BoreMesh mesh(bore_triangles(shape, 240, 30));
  const double tilt = 0.02;
  const Vector3d axis(std::sin(tilt), 0, std::cos(tilt));
  const Vector3d centre(9.9e-5, 2e-5, 2e-3);
  const auto found = mesh.contacts(centre, axis, journal_radius, 1e-4);
  ASSERT_EQ(found.size(), 1u);
  // Reference by brute force in the plane of the section.
  double nearest = 1;
  const Vector3d across(std::cos(tilt), 0, -std::sin(tilt));
  for (int i = 0; i < 20000; ++i) {
    const double t = 2 * pi * i / 20000;
    const Vector3d u = std::cos(t) * across + std::sin(t) * Vector3d::UnitY();
    double low = 4e-3, high = 6e-3;
    for (int k = 0; k < 60; ++k) {
      const double s = 0.5 * (low + high);
      const Vector3d p = centre + s * u;
      (std::hypot(p.x(), p.y()) < bore_radius(shape, 0, p.z()) ? low : high) = s;
    }
    nearest = std::min(nearest, low);
  }
  EXPECT_NEAR(journal_radius - found[0].depth, nearest, 1e-10);
  EXPECT_NEAR(found[0].normal.dot(axis), 0, 1e-15);
  // The radius is larger at both ends, so the wall is convex along the axis.
  EXPECT_NEAR(found[0].axial_curvature, 2 * 5e-5 / 25e-6, 0.02 * 4);
}

TEST(BoreContacts, OutsideTheBoreThereIsNone) {
  const BoreMesh mesh(bore_triangles(round_bore(), 60, 4));
  EXPECT_TRUE(mesh.contacts({1.01e-4, 0, 5.5e-3}, z_axis, journal_radius, 0).empty());
}

TEST(BallContacts, SphericalSocket) {
  BoreOptions options;
  options.kind = SurfaceKind::socket;
  const double socket = 8.05e-3, ball = 8e-3;
  const BoreMesh mesh(socket_triangles(socket, 1.4, 200, 80), options);
  EXPECT_NEAR(mesh.mean_radius(), socket, 1e-15);
  EXPECT_NEAR((mesh.axis() - z_axis).norm(), 0, 1e-12);
  Random random;
  for (int i = 0; i < 100; ++i) {
    const double polar = random.uniform(1.6, pi), angle = random.uniform(-4, 4);
    const Vector3d way(std::sin(polar) * std::cos(angle), std::sin(polar) * std::sin(angle),
                       std::cos(polar));
    const auto found = mesh.ball_contacts(5.1e-5 * way, ball, 1e-8);
    ASSERT_EQ(found.size(), 1u) << i;
    EXPECT_NEAR(found[0].depth, 1e-6, 1e-10);
    EXPECT_NEAR((found[0].normal - way).norm(), 0, 1e-3);
    EXPECT_NEAR(found[0].curvature_1, -1 / socket, 2e-3 / socket);
    EXPECT_NEAR(found[0].curvature_2, -1 / socket, 2e-3 / socket);
  }
  EXPECT_TRUE(mesh.ball_contacts(5.1e-5 * z_axis, ball, 0).empty());
}

TEST(BallContacts, BallInALobedBore) {
  const BoreShape shape = lobed(3, 1e-5, 0.3);
  const BoreMesh mesh(bore_triangles(shape, 240, 20));
  const auto found = mesh.ball_contacts({0, 0, 1e-3}, bearing_radius - 1e-5 + 1e-7, 0);
  ASSERT_EQ(found.size(), 3u);
  for (const auto& contact : found) {
    EXPECT_NEAR(contact.depth, 1e-7, 1e-11);
    EXPECT_NEAR(contact.point.z(), 1e-3, 1e-6);
  }
}

TEST(BallContacts, BetweenTheSamplesOfAWall) {
  // The samples of the search grid are far apart in a long bore, also compared with a thin journal
  // or a small ball.
  const BoreShape shapes[] = {round_bore(), {bearing_radius, 100e-3}};
  for (const BoreShape& shape : shapes) {
    const BoreMesh mesh(bore_triangles(shape, 120, 40));
    for (const double share : {0.02, 0.3, 0.98})
      for (int i = 0; i < 60; ++i) {
        const double radius = share * bearing_radius, depth = 1e-3 * radius;
        const double angle = 0.37 * i, z = shape.length * (i / 60.0 - 0.49);
        const Vector3d way(std::cos(angle), std::sin(angle), 0);
        const Vector3d centre = (bearing_radius - radius + depth) * way + z * z_axis;
        for (const auto& found :
             {mesh.ball_contacts(centre, radius, 0), mesh.contacts(centre, z_axis, radius, 0)}) {
          ASSERT_EQ(found.size(), 1u) << "length " << shape.length << " radius " << radius;
          EXPECT_NEAR(found[0].depth, depth, 1e-8);
          EXPECT_NEAR((found[0].normal - way).norm(), 0, 1e-3);
        }
      }
  }
}

TEST(BoreContacts, AtTheEndOfAWallThatNarrowsThere) {
  Triangles wall = bore_triangles(round_bore(), 120, 40);
  for (Vector3d& v : wall.vertices) {
    const double down = std::max(0.0, -v.z() / 5e-3);
    v.head<2>() *= 1 - 0.1 * down * down;
  }
  const BoreMesh mesh(wall);
  const double narrowest = 0.9 * bearing_radius;
  const auto found = mesh.contacts({0, 0, -5e-3}, z_axis, narrowest + 1e-7, 0);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_NEAR(found[0].depth, 1e-7, 1e-9);
  EXPECT_TRUE(mesh.contacts({0, 0, -5e-3}, z_axis, narrowest - 1e-7, 0).empty());
}

TEST(BallContacts, OnePlaceIsOneContact) {
  // If the rows of the search grid are much closer than its columns, an oblique valley of the
  // distance shows two minima.
  BoreShape shape{bearing_radius, 5e-3};
  shape.lobes = {{8, 1e-4, 0.3}, {7, 6e-5, 1.1}};
  const BoreMesh mesh(bore_triangles(shape, 150, 5));
  Random random;
  for (int i = 0; i < 500; ++i) {
    const double radius = random.uniform(0.1, 0.95) * bearing_radius, angle = random.uniform(0, 7);
    const double off = random.uniform(0.5, 1) * (bearing_radius - radius);
    const Vector3d centre(off * std::cos(angle), off * std::sin(angle),
                          random.uniform(-0.4, 0.4) * shape.length);
    const auto found = mesh.ball_contacts(centre, radius, 0.5 * bearing_radius);
    for (std::size_t a = 0; a < found.size(); ++a)
      for (std::size_t b = 0; b < a; ++b)
        EXPECT_GT((found[a].point - found[b].point).norm(), 1e-4 * bearing_radius) << i;
  }
}

}  // namespace
}  // namespace statejump::geometry
