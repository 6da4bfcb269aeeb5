// SPDX-License-Identifier: GPL-3.0-or-later
// Functions shared by the geometry and law functors of all joints.
#pragma once

#include <string>

#include "statejump/kernel/joint_kinematics.hpp"
#include "statejump/stepper/arrays.hpp"
#include "yade_api.hpp"

namespace statejump::dem {

inline kernel::BodyMotion motion(const yade::State& state) {
  return {state.se3.position, state.vel, state.angVel};
}

using stepper::axis_of;

// These functions report failures. They are separate to keep texts out of the code of every step.
// Lengths are in m.
[[gnu::cold]] void fail_closed(const char* inner, yade::Real inner_radius, const char* outer,
                               yade::Real outer_radius, const yade::Scene& scene,
                               const yade::Interaction& contact);
[[gnu::cold]] void fail_inside(yade::Real distance, yade::Real radius_1, yade::Real radius_2,
                               const yade::Scene& scene, const yade::Interaction& contact);
[[gnu::cold]] void fail_tilted(const yade::Scene& scene, const yade::Interaction& contact);
[[gnu::cold]] void fail_unstable(yade::Real effective_mass, yade::Real stiffness,
                                 const yade::Scene& scene, const yade::Interaction& contact);
// Text such as "time 0.5 s, temperature change 40 K", with all temperature changes imposed by
// thermal engines.
std::string when(const yade::Scene& scene);

}  // namespace statejump::dem
