// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "truss/joints/ball_contact.hpp"
#include "truss/joints/partial_slip.hpp"

namespace statejump::truss::detail {

// Friction of a ball with partial slip. The memory has components along two directions: a reference
// direction of the tangent plane that rotates with the contact, and the direction to its left, seen
// along the normal.

/// Slide of a step [m] along both directions of the memory.
template <class Number>
struct BallRub {
  Vector<Number> first;
  Vector<Number> second;
  Number along_first;
  Number along_second;
};

template <class Number>
BallRub<Number> ball_rub(const BallState<Number>& now, const BallMemory& start) {
  BallRub<Number> rub;
  const BallSlide<Number> moved = ball_slide(now, start);
  rub.first = moved.axis;
  rub.second = now.normal.cross(rub.first);
  rub.along_first = moved.slide.dot(rub.first);
  rub.along_second = moved.slide.dot(rub.second);
  return rub;
}

/// An arbitrary unit vector in the tangent plane; zero if the normal is undefined.
inline Eigen::Vector3d any_across(const Eigen::Vector3d& normal) {
  return normal.isZero(0.0) ? normal : normal.unitOrthogonal();
}

/// Friction t at the end of a step [N], with its derivatives.
struct BallRubbed {
  Vector<Dual> friction;
  std::size_t piece;  ///< Identifies the branch of the piecewise law.
};

/// @param compliance 1/k_t at the end of the step [m/N]
inline BallRubbed ball_rubbed(const BallJoint& joint, const BallState<Dual>& now,
                              const BallMemory& start, const Dual& compliance,
                              const kernel::PartialSlipMemory& memory) {
  const BallRub<Dual> rub = ball_rub(now, start);
  const Dual stiffness = 1.0 / compliance;
  const Dual limit = joint.friction_coefficient * now.normal_force;
  const kernel::PartialSlipPlane law =
      kernel::partial_slip_plane(stiffness.value(), limit.value(),
                                 {rub.along_first.value(), rub.along_second.value()}, memory);
  const auto component = [&](double kernel::Tangent::*at) {
    return Dual(law.force.*at, law.by_slide_a.*at * rub.along_first.derivatives() +
                                   law.by_slide_b.*at * rub.along_second.derivatives() +
                                   law.by_stiffness.*at * stiffness.derivatives() +
                                   law.by_limit.*at * limit.derivatives());
  };
  return {rub.first * component(&kernel::Tangent::a) + rub.second * component(&kernel::Tangent::b),
          piece_of(law)};
}

}  // namespace statejump::truss::detail
