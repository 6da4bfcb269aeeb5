// SPDX-License-Identifier: GPL-3.0-or-later
// Steps of high order (Radau methods) between changes of status.
#include "motion/smooth_stepper.hpp"

#include <gtest/gtest.h>

#include <boost/numeric/odeint.hpp>
#include <cmath>
#include <vector>

#include "scenes.hpp"

namespace statejump::truss {
namespace {

using Eigen::Vector2d;
using Eigen::VectorXd;
using namespace scenes;

TEST(SmoothSteps, RadauIntegratesPolynomialsAndIsPutTogetherFromItsModes) {
  for (const int stages : {3, 5, 7}) {
    SCOPED_TRACE(stages);
    const detail::Radau radau(stages);
    // The coefficients are sums of terms up to 1, computed in long double and rounded to double.
    for (int k = 0; k < 2 * stages - 1; ++k) {
      const VectorXd power = radau.c.array().pow(k);
      EXPECT_NEAR(radau.a.row(stages - 1).dot(power), 1.0 / (k + 1), 1e-15) << k;
      if (k >= stages) continue;
      const VectorXd integral = radau.c.array().pow(k + 1) / (k + 1);
      EXPECT_LT((radau.a * power - integral).cwiseAbs().maxCoeff(), 1e-15) << k;
      // The embedded method also uses the start as a node. It has the same order.
      const VectorXd increments = radau.a * power;
      const double start = k == 0 ? 1.0 / radau.eigenvalue : 0.0;
      EXPECT_NEAR(start + radau.embedded.dot(increments), 0.0, 1e-13) << k;
    }
    Eigen::MatrixXd sum = radau.eigenvalue * radau.from_mode * radau.to_mode;
    for (const detail::Radau::Pair& pair : radau.pairs) {
      sum += 2.0 * (pair.eigenvalue * pair.from_mode * pair.to_mode).real();
    }
    // For seven stages the eigenvectors amplify rounding errors up to a thousandfold.
    EXPECT_LT((sum - radau.inverse).cwiseAbs().maxCoeff(), 1e-12);
    EXPECT_LT((radau.a * radau.inverse - Eigen::MatrixXd::Identity(stages, stages)).norm(), 1e-12);
  }
}

TEST(SmoothSteps, ComplexFactorSolvesWhatItFactors) {
  const int n = 60;
  std::vector<Eigen::Triplet<double>> entries;
  for (int i = 0; i < n; ++i) {
    entries.emplace_back(i, i, 5.0);
    for (const int j : {(7 * i + 3) % n, (i * i + 1) % n}) {
      entries.emplace_back(i, j, 1.0);
      entries.emplace_back(j, i, 1.0);
    }
  }
  Eigen::SparseMatrix<double> pattern(n, n);
  pattern.setFromTriplets(entries.begin(), entries.end());
  Eigen::SparseMatrix<std::complex<double>> matrix = pattern.cast<std::complex<double>>();
  matrix *= std::complex<double>(0.3, 1.0);
  matrix.diagonal().array() += 1.0;
  linear::ComplexFactor factor;
  ASSERT_TRUE(factor.analyze(pattern));
  for (int round = 0; round < 2; ++round) {
    ASSERT_TRUE(factor.factorize(matrix.valuePtr()));
    const Eigen::VectorXcd exact = Eigen::VectorXcd::LinSpaced(n, 1.0, {2.0, 1.0});
    Eigen::VectorXcd found = matrix * exact;
    factor.solve(found);
    // The condition number is about 10.
    EXPECT_LT((found - exact).norm(), 1e-13);
    matrix *= 2.0;
  }
  matrix *= 0.0;
  EXPECT_FALSE(factor.factorize(matrix.valuePtr()));
}

TEST(SmoothSteps, TrajectoryOfASlideIsExactForPolynomials) {
  // A polynomial of degree 11 is determined by values and rates at six points.
  const auto slide = [](double t) { return std::pow(t, 11) - 2.0 * std::pow(t, 3) + t; };
  const auto speed = [](double t) { return 11.0 * std::pow(t, 10) - 6.0 * t * t + 1.0; };
  detail::SlipTrajectory slip;
  for (const double t : {0.0, 0.04, 0.2, 0.4, 0.6, 0.7}) slip.add(t, slide(t), speed(t));
  for (const double t : {0.02, 0.3, 0.65}) {
    EXPECT_NEAR(slip.slide_at(t), slide(t), 1e-13);
    EXPECT_NEAR(slip.speed_at(t), speed(t), 1e-12);
  }
}

constexpr double axial_stiffness = 5e3;  // E A [N]
constexpr double spring = 2e3;           // of the slider [N/m]
constexpr double gravity = 9.81;

/// A swinging pendulum: 1 kg on a rod of 1 m, with friction along x.
Model rubbing_pendulum(double bound, double seconds) {
  Model model;
  model.programs = {lasting(seconds)};
  model.nodes = {node("A", 0, 0, 0), node("B", 1, 0, 2)};
  model.nodes[1].load = {0.0, -gravity, 0.0};
  model.links = {{"AB", 0, 1, axial_stiffness, 1.0, 0.0, 0, 1.0}};
  Slider slider;
  slider.name = std::string("S");
  slider.first = 1;
  slider.axis = Eigen::Vector3d::UnitX();
  slider.friction_force = bound;
  slider.tangential_stiffness = spring;
  model.joints = {slider};
  return model;
}

/// Position of the pendulum, by integration of its equations of motion to 1e-13.
/// @param damping c of the slider [N s/m]
Vector2d swung(double bound, double damping, double seconds) {
  std::vector<double> y{0.0, 0.0, 0.0, 0.0, 0.0};  // displacements, velocities, force of the spring
  const auto rates = [&](const std::vector<double>& at, std::vector<double>& rate, double) {
    const Vector2d along(1.0 + at[0], at[1]);
    const double length = along.norm();
    const double tension = axial_stiffness * (length - 1.0);
    const double spring_force = std::clamp(at[4], -bound, bound);
    const double friction = std::clamp(spring_force + damping * at[2], -bound, bound);
    rate[0] = at[2];
    rate[1] = at[3];
    rate[2] = -tension * along.x() / length - friction;
    rate[3] = -tension * along.y() / length - gravity;
    rate[4] = std::abs(at[4]) >= bound && at[4] * at[2] > 0.0 ? 0.0 : spring * at[2];
  };
  namespace odeint = boost::numeric::odeint;
  // In short intervals the spring force exceeds its bound only slightly before it is reset.
  const int pieces = 40000;
  for (int i = 0; i < pieces; ++i) {
    odeint::integrate_adaptive(
        odeint::make_controlled(1e-14, 1e-14, odeint::runge_kutta_dopri5<std::vector<double>>()),
        rates, y, 0.0, seconds / pieces, seconds / pieces);
    y[4] = std::clamp(y[4], -bound, bound);
  }
  return {y[0], y[1]};
}

struct Reached {
  Vector2d place;
  int changes = 0;
};

/// Result of equal three-stage steps (order 5). A status change shortens the step in which it
/// occurs.
Reached stepped(double bound, double damping, double seconds, int steps) {
  const Model model = rubbing_pendulum(bound, seconds);
  Inertia inertia;
  inertia.node_mass = Vector2d(0.0, 1.0);
  inertia.joint_damping = VectorXd::Constant(1, damping / std::sqrt(spring));
  MotionOptions options;
  options.displacement_tolerance = 1e-10;  // iterations stop at a thousandth of it
  const detail::System system(model);
  const detail::Bodies bodies(system, inertia);
  const auto stepper = detail::SmoothStepper::of(system, bodies, inertia, options, 3);
  stepper->begin(VectorXd::Zero(2), VectorXd::Zero(2), nullptr);
  Reached reached;
  const double h = seconds / steps;
  while (stepper->time() < seconds) {
    double to = stepper->time() + h < seconds - 1e-9 ? stepper->time() + h : seconds;
    for (int tries = 0; tries < 10; ++tries) {
      EXPECT_TRUE(stepper->attempt(to));
      const std::optional<double> change = stepper->first_change();
      if (!change || *change >= to - 1e-6 * h) break;
      to = *change;
      if (to <= stepper->time()) break;
    }
    if (to > stepper->time()) stepper->accept();
    reached.changes += stepper->turn();
  }
  State state;
  stepper->describe(state);
  reached.place = state.displacement.col(1).head<2>();
  return reached;
}

TEST(SmoothSteps, KeepTheirOrderOverChangesOfBranches) {
  const double seconds = 3.0;
  struct Rubs {
    double bound;
    double damping;
    int least_changes;
  };
  double smooth_error = 0.0;
  // Cases: stick; slip and stick; slip and stick with a dashpot, whose contact spring also deforms
  // during slip.
  for (const Rubs& rubs : {Rubs{1e6, 0.0, 0}, Rubs{3.0, 0.0, 5}, Rubs{3.0, 4.0, 5}}) {
    SCOPED_TRACE(::testing::Message() << rubs.bound << " N, " << rubs.damping << " N s/m");
    const Vector2d exact = swung(rubs.bound, rubs.damping, seconds);
    const Reached coarse = stepped(rubs.bound, rubs.damping, seconds, 200);
    const Reached fine = stepped(rubs.bound, rubs.damping, seconds, 800);
    const double by = (coarse.place - exact).norm() / (fine.place - exact).norm();
    EXPECT_GE(fine.changes, rubs.least_changes);
    // Order five: a quarter of the step divides the error by 4^5 = 2^10. Measured are 2^9.8 to
    // 2^10.
    EXPECT_GT(std::log2(by), 9.0) << (coarse.place - exact).norm();
    // Located status changes cause errors as small as without changes. With changes only at ends of
    // steps, the error would be a thousand times larger.
    const double error = (fine.place - exact).norm();
    if (rubs.least_changes == 0) smooth_error = error;
    EXPECT_LT(error, 20.0 * smooth_error + 1e-15);
  }
}

TEST(SmoothSteps, EnergiesCloseWithTheTolerance) {
  // Bar of Table 1 and its block, which has a tangential spring and slides on heating and cooling.
  Model model = testing::sliding_bar(0.1);
  std::get<Slider>(model.joints[0]).tangential_stiffness = 1e7;
  const Inertia inertia{VectorXd::Constant(1, 0.1), {}, VectorXd::Constant(1, 50.0), {}, {},
                        VectorXd::Constant(1, 0.05)};
  MotionOptions options;
  options.steps = 20;
  const auto run = [&](double tolerance) {
    options.displacement_tolerance = tolerance;
    return simulate(model, inertia, options);
  };
  const Motion coarse = run(1e-7);
  const Motion fine = run(1e-9);
  for (const Motion* one : {&coarse, &fine}) {
    EXPECT_EQ(one->states.size(), 21u);
    EXPECT_EQ(one->inexact_steps, 0);
    EXPECT_GE(one->events.size(), 2u);
  }
  const double heat = fine.states.back().joint_dissipation.sum();
  EXPECT_GT(heat, 1e-3);
  EXPECT_GT(fine.moving.back().damping_dissipation, 0.0);
  // Each step may lose a position error equal to the tolerance, times a force of 30 N.
  EXPECT_LT(std::abs(residue(coarse)), 30.0 * 1e-7 * static_cast<double>(coarse.steps));
  EXPECT_LT(std::abs(residue(fine)), 30.0 * 1e-9 * static_cast<double>(fine.steps));
}

}  // namespace
}  // namespace statejump::truss
