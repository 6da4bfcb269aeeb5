// SPDX-License-Identifier: GPL-3.0-or-later
// Rigid and elastic balls in sockets in motion, compared with independent equations, with
// journals and with the quasi-static path.
#include <gtest/gtest.h>

#include <array>
#include <boost/numeric/odeint.hpp>
#include <cmath>
#include <limits>

#include "ball_scenes.hpp"
#include "statejump/kernel/require.hpp"

namespace statejump::truss {
namespace {

using namespace scenes;
using Eigen::Matrix3Xd;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double gravity = 9.81;
constexpr double clearance = 1e-3;
constexpr double infinite = std::numeric_limits<double>::infinity();

/// A rigid ball of 1 kg that falls in direction `down` within its rigid socket.
Model falling_ball(const Vector3d& down, double friction, double seconds) {
  Model model;
  model.programs = {lasting(seconds)};
  model.nodes = {testing::node("socket", {0, 0, 0}, 0), testing::node("ball", {0, 0, 0}, 3)};
  model.nodes[1].load = gravity * down;
  BallJoint joint = testing::ball_joint(1, -1, 0, -1);
  joint.radial_clearance = clearance;
  joint.ball_thermal_expansion = joint.socket_thermal_expansion = 0.0;
  joint.friction_coefficient = friction;
  joint.hertz_stiffness = joint.mindlin_stiffness = infinite;
  model.joints = {joint};
  return model;
}

Inertia one_kilogram() {
  Inertia inertia;
  inertia.node_mass = Vector2d(0.0, 1.0);
  return inertia;
}

TEST(MotionBall, BouncesAtItsAnalyticTimes) {
  const Vector3d down = Vector3d(1.0, -2.0, 0.7).normalized();
  const Model model = falling_ball(down, 0.3, 0.1);
  const double e = 0.7;
  MotionOptions options;
  options.steps = 20000;
  options.restitution = e;
  options.start = at_rest(model);
  options.start->displacement.col(1) = 0.5 * clearance * down;
  const Motion motion = simulate(model, one_kilogram(), options);
  double speed = std::sqrt(2.0 * gravity * 0.5 * clearance);
  const double energy = 0.5 * speed * speed;
  double time = speed / gravity;
  int impact = 0;
  for (const Event& event : motion.events) {
    if (event.before != JointStatus::open || impact == 6) continue;
    // A contact is located to one step, and every bounce inherits the errors of earlier ones.
    EXPECT_NEAR(event.time, time, 3.0 * motion.time_step * (1 + impact)) << "impact " << impact;
    speed *= e;
    time += 2.0 * speed / gravity;
    ++impact;
  }
  EXPECT_EQ(impact, 6);
  // The ball stays on its line, and impacts dissipate the energy of the fall.
  const Vector3d place = motion.states.back().displacement.col(1);
  EXPECT_LT((place - down * down.dot(place)).norm(), 1e-9 * clearance);
  EXPECT_NEAR(motion.moving.back().impact_dissipation, energy, 1e-3 * energy);
  EXPECT_LT(std::abs(residue(motion)), 1e-9 * energy);
}

using Numbers = std::array<double, 6>;

/// Reference for a point on a sphere under its weight and centrifugal force, with friction against
/// its velocity. Returns position and velocity, integrated to 1e-12.
Numbers slid_on_a_sphere(const Vector3d& down, double friction, double seconds, Numbers y) {
  const auto rates = [&](const Numbers& at, Numbers& rate, double) {
    const Vector3d place(at[0], at[1], at[2]);
    const Vector3d speed(at[3], at[4], at[5]);
    const Vector3d normal = place.normalized();
    const double pressed = gravity * down.dot(normal) + speed.squaredNorm() / clearance;
    const Vector3d force =
        gravity * down - pressed * normal - friction * pressed * speed.normalized();
    for (std::size_t k = 0; k < 3; ++k) {
      rate[k] = at[3 + k];
      rate[3 + k] = force[static_cast<int>(k)];
    }
  };
  namespace odeint = boost::numeric::odeint;
  odeint::integrate_adaptive(
      odeint::make_controlled(1e-14, 1e-12, odeint::runge_kutta_dopri5<Numbers>()), rates, y, 0.0,
      seconds, 1e-6);
  return y;
}

TEST(MotionBall, SlidesAroundItsSocketByItsOwnEquation) {
  const Vector3d down = Vector3d(1.0, -2.0, 0.7).normalized();
  const Vector3d aside = down.unitOrthogonal();
  const Vector3d along = down.cross(aside);
  // The ball starts beside the deepest point of the socket, perpendicular to the slope, so that the
  // directions of motion and friction change. Friction would stop the ball after three times the
  // duration.
  const double seconds = 0.02;
  const Vector3d place = clearance * (std::cos(0.6) * down + std::sin(0.6) * aside);
  const Vector3d speed = 0.08 * along;
  const double friction = 0.1;
  const Model model = falling_ball(down, friction, seconds);
  const Numbers exact = slid_on_a_sphere(
      down, friction, seconds, {place[0], place[1], place[2], speed[0], speed[1], speed[2]});
  const auto error = [&](long steps) {
    MotionOptions options;
    options.steps = options.sample_every = steps;
    options.start = at_rest(model);
    options.start->displacement.col(1) = place;
    options.start->velocity.col(1) = speed;
    const Motion motion = simulate(model, one_kilogram(), options);
    const Vector3d moved = motion.states.back().displacement.col(1);
    EXPECT_EQ(motion.states.back().joint_status[0], JointStatus::slip_plus);
    const Vector3d end(exact[3], exact[4], exact[5]);
    const double heat = 0.5 * (speed.squaredNorm() - end.squaredNorm()) +
                        gravity * down.dot(Vector3d(exact[0], exact[1], exact[2]) - place);
    EXPECT_NEAR(motion.states.back().joint_dissipation[0], heat,
                20.0 / static_cast<double>(steps) * heat);
    return (moved - Vector3d(exact[0], exact[1], exact[2])).norm() / clearance;
  };
  const double coarse = error(2000);
  const double fine = error(4000);
  EXPECT_LT(fine, 1e-3);
  // The scheme keeps friction direction and normal constant within a step, so it is at least of
  // first order.
  EXPECT_GT(coarse / fine, 1.8);
}

TEST(MotionBall, MovesAsTheJournalDoesInAPlane) {
  MotionOptions options;
  options.steps = 4000;
  options.sample_every = 400;
  // Ball and journal have the same law, in three and two dimensions. The ball may have friction
  // components across its direction. Both share the linear start of the depth.
  expect_ball_moves_as_journal(
      [&](const Model& model) { return simulate(model, rib_inertia(), options); }, 1e-6, 1e-4);
}

TEST(MotionBall, SlowHeatingFollowsTheQuasiStaticPath) {
  const auto apart = [](double seconds) {
    Model model = testing::tripod();
    for (thermal::Program& program : model.programs) {
      const double share = seconds / program.period;
      program.period = seconds;
      for (double& time : program.table_times) time *= share;
    }
    Inertia inertia;
    inertia.node_mass = Eigen::VectorXd::Constant(8, 0.02);
    inertia.link_damping = Eigen::VectorXd::Constant(4, 60.0);
    inertia.pin_damping = Eigen::VectorXd::Constant(4, 0.05);
    MotionOptions options;
    options.steps = options.sample_every = std::lround(16000 * seconds);
    const Motion motion = simulate(model, inertia, options);
    const State moved = motion.states.back();
    Options finely;
    finely.increments_per_branch = 1600;
    const State rested = solve(model, finely).states.back();
    EXPECT_NEAR(moved.joint_dissipation[0], rested.joint_dissipation[0],
                0.02 * rested.joint_dissipation[0]);
    return (moved.displacement - rested.displacement).norm() / rested.displacement.norm();
  };
  const double fast = apart(0.2);
  const double slow = apart(1.0);
  EXPECT_LT(slow, 1e-5);
  // Dashpots delay the end state in proportion to the heating rate. This first-order error is the
  // only one.
  EXPECT_NEAR(fast / slow, 5.0, 0.05);
}

TEST(MotionBall, IsRigidInMotionOnly) {
  const Model model = falling_ball(-Vector3d::UnitZ(), 0.1, 1.0);
  EXPECT_THROW(solve(model), kernel::OutOfRange);
}

}  // namespace
}  // namespace statejump::truss
