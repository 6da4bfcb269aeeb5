// SPDX-License-Identifier: GPL-3.0-or-later
// Bodies other than rods, and driven links.
#include <gtest/gtest.h>

#include <boost/numeric/odeint.hpp>
#include <cmath>
#include <stdexcept>
#include <vector>

#include "../../support/argument.hpp"
#include "scenes.hpp"

namespace statejump::truss {
namespace {

using statejump::testing::Argument;
using statejump::testing::refused_argument;
using namespace scenes;
using Eigen::Vector2d;

TEST(MotionMechanism, BodyOnAPinSwingsByItsOwnEquation) {
  // A plate whose centre of mass is beside the line of its nodes, so that θ'' = −m g d cos(θ +
  // φ)/(J + m d²).
  const double mass = 2.0;
  const double moment = 0.05;
  const double length = 0.5;
  const Vector2d centre(0.3, 0.04);
  const double inertia_about_pin = moment + mass * centre.squaredNorm();
  const double phase = std::atan2(centre.y(), centre.x());
  std::vector<double> exact{0.0, 0.0};
  namespace odeint = boost::numeric::odeint;
  odeint::integrate_adaptive(
      odeint::make_controlled(1e-12, 1e-12, odeint::runge_kutta_dopri5<std::vector<double>>()),
      [&](const std::vector<double>& y, std::vector<double>& rate, double) {
        rate[0] = y[1];
        rate[1] = -mass * 9.81 * centre.norm() * std::cos(y[0] + phase) / inertia_about_pin;
      },
      exact, 0.0, 0.3, 1e-4);

  Model model;
  model.programs = {lasting(0.3)};
  model.nodes = {node("A", 0, 0, 0), node("B", length, 0, 2)};
  // The link is so stiff that its relative elongation, 1e-9, is below the time integration errors.
  model.links = {{"AB", 0, 1, 1e10, length, 0.0, 0, 1.0}};
  // The weight at the centre of mass, which moves by G times the node, gives the nodal load Gᵀ m g.
  model.nodes[1].load = mass * 9.81 / length * Eigen::Vector3d(-centre.y(), -centre.x(), 0.0);
  Inertia inertia;
  inertia.link_mass = Eigen::VectorXd::Constant(1, mass);
  inertia.link_centre = centre / length;
  inertia.link_moment = Eigen::VectorXd::Constant(1, moment);
  inertia.link_damping =
      Eigen::VectorXd::Constant(1, 2.0 * std::sqrt(1e10 / length * inertia_about_pin) / length);
  const auto error = [&](long steps) {
    MotionOptions options;
    options.steps = options.sample_every = steps;
    options.start = at_rest(model);
    const Motion motion = simulate(model, inertia, options);
    const auto moved = motion.states.back().displacement.col(1);
    return std::abs(std::atan2(moved.y(), length + moved.x()) - exact[0]);
  };
  const double coarse = error(500);
  const double fine = error(1000);
  EXPECT_LT(fine, 1e-5);
  EXPECT_NEAR(coarse / fine, 4.0, 0.4);
}

TEST(MotionMechanism, DrivenLinkFollowsItsProgramAndTakesItsMoment) {
  // A drive accelerates a rod on a pin. It needs the moment (m L²/3) α'' plus that of the weight.
  const double mass = 3.0;
  const double length = 0.4;
  Model model;
  model.programs = {lasting(0.1)};
  model.nodes = {node("A", 0, 0, 0), node("B", length, 0, 2)};
  model.links = {{"AB", 0, 1, 1e9, length, 0.0, 0, 1.0}};
  model.nodes[1].load = {0.0, -9.81 * mass / 2.0, 0.0};
  Inertia inertia;
  inertia.link_mass = Eigen::VectorXd::Constant(1, mass);
  inertia.link_damping = Eigen::VectorXd::Constant(1, 2.0 * std::sqrt(1e9 / length * mass / 3.0));
  Drive drive;
  drive.name = "motor";
  drive.time = Vector2d(0.0, 0.08);
  drive.speed = Vector2d(0.0, 40.0);
  EXPECT_DOUBLE_EQ(drive.turned_at(0.04), 0.5 * 500.0 * 0.04 * 0.04);
  EXPECT_DOUBLE_EQ(drive.turned_at(0.1), 40.0 * (0.1 - 0.04));
  MotionOptions options;
  options.steps = 10000;
  options.sample_every = 500;
  options.start = at_rest(model);
  options.drives = {drive};
  const Motion motion = simulate(model, inertia, options);
  const double half = 0.5 * motion.time_step;  // a moment is the mean over its step
  for (std::size_t k = 1; k < motion.states.size(); ++k) {
    const double time = motion.states[k].time;
    const auto moved = motion.states[k].displacement.col(1);
    const double angle = std::atan2(moved.y(), length + moved.x());
    EXPECT_NEAR(std::remainder(angle - drive.turned_at(time), 2.0 * 3.14159265358979), 0.0, 1e-8);
    const double turned = drive.turned_at(time - half);
    const double rate = time - half < 0.08 ? 500.0 : 0.0;
    const double moment =
        mass * length * length / 3.0 * rate + 9.81 * mass * 0.5 * length * std::cos(turned);
    EXPECT_NEAR(motion.moving[k].drive_moment[0], moment, 1e-3 * 80.0) << time;
  }
  // The work of the drive equals the energy of the rod, except for energy and loss due to its
  // elongation.
  const double raised = 9.81 * mass * 0.5 * length * std::sin(drive.turned_at(0.1));
  const double has = 0.5 * mass * length * length / 3.0 * 1600.0 + raised;
  EXPECT_NEAR(motion.moving.back().drive_work, has, 1e-4 * has);
}

TEST(MotionMechanism, DrivesThatDoNotFitAreRefusedByName) {
  Model model = falling_journal();
  MotionOptions options;
  options.start = at_rest(model);
  Drive drive;
  drive.name = "motor";
  drive.time = drive.speed = Eigen::VectorXd::Zero(1);
  options.drives = {drive};  // of a link that does not exist
  Inertia inertia;
  inertia.node_mass = Vector2d(0.0, 1.0);
  EXPECT_EQ(refused_argument([&] { simulate(model, inertia, options); }),
            Argument("link", drive.link, "drive 'motor'"));
}

}  // namespace
}  // namespace statejump::truss
