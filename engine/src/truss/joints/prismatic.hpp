// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "statejump/truss/model.hpp"
#include "truss/joints/writer.hpp"
#include "truss/parts.hpp"

namespace statejump::truss::detail {

/// Frame of a joint whose first node moves along a fixed axis. Its first force acts along the axis.
/// If there is a second node, further forces constrain both nodes across the axis.
/// @param second −1: ground
inline JointFrame prismatic_frame(const Model& model, int first, int second, const Vector3d& axis) {
  JointFrame frame;
  frame.nodes = {first, second, -1, -1};
  frame.node_count = 2;
  frame.forces = 1;
  const Matrix32 plane = plane_of(axis);
  frame.axes << axis, plane;
  for (int i = 1; i < 3 && second >= 0; ++i) {
    const Vector3d across = frame.axes.col(i);
    frame.holds[index(i)] = moves_along(model.nodes[index(first)], across) ||
                            moves_along(model.nodes[index(second)], across);
    if (frame.holds[index(i)]) ++frame.forces;
  }
  return frame;
}

/// Applies the joint's first unknown to both nodes, as equal and opposite forces along the axis.
inline void push_along(const Trial& trial, const Vector3d& axis, JointWriter& writer) {
  const double force = trial.force[0];
  writer.carries(force);
  writer.force(0, force * axis);
  writer.force(1, -force * axis);
  writer.column(0, 0, axis);
  writer.column(1, 0, -axis);
}

/// Writes the rows of the forces that constrain the nodes across the axis.
inline void hold_across(const Trial& trial, JointWriter& writer) {
  int held = 1;
  for (int i = 1; i < 3; ++i) {
    if (!trial.frame.holds[index(i)]) continue;
    const Vector3d across = trial.frame.axes.col(i);
    writer.hold(held, across, trial.force[index(held)],
                across.dot(trial.moved[0] - trial.moved[1]));
    ++held;
  }
}

}  // namespace statejump::truss::detail
