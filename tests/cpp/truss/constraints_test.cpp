// SPDX-License-Identifier: GPL-3.0-or-later
// Constraints Σ c · u = 0 between displacements: closed forms, limits of stiff springs, rotations.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <string>
#include <vector>

#include "dof_map.hpp"
#include "motion/scenes.hpp"
#include "parts.hpp"

namespace statejump::truss {
namespace {

using Eigen::Matrix3Xd;
using Eigen::Vector3d;
using scenes::lasting;
using testing::node;
using testing::triangle;

const Vector3d x = Vector3d::UnitX();
const Vector3d y = Vector3d::UnitY();
constexpr double epsilon = std::numeric_limits<double>::epsilon();

Constraint tie(const std::string& name, int first, const Vector3d& one, int second,
               const Vector3d& other) {
  return {name, {{first, one}, {second, other}}};
}

/// Violation [m] of a constraint at given displacements of the nodes [m].
double gap(const Constraint& constraint, const Matrix3Xd& moved) {
  double sum = 0.0;
  for (const ConstraintTerm& term : constraint.terms) sum += term.factor.dot(moved.col(term.node));
  return sum;
}

/// Two collinear bars, pushed towards each other by heating. B is on a block with friction; C is at
/// the tip of a bar that does not expand.
Model facing_bars() {
  Model model = testing::sliding_bar();
  model.nodes.push_back(node("C", 1.0, 0, 1));
  model.nodes.push_back(node("D", 1.5, 0, 0));
  model.links.push_back({"CD", 2, 3, 4e5, 0.5, 0.0, 0, 1.0});
  return model;
}

TEST(Constraints, AreTheLimitOfAStiffSpring) {
  Model constrained = facing_bars();
  constrained.constraints = {tie("equal", 1, x, 2, -x)};
  const Path exact = solve(constrained);
  ASSERT_GE(exact.events.size(), 2u);
  const auto error = [&](double stiffness) {
    Model model = facing_bars();
    model.springs = {{"stiff", 1, 2, stiffness, 0.5, false}};
    return (solve(model).states.back().displacement - exact.states.back().displacement).norm();
  };
  // The spring deforms by force over stiffness, so a tenfold stiffness divides the error by ten.
  const double soft = error(1e10);
  EXPECT_GT(soft, 0.0);
  EXPECT_LT(soft, 1e-3 * exact.states.back().displacement.norm());
  EXPECT_NEAR(soft / error(1e11), 10.0, 0.1);
  for (const State& state : exact.states) {
    EXPECT_EQ(state.displacement(0, 1), state.displacement(0, 2));
  }
}

TEST(Constraints, LeverCarriesByItsRatio) {
  // For u_B = 3 u_C, equilibrium is k u_B + k' u_C / 3 = F.
  Model model = facing_bars();
  model.joints.clear();
  model.programs = {triangle(0.0)};
  model.constraints = {tie("lever", 1, x, 2, -3.0 * x)};
  const double force = 1.0;
  model.nodes[1].load = force * x;
  const double k = 70e9 * 9e-6 / 0.5;
  const double other = 4e5 / 0.5;
  const Path path = solve(model);
  // Along a line the lengths are linear in the displacements.
  EXPECT_NEAR(path.states.back().displacement(0, 1), force / (k + other / 9.0), 1e-10 * force / k);
}

/// Pyramid with two constraints and four feet, two of which move on tilted planes.
Model pyramid() {
  Model model;
  model.programs = {triangle(60.0)};
  model.nodes = {node("A", {0, 0, 0}, 0), node("B", {1, 0.1, 0}, 2), node("C", {0.9, 1.2, 0.1}, 2),
                 node("D", {-0.1, 1.0, 0}, 0), node("top", {0.5, 0.4, 0.8}, 3)};
  const Eigen::Matrix3d tilted =
      Eigen::Quaterniond(0.8, 0.3, -0.4, 0.2).normalized().toRotationMatrix();
  model.nodes[1].free_directions = tilted;
  model.nodes[2].free_directions = tilted;
  model.nodes[4].load = Vector3d(200.0, -100.0, -300.0);
  const auto bar = [&](int first, int second, double expansion) {
    const double length = (model.nodes[static_cast<std::size_t>(second)].position -
                           model.nodes[static_cast<std::size_t>(first)].position)
                              .norm();
    model.links.push_back(
        {std::to_string(model.links.size()), first, second, 5e5, length, expansion, 0, 1.0});
  };
  for (const int foot : {0, 1, 2, 3}) bar(foot, 4, 1e-5 * (1 + foot));
  bar(0, 1, 2e-5);
  bar(1, 2, 0.0);
  bar(2, 3, 3e-5);
  model.constraints = {
      tie("skew", 1, Vector3d(1.0, -0.5, 0.3), 2, Vector3d(0.2, 0.7, -1.0)),
      {"three", {{1, Vector3d(0.4, 0.1, 0.0)}, {2, y}, {4, Vector3d(-0.3, 0.2, 0.6)}}}};
  return model;
}

TEST(Constraints, RotateWithTheTruss) {
  const Model model = pyramid();
  Model turned = model;
  const Eigen::Matrix3d by =
      Eigen::Quaterniond(0.5, -0.6, 0.3, 0.4).normalized().toRotationMatrix();
  for (Node& one : turned.nodes) {
    one.position = by * one.position;
    one.load = by * one.load;
    one.free_directions = Eigen::Matrix3d(by * one.free_directions.matrix());
  }
  for (Constraint& one : turned.constraints) {
    for (ConstraintTerm& term : one.terms) term.factor = by * term.factor;
  }
  const State one = solve(model).states.back();
  const State other = solve(turned).states.back();
  // Newton's tolerance is 1e-12 of the forces. The stiffness matrix of this pyramid has a condition
  // number below 1e3.
  EXPECT_LT((by * one.displacement - other.displacement).norm(), 1e-9 * one.displacement.norm());
  for (const Constraint& constraint : model.constraints) {
    EXPECT_NEAR(gap(constraint, one.displacement), 0.0, 16 * epsilon * one.displacement.norm());
  }
}

TEST(Constraints, CompatibleExpansionIsFreeOfForce) {
  // All bars have equal thermal strain, so u = α ΔT X, which satisfies X_C u_B = X_B u_C along each
  // axis.
  Model model;
  model.programs = {triangle(100.0)};
  model.nodes = {node("A", 0, 0, 0), node("B", 1.0, 0.2, 2), node("C", 0.7, 1.1, 2),
                 node("D", -0.4, 0.9, 2)};
  for (const auto& [first, second] :
       std::vector<std::pair<int, int>>{{0, 1}, {0, 2}, {0, 3}, {1, 2}, {2, 3}}) {
    const double length = (model.nodes[static_cast<std::size_t>(second)].position -
                           model.nodes[static_cast<std::size_t>(first)].position)
                              .norm();
    model.links.push_back(
        {std::to_string(model.links.size()), first, second, 5e5, length, 2e-5, 0, 1.0});
  }
  model.constraints = {tie("x", 1, 0.7 * x, 2, -1.0 * x), tie("y", 2, 0.9 * y, 3, -1.1 * y)};
  const Path path = solve(model);
  for (const State& state : path.states) {
    const Eigen::VectorXd axial = element_output<Bar>(model, state).row(0);
    // Bars with fixed ends would carry E A α ΔT = 1000 N.
    EXPECT_LT(axial.lpNorm<Eigen::Infinity>(), 1e-8);
    const double grown = 2e-5 * state.temperature_change;
    EXPECT_NEAR(state.displacement(0, 1), grown * 1.0, 1e-12);
    EXPECT_NEAR(state.displacement(1, 3), grown * 0.9, 1e-12);
  }
}

TEST(Constraints, RedundantOnesAreListed) {
  Model model = pyramid();
  EXPECT_TRUE(model.redundant_constraints().empty());
  model.constraints.push_back({"sum", {}});
  for (const std::size_t of : {0u, 1u}) {
    for (ConstraintTerm term : model.constraints[of].terms) {
      term.factor *= of == 0 ? 0.3 : -2.0;
      model.constraints.back().terms.push_back(term);
    }
  }
  model.constraints.push_back(tie("of supports", 0, x, 3, y));
  EXPECT_EQ(model.redundant_constraints(), (std::vector<int>{2, 3}));
  // Redundant constraints do not change the result.
  const State with = solve(model).states.back();
  EXPECT_EQ(with.displacement, solve(pyramid()).states.back().displacement);
}

TEST(Constraints, ChainLeavesOneDof) {
  Model model;
  for (int i = 0; i < 50; ++i) model.nodes.push_back(node(std::to_string(i), i, 0, 1));
  for (int i = 0; i + 1 < 50; ++i) {
    model.constraints.push_back(tie(std::to_string(i), i, 2.0 * x, i + 1, -1.0 * x));
  }
  const detail::DofMap dofs(model);
  ASSERT_EQ(dofs.dofs(), 1);
  const Eigen::VectorXd q = Eigen::VectorXd::Ones(1);
  for (int i = 0; i + 1 < 50; ++i) {
    EXPECT_DOUBLE_EQ(2.0 * dofs.displacement(i, q).x(), dofs.displacement(i + 1, q).x());
  }
  Matrix3Xd moved;
  dofs.displacements(q, moved);
  EXPECT_EQ(dofs.dofs_at(moved), q);
}

TEST(Constraints, WrongTermsAndJointsThatHoldTheSameAreRefused) {
  Model model = facing_bars();
  model.constraints = {{"empty", {}}};
  EXPECT_THROW(model.validate(), std::invalid_argument);
  model.constraints = {tie("none", 1, x, 2 * static_cast<int>(model.nodes.size()), x)};
  EXPECT_THROW(model.validate(), std::invalid_argument);
  model.constraints = {tie("small", 1, x, 2, 1e-10 * x)};
  EXPECT_THROW(model.validate(), std::invalid_argument);
  // A slider between two nodes constrains their relative displacement perpendicular to its axis, as
  // this constraint does.
  model.nodes[2].position = model.nodes[1].position;
  model.nodes[1].freedoms = model.nodes[2].freedoms = 2;
  std::get<Slider>(model.joints[0]).second = 2;
  model.constraints = {tie("across", 1, y, 2, -y)};
  EXPECT_THROW(model.validate(), std::invalid_argument);
  model.constraints = {};
  EXPECT_NO_THROW(model.validate());
}

/// Two masses on springs along x. A constraint makes the second one move twice as far as the first.
Model two_masses(double seconds) {
  Model model;
  model.programs = {lasting(seconds)};
  model.nodes = {node("A", 0, 0, 0), node("B", 1, 0, 1), node("C", 2, 0, 1), node("D", 3, 0, 0)};
  model.links = {{"AB", 0, 1, 300.0, 1.0, 0.0, 0, 1.0}, {"CD", 2, 3, 200.0, 1.0, 0.0, 0, 1.0}};
  model.constraints = {tie("twice", 1, 2.0 * x, 2, -1.0 * x)};
  return model;
}

TEST(Constraints, MassesSwingTogetherAndKeepTheirEnergy) {
  // The constraint u_C = 2 u_B gives ω² = (300 + 4 · 200) / (1 + 4 · 0.5).
  const double omega = std::sqrt(1100.0 / 3.0);
  const double seconds = 10.5 * std::numbers::pi / omega;  // five periods and a quarter
  const Model model = two_masses(seconds);
  Inertia inertia = scenes::masses(Eigen::Vector4d(0.0, 1.0, 0.5, 0.0));
  const auto run = [&](long steps) {
    MotionOptions options;
    options.steps = options.sample_every = steps;
    options.start = scenes::at_rest(model);
    options.start->displacement(0, 1) = 0.01;
    options.start->displacement(0, 2) = 0.02;
    return simulate(model, inertia, options);
  };
  const auto error = [&](const Motion& motion) {
    return std::abs(motion.states.back().displacement(0, 1));
  };
  const Motion fine = run(4000);
  // The phase of the midpoint rule lags by the fraction (ω h)²/12 of the elapsed time.
  EXPECT_LT(error(fine), 1e-3 * 0.01);
  EXPECT_NEAR(error(run(2000)) / error(fine), 4.0, 0.1);
  const State& end = fine.states.back();
  EXPECT_EQ(2.0 * end.displacement(0, 1), end.displacement(0, 2));
  const Matrix3Xd& speed = fine.moving.back().velocity;
  EXPECT_EQ(2.0 * speed(0, 1), speed(0, 2));
  const double energy = fine.states.front().elastic_energy;
  EXPECT_NEAR(energy, 0.5 * 1100.0 * 1e-4, 1e-12);
  // The midpoint rule conserves quadratic energies, so only rounding of 4000 steps remains.
  EXPECT_NEAR(scenes::residue(fine), 0.0, 4000 * 4 * epsilon * energy);
}

TEST(Constraints, ExplicitStepsMoveWhatIsTied) {
  // With equal displacements the lumped mass matrix remains diagonal.
  Model model = testing::sliding_bar(0.05);
  Slider& slider = std::get<Slider>(model.joints[0]);
  slider.tangential_stiffness = 1e6;
  model.nodes.push_back(node("C", 1.0, 0, 1));
  model.nodes.push_back(node("D", 1.5, 0, 0));
  model.links.push_back({"CD", 2, 3, 4e5, 0.5, 0.0, 0, 1.0});
  model.constraints = {tie("equal", 1, x, 2, -x)};
  Inertia inertia = scenes::masses(Eigen::Vector4d(0.0, 0.3, 0.2, 0.0));
  inertia.link_damping = Eigen::Vector2d(200.0, 200.0);
  MotionOptions options;
  options.steps = 20000;
  options.sample_every = 20000;
  options.start = scenes::at_rest(model);
  const Motion explicit_steps = simulate_regularised(model, inertia, "mindlin", options);
  const Motion implicit_steps = simulate(model, inertia, options);
  const State& one = explicit_steps.states.back();
  const State& other = implicit_steps.states.back();
  EXPECT_EQ(one.displacement(0, 1), one.displacement(0, 2));
  // The friction force of 30 N deflects its spring by 3e-5 m. Both schemes are of second order.
  EXPECT_NEAR(one.displacement(0, 1), other.displacement(0, 1), 1e-4 * 3e-5);
  model.constraints = {tie("twice", 1, 2.0 * x, 2, -x)};
  EXPECT_NO_THROW(simulate_regularised(model, inertia, "mindlin", options));
}

}  // namespace
}  // namespace statejump::truss
