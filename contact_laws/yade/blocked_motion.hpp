// SPDX-License-Identifier: GPL-3.0-or-later
// Blocked dofs and inverse mass of a body.
#pragma once

#include "yade_api.hpp"

namespace statejump::dem {

// Bits of State::blockedDOFs: three translations, then three rotations.
constexpr unsigned int all_translations_blocked = 7;
constexpr unsigned int all_rotations_blocked = 56;

// Inverse mass 1/m [1/kg]; 0 (infinite mass) for a body that cannot translate or has no mass.
inline yade::Real inverse_mass(const yade::State& state) {
  const bool fixed = (state.blockedDOFs & all_translations_blocked) == all_translations_blocked;
  return fixed || !(state.mass > 0) ? 0 : 1 / state.mass;
}

}  // namespace statejump::dem
