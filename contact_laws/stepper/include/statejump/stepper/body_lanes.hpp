// SPDX-License-Identifier: GPL-3.0-or-later
// One step of four non-rotating bodies at once: sum_forces() and move() in this order.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "statejump/stepper/body.hpp"
#include "statejump/stepper/pack.hpp"

namespace statejump::stepper {

/// Up to four bodies. Unused lanes repeat the first body.
struct BodyLanes {
  std::array<std::size_t, lanes> body;
  std::size_t count;
  Pack3 position, velocity, permanent_force, bound_position;
  Pack mass, damping, bound_reach;
  Mask moves_x, moves_y, moves_z, free, held;  // free to move along an axis, along all, along none
  Mask bounded;  // has a bound: the collider runs again if the body leaves it

  void load(std::size_t lane, std::size_t index, const Body& from, const Newton& newton) {
    body[lane] = index;
    put(position, lane, from.motion.position);
    put(velocity, lane, from.motion.velocity);
    put(permanent_force, lane, from.permanent_force);
    put(bound_position, lane, from.bound_position);
    mass[lane] = from.mass;
    damping[lane] = from.damped ? newton.damping : 0;
    bound_reach[lane] = from.bound_reach;
    moves_x[lane] = from.blocked & 1U ? 0 : -1;
    moves_y[lane] = from.blocked & 2U ? 0 : -1;
    moves_z[lane] = from.blocked & 4U ? 0 : -1;
    free[lane] = from.blocked == 0 ? -1 : 0;
    held[lane] = from.blocked == all_dofs ? -1 : 0;
    bounded[lane] = from.bounded ? -1 : 0;
  }
};

namespace detail {

[[gnu::always_inline]] inline void accelerate(const BodyLanes& at, const Pack& force,
                                              const Mask& moves, const Newton& newton,
                                              double gravity, double time_step, Pack& velocity) {
  Pack acceleration = force / at.mass;
  if (newton.dampGravity) acceleration += gravity;
  acceleration = at.free ? acceleration : moves ? 0.0 + acceleration : 0.0;
  if (newton.damping != 0) {
    const Pack power = acceleration * (velocity + 0.5 * time_step * acceleration);
    const Pack sign = power > 0.0 ? Pack{} + 1.0 : power < 0.0 ? Pack{} - 1.0 : Pack{};
    acceleration *= 1.0 - at.damping * sign;
  }
  if (!newton.dampGravity) acceleration += moves ? Pack{} + gravity : Pack{};
  velocity = at.held ? velocity : velocity + time_step * acceleration;
}

}  // namespace detail

/// Makes one step.
/// @param added forces since the last step [N]
/// @return lanes whose body has left its collider bound
[[gnu::always_inline]] inline Mask move_lanes(BodyLanes& at, const Pack3& added,
                                              const Newton& newton, double time_step) {
  const Pack3 force = added + at.permanent_force;
  detail::accelerate(at, force.x, at.moves_x, newton, newton.gravity[0], time_step, at.velocity.x);
  detail::accelerate(at, force.y, at.moves_y, newton, newton.gravity[1], time_step, at.velocity.y);
  detail::accelerate(at, force.z, at.moves_z, newton, newton.gravity[2], time_step, at.velocity.z);
  at.position = at.position + at.velocity * time_step;
  const Pack3 moved = at.position - at.bound_position;
  const Pack most = larger(absolute(moved.x), larger(absolute(moved.y), absolute(moved.z)));
  return at.bounded & (most != 0.0) & ~(most < at.bound_reach);
}

}  // namespace statejump::stepper
