// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "path_follower.hpp"

namespace statejump::truss::detail {

/// Moves a path follower from the drawn shape to the first equilibrium, as
/// Options::start_friction has it. With StartFriction::frictionless the follower of a truss without
/// friction finds that equilibrium; joints then count their slides from there. Fails as
/// PathFollower::start() does; without friction a truss may be a mechanism under its loads.
void start_as_chosen(PathFollower& follower);

}  // namespace statejump::truss::detail
