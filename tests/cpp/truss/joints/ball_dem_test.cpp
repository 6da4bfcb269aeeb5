// SPDX-License-Identifier: GPL-3.0-or-later
// Drives the DEM's contact, with its own kinematics, along the paths of the quasi-static solver.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "ball_models.hpp"
#include "statejump/kernel/contact_law.hpp"
#include "statejump/kernel/frame.hpp"
#include "statejump/kernel/joint_kinematics.hpp"
#include "statejump/kernel/laws/friction.hpp"

namespace statejump::truss {
namespace {

using namespace testing;
using Eigen::Vector3d;

struct Driven {
  double error = 0.0;     ///< Error of friction relative to the largest friction force.
  double smallest = 1.0;  ///< Smallest friction over its bound, without the first state.
  int slips = 0;
  int states = 0;
};

/// @param partial whether the DEM's contact has partial slip
Driven driven(const Model& model, int increments, bool partial) {
  const BallJoint& joint = joint_of(model);
  Options options;
  options.increments_per_branch = increments;
  const Path path = solve(model, options);
  kernel::ContactHistory history;
  Vector3d before = Vector3d::Zero();
  Driven found;
  double largest = 0.0;
  for (std::size_t i = 0; i < path.states.size(); ++i) {
    const State& state = path.states[i];
    const Vector3d offset = output(model, state, 0, "ball_eccentricity_m");
    const Vector3d n = offset.normalized();
    const double change = state.temperature_change;
    const double inner = joint.ball_radius * (1.0 + joint.ball_thermal_expansion * change);
    const double outer = (joint.ball_radius + joint.radial_clearance) *
                         (1.0 + joint.socket_thermal_expansion * change);
    const double stiffness = joint.mindlin_stiffness * std::sqrt(offset.norm() - (outer - inner));
    const double pressed = normal(model, state);
    kernel::laws::FrictionKinematics at;
    at.normal_force = pressed;
    at.normal = n;
    at.tangential_stiffness = stiffness;
    at.tangential_velocity.setZero();
    at.time_step = 1.0;
    const kernel::laws::FrictionParameters parameters{joint.friction_coefficient};
    if (i == 0) {
      history.tangential_stiffness = stiffness;
      if (partial) kernel::laws::MindlinDeresiewiczFriction{}(parameters, at, history);
      before = n;
      continue;
    }
    const State& last = path.states[i - 1];
    // Displacement of a node in the step, i.e. its mean velocity times the step length.
    const auto moved = [&](int at_node) {
      return Vector3d(state.displacement.col(at_node) - last.displacement.col(at_node));
    };
    const auto place = [&](const State& of, int number) {
      return Vector3d(model.nodes[static_cast<std::size_t>(number)].position +
                      of.displacement.col(number));
    };
    const auto spin = [&](int tip, int root) {
      const Vector3d along =
          0.5 * (place(state, tip) + place(last, tip) - place(state, root) - place(last, root));
      return Vector3d(along.cross(moved(tip) - moved(root)) / along.squaredNorm());
    };
    const kernel::BodyMotion ball{place(state, 4), moved(4), spin(4, 5)};
    const kernel::BodyMotion socket{place(state, 3), moved(3), spin(3, 0)};
    const kernel::BallContact contact = kernel::ball_contact(ball, inner, socket, outer);
    const double twist = 0.5 * (ball.angular_velocity + socket.angular_velocity).dot(n);
    history.tangential_force = kernel::transport(history.tangential_force, before, n, twist);
    history.tangential_axis = kernel::transport(history.tangential_axis, before, n, twist);
    at.tangential_velocity = contact.relative_velocity - n * n.dot(contact.relative_velocity);
    if (partial) {
      kernel::laws::MindlinDeresiewiczFriction{}(parameters, at, history);
    } else {
      kernel::laws::MindlinFriction{}(parameters, at, history);
    }
    before = n;
    const Vector3d rubs = friction(model, state);
    found.error = std::max(found.error, (history.tangential_force - rubs).norm());
    largest = std::max(largest, rubs.norm());
    found.smallest = std::min(found.smallest, rubs.norm() / (joint.friction_coefficient * pressed));
    if (is_slip(state.joint_status[0])) ++found.slips;
  }
  found.error /= largest;
  found.states = static_cast<int>(path.states.size());
  return found;
}

TEST(BallJoint, IsTheHistorySpringOfTheDemInSpace) {
  const Driven coarse = driven(tripod(), 1000, false);
  const Driven fine = driven(tripod(), 2000, false);
  EXPECT_GT(fine.slips, 100);
  EXPECT_LT(fine.slips, fine.states - 100);
  // If the slide direction changes, a contact step of the DEM is of first order.
  EXPECT_LT(coarse.error, 2e-3);
  EXPECT_NEAR(fine.error, 0.5 * coarse.error, 0.05 * coarse.error);
}

TEST(BallJoint, IsTheContactWithPartialSlipOfTheDemInSpace) {
  Model model = tripod();
  std::get<BallJoint>(model.joints[0]).partial_slip = 1;
  const Driven coarse = driven(model, 1000, true);
  const Driven fine = driven(model, 2000, true);
  EXPECT_GT(fine.slips, 100);
  EXPECT_LT(fine.slips, fine.states - 100);
  EXPECT_LT(fine.smallest, 0.5);
  // The error is of first order, plus the chord errors of solver and DEM.
  EXPECT_LT(coarse.error, 2e-3);
  EXPECT_LT(fine.error, 0.5 * coarse.error + 3e-4);
}

}  // namespace
}  // namespace statejump::truss
