// SPDX-License-Identifier: GPL-3.0-or-later
// The stable time step of a scene in YADE.
#pragma once

#include "yade_api.hpp"

namespace statejump::dem {

// Stable time step of the current state [s], on the safe side: the smallest 4 / (c + sqrt(c^2 + 4
// k)) over the bodies. k is twice the sum of stiffness times mobility (1/m, and arm^2/I if the body
// may rotate) over the springs of the body; c likewise for damping. Exact for a spring between
// equal masses, otherwise smaller by a factor of up to sqrt(2). Infinity if nothing acts on a free
// body.
double stable_time_step(const yade::Scene& scene);

}  // namespace statejump::dem
