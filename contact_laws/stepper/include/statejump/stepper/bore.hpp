// SPDX-License-Identifier: GPL-3.0-or-later
// One step of a journal or ball with a meshed bore: finds the contacts, applies the law at each,
// and stores the state until the next step. The plugin's functors and the stepper call the same
// functions, with YADE's objects or with plain values.
//
// A list of contacts holds values or pointers; contact_of() returns the contact of an entry.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <type_traits>
#include <utility>
#include <vector>

#include "statejump/geometry/follow.hpp"
#include "statejump/kernel/joint_kinematics.hpp"
#include "statejump/stepper/checks.hpp"
#include "statejump/stepper/contact.hpp"
#include "statejump/stepper/link.hpp"

namespace statejump::stepper {

/// Geometry of one of several contacts of a pair. The members are the attributes of JointGeom.
struct BoreContactGeometry : ContactGeometry {
  Vector3 contactPoint = Vector3::Zero();  ///< [m]
  double refR1 = 0.0, refR2 = 0.0;  ///< radii [m]; refR2 is the magnitude of the wall's radius
};

/// Geometry of a pair; the attributes of BoreGeom.
struct BoreGeometry {
  std::vector<BoreContactGeometry> contacts;
  std::vector<int> previous;  ///< index of the same contact in the previous step, -1: new
  std::vector<double> known;  ///< state of follow_contacts()
  double strain_change = 0.0;
  Vector3 normal = Vector3::Zero(), contactPoint = Vector3::Zero();  ///< of the deepest contact
  double refR1 = 0.0, refR2 = 0.0;
};

/// Physics of a pair. The members are the attributes of BorePhys. Forces and stiffnesses are sums
/// over contacts.
struct BorePhysics : ContactPhysics {
  std::vector<ContactPhysics> contacts;
};

/// Data of a contact with a meshed bore that Contact does not contain.
struct Bore {
  const geometry::BoreMesh* mesh = nullptr;
  bool is_ball = false;
  double patch_angle = 0.0;   ///< [rad], for follow_contacts()
  double largest_tilt = 0.0;  ///< allowed angle between the axes of journal and bore [rad]
  bool has_geometry = false;  ///< kept without contact, because it stores the known wall geometry
  bool renewed = false;       ///< its geometry was created after the arrays were filled
  BoreGeometry geometry;
  BorePhysics physics;
};

/// Journal or ball at its current temperature.
struct BoreProbe {
  bool is_ball;
  double radius;       ///< [m]
  double radius_rate;  ///< rate of the radius by thermal expansion [m/s]
  Vector3 axis;        ///< world, unit; zero for a ball
};

/// Wall at its current temperature.
struct BoreWall {
  const geometry::BoreMesh& mesh;
  double thermal_stretch;  ///< 1 + thermal strain [-]
  double strain_rate;      ///< rate over the last step [1/s]
  double patch_angle;      ///< [rad]
};

enum class BoreSearch : unsigned char {
  apart,      ///< no contact now and none in the previous step
  contact,    ///< contact; the pair's geometry is updated to this step
  undefined,  ///< the relative position is undefined
  conforming  ///< error: the wall is concave with a radius not larger than that of the journal or
              ///< ball
};

struct BoreStep {
  BoreSearch found;
  double wall_radius = 0.0;            ///< only for conforming: radius of the wall [m]
  Vector3 position = Vector3::Zero();  ///< only for conforming: point of contact [m]
};

template <class Entry>
constexpr bool is_value = std::is_base_of_v<ContactGeometry, std::remove_const_t<Entry>> ||
                          std::is_base_of_v<ContactPhysics, std::remove_const_t<Entry>>;

template <class Entry>
auto& contact_of(Entry& entry) {
  if constexpr (is_value<Entry>) {
    return entry;
  } else {
    return *entry;
  }
}

template <class Entry>
Entry new_contact() {
  if constexpr (is_value<Entry>) {
    return {};
  } else {
    return Entry(new typename Entry::element_type());
  }
}

/// Returns whether the small angle between the axes of journal and bore exceeds `allowed` [rad].
inline bool tilted_in_bore(const Vector3& journal_axis, const geometry::BoreMesh& mesh,
                           const Quaternion& orientation, double allowed) {
  return !(journal_axis.cross(orientation * mesh.axis()).squaredNorm() <= allowed * allowed);
}

/// Updates the pair's contact list with the contacts found in this step. A continued contact keeps
/// its label. A contact that has just ended stays in the list for one step, so that the law can
/// complete its energy balance.
/// @param touches returns whether a found contact has overlap
/// @param turn rotation from the mesh axes to the world axes
template <class Pair, class Touches>
void list_contacts(const std::vector<geometry::FollowedContact>& found, const Touches& touches,
                   const Eigen::Matrix3d& turn, Pair& pair) {
  using Entry = typename decltype(pair.contacts)::value_type;
  std::size_t touching = 0;
  bool same = true;
  for (std::size_t i = 0; i < found.size(); ++i) {
    const bool now = touches(found[i]);
    const int label = now ? static_cast<int>(touching) : -1;
    same = same && found[i].label == label;
    geometry::set_label(pair.known, i, label);
    touching += now;
  }
  if (same && touching == pair.contacts.size()) {  // unchanged list, as in most steps
    for (std::size_t i = 0; i < touching; ++i) pair.previous[i] = static_cast<int>(i);
    return;
  }
  std::vector<Entry> old = std::move(pair.contacts);
  std::vector<char> continues(old.size(), 0);
  pair.contacts.clear();
  pair.previous.clear();
  for (const geometry::FollowedContact& one : found) {
    if (!touches(one)) continue;
    pair.previous.push_back(one.label);
    if (one.label >= 0) {
      const auto before = static_cast<std::size_t>(one.label);
      pair.contacts.push_back(old[before]);
      continues[before] = 1;
    } else {
      pair.contacts.push_back(new_contact<Entry>());
      contact_of(pair.contacts.back()).normal = turn * one.normal;
    }
  }
  for (std::size_t i = 0; i < old.size(); ++i) {
    auto& ended = contact_of(old[i]);
    if (continues[i] || !(ended.penetrationDepth > 0)) continue;
    ended.eccentricity -= ended.penetrationDepth;
    ended.penetrationDepth = 0;
    ended.previousNormal = ended.normal;
    ended.clearanceRate = 0;
    pair.contacts.push_back(old[i]);
    pair.previous.push_back(static_cast<int>(i));
  }
}

/// Finds all contacts of a journal or ball (body 1) with a bore (body 2).
/// @param centres vector from the centre of body 2 to that of body 1 [m]
/// @param keep whether the pair is already in contact; @param time_step [s]
/// @param make returns the geometry of the pair and creates it if necessary. The geometry persists
///     without contact, because it stores the known shape of the wall.
/// @throws any exception of follow_contacts() and the kernel
template <class CreatePhysics>
BoreStep find_in_bore(const BoreProbe& probe, const BoreWall& wall,
                      const kernel::BodyMotion& motion_1, const kernel::BodyMotion& motion_2,
                      const Quaternion& orientation_2, const Vector3& centres, bool keep,
                      double time_step, CreatePhysics&& make) {
  const geometry::BoreMesh& mesh = wall.mesh;
  const Eigen::Matrix3d turn = orientation_2.toRotationMatrix();
  const double thermal_stretch = wall.thermal_stretch;
  const Vector3 centre =
      mesh.centre() + (turn.transpose() * centres - mesh.centre()) / thermal_stretch;
  const Vector3 axis = turn.transpose() * probe.axis;
  const double radius = probe.radius / thermal_stretch;
  if (!is_finite_fast(centre) || !(radius > 0)) return {BoreSearch::undefined};

  auto& pair = make();
  thread_local std::vector<geometry::FollowedContact> found;
  geometry::follow_contacts(mesh, {centre, axis, radius}, wall.patch_angle, pair.known, found);
  const auto touches = [radius](const geometry::FollowedContact& one) {
    return one.distance < radius;
  };
  list_contacts(found, touches, turn, pair);

  pair.refR1 = pair.refR2 = probe.radius;
  pair.strain_change = wall.strain_rate * time_step / thermal_stretch;
  const Vector3 world_axis = probe.is_ball ? Vector3(Vector3::Zero()) : turn * mesh.axis();
  std::size_t next = 0;
  double deepest = 0;
  for (const geometry::FollowedContact& one : found) {
    if (!touches(one)) continue;
    const bool is_new = pair.previous[next] < 0;
    auto& geometry = contact_of(pair.contacts[next++]);
    const Vector3 foot = centre - mesh.centre() + one.distance * one.normal;
    const double wall_radius = thermal_stretch / one.curvature;
    if (wall_radius > 0 && !(wall_radius > probe.radius)) {
      return {BoreSearch::conforming, wall_radius,
              motion_1.position + turn * (probe.radius * one.normal)};
    }
    kernel::JointContact here;
    here.normal = turn * one.normal;
    here.penetration_depth = thermal_stretch * (radius - one.distance);
    here.effective_radius = kernel::internal_effective_radius(probe.radius, wall_radius);
    here.arm_1 = (probe.radius - 0.5 * here.penetration_depth) * here.normal;
    here.arm_2 = centres + here.arm_1;
    here.relative_velocity = kernel::material_velocity(motion_1, here.arm_1) -
                             kernel::material_velocity(motion_2, here.arm_2);
    // Thermal expansion moves the wall point along the normal and changes the depth. `clearance`
    // sums only these changes, so that motion along an uneven wall does not count as thermal
    // expansion.
    const double reach = foot.dot(one.normal);
    const double clearance_rate = wall.strain_rate * reach - probe.radius_rate;
    const double clearance =
        is_new ? thermal_stretch * reach - probe.radius
               : geometry.eccentricity - geometry.penetrationDepth + clearance_rate * time_step;
    here.eccentricity = here.penetration_depth + clearance;
    geometry.refR1 = probe.radius;
    geometry.refR2 = std::abs(wall_radius);
    geometry.journalRadius = probe.radius;
    geometry.bearingRadius = wall_radius;
    geometry.axis = world_axis;
    geometry.clearanceRate = clearance_rate;
    update(here, motion_1, motion_2, time_step, geometry);
    geometry.contactPoint = motion_1.position + geometry.arm1;
    if (here.penetration_depth > deepest) {
      deepest = here.penetration_depth;
      pair.normal = here.normal;
      pair.contactPoint = geometry.contactPoint;
      pair.refR2 = std::abs(wall_radius);
    }
  }
  return {keep || next > 0 ? BoreSearch::contact : BoreSearch::apart};
}

/// Applies the law at every contact of a pair. First brings the list of physics into the order of
/// the geometries.
/// @param step steps one contact from its geometry and physics; returns false if it is open
/// @return whether any contact touches
template <class Geometry, class Physics, class Step>
bool bore_law_step(const Geometry& geometry, Physics& pair, Step&& step) {
  using Entry = typename decltype(pair.contacts)::value_type;
  const std::size_t count = geometry.contacts.size();
  bool same = pair.contacts.size() == count;
  for (std::size_t i = 0; same && i < count; ++i) {
    same = geometry.previous[i] == static_cast<int>(i);
  }
  if (!same) {
    const std::vector<Entry> old = std::move(pair.contacts);
    pair.contacts.clear();
    for (const int before : geometry.previous) {
      if (before >= 0 && before < static_cast<int>(old.size())) {
        pair.contacts.push_back(old[static_cast<std::size_t>(before)]);
        continue;
      }
      pair.contacts.push_back(new_contact<Entry>());
      auto& fresh = contact_of(pair.contacts.back());
      fresh.effectiveYoungModulus = pair.effectiveYoungModulus;
      fresh.effectiveShearModulus = pair.effectiveShearModulus;
      fresh.effectiveMass = pair.effectiveMass;
      fresh.normalDampingRatio = pair.normalDampingRatio;
      fresh.tangentialDampingRatio = pair.tangentialDampingRatio;
      fresh.tangensOfFrictionAngle = pair.tangensOfFrictionAngle;
    }
  }
  bool touching = false;
  pair.kn = pair.ks = 0;
  pair.slipping = true;
  pair.normalForce = pair.shearForce = Vector3::Zero();
  for (std::size_t i = 0; i < count; ++i) {
    const auto& here = contact_of(geometry.contacts[i]);
    auto& physics = contact_of(pair.contacts[i]);
    // Only thermal expansion counts as a change of this radius; motion to a wall point with another
    // radius does not.
    physics.previousBearingRadius = here.bearingRadius * (1 - geometry.strain_change);
    if (!step(here, physics)) continue;
    touching = true;
    pair.kn += physics.kn;
    pair.ks += physics.ks;
    pair.slipping = pair.slipping && physics.slipping;
    pair.normalForce += physics.normalForce;
    pair.shearForce += physics.shearForce;
  }
  return touching;
}

}  // namespace statejump::stepper
