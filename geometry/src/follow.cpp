// SPDX-License-Identifier: GPL-3.0-or-later
#include "statejump/geometry/follow.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "impl.hpp"

namespace statejump::geometry {
namespace {

using ConstVector = Eigen::Map<const Vector3>;
using Vector = Eigen::Map<Vector3>;

// Layout of the track. The header has the position of the last search and the travel for which it
// is valid.
enum Header {
  at_centre = 0,
  at_axis = 3,
  at_radius = 6,
  at_free = 7,
  at_flat = 8,  // whether contacts may be followed on the smooth wall beyond their patch
  header_size = 9
};
// Layout of a patch of the wall, one per contact. For a journal, u is the wall's normal, which may
// be inclined to the section; k_a is the curvature in the section, k_b perpendicular to it. For a
// ball, u and v are the principal directions of k_a and k_b. Concave curvatures are positive.
enum Patch {
  at_point = 0,
  at_normal = 3,
  at_u = 6,
  at_v = 9,
  at_k_a = 12,
  at_k_b = 13,
  at_face = 14,  // wall face index
  at_label = 15,
  patch_size = 16
};

constexpr double travel_share = 0.05;     // largest travel between searches, fraction of the play
constexpr double unsafe_share = 1e-3;     // the same at wall that is not flatter than the journal
constexpr double farthest_turn = 0.1;     // [rad], rotation of a normal that is followed at most
constexpr double one_place = 1 - 0.0001;  // cosine; contacts with normals closer than this are
                                          // considered as one and searched again
constexpr int most_refinements = 3;

// Distance of a point from a circle through the origin. At the origin the tangent of the circle is
// horizontal; the centre of the circle is at height 1/k. The point is (along, height). The result
// is exact for any k, also 0.
struct OnCircle {
  double distance;
  double cosine;  // of the rotation of the normal
  double sine;
};
OnCircle on_circle(double k, double height, double along) {
  const double q = 1 - k * height;
  const double root = std::sqrt(q * q + k * k * along * along);
  return {(2 * height - k * (height * height + along * along)) / (1 + root), q / root,
          k * along / root};
}

FollowedContact near_patch(const double* patch, const Probe& probe, bool is_ball) {
  const ConstVector point(patch + at_point), normal(patch + at_normal), u(patch + at_u);
  const double k_a = patch[at_k_a], k_b = patch[at_k_b];
  const int label = static_cast<int>(patch[at_label]);
  if (is_ball) {
    const ConstVector v(patch + at_v);
    const Vector3 from = probe.centre - point;
    const OnCircle first = on_circle(k_a, -from.dot(normal), from.dot(u));
    const OnCircle second = on_circle(k_b, first.distance, from.dot(v));
    const Vector3 turned = first.cosine * normal + first.sine * u;
    return {(second.cosine * turned + second.sine * v).normalized(), second.distance,
            0.5 * (k_a + k_b), label};
  }
  // Distance along the axis between the section and the patch.
  const Vector3& axis = probe.axis;
  const double shift = (probe.centre - point).dot(axis);
  const Vector3 across = (normal - normal.dot(axis) * axis).normalized();
  const double lean = u.dot(axis) / u.dot(normal);
  const Vector3 moved = point + shift * axis - (shift * lean + 0.5 * k_b * shift * shift) * across;
  const Vector3 from = probe.centre - moved;
  const Vector3 tangent = cross(axis, across);
  const OnCircle found = on_circle(k_a, -from.dot(across), from.dot(tangent));
  return {found.cosine * across + found.sine * tangent, found.distance, k_a, label};
}

bool within_patch(const double* patch, const FollowedContact& one, double angle) {
  return (one.normal - ConstVector(patch + at_normal)).squaredNorm() < angle * angle &&
         one.distance > 0;
}

/// Stores the wall around a contact point as a patch.
void write_patch(double* patch, const Hit& hit, const Probe& probe, bool is_ball) {
  Vector(patch + at_point) = hit.point;
  if (is_ball) {
    const Principal p = principal(hit);
    Vector(patch + at_normal) = -hit.normal;
    Vector(patch + at_u) = p.direction_larger;
    Vector(patch + at_v) = p.direction_smaller;
    patch[at_k_a] = -p.larger;
    patch[at_k_b] = -p.smaller;
  } else {
    const SectionCurvature k = section_curvature(hit, probe.axis);
    Vector(patch + at_normal) = -k.normal;
    Vector(patch + at_u) = -hit.normal;
    patch[at_k_a] = k.section;
    patch[at_k_b] = k.axial;
  }
  patch[at_face] = hit.face;
}

/// Moves a patch on the smooth wall to the new position of its contact. Returns false if a search
/// is needed.
bool refine(const BoreMesh::Impl& m, double* patch, const Probe& probe, bool is_ball, double angle,
            FollowedContact& one) {
  const Vector3 start = ConstVector(patch + at_normal);
  for (int i = 0; i < most_refinements; ++i) {
    if (!(one.distance > 0) ||
        !((one.normal - start).squaredNorm() < farthest_turn * farthest_turn))
      return false;
    Hit hit;
    if (!m.meet_near(probe.centre, one.normal, static_cast<int>(patch[at_face]), one.distance, hit))
      return false;
    write_patch(patch, hit, probe, is_ball);
    one = near_patch(patch, probe, is_ball);
    if (within_patch(patch, one, angle)) return true;
  }
  return false;
}

/// Searches the whole wall and creates a new track. Contacts that continue keep their labels.
void search(const BoreMesh& mesh, const Probe& probe, bool is_ball, std::vector<double>& track) {
  const BoreMesh::Impl& m = mesh.impl();
  std::vector<Vector3> before;
  std::vector<double> labels;
  for (std::size_t at = header_size; at < track.size(); at += patch_size) {
    before.emplace_back(ConstVector(track.data() + at + at_normal));
    labels.push_back(track[at + at_label]);
  }
  const double play = std::max(m.wall.radius - probe.radius, 1e-3 * m.wall.radius);
  const double reach = (is_ball ? 0.5 : 2) * play;
  const double near = travel_share * play;
  Survey survey;
  survey.travel = near;
  const std::vector<BoreContact> now =
      is_ball ? find_ball_contacts(m, probe.centre, probe.radius, reach, before, &survey)
              : find_contacts(m, probe.centre, probe.axis, probe.radius, reach, before, &survey);
  track.assign(header_size, 0);
  // Every section of the wall has a nearest point. So if there is no contact, the section misses
  // the wall.
  double free = now.empty() && !is_ball ? 0 : is_ball ? reach : 2 * play;
  for (std::size_t i = 0; i < now.size(); ++i) {
    const BoreContact& one = now[i];
    if (one.depth <= -near) {
      free = std::min(free, -one.depth);
      continue;
    }
    const std::size_t start = track.size();
    track.resize(start + patch_size, 0);
    write_patch(track.data() + start, survey.hits[i], probe, is_ball);
    track[start + at_label] =
        one.previous >= 0 ? labels[static_cast<std::size_t>(one.previous)] : -1;
  }
  bool flat = true;
  if (track.size() > header_size) {
    free = std::min({free, near, survey.not_flat - probe.radius});
    flat = free > unsafe_share * play;
    if (!flat) free = unsafe_share * play;
  }
  Vector(track.data() + at_centre) = probe.centre;
  Vector(track.data() + at_axis) = probe.axis;
  track[at_radius] = probe.radius;
  track[at_free] = free;
  track[at_flat] = flat;
}

}  // namespace

Followed follow_contacts(const BoreMesh& mesh, const Probe& probe, double patch_angle,
                         std::vector<double>& track, std::vector<FollowedContact>& found) {
  const bool is_ball = probe.axis.isZero(0);
  const BoreMesh::Impl& m = mesh.impl();
  Followed how = Followed::patches;
  bool good = !track.empty() && patch_angle > 0;
  if (good) {
    const double moved = 1.5 * (probe.centre - ConstVector(track.data() + at_centre)).norm() +
                         m.wall.radius * (probe.axis - ConstVector(track.data() + at_axis)).norm() +
                         std::abs(probe.radius - track[at_radius]);
    good = moved < track[at_free];
  }
  if (good) {
    found.clear();
    bool touches = false, labelled = false;
    for (std::size_t at = header_size; good && at < track.size(); at += patch_size) {
      double* patch = track.data() + at;
      FollowedContact one = near_patch(patch, probe, is_ball);
      if (!within_patch(patch, one, patch_angle)) {
        how = Followed::wall;
        good = track[at_flat] != 0 && refine(m, patch, probe, is_ball, patch_angle, one);
      }
      // Two contacts have converged to one: search again.
      for (const FollowedContact& other : found)
        good = good && other.normal.dot(one.normal) < one_place;
      touches = touches || one.distance < probe.radius;
      labelled = labelled || one.label >= 0;
      found.push_back(one);
    }
    good = good && (labelled || !touches);
  }
  if (good) return how;
  search(mesh, probe, is_ball, track);
  found.clear();
  for (std::size_t at = header_size; at < track.size(); at += patch_size)
    found.push_back(near_patch(track.data() + at, probe, is_ball));
  return Followed::search;
}

void set_label(std::vector<double>& track, std::size_t index, int label) {
  track[header_size + index * patch_size + at_label] = label;
}

}  // namespace statejump::geometry
