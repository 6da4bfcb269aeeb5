// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <limits>

#include "statejump/kernel/laws/normal.hpp"

namespace toys {

using namespace statejump::kernel::laws;

/// Normal law F = E*/R1 delta^3, which the project does not contain.
struct Cubic {
  static constexpr LawInfo info{"cubic",
                                "F = E*/R1 delta^3",
                                "the tests",
                                "delta >= 0",
                                Trait::holds_static_load | Trait::accepts_bulging_wall,
                                {}};
  static double largest_depth(const NormalGeometry&) {
    return std::numeric_limits<double>::infinity();
  }
  NormalState operator()(double depth, const NormalGeometry& geometry,
                         const NormalMaterial& material) const {
    if (depth <= 0.0) return {0.0, 0.0, 0.0, 0.0};
    const double k = material.effective_young_modulus / geometry.journal_radius;
    const double force = k * depth * depth * depth;
    return {force, 3.0 * k * depth * depth, 2.0 * depth, 0.25 * force * depth};
  }
};

}  // namespace toys

using UserLaw = toys::Cubic;
