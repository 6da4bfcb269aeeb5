// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "system.hpp"

namespace statejump::truss::detail {

/// Springs for all straight beams, or rows of them, that are free to spin about their own axis. An
/// example is a strut between two ball joints. Such a spin moves no node and does no work, so
/// statics does not determine it. Spins on which a moment does work get no spring.
std::vector<SpinSpring> spin_springs(const System& system);

}  // namespace statejump::truss::detail
