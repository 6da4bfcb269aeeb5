// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "ball_models.hpp"
#include "gradients.hpp"

namespace statejump::truss::testing {

/// A ball between two links, pressed into its socket and slipping.
struct Pressed {
  Model model;
  Eigen::VectorXd z;
  Vector3d n;
  Vector3d across;

  explicit Pressed(const BallJoint& joint = ball_joint(3, 1, 2, 0)) {
    model.programs = {triangle(100.0)};
    // Soft links have small rounding errors, which do not hide the terms of the joint.
    model.nodes = {node("A", {0, 0, 0}, 3), node("C", {0.12, 0.03, -0.05}, 3),
                   node("B", {0.02875, 0.0409, 0.01}, 3), node("J", {0.02875, 0.0409, 0.01}, 3)};
    model.links = {{"AB", 0, 2, 1e2, 0.05, 2e-5, 0, 1.0}, {"CJ", 1, 3, 1e2, 0.1, 1e-5, 0, 0.5}};
    model.joints = {joint};
    const detail::System system(model);
    z = Eigen::VectorXd::LinSpaced(system.unknowns(), 1e-5, 6e-5);
    z.segment<3>(9) += Vector3d(6e-5, 3e-5, -5e-5);  // in contact
    n = (z.segment<3>(9) - z.segment<3>(6)).normalized();
    across = n.unitOrthogonal();
    z.tail<3>() = 5.0 * n + 0.4 * across + 0.3 * n.cross(across);
  }
  /// @param load normal force [N]
  Eigen::VectorXd before(double load) const {
    Eigen::VectorXd state = z;
    state[0] -= 3e-6;
    state[4] += 4e-6;
    state[10] += 2e-6;
    state[5] -= 5e-6;
    state.tail<3>() = load * n + 0.3 * n.cross(across);
    return state;
  }
};

}  // namespace statejump::truss::testing
