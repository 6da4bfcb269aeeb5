// SPDX-License-Identifier: GPL-3.0-or-later
#include "statejump/geometry/follow.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>

#include "support.hpp"

namespace statejump::geometry {
namespace {

using testing::bearing_radius;
using testing::journal_radius;
using testing::pi;
using testing::Random;
using testing::round_bore;
using testing::Vector3d;

constexpr double patch_angle = 2e-4;  // default of the plugin

struct Seen {
  std::array<int, 3> how{};  ///< numbers of steps by Followed
  int several = 0;           ///< number of steps with more than one contact
  int begun = 0;             ///< number of contacts that begin
  /// number of steps in which only one of the two methods finds a contact
  int lost = 0;
  double depth = 0, normal = 0, curvature = 0;  ///< largest differences: [m], [-], relative
};

/// Path of a journal or ball.
struct Walk {
  bool is_ball;
  double radius;   ///< [m]
  Vector3d start;  ///< initial position of the centre [m]
  double height;   ///< amplitude of the axial motion [m]
  int steps;
  double tilt = 0;  ///< amplitude of the tilt of a journal [rad]
};

/// Moves the centre at random speeds of 1e-9 to 1e-6 m per step, along the wall once the depth is 2
/// um. Compares the followed contacts in every step with a search of the whole wall.
Seen compare(const BoreMesh& mesh, const Walk& walk) {
  Random random;
  Seen seen;
  Vector3d centre = walk.start, velocity = Vector3d::Zero();
  std::vector<double> track;
  std::vector<FollowedContact> found;
  for (int i = 0; i < walk.steps; ++i) {
    if (i % 200 == 0) {
      const double speed = std::pow(10.0, random.uniform(-9, -6)), angle = random.uniform(-4, 4);
      velocity = speed * Vector3d(std::cos(angle), std::sin(angle), random.uniform(-0.5, 0.5));
    }
    const Vector3d axis = walk.is_ball
                              ? Vector3d(Vector3d::Zero())
                              : Vector3d(walk.tilt * std::sin(1e-3 * i), 0, 1).normalized();
    centre += velocity;
    const auto expected = walk.is_ball ? mesh.ball_contacts(centre, walk.radius, 0)
                                       : mesh.contacts(centre, axis, walk.radius, 0);
    for (const BoreContact& one : expected)
      if (one.depth > 2e-6) velocity -= 1.05 * std::max(velocity.dot(one.normal), 0.0) * one.normal;
    const double up = centre.z() - walk.start.z();
    if (std::abs(up) > walk.height) velocity.z() = -std::copysign(velocity.z(), up);

    ++seen.how[static_cast<std::size_t>(
        follow_contacts(mesh, {centre, axis, walk.radius}, patch_angle, track, found))];
    std::size_t touching = 0;
    for (std::size_t k = 0; k < found.size(); ++k) {
      const bool touches = found[k].distance < walk.radius;
      seen.begun += touches && found[k].label < 0;
      set_label(track, k, touches ? 1 : -1);
      if (!touches) continue;
      ++touching;
      const auto match =
          std::max_element(expected.begin(), expected.end(), [&](const auto& a, const auto& b) {
            return a.normal.dot(found[k].normal) < b.normal.dot(found[k].normal);
          });
      if (match == expected.end()) {
        seen.lost += walk.radius - found[k].distance > mesh.prominence();
        continue;
      }
      const double curvature = walk.is_ball ? -0.5 * (match->curvature_1 + match->curvature_2)
                                            : -match->section_curvature;
      seen.depth = std::max(seen.depth, std::abs(walk.radius - found[k].distance - match->depth));
      seen.normal = std::max(seen.normal, (match->normal - found[k].normal).norm());
      seen.curvature =
          std::max(seen.curvature, std::abs(curvature - found[k].curvature) / curvature);
    }
    // The follower may miss a contact whose depth is below the uncertainty of the wall.
    const auto sure = std::count_if(expected.begin(), expected.end(), [&](const BoreContact& one) {
      return one.depth > mesh.prominence();
    });
    seen.lost += touching < static_cast<std::size_t>(sure) || touching > expected.size();
    seen.several += touching > 1;
  }
  std::printf(
      "%d on patches, %d on the wall, %d searches; %d contacts begin, %d steps with several; "
      "depth %.2g m, normal %.2g, curvature %.2g\n",
      seen.how[0], seen.how[1], seen.how[2], seen.begun, seen.several, seen.depth, seen.normal,
      seen.curvature);
  EXPECT_EQ(seen.lost, 0);
  // Uncertainty of the smooth wall.
  EXPECT_LT(seen.depth, mesh.prominence());
  // A contact leaves its patch when the normal has rotated by patch_angle, so the error is smaller.
  EXPECT_LT(seen.normal, patch_angle);
  // Bound: arc length on a patch, patch_angle / k, times the derivative of the curvature k. For the
  // lobes used here this derivative is at most a n^3 / R^3 = 2e4 /m^2, which gives 1e-4 of k. The
  // tilt of the axis adds less.
  EXPECT_LT(seen.curvature, 2e-4);
  // Most steps are covered by a patch; few need a search.
  EXPECT_LT(seen.how[2], walk.steps / 10);
  return seen;
}

BoreShape lobed(std::vector<Lobe> lobes) {
  BoreShape shape = round_bore();
  shape.lobes = std::move(lobes);
  return shape;
}

TEST(FollowedContacts, RoundBore) {
  const BoreMesh mesh(bore_triangles(round_bore(), 200, 10));
  const Seen seen = compare(mesh, {false, journal_radius, {9.9e-5, 0, 1e-3}, 1e-3, 60000});
  EXPECT_GT(seen.how[1], 3000);
  EXPECT_GT(seen.begun, 20);
}

TEST(FollowedContacts, LobesWithTwoContacts) {
  const BoreMesh mesh(bore_triangles(lobed({{3, 4e-5, 0.2}, {2, 1e-5, 1.0}}), 240, 20));
  const Seen seen = compare(mesh, {false, journal_radius, {5e-5, 0, 1e-3}, 1e-3, 60000});
  EXPECT_GT(seen.how[1], 3000);
  EXPECT_GT(seen.begun, 20);
  EXPECT_GT(seen.several, 1000);
}

TEST(FollowedContacts, ManySmallLobes) {
  const BoreMesh mesh(bore_triangles(lobed({{9, 4e-6, 0.2}}), 360, 8));
  const Seen seen = compare(mesh, {false, journal_radius, {5e-5, 0, 1e-3}, 1e-3, 60000});
  EXPECT_GT(seen.begun, 20);
  EXPECT_GT(seen.several, 1000);
}

TEST(FollowedContacts, TiltingInATaperedBore) {
  BoreShape shape = lobed({{2, 1e-5, 0.2}});
  shape.crown = 5e-5;
  const BoreMesh mesh(bore_triangles(shape, 240, 30));
  const Seen seen = compare(mesh, {false, journal_radius, {5e-5, 0, 1e-3}, 1e-3, 60000, 1e-3});
  EXPECT_GT(seen.how[1], 3000);
  EXPECT_GT(seen.begun, 20);
}

TEST(FollowedContacts, BallInASocket) {
  BoreOptions options;
  options.kind = SurfaceKind::socket;
  const BoreMesh mesh(socket_triangles(8.05e-3, 1.4, 200, 80), options);
  const Seen seen = compare(mesh, {true, 8e-3, {0, 0, -4e-5}, 2e-5, 20000});
  EXPECT_GT(seen.how[1], 1000);
}

TEST(FollowedContacts, BallInALobedBore) {
  const BoreMesh mesh(bore_triangles(lobed({{3, 1e-5, 0.3}}), 240, 20));
  const Seen seen = compare(mesh, {true, journal_radius, {1e-4, 0, 0}, 1e-3, 10000});
  EXPECT_GT(seen.how[1], 500);
}

TEST(FollowedContacts, AxialMotionInACrownedBoreFollowsTheSag) {
  // Wall r = R + b (2 z/L)^2. If a journal moves by s along the axis, the wall recedes by slope
  // times s plus 1/2 k s^2, k = 8 b/L^2. A third-order term does not exist.
  BoreShape shape = round_bore();
  shape.crown = 1e-3;
  const BoreMesh mesh(bore_triangles(shape, 200, 40));
  const double k = 8 * shape.crown / (shape.length * shape.length);
  const Vector3d axis(0, 0, 1);
  // journal radius with enough play for a motion of 50 um on one patch
  constexpr double small = 4e-3;
  for (const double z : {0.0, 1e-3}) {
    std::vector<double> track;
    std::vector<FollowedContact> found;
    const double radius = bore_radius(shape, 0, z);
    const Vector3d centre(radius - small + 1e-6, 0, z);
    ASSERT_EQ(follow_contacts(mesh, {centre, axis, small}, 0.02, track, found), Followed::search);
    ASSERT_EQ(found.size(), 1u);
    set_label(track, 0, 1);
    const double before = found[0].distance;
    for (const double s : {-20e-6, 15e-6, 30e-6}) {
      ASSERT_EQ(follow_contacts(mesh, {centre + s * axis, axis, small}, 0.02, track, found),
                Followed::patches);
      const double sunk = found[0].distance - before - k * z * s;
      EXPECT_NEAR(sunk, 0.5 * k * s * s, 0.02 * 0.5 * k * s * s + mesh.prominence())
          << z << ' ' << s;
    }
  }
}

TEST(FollowedContacts, AJumpIsSearched) {
  const BoreMesh mesh(bore_triangles(lobed({{3, 4e-5, 0}}), 240, 10));
  std::vector<double> track;
  std::vector<FollowedContact> found;
  const Vector3d axis = Vector3d::UnitZ();
  for (const double angle : {0.1, 2.0, 4.5}) {
    const Vector3d centre = 9e-5 * Vector3d(std::cos(angle), std::sin(angle), 0);
    EXPECT_EQ(follow_contacts(mesh, {centre, axis, journal_radius}, patch_angle, track, found),
              Followed::search);
    for (std::size_t i = 0; i < found.size(); ++i) set_label(track, i, 0);
    EXPECT_EQ(follow_contacts(mesh, {centre, axis, journal_radius}, patch_angle, track, found),
              Followed::patches);
    EXPECT_EQ(follow_contacts(mesh, {centre, axis, journal_radius}, 0, track, found),
              Followed::search);
  }
}

TEST(FollowedContacts, AWallThatIsNotFlatterThanTheJournalIsSearchedAnew) {
  // In the middle of a lobe the wall's radius of curvature is 4.8 mm, so a smaller journal touches
  // there.
  const BoreMesh mesh(bore_triangles(lobed({{3, 4e-5, 0}}), 240, 10));
  std::vector<double> track;
  std::vector<FollowedContact> found;
  const Vector3d axis = Vector3d::UnitZ();
  const auto how = [&](double radius, double aside) {
    const Vector3d centre(bearing_radius + 4e-5 - radius + 1e-7, aside, 0);
    return follow_contacts(mesh, {centre, axis, radius}, patch_angle, track, found);
  };
  // Both motions rotate the normal by a few 1e-3.
  const struct {
    double radius, aside;
    Followed how;
  } cases[] = {{4.6e-3, 1e-6, Followed::wall}, {4.795e-3, 1e-8, Followed::search}};
  for (const auto& one : cases) {
    track.clear();
    EXPECT_EQ(how(one.radius, 0), Followed::search);
    ASSERT_EQ(found.size(), 1u);
    set_label(track, 0, 0);
    EXPECT_EQ(how(one.radius, 0), Followed::patches);
    EXPECT_EQ(how(one.radius, one.aside), one.how);
  }
}

TEST(FollowedContacts, ALabelStaysWithItsPlaceWhenAnotherComesFirst) {
  // A journal that moves towards the widest point of a lobe touches both flanks. The deeper contact
  // comes first.
  const BoreMesh mesh(bore_triangles(lobed({{3, 4e-5, 0}}), 240, 10));
  std::vector<double> track;
  std::vector<FollowedContact> found;
  const auto at = [&](double aside) {
    const Vector3d centre(1.15e-4, aside, 0);
    return follow_contacts(mesh, {centre, Vector3d::UnitZ(), journal_radius}, 0, track, found);
  };
  EXPECT_EQ(at(-2e-7), Followed::search);
  ASSERT_EQ(found.size(), 2u);
  const Vector3d first = found[0].normal;
  set_label(track, 0, 7);
  set_label(track, 1, 8);
  EXPECT_EQ(at(2e-7), Followed::search);
  ASSERT_EQ(found.size(), 2u);
  EXPECT_LT(found[0].normal.y() * first.y(), 0);
  EXPECT_EQ(found[0].label, 8);
  EXPECT_EQ(found[1].label, 7);
}

}  // namespace
}  // namespace statejump::geometry
