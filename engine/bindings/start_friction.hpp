// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "statejump/start_friction.hpp"

#include <string>

namespace statejump::bindings {

/// "stuck" or "frictionless". Throws std::invalid_argument for another name.
StartFriction start_friction_of(const std::string& name);

}  // namespace statejump::bindings
