// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <stdexcept>
#include <string>

#include "ball_gradients.hpp"
#include "ball_models.hpp"
#include "statejump/truss/path.hpp"

namespace statejump::truss {
namespace {

using namespace testing;
using Eigen::Matrix3d;
using Eigen::Vector3d;

TEST(BallJoint, GradientsAreThoseOfItsForces) {
  const Pressed pressed;
  // Loading and unloading: the elastic slide has a branch for each.
  for (const double loaded : {4.0, 7.0}) {
    check_gradients(pressed.model, pressed.z, pressed.before(loaded),
                    {JointStatus::stick, JointStatus::slip_plus, JointStatus::open}, 1e-8, 1e-4);
  }
}

TEST(BallJoint, GradientsByRotationsOfNodesAreThoseOfItsForces) {
  Pressed pressed;
  bend_links(pressed.model);
  BallJoint& joint = std::get<BallJoint>(pressed.model.joints[0]);
  joint.ball_link = joint.socket_link = -1;
  joint.ball_turns = joint.socket_turns = 1;
  const detail::System system(pressed.model);
  ASSERT_EQ(system.displacements(), 24);
  // Six displacements of a node instead of three; both nodes of the joint have large rotations.
  const auto widened = [&](const Eigen::VectorXd& from) {
    Eigen::VectorXd to(system.unknowns());
    for (int n = 0; n < 4; ++n) to.segment<3>(6 * n) = from.segment<3>(3 * n);
    to.segment<3>(3) = to.segment<3>(9) = Vector3d(2e-5, -1e-5, 3e-5);
    to.segment<3>(15) = Vector3d(0.1, -0.2, 0.3) * 0.05;
    to.segment<3>(21) = Vector3d(-0.3, 0.1, 0.2) * 0.05;
    to.tail<3>() = from.tail<3>();
    return to;
  };
  for (const double loaded : {4.0, 7.0}) {
    Eigen::VectorXd before = widened(pressed.before(loaded));
    before.segment<3>(15) += Vector3d(-3e-6, 1e-6, 2e-6);
    before.segment<3>(21) += Vector3d(2e-6, -4e-6, 1e-6);
    check_gradients(pressed.model, widened(pressed.z), before,
                    {JointStatus::stick, JointStatus::slip_plus, JointStatus::open}, 1e-8, 1e-4);
  }
}

TEST(BallJoint, InAPlaneHoweverTurnedItIsTheRevolute) {
  const Path planar = solve(rib(false, Matrix3d::Identity()));
  for (const Vector3d& axis : {Vector3d(0, 0, 1), Vector3d(1, 2, -2), Vector3d(-3, 0.5, 1)}) {
    const Matrix3d turned =
        Eigen::AngleAxisd(axis.norm() - 1.0, axis.normalized()).toRotationMatrix();
    const Path path = solve(rib(true, turned));
    ASSERT_EQ(path.states.size(), planar.states.size());
    ASSERT_EQ(path.events.size(), planar.events.size());
    ASSERT_GE(path.events.size(), 2u);
    for (std::size_t i = 0; i < path.events.size(); ++i) {
      EXPECT_NEAR(path.events[i].time, planar.events[i].time, 2e-9);
    }
    const State& end = path.states.back();
    const State& expected = planar.states.back();
    const double size = expected.displacement.norm();
    EXPECT_LT((turned.transpose() * end.displacement - expected.displacement).norm(), 1e-10 * size);
    EXPECT_NEAR(end.joint_dissipation[0], expected.joint_dissipation[0],
                1e-9 * expected.joint_dissipation[0]);
  }
}

TEST(BallJoint, TurnedInSpaceTheTrussIsTheSame) {
  expect_the_same_turned(tripod(), 2e-7);
}

TEST(BallJoint, FrictionTurnsIntoANewSlideAsATractrix) {
  // Gross slip along x is followed by a slide s along y. The angle θ between friction and slide
  // obeys dθ/ds = −(k/μN) sin θ, so tan(θ/2) decreases from 1 as exp(−k s/μN).
  const Model model = pushed_around_a_corner();
  double error[2] = {0.0, 0.0};
  for (const int fine : {0, 1}) {
    Options options;
    options.increments_per_branch = 100 << fine;
    const Path path = solve(model, options);
    error[fine] = 0.0;
    int turning = 0;
    for (const State& state : path.states) {
      const double pressed = normal(model, state);
      EXPECT_NEAR(pressed, 100.0, 0.2);
      if (state.time < 0.25) continue;
      const double bound = 0.15 * pressed;
      const Vector3d rubs = -friction(model, state);
      EXPECT_NEAR(rubs.norm(), bound, 1e-9 * bound);
      const double depth = std::pow(pressed / joint_of(model).hertz_stiffness, 2.0 / 3.0);
      const double stiffness = joint_of(model).mindlin_stiffness * std::sqrt(depth);
      // Slide since the second rod began to expand.
      const double slid = 5e-6 * (state.time - 0.25) / 0.25;
      const double expected = 2.0 * std::atan(std::exp(-stiffness * slid / bound));
      const double found = std::atan2(rubs.x(), rubs.y());
      error[fine] = std::max(error[fine], std::abs(found - expected));
      if (expected < 1.3 && expected > 0.1) ++turning;
    }
    EXPECT_GT(turning, 20);
  }
  // The rods deform by a thousandth of the contact's deflection. The number of increments has no
  // effect.
  EXPECT_LT(error[0], 1e-3);
  EXPECT_NEAR(error[1], error[0], 1e-6);
}

TEST(BallJoint, OpensAndClosesWhereTheRodThatPressesItIsAsLongAsTheWay) {
  // Three rods constrain the ball. Cooling shortens the rod that presses the ball down.
  Model model = pushed_around_a_corner();
  model.programs = {quarters({0.0, -100.0, 0.0})};
  model.nodes[1].load.setZero();
  model.nodes.push_back(node("Z", {0, 0, 10.0}, 0));
  const double pressed = 10.002;
  const double expansion = 2e-6;
  model.links = {{"X", 2, 1, 1e9, 10.0, 0.0, 0, 1.0},
                 {"Y", 3, 1, 1e9, 10.0, 0.0, 0, 1.0},
                 {"Z", 4, 1, 1e9, pressed, expansion, 0, 1.0}};
  const Path path = solve(model);
  // As the load vanishes, so does the friction bound, but not the tangential deflection. The
  // contact slips before it opens.
  const JointStatus expected[] = {JointStatus::stick, JointStatus::slip_plus, JointStatus::open,
                                  JointStatus::stick};
  ASSERT_GE(path.events.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(path.events[i].before, expected[i]);
    EXPECT_EQ(path.events[i].after, expected[i + 1]);
  }
  // Lateral rods elongate by c²/(2 L) = 5e-8 m and carry the fraction c/L of their force, which
  // shifts the event by less than 1e-5 K.
  const double change = ((10.0 + joint_of(model).radial_clearance) / pressed - 1.0) / expansion;
  EXPECT_NEAR(path.events[1].temperature_change, change, 1e-5);
  EXPECT_NEAR(path.events[2].temperature_change, change, 1e-5);
  for (const State& state : path.states) {
    if (state.joint_status[0] != JointStatus::open) continue;
    EXPECT_EQ(normal(model, state), 0.0);
    EXPECT_TRUE(friction(model, state).isZero(0.0));
  }
}

TEST(BallJoint, EnergyIsKeptWhateverTheIncrements) {
  for (const int increments : {10, 50}) {
    Options options;
    options.increments_per_branch = increments;
    const auto lost = [&] {
      const Path path = solve(tripod(), options);
      double work = 0.0;
      for (const State& state : path.states) work = std::max(work, std::abs(state.thermal_work));
      return std::abs(relative_residue(path)) * path.states.back().joint_dissipation.sum() / work;
    };
    // Step halving and event location may each cause an energy error of the tolerance, with the
    // same sign. The scale is the largest work, less than twice the solver's.
    EXPECT_LT(lost(), 2.0 * options.energy_tolerance);
    // Without step halving more energy is lost.
    options.energy_tolerance = 1.0;
    EXPECT_GT(lost(), 4.0 * Options().energy_tolerance);
  }
}

TEST(BallJoint, IncrementsDoNotMatterAndEnergyIsKept) {
  const Model model = tripod();
  double jump[3] = {0.0, 0.0, 0.0};
  double residue[3] = {0.0, 0.0, 0.0};
  Vector3d fine = Vector3d::Zero();
  for (const int i : {2, 1, 0}) {
    Options options;
    options.increments_per_branch = i == 2 ? 3200 : 50 << (2 * i);
    options.energy_tolerance = 1.0;  // disables step halving
    const Path path = solve(model, options);
    const Vector3d moved = path.states.back().displacement.col(4);
    if (i == 2) fine = moved;
    jump[i] = (moved - fine).norm() / fine.norm();
    residue[i] = std::abs(relative_residue(path));
  }
  // With four times the increments, jump and residue decrease at least with second order.
  EXPECT_LT(jump[0], 1e-6);
  EXPECT_LT(jump[1], 0.08 * jump[0]);
  EXPECT_LT(residue[0], 1e-6);
  EXPECT_LT(residue[1], 0.08 * residue[0]);
}

TEST(BallJoint, ItemsOutOfRangeAreNamed) {
  const auto refused = [](auto change) {
    Model model = tripod();
    change(std::get<BallJoint>(model.joints[0]));
    EXPECT_THROW(solve(model), std::invalid_argument);
  };
  refused([](BallJoint& one) { one.socket_node = one.ball_node; });
  refused([](BallJoint& one) { one.ball_link = 1; });
  refused([](BallJoint& one) { one.socket_link = 3; });
  refused([](BallJoint& one) { one.hertz_stiffness = 0.0; });
  refused([](BallJoint& one) { one.mindlin_stiffness = INFINITY; });
  refused([](BallJoint& one) { one.radial_clearance = 0.0; });
  refused([](BallJoint& one) { one.friction_coefficient = -0.1; });
  refused([](BallJoint& one) { one.ball_thermal_expansion = 1e-3; });
}

}  // namespace
}  // namespace statejump::truss
