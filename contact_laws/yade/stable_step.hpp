// SPDX-License-Identifier: GPL-3.0-or-later
// The stable time step of a scene in YADE.
#pragma once

#include "yade_api.hpp"

namespace statejump::dem {

// Lower bound of the stable time step [s] in the current state: the smallest 4 / (c + sqrt(c^2 + 4
// k)) over the bodies. k is twice the sum of stiffness times mobility (1/m, plus arm^2/I if the
// body can rotate) over the springs of the body; c is the same sum for damping. Exact for a spring
// between equal masses, otherwise too small by a factor of at most sqrt(2). Infinity if nothing
// acts on a free body.
double stable_time_step(const yade::Scene& scene);

}  // namespace statejump::dem
