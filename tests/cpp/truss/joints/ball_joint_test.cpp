// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/Geometry>
#include <cmath>
#include <stdexcept>
#include <string>

#include "gradients.hpp"
#include "statejump/kernel/contact_law.hpp"
#include "statejump/kernel/frame.hpp"
#include "statejump/kernel/joint_kinematics.hpp"
#include "statejump/truss/path.hpp"

namespace statejump::truss {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

thermal::Program triangle(double largest) {
  thermal::Program program;
  program.shape = thermal::Shape::triangle;
  program.temperature_change_max = largest;
  program.period = 1.0;
  return program;
}

/// ΔT at every quarter of a second.
thermal::Program quarters(std::vector<double> changes) {
  thermal::Program program;
  program.shape = thermal::Shape::table;
  for (std::size_t i = 0; i < changes.size(); ++i)
    program.table_times.push_back(0.25 * static_cast<double>(i));
  program.period = program.table_times.back();
  program.table_temperature_changes = std::move(changes);
  return program;
}

Node node(const char* name, const Vector3d& position, int freedoms) {
  Node made;
  made.name = std::string(name);
  made.position = position;
  made.freedoms = freedoms;
  return made;
}

BallJoint ball_joint(int ball_node, int ball_link, int socket_node, int socket_link) {
  BallJoint joint;
  joint.name = std::string("ball");
  joint.ball_node = ball_node;
  joint.ball_link = ball_link;
  joint.socket_node = socket_node;
  joint.socket_link = socket_link;
  joint.ball_radius = 5e-3;
  joint.radial_clearance = 1e-4;
  joint.ball_thermal_expansion = 2e-5;
  joint.socket_thermal_expansion = 1e-5;
  joint.friction_coefficient = 0.05;
  joint.hertz_stiffness = 2.6e10;
  joint.mindlin_stiffness = 3.2e10;
  return joint;
}

const BallJoint& joint_of(const Model& model) {
  return std::get<BallJoint>(model.joints[0]);
}

Vector3d friction(const Model& model, const State& state) {
  return output(model, state, 0, "ball_friction_force_N");
}

double normal(const Model& model, const State& state) {
  return output(model, state, 0, "ball_normal_force_N")[0];
}

/// A bar with the ball on the end of another, both ends of which a spring pulls: a rib in space,
/// whose sockets and bars turn about every axis as it is heated.
Model tripod() {
  Model model;
  model.programs = {triangle(100.0), quarters({0.0, 60.0, -40.0, 30.0, 0.0})};
  model.nodes = {node("A", {0.3, 0.0, 0.0}, 0),    node("B", {-0.2, 0.25, 0.0}, 0),
                 node("C", {-0.2, -0.25, 0.0}, 0), node("top", {0.0, 0.0, 0.3}, 3),
                 node("ball", {0.0, 0.0, 0.3}, 3), node("D", {0.1, 0.1, 0.7}, 0),
                 node("E", {0.3, -0.2, 0.5}, 0),   node("F", {-0.3, 0.0, 0.6}, 0)};
  model.links = {{"A-top", 0, 3, 2e5, 0.4242, 2.4e-5, 0, 1.0},
                 {"B-top", 1, 3, 2e5, 0.4387, 2.4e-5, 1, 1.0},
                 {"C-top", 2, 3, 2e5, 0.4387, 2.4e-5, 0, -0.4},
                 {"D-ball", 5, 4, 2e5, 0.4242640687119285, 2.4e-5, 1, 0.5}};
  for (Link& link : model.links) {
    link.stress_free_length = (model.nodes[static_cast<std::size_t>(link.second)].position -
                               model.nodes[static_cast<std::size_t>(link.first)].position)
                                  .norm();
  }
  model.springs = {{"E", 6, 4, 2e4, 0.35, false}, {"F", 7, 4, 3e4, 0.40, false}};
  model.joints = {ball_joint(4, 3, 3, 0)};
  return model;
}

double relative_residue(const Path& path) {
  const State& first = path.states.front();
  const State& last = path.states.back();
  const double heat = last.joint_dissipation.sum();
  return (last.thermal_work - (last.elastic_energy - first.elastic_energy) -
          (last.load_potential - first.load_potential) - heat) /
         heat;
}

TEST(BallJoint, GradientsAreThoseOfItsForces) {
  Model model;
  model.programs = {triangle(100.0)};
  // Soft links: their rounding does not hide what the joint adds.
  model.nodes = {node("A", {0, 0, 0}, 3), node("C", {0.12, 0.03, -0.05}, 3),
                 node("B", {0.02875, 0.0409, 0.01}, 3), node("J", {0.02875, 0.0409, 0.01}, 3)};
  model.links = {{"AB", 0, 2, 1e2, 0.05, 2e-5, 0, 1.0}, {"CJ", 1, 3, 1e2, 0.1, 1e-5, 0, 0.5}};
  model.joints = {ball_joint(3, 1, 2, 0)};
  const detail::System system(model);
  Eigen::VectorXd z = Eigen::VectorXd::LinSpaced(system.unknowns(), 1e-5, 6e-5);
  z.segment<3>(9) += Vector3d(6e-5, 3e-5, -5e-5);  // in contact
  const Vector3d n = (z.segment<3>(9) - z.segment<3>(6)).normalized();
  Eigen::VectorXd before = z;
  before[0] -= 3e-6;
  before[4] += 4e-6;
  before[10] += 2e-6;
  before[5] -= 5e-6;
  const Vector3d across = n.unitOrthogonal();
  z.tail<3>() = 5.0 * n + 0.4 * across + 0.3 * n.cross(across);
  // Loaded and unloaded: what bends has a branch for each.
  for (const double loaded : {4.0, 7.0}) {
    before.tail<3>() = loaded * n + 0.3 * n.cross(across);
    check_gradients(model, z, before,
                    {JointStatus::stick, JointStatus::slip_plus, JointStatus::open}, 1e-8, 1e-4);
  }
}

/// The rib of the tests of revolutes, in a plane; with a ball it stands in a plane that is turned.
Model rib(bool with_ball, const Matrix3d& turned) {
  Model model;
  model.programs = {triangle(150.0)};
  model.nodes = {node("A", {0, 0, 0}, 0), node("C", {0.12, 0, 0}, 0), node("B", {0.04, 0.05, 0}, 2),
                 node("J", {0.04, 0.05, 0}, 2), node("S", {0.05, 0.15, 0}, 0)};
  for (Node& one : model.nodes) {
    one.position = turned * one.position;
    one.free_directions = turned;
  }
  const auto length = [&](std::size_t a, std::size_t b) {
    return (model.nodes[a].position - model.nodes[b].position).norm();
  };
  model.links = {{"AB", 0, 2, 6e5, length(0, 2), 2.4e-5, 0, 1.0},
                 {"CJ", 1, 3, 6e5, length(1, 3), 2.4e-5, 0, -0.7}};
  model.springs = {{"S", 4, 3, 2e3, 0.05, false}};
  const BallJoint ball = ball_joint(3, 1, 2, 0);
  if (with_ball) {
    model.joints = {ball};
    return model;
  }
  ClearanceRevolute joint;
  joint.name = std::string("joint");
  joint.journal_node = ball.ball_node;
  joint.journal_link = ball.ball_link;
  joint.bearing_node = ball.socket_node;
  joint.bearing_link = ball.socket_link;
  joint.journal_radius = ball.ball_radius;
  joint.radial_clearance = ball.radial_clearance;
  joint.journal_thermal_expansion = ball.ball_thermal_expansion;
  joint.bearing_thermal_expansion = ball.socket_thermal_expansion;
  joint.friction_coefficient = ball.friction_coefficient;
  joint.hertz_stiffness = ball.hertz_stiffness;
  joint.mindlin_stiffness = ball.mindlin_stiffness;
  joint.axis = turned * Vector3d::UnitZ();
  model.joints = {joint};
  return model;
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
  const Model model = tripod();
  const Path path = solve(model);
  Model other = model;
  const Matrix3d turned =
      Eigen::AngleAxisd(2.1, Vector3d(1.0, -2.0, 0.5).normalized()).toRotationMatrix();
  for (Node& one : other.nodes) {
    one.position = turned * one.position;
    one.free_directions = turned;
  }
  const Path found = solve(other);
  ASSERT_EQ(found.events.size(), path.events.size());
  const double size = path.states.back().displacement.norm();
  EXPECT_LT(
      (turned.transpose() * found.states.back().displacement - path.states.back().displacement)
          .norm(),
      1e-10 * size);
  EXPECT_LT((turned.transpose() * friction(other, found.states.back()) -
             friction(model, path.states.back()))
                .norm(),
            1e-7 * friction(model, path.states.back()).norm());
}

/// A ball that a load presses into a wide socket, and that two stiff rods shift along x, then along
/// y: so little that the normal hardly turns.
Model pushed_around_a_corner() {
  Model model;
  model.programs = {quarters({0.0, 100.0, 100.0}), quarters({0.0, 0.0, 100.0})};
  model.nodes = {node("socket", {0, 0, 0}, 0), node("ball", {0, 0, 0}, 3),
                 node("X", {-10.0, 0, 0}, 0), node("Y", {0, -10.0, 0}, 0)};
  model.nodes[1].load = {0.0, 0.0, -100.0};
  model.links = {{"X", 2, 1, 1e11, 10.0, 1e-8, 0, 1.0}, {"Y", 3, 1, 1e11, 10.0, 1e-8, 1, 0.5}};
  BallJoint joint = ball_joint(1, -1, 0, -1);
  joint.ball_radius = 1.0;
  joint.radial_clearance = 1e-3;
  joint.ball_thermal_expansion = joint.socket_thermal_expansion = 0.0;
  joint.friction_coefficient = 0.15;
  joint.hertz_stiffness = 1e11;
  joint.mindlin_stiffness = 1e10;
  model.joints = {joint};
  return model;
}

TEST(BallJoint, FrictionTurnsIntoANewSlideAsATractrix) {
  // Gross slip along x, then a slide along y: with the angle θ between friction and slide
  // dθ/ds = −(k/μN) sin θ, so that tan(θ/2) falls from 1 as exp(−k s/μN).
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
      // From where the rod begins: its length from that of the start of its heating.
      const double slid = 5e-6 * (state.time - 0.25) / 0.25;
      const double expected = 2.0 * std::atan(std::exp(-stiffness * slid / bound));
      const double found = std::atan2(rubs.x(), rubs.y());
      error[fine] = std::max(error[fine], std::abs(found - expected));
      if (expected < 1.3 && expected > 0.1) ++turning;
    }
    EXPECT_GT(turning, 20);
  }
  // The rods give way by a thousandth of what the contact does; increments do not matter.
  EXPECT_LT(error[0], 1e-3);
  EXPECT_NEAR(error[1], error[0], 1e-6);
}

TEST(BallJoint, OpensAndClosesWhereTheRodThatPressesItIsAsLongAsTheWay) {
  // Three rods hold the ball; cooling shortens the one that presses it down.
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
  // At the apex of the cone friction slips before the contact opens: the bend outlives the bound.
  const JointStatus expected[] = {JointStatus::stick, JointStatus::slip_plus, JointStatus::open,
                                  JointStatus::stick};
  ASSERT_GE(path.events.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(path.events[i].before, expected[i]);
    EXPECT_EQ(path.events[i].after, expected[i + 1]);
  }
  // Rods across carry c/L of what 5e-8 m, c²/(2 L), stretch them by: below 1e-5 K.
  const double change = ((10.0 + joint_of(model).radial_clearance) / pressed - 1.0) / expansion;
  EXPECT_NEAR(path.events[1].temperature_change, change, 1e-5);
  EXPECT_NEAR(path.events[2].temperature_change, change, 1e-5);
  for (const State& state : path.states) {
    if (state.joint_status[0] != JointStatus::open) continue;
    EXPECT_EQ(normal(model, state), 0.0);
    EXPECT_TRUE(friction(model, state).isZero(0.0));
  }
}

TEST(BallJoint, IsTheHistorySpringOfTheDemInSpace) {
  // The contact of the DEM, with its own kinematics, driven along the path that the solver found.
  const Model model = tripod();
  const BallJoint& joint = joint_of(model);
  double error[2] = {0.0, 0.0};
  int slips = 0;
  for (const int fine : {0, 1}) {
    Options options;
    options.increments_per_branch = 1000 << fine;
    const Path path = solve(model, options);
    kernel::ContactHistory history;
    Vector3d before = Vector3d::Zero();
    error[fine] = 0.0;
    double largest = 0.0;
    slips = 0;
    for (std::size_t i = 0; i < path.states.size(); ++i) {
      const State& state = path.states[i];
      const Vector3d offset = output(model, state, 0, "ball_eccentricity_m");
      const Vector3d n = offset.normalized();
      const double change = state.temperature_change;
      const double inner = joint.ball_radius * (1.0 + joint.ball_thermal_expansion * change);
      const double outer = (joint.ball_radius + joint.radial_clearance) *
                           (1.0 + joint.socket_thermal_expansion * change);
      const double stiffness = joint.mindlin_stiffness * std::sqrt(offset.norm() - (outer - inner));
      if (i == 0) {
        history.tangential_stiffness = stiffness;
        before = n;
        continue;
      }
      const State& last = path.states[i - 1];
      // Velocities over the step, times its length.
      const auto moved = [&](int at) {
        return Vector3d(state.displacement.col(at) - last.displacement.col(at));
      };
      const auto at = [&](const State& of, int number) {
        return Vector3d(model.nodes[static_cast<std::size_t>(number)].position +
                        of.displacement.col(number));
      };
      const auto spin = [&](int tip, int root) {
        const Vector3d along =
            0.5 * (at(state, tip) + at(last, tip) - at(state, root) - at(last, root));
        return Vector3d(along.cross(moved(tip) - moved(root)) / along.squaredNorm());
      };
      const kernel::BodyMotion ball{at(state, 4), moved(4), spin(4, 5)};
      const kernel::BodyMotion socket{at(state, 3), moved(3), spin(3, 0)};
      const kernel::BallContact contact = kernel::ball_contact(ball, inner, socket, outer);
      const double twist = 0.5 * (ball.angular_velocity + socket.angular_velocity).dot(n);
      history.tangential_force = kernel::transport(history.tangential_force, before, n, twist);
      const Vector3d slide = contact.relative_velocity - n * n.dot(contact.relative_velocity);
      kernel::mindlin_step(stiffness, joint.friction_coefficient * normal(model, state), slide,
                           history);
      before = n;
      error[fine] =
          std::max(error[fine], (history.tangential_force - friction(model, state)).norm());
      largest = std::max(largest, friction(model, state).norm());
      if (is_slip(state.joint_status[0])) ++slips;
    }
    error[fine] /= largest;
    EXPECT_GT(slips, 100);
    EXPECT_LT(slips, static_cast<int>(path.states.size()) - 100);
  }
  // A step of the DEM's contact is of first order where the slide turns.
  EXPECT_LT(error[0], 2e-3);
  EXPECT_NEAR(error[1], 0.5 * error[0], 0.05 * error[0]);
}

TEST(BallJoint, IncrementsDoNotMatterAndEnergyIsKept) {
  Model model = tripod();
  // The work of what expands at a contact is not in the balance of the truss.
  BallJoint& joint = std::get<BallJoint>(model.joints[0]);
  joint.ball_thermal_expansion = joint.socket_thermal_expansion = 0.0;
  double jump[3] = {0.0, 0.0, 0.0};
  double residue[3] = {0.0, 0.0, 0.0};
  Vector3d fine = Vector3d::Zero();
  for (const int i : {2, 1, 0}) {
    Options options;
    options.increments_per_branch = i == 2 ? 3200 : 50 << (2 * i);
    const Path path = solve(model, options);
    const Vector3d moved = path.states.back().displacement.col(4);
    if (i == 2) fine = moved;
    jump[i] = (moved - fine).norm() / fine.norm();
    residue[i] = std::abs(relative_residue(path));
  }
  // Four times as many: of second order both, the works of higher.
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
