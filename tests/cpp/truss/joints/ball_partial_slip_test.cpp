// SPDX-License-Identifier: GPL-3.0-or-later
// Ball joint with partial slip, and rotation of friction directions.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "ball_gradients.hpp"
#include "ball_models.hpp"
#include "statejump/kernel/frame.hpp"
#include "statejump/truss/path.hpp"
#include "truss/joints/ball_contact.hpp"

namespace statejump::truss {
namespace {

using namespace testing;
using Eigen::Matrix3d;
using Eigen::Vector3d;

Model with_partial_slip(Model model) {
  for (Joint& joint : model.joints) {
    if (auto* one = std::get_if<BallJoint>(&joint)) one->partial_slip = 1;
    if (auto* one = std::get_if<ClearanceRevolute>(&joint)) one->partial_slip = 1;
  }
  return model;
}

TEST(BallPartialSlip, GradientsAreThoseOfItsForces) {
  BallJoint joint = ball_joint(3, 1, 2, 0);
  joint.partial_slip = 1;
  // This contact is so soft that slides of 1e-6 m to 1e-5 m per step remain within partial slip.
  joint.mindlin_stiffness = 3e7;
  const Pressed pressed(joint);
  for (const double loaded : {4.0, 7.0}) {
    const Eigen::VectorXd before = pressed.before(loaded);
    check_gradients(pressed.model, pressed.z, before, {JointStatus::stick, JointStatus::open}, 1e-9,
                    1e-5);
    // First a step in another direction: the slip direction changes.
    Eigen::VectorXd between = before;
    between.segment<3>(9) += 8e-6 * pressed.across;
    check_gradients(pressed.model, pressed.z, before, {JointStatus::stick, JointStatus::open}, 1e-9,
                    1e-5, between);
  }
}

TEST(BallPartialSlip, InAPlaneHoweverTurnedItIsTheRevolute) {
  // Ball and revolute joints integrate the slide of a step differently. With 50 increments their
  // heats differ by 1.4e-9, proportional to the fourth power of the increment.
  Options options;
  options.increments_per_branch = 100;
  const Path planar = solve(with_partial_slip(rib(false, Matrix3d::Identity())), options);
  for (const Vector3d& axis : {Vector3d(0, 0, 1), Vector3d(1, 2, -2), Vector3d(-3, 0.5, 1)}) {
    const Matrix3d turned =
        Eigen::AngleAxisd(axis.norm() - 1.0, axis.normalized()).toRotationMatrix();
    const Path path = solve(with_partial_slip(rib(true, turned)), options);
    ASSERT_EQ(path.states.size(), planar.states.size());
    ASSERT_EQ(path.events.size(), planar.events.size());
    const State& end = path.states.back();
    const State& expected = planar.states.back();
    const double size = expected.displacement.norm();
    EXPECT_LT((turned.transpose() * end.displacement - expected.displacement).norm(), 1e-10 * size);
    ASSERT_GT(expected.joint_dissipation[0], 0.0);
    EXPECT_NEAR(end.joint_dissipation[0], expected.joint_dissipation[0],
                1e-9 * expected.joint_dissipation[0]);
  }
}

TEST(BallPartialSlip, TurnedInSpaceTheTrussIsTheSame) {
  expect_the_same_turned(with_partial_slip(tripod()), 1e-6);
}

TEST(BallPartialSlip, IncrementsMatterToFirstOrderAndEnergyIsKeptToTheChords) {
  const Model model = with_partial_slip(tripod());
  const BallJoint& joint = joint_of(model);
  Vector3d fine = Vector3d::Zero();
  double off[2] = {0.0, 0.0};
  for (const int increments : {1600, 200, 50}) {
    Options options;
    options.increments_per_branch = increments;
    const Path path = solve(model, options);
    const Vector3d moved = path.states.back().displacement.col(4);
    if (increments == 1600) {
      fine = moved;
    } else {
      off[increments == 50 ? 0 : 1] = (moved - fine).norm() / fine.norm();
    }
    // A chord has an error of 1e-4 of the limit; several lie within the slide that erases the
    // memory. More steps have more chords.
    EXPECT_LT(std::abs(relative_residue(path)), 3e-4) << increments;
    double before = 0.0;
    for (const State& state : path.states) {
      EXPECT_GE(state.joint_dissipation[0], before);
      before = state.joint_dissipation[0];
      EXPECT_LE(friction(model, state).norm(),
                joint.friction_coefficient * normal(model, state) * (1.0 + 1e-9));
    }
  }
  // Annuli return radially to their bounds, whatever the path. If the slide direction changes, this
  // causes a first-order error.
  EXPECT_LT(off[0], 5e-6);
  EXPECT_LT(off[1], 0.3 * off[0]);
}

/// Ball and socket are at the tips of two stiff triangles. First a rod of the ball's triangle is
/// heated a little, which causes friction. Then struts rotate both triangles about one corner,
/// about the contact normal. The socket's triangle is higher by the offset of the centres under
/// load, because an inclined triangle would rotate its tip differently. In the reference
/// configuration both centres coincide.
Model on_turntables() {
  Model model;
  model.programs = {quarters({0.0, 100.0, 100.0}), quarters({0.0, 0.0, 100.0})};
  BallJoint joint = ball_joint(3, 4, 8, 9);
  joint.ball_thermal_expansion = joint.socket_thermal_expansion = 0.0;
  joint.friction_coefficient = 0.3;
  model.joints = {joint};
  const double load = 100.0;
  const double above = joint.radial_clearance + std::pow(load / joint.hertz_stiffness, 2.0 / 3.0);
  // Heating causes a slide of 1.5e-7 m along x. Gross slip would begin at 9e-7 m.
  for (const auto& [height, rubs] : {std::pair{0.0, 5e-9}, std::pair{above, 0.0}}) {
    const int first = static_cast<int>(model.nodes.size());
    for (const Node& one : {node("pivot", {0.0, 0.0, height}, 0), node("P", {0.1, -0.1, height}, 2),
                            node("Q", {0.1, 0.1, height}, 2), node("tip", {0.4, 0.0, above}, 2),
                            node("strut", {0.1, -0.5, height}, 0)}) {
      model.nodes.push_back(one);
      model.nodes.back().name += height > 0.0 ? " of the socket" : " of the ball";
    }
    const auto link = [&](int from, int to, double expansion, int program) {
      const Node& a = model.nodes[static_cast<std::size_t>(first + from)];
      const Node& b = model.nodes[static_cast<std::size_t>(first + to)];
      model.links.push_back({a.name + " - " + b.name, first + from, first + to,
                             to == 3 ? 1e9 : 1e11, (b.position - a.position).head<2>().norm(),
                             expansion, program, 1.0});
    };
    link(0, 1, 0.0, 0);
    link(0, 2, 0.0, 0);
    link(1, 2, 0.0, 0);
    link(1, 3, rubs, 0);
    link(2, 3, 0.0, 0);
    link(4, 1, 1e-3, 1);  // a rotation of about 0.3 rad
  }
  model.nodes[3].freedoms = 3;
  model.nodes[3].load = {0.0, 0.0, -load};
  return model;
}

TEST(BallPartialSlip, FrictionTurnsWithPartsThatTurnAboutTheNormal) {
  for (const bool partial : {false, true}) {
    const Model model = partial ? with_partial_slip(on_turntables()) : on_turntables();
    const Path path = solve(model);
    Vector3d rubbed = Vector3d::Zero();
    double turned = 0.0;
    for (const State& state : path.states) {
      if (state.time < 0.25) continue;
      // Rotation angle of the triangle, from the position of P on its circle about the pivot.
      const Vector3d corner = model.nodes[1].position + state.displacement.col(1);
      const double angle = std::atan2(corner.y(), corner.x()) + 0.25 * 3.14159265358979323846;
      const Matrix3d back = Eigen::AngleAxisd(-angle, Vector3d::UnitZ()).toRotationMatrix();
      const Vector3d now = back * friction(model, state);
      if (rubbed.isZero(0.0)) rubbed = now;
      // The friction moment deforms the struts by a thousandth of the slide.
      EXPECT_LT((now - rubbed).norm(), 4e-3 * rubbed.norm()) << angle << " rad";
      turned = std::max(turned, angle);
      EXPECT_EQ(state.joint_status[0], JointStatus::stick);
    }
    EXPECT_GT(rubbed.norm(), 5.0);
    EXPECT_GT(turned, 0.3);
  }
}

TEST(BallPartialSlip, DirectionsOfFrictionTurnByTheMeanSpinOfBothParts) {
  // Ball and socket rotate about the contact normal by different angles.
  const Vector3d n = Vector3d(1.0, -2.0, 0.5).normalized();
  const Vector3d across = n.unitOrthogonal();
  detail::BallMemory start{};
  start.offset = 1e-4 * n;
  start.ball_direction = 0.3 * across;
  start.socket_direction = 0.2 * n.cross(across);
  start.friction = 2.0 * across - n.cross(across);
  start.axis = across;
  for (const auto& [of_ball, of_socket] :
       {std::pair{0.2, 0.2}, std::pair{0.3, -0.1}, std::pair{0.0, 0.4}, std::pair{-0.25, 0.0}}) {
    const auto turn = [&](const Vector3d& direction, double angle) {
      return Vector3d(Eigen::AngleAxisd(angle, n) * direction);
    };
    detail::BallState<double> now{};
    now.offset = start.offset;
    now.normal = n;
    now.distance = start.offset.norm();
    now.ball_direction = turn(start.ball_direction, of_ball);
    now.socket_direction = turn(start.socket_direction, of_socket);
    const detail::BallSlide<double> found = detail::ball_slide(now, start);
    const double mean = 0.5 * (of_ball + of_socket);
    EXPECT_LT((found.kept - kernel::transport(start.friction, n, n, mean)).norm(), 1e-14);
    EXPECT_LT((found.axis - turn(across, mean)).norm(), 1e-14);
    EXPECT_LT(found.slide.norm(), 1e-18);
  }
}

TEST(BallPartialSlip, WithoutFrictionItIsRefused) {
  Model model = with_partial_slip(tripod());
  std::get<BallJoint>(model.joints[0]).friction_coefficient = 0.0;
  EXPECT_THROW(solve(model), std::invalid_argument);
}

}  // namespace
}  // namespace statejump::truss
