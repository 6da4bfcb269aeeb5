// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "path_follower.hpp"

namespace statejump::truss::detail {

/// Moves a path follower from the reference configuration to the first equilibrium, according to
/// Options::start_friction. With StartFriction::frictionless the equilibrium is that of a truss
/// without friction, and slides are counted from there. Fails like PathFollower::start(); without
/// friction a truss may be a mechanism under its loads.
void start_as_chosen(PathFollower& follower);

}  // namespace statejump::truss::detail
