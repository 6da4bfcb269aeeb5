// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>

#include "statejump/kernel/laws/friction.hpp"

namespace toys {

using namespace statejump::kernel;

/// Friction force mu F_N v/sqrt(v^2 + v1^2) against the velocity v, without a corner.
struct Smooth {
  static constexpr laws::LawInfo info{
      "smooth",    "F_T = mu F_N v/sqrt(v^2 + v1^2), against v",
      "the tests", "v1 > 0; cannot hold a static load: creeps",
      {},          {&laws::parameter::friction_coefficient, &laws::parameter::v1}};
  static double largest_slope(const laws::FrictionParameters& parameters, double normal_force) {
    return parameters.friction_coefficient * normal_force / parameters.v1;
  }
  laws::FrictionResponse operator()(const laws::FrictionParameters& parameters,
                                    const laws::FrictionKinematics& kinematics,
                                    ContactHistory& history) const {
    history = {};
    const Vector3& v = kinematics.tangential_velocity;
    const double speed = std::sqrt(v.squaredNorm() + parameters.v1 * parameters.v1);
    const double size = parameters.friction_coefficient * kinematics.normal_force / speed;
    return {-size * v, 0.0, size * v.squaredNorm() * kinematics.time_step};
  }
};

}  // namespace toys

using UserLaw = toys::Smooth;
