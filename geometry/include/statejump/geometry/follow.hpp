// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "statejump/geometry/bore_mesh.hpp"

namespace statejump::geometry {

/// A journal or a ball as a wall sees it, in the axes of the mesh.
struct Probe {
  Eigen::Vector3d centre;  ///< [m]
  Eigen::Vector3d axis;    ///< unit, of a journal; zero: a ball
  double radius;           ///< [m], > 0
};

/// A place of a wall that a journal or ball touches or nearly touches.
struct FollowedContact {
  Eigen::Vector3d normal;  ///< unit, into the wall, perpendicular to a journal's axis
  double distance;         ///< [m] of the wall from the centre; below the radius: contact
  double curvature;  ///< [1/m] of the wall, hollow positive: of a journal's section, of a ball
                     ///< the mean of both principal ones
  int label;         ///< as given by set_label() in an earlier step, -1 for a new place
};

/// Where the contacts of a step come from; the dearest of what was needed.
enum class Followed {
  patches,  ///< circles (of a ball: tori) that osculate the wall
  wall,     ///< the smooth wall, near the contacts of the step before
  search    ///< the whole wall
};

/// Contacts of a journal or ball that moves by little from call to call: what
/// BoreMesh::contacts() or ball_contacts() find, for a fraction of their cost.
///
/// Around each contact the wall is a circle that osculates it (error of the distance: a sixth of
/// the curvature's slope times the cube of the way, below 1e-15 m at the default patch angle). When
/// its normal has turned by more than patch_angle, the smooth wall is asked again at the place
/// where the contact has gone to.
///
/// The whole wall is searched when another contact might have begun. No distance from the wall
/// changes faster than the centre moves (in a section of a wall that leans 45 degrees: by 1.5 of
/// it). So within a travel f of the last search contacts stay where the gap was below f then.
/// There, the wall is flatter than the journal: its hollow curvature times the distance is below 1,
/// every stationary point of the distance is then a minimum, and two minima would need a maximum
/// between them; so each such part holds the one contact that is followed. f is at most a twentieth
/// of the play, and ends where the gap of the next part of the wall or of one that is not flatter
/// would. Where a contact lies itself in wall that is not flatter than the journal, nothing is
/// followed beyond its patch, and f is a thousandth of the play. Limits: those of the search,
/// BoreMesh::contacts(). The wall's curvature is that at its vertices.
///
/// @param patch_angle [rad], >= 0; 0 searches in every call
/// @param track what is known from the last calls, to be kept by the caller for each pair, empty at
///        first; numbers in the axes of the mesh [m, 1/m], fit for saving as they are
/// @param found the places in contact or within a twentieth of the play of it
/// @throws as BoreMesh::contacts() and ball_contacts()
Followed follow_contacts(const BoreMesh& mesh, const Probe& probe, double patch_angle,
                         std::vector<double>& track, std::vector<FollowedContact>& found);

/// Writes on a followed place a number that later calls return with it. While no place has a label
/// >= 0, a contact that begins is searched for, so that it does not depend on what was known
/// before.
/// @param index in found
void set_label(std::vector<double>& track, std::size_t index, int label);

}  // namespace statejump::geometry
