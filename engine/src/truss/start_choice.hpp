// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "path_follower.hpp"

namespace statejump::truss::detail {

/// Moves a path follower from the reference configuration to its first equilibrium, as
/// Options::start_friction specifies. With StartFriction::frictionless the equilibrium is that of a
/// truss without friction, and slides are counted from there. Throws like PathFollower::start().
/// Without friction, a truss may be a mechanism under its loads.
void start_as_chosen(PathFollower& follower);

/// Copy of a truss whose joints have no friction, with the same unknowns.
Model without_friction(const Model& model);

/// Writes the memory of a joint in which friction begins at zero force.
void begin_at_zero_force(const Joint& joint, const Trial& trial, JointStatus status, double* now);

}  // namespace statejump::truss::detail
