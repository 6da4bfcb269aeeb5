// SPDX-License-Identifier: GPL-3.0-or-later
#include "statejump/truss/elements/torsion_spring.hpp"

#include <cmath>

#include "statejump/kernel/require.hpp"
#include "statejump/truss/model.hpp"
#include "truss/elements/writer.hpp"
#include "truss/parts.hpp"

namespace statejump::truss {

using detail::index;
using detail::turn_by;
using detail::turned_left;
using Eigen::Vector2d;
using Eigen::Vector3d;

namespace {

/// The bars between which the spring acts.
struct Arms {
  struct Arm {
    int first;
    int second;
    double sign;  ///< Sign of its rotation in the angle.
    Vector2d drawn;
    Vector2d moved;  ///< Displacement of the second end relative to the first [m].
  };
  std::array<Arm, 2> arms;
  std::size_t count = 0;
  double angle = 0.0;  ///< From the reference configuration [rad].
};

/// The bars and their angle: from the first bar to the second, or from the ground to a single bar.
Arms arms_of(const TorsionSpring::Frame& frame, const ElementState& state) {
  Arms found;
  const bool single = frame.nodes[2] < 0;
  for (std::size_t k = 0; k < (single ? 1 : 2); ++k) {
    const int first = frame.nodes[2 * k];
    const int second = frame.nodes[2 * k + 1];
    const Vector2d drawn = frame.plane.transpose() * state.drawn_between(first, second);
    const Vector2d moved = frame.plane.transpose() * state.moved_between(first, second);
    const double sign = k == 0 && !single ? -1.0 : 1.0;
    found.angle += sign * turn_by(drawn, moved);
    found.arms[found.count++] = {first, second, sign, drawn, moved};
  }
  return found;
}

}  // namespace

std::span<const Parameter<TorsionSpring>> TorsionSpring::parameters() {
  using T = TorsionSpring;
  static const Parameter<T> table[] = {
      {"links", "first link", "-", Allowed::link, "the case's links", &T::first_link, 0, 2},
      {"links", "second link", "-", Allowed::link_or_none, "the case's links", &T::second_link, 1,
       2},
      {"stiffness_N_m_per_rad", "stiffness", "N m/rad", Allowed::not_negative, "the case: K",
       &T::stiffness},
      {"bias_rad", "free_angle", "rad", Allowed::finite, "the case: α0", &T::free_angle},
      {"axis", "axis", "-", Allowed::direction, "the case", &T::axis},
  };
  return table;
}

void TorsionSpring::validate(const Model&, std::span<const TemperatureRange>) const {
  if (second_link != first_link) return;
  throw kernel::OutOfRange(std::string(kind) + " '" + name + "'", "second link", second_link,
                           "another than the first");
}

TorsionSpring::Frame TorsionSpring::frame(const Model& model) const {
  const Bar& first = model.links[index(first_link)];
  Frame made{{first.first, first.second, -1, -1}, detail::plane_of(axis)};
  if (second_link >= 0) {
    const Bar& second = model.links[index(second_link)];
    made.nodes[2] = second.first;
    made.nodes[3] = second.second;
  }
  return made;
}

ElementScale TorsionSpring::scale(const Frame& frame, const std::vector<Vector3d>& drawn) const {
  const double arm = (drawn[index(frame.nodes[1])] - drawn[index(frame.nodes[0])]).norm();
  return {0.0, stiffness * std::abs(free_angle) / arm};
}

void TorsionSpring::evaluate(const Frame& frame, const ElementState& state,
                             ElementWriter& writer) const {
  const Arms now = arms_of(frame, state);
  const double moment = stiffness * (now.angle - free_angle);
  // The angle of a bar increases with the motion of its second end and decreases with that of its
  // first.
  struct End {
    std::size_t bar;
    int node;
    Vector3d turns;    ///< Derivative of the angle along the node's directions [rad/m].
    Vector3d outward;  ///< Direction of the bar over its length, along the node's directions [1/m].
  };
  std::array<End, 4> ends;
  std::size_t count = 0;
  for (std::size_t k = 0; k < now.count; ++k) {
    const Arms::Arm& arm = now.arms[k];
    const Vector2d along = arm.drawn + arm.moved;
    const double squared = along.squaredNorm();
    const Vector3d turns = frame.plane * (arm.sign / squared * turned_left(along));
    writer.force(arm.second, moment * turns);
    writer.force(arm.first, -moment * turns);
    writer.carries(moment * turns.norm());
    if (writer.residual_only()) continue;
    const Vector3d outward = frame.plane * (along / squared);
    ends[count++] = {k, arm.second, writer.seen(arm.second, turns),
                     writer.seen(arm.second, outward)};
    ends[count++] = {k, arm.first, -writer.seen(arm.first, turns),
                     -writer.seen(arm.first, outward)};
  }
  for (std::size_t a = 0; a < count; ++a) {
    const End& by = ends[a];
    for (std::size_t b = 0; b < count; ++b) {
      const End& of = ends[b];
      const double bends = by.bar == of.bar ? moment : 0.0;
      writer.block(by.node, of.node, [&](int m, int n) {
        return stiffness * by.turns[m] * of.turns[n] -
               bends * (by.outward[m] * of.turns[n] + by.turns[m] * of.outward[n]);
      });
    }
  }
}

double TorsionSpring::energy(const Frame& frame, const ElementState& state) const {
  const double wound = arms_of(frame, state).angle - free_angle;
  return 0.5 * stiffness * wound * wound;
}

}  // namespace statejump::truss
