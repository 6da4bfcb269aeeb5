// SPDX-License-Identifier: GPL-3.0-or-later
#include "start_friction.hpp"

#include "statejump/kernel/require.hpp"

statejump::StartFriction statejump::bindings::start_friction_of(const std::string& name) {
  if (name == "stuck") return StartFriction::stuck;
  if (name == "frictionless") return StartFriction::frictionless;
  throw kernel::OutOfRange("start_friction", name, "stuck or frictionless");
}
