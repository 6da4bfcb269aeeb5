// SPDX-License-Identifier: GPL-3.0-or-later
// The stable time step of a scene in YADE.
#pragma once

#include "yade_api.hpp"

namespace statejump::dem {

// Lower bound of the stable time step [s] in the current state: the smallest 4 / (c + sqrt(c^2 + 4
// k)) over all bodies. Here k is twice the sum of stiffness times mobility over the springs of a
// body, and c the same sum for damping. The mobility is 1/m, plus arm^2/I if the body can rotate.
// The bound is exact for a spring between equal masses, otherwise up to sqrt(2) too small. It is
// infinity if no spring acts on a free body.
double stable_time_step(const yade::Scene& scene);

}  // namespace statejump::dem
