// SPDX-License-Identifier: GPL-3.0-or-later
#include "statejump/truss/joints/latch_hinge.hpp"

#include <algorithm>
#include <cmath>

#include "statejump/kernel/require.hpp"
#include "statejump/truss/model.hpp"
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

double rotation_of(const LatchHinge& hinge, const Trial& trial) {
  const Matrix32 plane = plane_of(trial);
  const std::array<Arm, 2> arms = arms_of(hinge);
  double rotation = 0.0;
  for (std::size_t k = 0; k < arm_count(hinge); ++k) {
    const Arm& arm = arms[k];
    const Vector2d drawn = plane.transpose() * (trial.drawn[arm.to] - trial.drawn[arm.from]);
    const Vector2d moved = plane.transpose() * (trial.moved[arm.to] - trial.moved[arm.from]);
    rotation += arm.sign * turn_by(drawn, moved);
  }
  return rotation;
}

/// Radius that converts a moment to a force [m].
double radius_of(const Trial& trial) {
  return (trial.drawn[1] - trial.drawn[0]).norm();
}

/// Elastic rotation of sticking friction [rad].
double bend(const LatchHinge& hinge, const Trial& trial) {
  return radius_of(trial) * trial.force[0] / hinge.friction_stiffness;
}

/// Slipped part of the rotation [rad].
double slipped(const LatchHinge& hinge, const Trial& trial) {
  return rotation_of(hinge, trial) - bend(hinge, trial);
}

/// Rotation beyond the play [rad].
double beyond_play(const LatchHinge& hinge, double rotation) {
  return rotation - std::clamp(rotation, -hinge.deadband, hinge.deadband);
}

}  // namespace

std::span<const Parameter<LatchHinge>> LatchHinge::parameters() {
  using H = LatchHinge;
  static const Parameter<H> table[] = {
      {"first_link", "first link", "-", Allowed::link, "the case's links", &H::first_link},
      {"second_link", "second link", "-", Allowed::link_or_none, "the case's links",
       &H::second_link},
      {"deadband_rad", "deadband", "rad", Allowed::not_negative, "the case", &H::deadband},
      {"stiffness_N_m_per_rad", "stiffness", "N m/rad", Allowed::not_negative, "the case",
       &H::stiffness},
      {"friction_moment_N_m", "friction_moment", "N m", Allowed::not_negative, "the case",
       &H::friction_moment},
      {"friction_stiffness_N_m_per_rad", "friction_stiffness", "N m/rad",
       Allowed::positive_or_infinite, "the case", &H::friction_stiffness},
      {"preload_moment_N_m", "preload_moment", "N m", Allowed::finite, "the case",
       &H::preload_moment},
      {"axis", "axis", "-", Allowed::direction, "the case", &H::axis},
  };
  return table;
}

std::span<const Output> LatchHinge::outputs() {
  // Outputs: rotation from the reference configuration; moment against it (preload, stiffness and
  // friction).
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
  const double rotation = rotation_of(*this, trial);
  const double radius = radius_of(trial);
  const double force = trial.force[0];
  const double moment = elastic_moment(rotation) + radius * force;
  const double tangent = std::abs(rotation) < deadband ? 0.0 : stiffness;
  writer.carries(force);
  writer.carries(moment / radius);
  double corner = 0.0;
  double sticks = 0.0;
  switch (status) {
    case JointStatus::slip_plus:
    case JointStatus::slip_minus: {
      const double sense = status == JointStatus::slip_plus ? 1.0 : -1.0;
      writer.balance(0, force - sense * friction_moment / radius);
      corner = 1.0;
      break;
    }
    default:
      writer.closure(0, radius * (slipped(*this, trial) - trial.history[0]));
      corner = -radius * radius / friction_stiffness;
      sticks = radius;
  }
  writer.corner(0, 0, corner);
  std::array<AngleDerivatives, 2> turn;
  for (std::size_t k = 0; k < count; ++k) {
    turn[k] = angle_derivatives(plane.transpose() * trial.between(arms[k].from, arms[k].to), plane);
    const Vector3d gradient = arms[k].sign * turn[k].gradient;
    for (const auto& [node, sign] : {std::pair{arms[k].to, 1.0}, std::pair{arms[k].from, -1.0}}) {
      writer.force(node, sign * moment * gradient);
      writer.column(node, 0, sign * radius * gradient);
      writer.row(0, node, sign * sticks * gradient);
    }
  }
  for (std::size_t k = 0; k < count; ++k) {
    for (std::size_t m = 0; m < count; ++m) {
      Matrix3d block =
          tangent * arms[k].sign * arms[m].sign * turn[k].gradient * turn[m].gradient.transpose();
      if (k == m) block += moment * arms[k].sign * turn[k].hessian;
      writer.block(arms[k].to, arms[m].to, block);
      writer.block(arms[k].from, arms[m].from, block);
      writer.block(arms[k].to, arms[m].from, -block);
      writer.block(arms[k].from, arms[m].to, -block);
    }
  }
}

JointStatus LatchHinge::decide(const Trial& trial, JointStatus status) const {
  const double force = trial.force[0];
  if (status == JointStatus::stick) {
    const double bound = friction_moment / radius_of(trial) + trial.force_rounding;
    return force > bound    ? JointStatus::slip_plus
           : force < -bound ? JointStatus::slip_minus
                            : status;
  }
  const double sense = status == JointStatus::slip_plus ? 1.0 : -1.0;
  const double slid = radius_of(trial) * (slipped(*this, trial) - trial.history[0]);
  const double rounding = slide_rounding(trial, trial.length_rounding, trial.force_rounding);
  if (sense * slid >= -rounding) return status;
  if (friction_moment > 0.0) return JointStatus::stick;
  // Without friction both directions of slip are admissible.
  return sense > 0.0 ? JointStatus::slip_minus : JointStatus::slip_plus;
}

void LatchHinge::begin(const Trial& trial, JointStatus, double* now) const {
  now[0] = slipped(*this, trial);
}

void LatchHinge::commit(const Trial& trial, JointStatus status, double* after) const {
  begin(trial, status, after);
}

double LatchHinge::slip(const Trial& trial, const double* after) const {
  return radius_of(trial) * (after[0] - trial.history[0]);
}

double LatchHinge::dissipation(const Trial& trial, const double*, double slip) const {
  return friction_moment / radius_of(trial) * std::abs(slip);
}

double LatchHinge::elastic_energy(const Trial& trial, const double* now) const {
  const double rotation = rotation_of(*this, trial);
  const double beyond = beyond_play(*this, rotation);
  const double bent = std::isinf(friction_stiffness)
                          ? 0.0
                          : 0.5 * friction_stiffness * std::pow(rotation - now[0], 2);
  return 0.5 * stiffness * beyond * beyond + preload_moment * rotation + bent;
}

double LatchHinge::elastic_moment(double rotation) const {
  return preload_moment + stiffness * beyond_play(*this, rotation);
}

std::array<double, 2> LatchHinge::beyond_edges(const Trial& trial) const {
  const double radius = radius_of(trial), rotation = rotation_of(*this, trial);
  return {radius * (rotation - deadband), radius * (rotation + deadband)};
}

void LatchHinge::describe(const Trial& trial, double* outputs) const {
  const double rotation = rotation_of(*this, trial);
  outputs[0] = rotation;
  outputs[1] =
      preload_moment + stiffness * beyond_play(*this, rotation) + radius_of(trial) * trial.force[0];
}

double LatchHinge::slide_rounding(const Trial& trial, double length, double force) const {
  // Equal rounding errors of the end displacements rotate a shorter link by a larger angle.
  double turned = length;
  if (second_link >= 0) {
    turned *= std::max(1.0, radius_of(trial) / (trial.drawn[3] - trial.drawn[2]).norm());
  }
  return turned + std::pow(radius_of(trial), 2) * force / friction_stiffness;
}

bool LatchHinge::remembers_when(JointStatus before, JointStatus after) const {
  return friction_moment > 0.0 && is_slip(before) &&
         (after == JointStatus::stick || is_slip(after));
}

std::optional<LocalContact> LatchHinge::contact(const Trial& trial, JointStatus) const {
  return LocalContact{0, -1, 1.0, friction_moment / radius_of(trial)};
}

}  // namespace statejump::truss
