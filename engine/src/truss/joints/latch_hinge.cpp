// SPDX-License-Identifier: GPL-3.0-or-later
#include "statejump/truss/joints/latch_hinge.hpp"

#include <algorithm>
#include <vector>

#include "statejump/kernel/require.hpp"
#include "statejump/truss/model.hpp"
#include "truss/joints/hinge_law.hpp"
#include "truss/joints/writer.hpp"
#include "truss/parts.hpp"

namespace statejump::truss {

using detail::angle_derivatives;
using detail::AngleDerivatives;
using detail::index;
using detail::Matrix32;
using detail::turn_by;
using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

namespace {

Matrix32 plane_of(const Trial& trial) {
  return trial.frame.axes.leftCols<2>();
}

/// A link of the hinge: local nodes of its ends, and the sign with which its rotation contributes
/// to φ.
struct Arm {
  std::size_t from;
  std::size_t to;
  double sign;
};

/// The first link, and the second one if there is one.
std::array<Arm, 2> arms_of(const LatchHinge& hinge) {
  // Against the ground, the rotation of the first link itself counts.
  return {Arm{0, 1, hinge.second_link < 0 ? 1.0 : -1.0}, Arm{2, 3, 1.0}};
}

std::size_t arm_count(const LatchHinge& hinge) {
  return hinge.second_link < 0 ? 1 : 2;
}

}  // namespace

std::span<const Parameter<LatchHinge>> LatchHinge::parameters() {
  using H = LatchHinge;
  static const std::vector<Parameter<H>> table = detail::with_hinge_law<H>({
      {"first_link", "first link", "-", Allowed::link, "the case's links", &H::first_link},
      {"second_link", "second link", "-", Allowed::link_or_none, "the case's links",
       &H::second_link},
  });
  return table;
}

std::span<const Output> LatchHinge::outputs() {
  static const Output table[] = {{"hinge_rotation_rad", 1}, {"hinge_moment_N_m", 1}};
  return table;
}

void LatchHinge::validate(const Model&) const {
  if (second_link == first_link) {
    throw kernel::OutOfRange("latch_hinge '" + name + "'", "second link", second_link,
                             "another than the first");
  }
}

JointFrame LatchHinge::frame(const Model& model) const {
  JointFrame frame;
  const Bar& first = model.links[index(first_link)];
  frame.nodes = {first.first, first.second, -1, -1};
  frame.node_count = 2;
  if (second_link >= 0) {
    const Bar& second = model.links[index(second_link)];
    frame.nodes = {first.first, first.second, second.first, second.second};
    frame.node_count = 4;
  }
  frame.forces = 1;
  frame.axes << detail::plane_of(axis), axis;
  return frame;
}

void LatchHinge::evaluate(const Trial& trial, JointStatus status, JointWriter& writer) const {
  const Matrix32 plane = plane_of(trial);
  const std::array<Arm, 2> arms = arms_of(*this);
  const std::size_t count = arm_count(*this);
  const Law law = evaluate_law(trial, status, writer);
  std::array<AngleDerivatives, 2> turn;
  for (std::size_t k = 0; k < count; ++k) {
    turn[k] = angle_derivatives(plane.transpose() * trial.between(arms[k].from, arms[k].to), plane);
    const Vector3d gradient = arms[k].sign * turn[k].gradient;
    for (const auto& [node, sign] : {std::pair{arms[k].to, 1.0}, std::pair{arms[k].from, -1.0}}) {
      writer.force(node, sign * law.moment * gradient);
      writer.column(node, 0, sign * law.radius * gradient);
      writer.row(0, node, sign * law.by_row * gradient);
    }
  }
  for (std::size_t k = 0; k < count; ++k) {
    for (std::size_t m = 0; m < count; ++m) {
      Matrix3d block = law.tangent * arms[k].sign * arms[m].sign * turn[k].gradient *
                       turn[m].gradient.transpose();
      if (k == m) block += law.moment * arms[k].sign * turn[k].hessian;
      writer.block(arms[k].to, arms[m].to, block);
      writer.block(arms[k].from, arms[m].from, block);
      writer.block(arms[k].to, arms[m].from, -block);
      writer.block(arms[k].from, arms[m].to, -block);
    }
  }
}

double LatchHinge::rotation(const Trial& trial) const {
  const Matrix32 plane = plane_of(trial);
  const std::array<Arm, 2> arms = arms_of(*this);
  double sum = 0.0;
  for (std::size_t k = 0; k < arm_count(*this); ++k) {
    const Arm& arm = arms[k];
    const Vector2d drawn = plane.transpose() * (trial.drawn[arm.to] - trial.drawn[arm.from]);
    const Vector2d moved = plane.transpose() * (trial.moved[arm.to] - trial.moved[arm.from]);
    sum += arm.sign * turn_by(drawn, moved);
  }
  return sum;
}

double LatchHinge::radius(const Trial& trial) const {
  return (trial.drawn[1] - trial.drawn[0]).norm();
}

double LatchHinge::turning_ratio(const Trial& trial) const {
  if (second_link < 0) return 1.0;
  return std::max(1.0, radius(trial) / (trial.drawn[3] - trial.drawn[2]).norm());
}

template struct HingeLaw<LatchHinge>;

}  // namespace statejump::truss
