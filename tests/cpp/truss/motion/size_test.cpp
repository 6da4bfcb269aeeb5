// SPDX-License-Identifier: GPL-3.0-or-later
// Steps in which slip spreads over many joints.
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "scenes.hpp"
#include "truss/motion/refilled_matrix.hpp"

namespace statejump::truss {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using namespace scenes;

constexpr double axial_stiffness = 70e9 * 9e-6;  // [N]
constexpr double length = 0.5;                   // [m]
constexpr double expansion = 23.4e-6;            // [1/K]
constexpr double heating = 100.0;                // [K]
constexpr double link_mass = 0.0122;             // [kg]

double friction(int blocks) {
  return axial_stiffness * expansion * heating / (4.0 * blocks);
}

/// A row of blocks with friction on the ground, connected by heated bars.
Model chain(int blocks) {
  Model model;
  model.programs = {lasting(1.0, heating)};
  model.nodes = {node("N0", 0, 0, 0)};
  for (int i = 1; i <= blocks; ++i) {
    const std::string number = std::to_string(i);
    model.nodes.push_back(node("N" + number, length * i, 0, 1));
    model.links.push_back({"L" + number, i - 1, i, axial_stiffness, length, expansion, 0, 1.0});
    Slider slider;
    slider.name = "S" + number;
    slider.first = i;
    slider.friction_force = friction(blocks);
    model.joints.emplace_back(slider);
  }
  return model;
}

Inertia inertia(int blocks, double damping_ratio) {
  const double critical = 2.0 * std::sqrt(axial_stiffness / length * link_mass / 3.0);
  Inertia made{VectorXd::Constant(blocks, link_mass), {}, {}, {}, {}};
  if (damping_ratio > 0.0) {
    made.link_damping = VectorXd::Constant(blocks, damping_ratio * critical);
  }
  return made;
}

/// Reference displacements of the blocks after an undamped cycle. It solves the equations of the
/// scheme with a dense W, and the impulses by projected Gauss-Seidel.
VectorXd reference(int blocks, int steps) {
  const thermal::Program program = lasting(1.0, heating);
  MatrixXd mass = MatrixXd::Zero(blocks, blocks);
  MatrixXd laplace = MatrixXd::Zero(blocks, blocks);
  for (int i = 0; i < blocks; ++i) {
    const double links = i + 1 < blocks ? 2.0 : 1.0;
    mass(i, i) = links * link_mass / 3.0;
    laplace(i, i) = links;
    if (i == 0) continue;
    mass(i, i - 1) = mass(i - 1, i) = link_mass / 6.0;
    laplace(i, i - 1) = laplace(i - 1, i) = -1.0;
  }
  const auto stiffness = [&](double time) {
    return axial_stiffness / (length * (1.0 + expansion * program.temperature_change(time)));
  };
  const auto force = [&](const VectorXd& q, double time) {
    VectorXd found = -stiffness(time) * (laplace * q);
    // Thermal forces of adjacent bars cancel. Only the last block has a single bar.
    found[blocks - 1] += stiffness(time) * length * expansion * program.temperature_change(time);
    return found;
  };
  const double theta = MotionOptions{}.theta;
  const double h = 1.0 / steps;
  const double bound = h * friction(blocks);
  VectorXd q = VectorXd::Zero(blocks);
  VectorXd v = VectorXd::Zero(blocks);
  VectorXd impulses = VectorXd::Zero(blocks);
  for (int k = 0; k < steps; ++k) {
    const double to = h * (k + 1);
    const MatrixXd matrix = mass + std::pow(h * theta, 2) * stiffness(to) * laplace;
    const MatrixXd answers = matrix.inverse();
    const VectorXd without = answers * (mass * v + h * (theta * force(q + h * (1 - theta) * v, to) +
                                                        (1 - theta) * force(q, h * k)));
    VectorXd speed = without + answers * impulses;
    for (double moved = 1.0; moved > 1e-14 * bound;) {
      moved = 0.0;
      for (int i = 0; i < blocks; ++i) {
        const double now = std::clamp(impulses[i] - speed[i] / answers(i, i), -bound, bound);
        moved = std::max(moved, std::abs(now - impulses[i]));
        speed += answers.col(i) * (now - impulses[i]);
        impulses[i] = now;
      }
    }
    speed = without + answers * impulses;
    q += h * (theta * speed + (1 - theta) * v);
    v = speed;
  }
  return q;
}

TEST(MotionSize, SlipSpreadsInAStepAsTheContactProblemHasIt) {
  constexpr int blocks = 60;
  MotionOptions options;
  options.steps = options.sample_every = 60;
  const Motion motion = simulate(chain(blocks), inertia(blocks, 0.0), options);
  EXPECT_GT(motion.events.size(), static_cast<std::size_t>(4 * options.steps));
  const VectorXd exact = reference(blocks, static_cast<int>(options.steps));
  const VectorXd found = motion.states.back().displacement.row(0).tail(blocks).transpose();
  // Each step solves equilibrium to 1e-10. A wrong status would cause an error as large as a slide.
  EXPECT_LT((found - exact).cwiseAbs().maxCoeff(), 1e-7 * exact.cwiseAbs().maxCoeff());
}

TEST(MotionSize, SystemsOfAStepDoNotGrowWithTheJointsThatSlip) {
  for (const int blocks : {100, 1000}) {
    MotionOptions options;
    options.steps = options.sample_every = 200;
    const Motion motion = simulate(chain(blocks), inertia(blocks, 1.0), options);
    SCOPED_TRACE(blocks);
    // Every block slips during heating and most slip during cooling; one step contains up to a
    // dozen changes.
    EXPECT_GT(motion.events.size(), static_cast<std::size_t>(2 * blocks));
    // A step with status changes needs one factorization, and another one if they affect remote
    // joints.
    EXPECT_LT(motion.factorizations, 3 * options.steps);
    EXPECT_EQ(motion.iterations, 0);
  }
}

TEST(MotionSize, FrictionJustWithinItsBoundHoldsWithoutAContactProblem) {
  // Among ten thousand joints, one is this close to its bound. It must not switch to slip, because
  // the iteration would switch it back.
  Model model;
  model.programs = {lasting(0.1)};
  model.nodes = {node("B", 0, 0, 1)};
  model.nodes[0].load = {30.0 * (1.0 - 5e-11), 0.0, 0.0};
  Slider slider;
  slider.name = "S";
  slider.first = 0;
  slider.friction_force = 30.0;
  model.joints = {slider};
  MotionOptions options;
  options.steps = options.sample_every = 10;
  options.start = at_rest(model);
  const Motion motion = simulate(model, {{}, VectorXd::Ones(1), {}, {}, {}}, options);
  EXPECT_EQ(motion.iterations, 0);
  EXPECT_EQ(motion.states.back().displacement.norm(), 0.0);
}

TEST(MotionSize, RefilledMatrixFindsItsPlacesAnewWhereTheyMove) {
  detail::RefilledMatrix made;
  const auto fill = [&](int column, double value) {
    made.begin(2);
    made.add(0, 0, value);
    made.add(0, 0, 1.0);
    const std::size_t last = made.next();
    made.add(1, column, 3.0);
    made.end();
    return last;
  };
  const auto expect = [&](double a, double b, double c) {
    const MatrixXd now(made.matrix());
    EXPECT_EQ(now, (Eigen::Matrix2d() << a, 0.0, b, c).finished());
  };
  fill(0, 2.0);
  expect(3.0, 3.0, 0.0);
  fill(0, 5.0);
  expect(6.0, 3.0, 0.0);
  const std::size_t last = fill(1, 5.0);
  expect(6.0, 0.0, 3.0);
  made.set(last, -4.0);
  expect(6.0, 0.0, -4.0);
  made.begin(2);
  made.add(0, 0, 7.0);
  made.end();
  expect(7.0, 0.0, 0.0);
}

}  // namespace
}  // namespace statejump::truss
