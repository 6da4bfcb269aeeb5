// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "statejump/geometry/bore_mesh.hpp"

namespace statejump::geometry {

/// Journal or ball in the axes of the mesh.
struct Probe {
  Eigen::Vector3d centre;  ///< [m]
  Eigen::Vector3d axis;    ///< unit axis of a journal; zero: a ball
  double radius;           ///< [m], > 0
};

/// Point at which the wall touches a journal or ball, or nearly touches it.
struct FollowedContact {
  Eigen::Vector3d normal;  ///< unit, into the wall, perpendicular to a journal's axis
  double distance;   ///< distance of the wall from the centre [m]; less than the radius: contact
  double curvature;  ///< curvature of the wall [1/m], concave positive: in the section of a
                     ///< journal; for a ball the mean of both principal curvatures
  int label;         ///< as set by set_label() in an earlier step; -1: new contact
};

/// The most expensive method that a step needed. Values are in increasing order of cost.
enum class Followed {
  patches,  ///< circles (for a ball: tori) that osculate the wall
  wall,     ///< smooth wall near the contacts of the previous step
  search    ///< search of the whole wall
};

/// Contacts of a journal or ball that moves little between calls. The result is that of
/// BoreMesh::contacts() or ball_contacts(), at a fraction of the cost.
///
/// Around each contact the wall is replaced by an osculating circle. The error of its distance is a
/// sixth of the derivative of the curvature, times the cube of the arc length, below 1e-15 m at the
/// default patch_angle. When the contact normal has rotated by more than patch_angle, the circle is
/// fitted again to the smooth wall at the new position of the contact.
///
/// The whole wall is searched again before a new contact can begin. The distance from the wall
/// changes at most as fast as the centre moves (in a section of a wall inclined by 45 degrees: 1.5
/// times as fast). So within a travel f since the last search, contacts stay in regions where the
/// gap was then below f. In these regions the wall is less curved than the journal: concave
/// curvature times distance is below 1. Every stationary point of the distance in them is then a
/// minimum. Two minima would need a maximum between them, so each region contains exactly one
/// contact, the followed one. f is at most a twentieth of the play, at most the gap of the next
/// region, and at most the gap at the nearest wall that is not less curved than the journal. If a
/// contact itself lies in such wall, it is followed only within its patch, and f is a thousandth of
/// the play. Limits: those of BoreMesh::contacts(). The curvature of the wall is evaluated at its
/// vertices.
///
/// @param patch_angle [rad], >= 0; 0 searches in every call
/// @param track state of the pair, stored by the caller between calls, empty at first; numbers in
///        the axes of the mesh [m, 1/m] that may be saved and restored
/// @param found contacts, including gaps below a twentieth of the play
/// @throws any exception of BoreMesh::contacts() and ball_contacts()
Followed follow_contacts(const BoreMesh& mesh, const Probe& probe, double patch_angle,
                         std::vector<double>& track, std::vector<FollowedContact>& found);

/// Sets the label of a followed contact, which later calls return. While no contact has a label >=
/// 0, a beginning contact triggers a search, so that results do not depend on the past.
/// @param index index of the contact in `found`
void set_label(std::vector<double>& track, std::size_t index, int label);

}  // namespace statejump::geometry
