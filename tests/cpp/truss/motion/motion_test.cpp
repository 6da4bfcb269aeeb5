// SPDX-License-Identifier: GPL-3.0-or-later
#include "statejump/truss/motion.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <boost/numeric/odeint.hpp>
#include <cmath>
#include <limits>
#include <tuple>
#include <vector>

#include "scenes.hpp"
#include "statejump/linkage/run.hpp"

namespace statejump::truss {
namespace {

using Eigen::Matrix2d;
using Eigen::Matrix3Xd;
using Eigen::Vector2d;
using Eigen::Vector3d;
using namespace scenes;

constexpr double stiffness = 5e3;  // E A [N]
constexpr double rod_mass = 0.3;   // [kg]

/// Two rods that hang from a hinge, with point loads.
Model double_pendulum() {
  Model model;
  model.programs = {lasting(0.5)};
  model.nodes = {node("A", 0, 0, 0), node("B", 1, 0, 2), node("C", 1.5, 0.5, 2)};
  for (int i : {1, 2}) model.nodes[static_cast<std::size_t>(i)].load = {0.0, -5.0, 0.0};
  model.links = {{"AB", 0, 1, stiffness, 1.0, 0.0, 0, 1.0},
                 {"BC", 1, 2, stiffness, std::sqrt(0.5), 0.0, 0, 1.0}};
  return model;
}

/// Reference: final positions of B and C from the equations of motion, accurate to 1e-12.
Eigen::Vector4d double_pendulum_by_ode() {
  using Numbers = std::vector<double>;
  // Mass matrix of rods with linear velocity profile: at B m/3 of both rods, at C m/3 of one,
  // coupling m/6.
  Matrix2d mass;
  mass << 2.0 * rod_mass / 3.0, rod_mass / 6.0, rod_mass / 6.0, rod_mass / 3.0;
  const Matrix2d inverse = mass.inverse();
  const auto pull = [](const Vector2d& along, double length) -> Vector2d {
    return stiffness * (along.norm() / length - 1.0) * along.normalized();
  };
  const auto rates = [&](const Numbers& y, Numbers& dy, double) {
    const Vector2d b(y[0], y[1]);
    const Vector2d c(y[2], y[3]);
    const Vector2d lower = pull(c - b, std::sqrt(0.5));
    const Vector2d on_b = Vector2d(0.0, -5.0) - pull(b, 1.0) + lower;
    const Vector2d on_c = Vector2d(0.0, -5.0) - lower;
    for (std::size_t k = 0; k < 2; ++k) {
      dy[k] = y[4 + k];
      dy[2 + k] = y[6 + k];
      const auto i = static_cast<Eigen::Index>(k);
      dy[4 + k] = inverse(0, 0) * on_b[i] + inverse(0, 1) * on_c[i];
      dy[6 + k] = inverse(1, 0) * on_b[i] + inverse(1, 1) * on_c[i];
    }
  };
  namespace odeint = boost::numeric::odeint;
  Numbers y{1.0, 0.0, 1.5, 0.5, 0.0, 0.0, 0.0, 0.0};
  odeint::integrate_adaptive(
      odeint::make_controlled(1e-12, 1e-12, odeint::runge_kutta_dopri5<Numbers>()), rates, y, 0.0,
      0.5, 1e-4);
  return {y[0], y[1], y[2], y[3]};
}

TEST(Motion, DoublePendulumConvergesAtSecondOrderToItsOwnEquations) {
  const Model model = double_pendulum();
  const Inertia inertia{Eigen::Vector2d(rod_mass, rod_mass), {}, {}, {}, {}};
  const Eigen::Vector4d exact = double_pendulum_by_ode();
  const auto error = [&](long steps) {
    MotionOptions options;
    options.steps = options.sample_every = steps;
    options.start = at_rest(model);
    const Motion motion = simulate(model, inertia, options);
    const Matrix3Xd& moved = motion.states.back().displacement;
    const Eigen::Vector4d found(1.0 + moved(0, 1), moved(1, 1), 1.5 + moved(0, 2),
                                0.5 + moved(1, 2));
    return (found - exact).norm();
  };
  const double coarse = error(8000);
  const double fine = error(16000);
  EXPECT_LT(fine, 1e-4);
  EXPECT_NEAR(coarse / fine, 4.0, 0.2);
}

TEST(Motion, FreeChainKeepsItsMomenta) {
  // Without external forces momentum is conserved exactly, angular momentum and energy to second
  // order.
  Model model = double_pendulum();
  model.nodes[0].freedoms = 2;
  for (Node& one : model.nodes) one.load.setZero();
  const Inertia inertia{Eigen::Vector2d(rod_mass, rod_mass), Vector3d(0.1, 0.2, 0.3), {}, {}, {}};
  const auto run = [&](long steps) {
    MotionOptions options;
    options.steps = options.sample_every = steps;
    options.start = at_rest(model);
    options.start->velocity << 0.3, -1.0, 0.5, -1.0, 2.0, 1.0, 0.0, 0.0, 0.0;
    return simulate(model, inertia, options);
  };
  const auto momenta = [&](const Motion& motion, std::size_t sample) {
    // Rods with linear velocity profile, as in the mass matrix.
    Eigen::Matrix3d mass = Vector3d(0.1, 0.2, 0.3).asDiagonal();
    for (int i : {0, 1}) {
      Matrix2d rod;
      rod << 2.0, 1.0, 1.0, 2.0;
      mass.block<2, 2>(i, i) += rod_mass / 6.0 * rod;
    }
    Matrix3Xd places = motion.states[sample].displacement;
    for (int i = 0; i < 3; ++i) places.col(i) += model.nodes[static_cast<std::size_t>(i)].position;
    const Matrix3Xd carried = motion.moving[sample].velocity * mass;
    double turning = 0.0;
    for (int i = 0; i < 3; ++i) {
      turning += places(0, i) * carried(1, i) - places(1, i) * carried(0, i);
    }
    return Vector3d(carried.row(0).sum(), carried.row(1).sum(), turning);
  };
  const auto lost = [&](const Motion& motion) -> Vector3d {
    return momenta(motion, motion.states.size() - 1) - momenta(motion, 0);
  };
  const Motion coarse = run(4000);
  const Motion fine = run(8000);
  for (const Motion* one : {&coarse, &fine}) {
    // The residual of each step is 1e-10 of its forces, with random sign over 8000 steps.
    EXPECT_LT(lost(*one).head<2>().norm(), 1e-8);
  }
  EXPECT_NEAR(lost(coarse)[2] / lost(fine)[2], 4.0, 0.5);
  EXPECT_NEAR(residue(coarse) / residue(fine), 4.0, 0.5);
}

TEST(Motion, JournalBouncesAtItsAnalyticTimes) {
  const Model model = falling_journal();
  const Inertia inertia{{}, Vector2d(0.0, 1.0), {}, {}, {}};
  const double e = 0.7;
  MotionOptions options;
  options.steps = 20000;
  options.restitution = e;
  options.start = at_rest(model);
  options.start->displacement(1, 1) = -0.5e-3;
  const Motion motion = simulate(model, inertia, options);
  const double h = motion.time_step;
  double speed = std::sqrt(2.0 * 9.81 * 0.5e-3);
  double time = speed / 9.81;
  double energy = 0.5 * speed * speed;
  int impact = 0;
  for (const Event& event : motion.events) {
    if (event.before != JointStatus::open || impact == 6) continue;
    // A contact is located to one step, and every bounce inherits the errors of earlier ones.
    EXPECT_NEAR(event.time, time, 3.0 * h * (1 + impact)) << "impact " << impact;
    speed *= e;
    time += 2.0 * speed / 9.81;
    ++impact;
  }
  EXPECT_EQ(impact, 6);
  // At the end the journal rests, and impacts have dissipated the energy of the fall.
  EXPECT_NEAR(motion.moving.back().impact_dissipation, energy, 1e-3 * energy);
  EXPECT_LT(motion.moving.back().velocity.norm(), 9.81 * h * 2.0);
  EXPECT_LT(std::abs(residue(motion)), 1e-12 * energy * 1e3);
}

/// Bar of Table 1 on a block that slides on the ground up to a stop.
Model bar(double seconds) {
  Model model = testing::sliding_bar(seconds);
  std::get<Slider>(model.joints[0]).clearance_plus = 1e-3;
  return model;
}

TEST(Motion, SlidingBlockStopsWhereFrictionHasTakenItsEnergy) {
  Model model = bar(0.02);
  model.programs = {lasting(0.02)};
  model.links.clear();
  const Inertia inertia{{}, Vector2d(0.0, 2.0), {}, {}, {}};
  const auto slid = [&](long steps) {
    MotionOptions options;
    options.steps = steps;
    options.start = at_rest(model);
    options.start->velocity(0, 1) = 0.1;
    const Motion motion = simulate(model, inertia, options);
    EXPECT_NEAR(motion.states.back().joint_dissipation[0], 0.5 * 2.0 * 0.01, 1e-12);
    EXPECT_EQ(motion.states.back().joint_status[0], JointStatus::stick);
    return motion.states.back().displacement(0, 1);
  };
  const double exact = 2.0 * 0.01 / (2.0 * 30.0);
  EXPECT_NEAR(slid(1000), exact, 0.1 * 2e-5);  // the step in which it stops
}

TEST(Motion, ContactProblemsAreSolvedOnlyWhereBranchesAreNotFound) {
  // A block that slides and then sticks, and a journal that bounces off an elastic contact with
  // friction. In every step the active-set iteration must find the statuses.
  Model block = bar(0.02);
  block.programs = {lasting(0.02)};
  block.links.clear();
  MotionOptions options;
  options.steps = 1000;
  options.start = at_rest(block);
  options.start->velocity(0, 1) = 0.1;
  Model journal = falling_journal();
  ClearanceRevolute& joint = std::get<ClearanceRevolute>(journal.joints[0]);
  joint.hertz_stiffness = 1e9;
  joint.friction_coefficient = 0.2;
  for (const double mindlin : {std::numeric_limits<double>::infinity(), 1e9}) {
    joint.mindlin_stiffness = mindlin;
    for (const Model* model : {&block, &journal}) {
      const Motion motion = simulate(*model, {{}, Vector2d(0.0, 1.0), {}, {}, {}}, options);
      EXPECT_EQ(motion.iterations, 0);
      EXPECT_EQ(motion.largest_contact_merit, 0.0);
      // otherwise every other step would need its own
      EXPECT_LT(motion.factorizations, motion.steps / 4);
    }
  }
  // The active-set iteration fails when a bar with elastic friction reaches its stop; the merit is
  // reported.
  Model heated = bar(0.1);
  std::get<Slider>(heated.joints[0]).tangential_stiffness = 1e6;
  options = {};
  options.steps = 2000;
  const Motion motion = simulate(heated, {Vector2d(0.1, 0.0).head(1), {}, {}, {}, {}}, options);
  EXPECT_GT(motion.iterations, 0);
  EXPECT_GT(motion.largest_contact_merit, 0.0);
  EXPECT_LT(motion.largest_contact_merit, 1e-10);  // tolerance of a contact problem
}

TEST(Motion, BarsBesideEachOtherMoveAsEachAlone) {
  // Two bars, coupled only by the common contact problem. The second one has different friction,
  // play and springs.
  const auto heated = [](int which) {
    Model model = bar(0.1);
    Slider& slider = std::get<Slider>(model.joints[0]);
    slider.tangential_stiffness = which == 0 ? 1e6 : 3e6;
    if (which == 1) {
      slider.friction_force = 50.0;
      slider.clearance_plus = 0.8e-3;
      model.links[0].axial_stiffness *= 2.0;
    }
    return model;
  };
  const auto moved = [](const Model& model, const Inertia& inertia) {
    MotionOptions options;
    options.steps = 2000;
    options.sample_every = 100;
    options.start = at_rest(model);
    return simulate(model, inertia, options);
  };
  const Vector2d masses(0.1, 0.25);
  Model both = heated(0);
  const Model other = heated(1);
  both.nodes.insert(both.nodes.end(), other.nodes.begin(), other.nodes.end());
  both.links.push_back(other.links[0]);
  both.links[1].first += 2;
  both.links[1].second += 2;
  both.joints.push_back(other.joints[0]);
  std::get<Slider>(both.joints[1]).first += 2;
  const Motion together = moved(both, {masses, {}, {}, {}, {}});
  EXPECT_GT(together.iterations, 0);
  for (int which : {0, 1}) {
    const Motion alone = moved(heated(which), {masses.segment<1>(which), {}, {}, {}, {}});
    ASSERT_EQ(alone.states.size(), together.states.size());
    for (std::size_t i = 0; i < alone.states.size(); ++i) {
      // Contact problems are solved to a relative 1e-10; displacements of millimetres agree to a
      // millionth.
      EXPECT_NEAR(together.states[i].displacement(0, 1 + 2 * which),
                  alone.states[i].displacement(0, 1), 1e-9)
          << which << " " << i;
    }
  }
}

TEST(Motion, ProgressEndsAMotion) {
  const Model model = falling_journal();
  MotionOptions options;
  options.steps = 100;
  options.start = at_rest(model);
  for (const double share : {0.3, 1.0}) {
    // At the very end there is nothing to cancel.
    options.progress = [share](double done) { return done < share; };
    const Motion motion = simulate(model, {{}, Vector2d(0.0, 1.0), {}, {}, {}}, options);
    EXPECT_EQ(motion.complete, share == 1.0);
    EXPECT_NEAR(motion.states.back().time, share * 0.1, 1e-3 + 1e-15);
  }
}

TEST(Motion, SlowHeatingFollowsTheQuasiStaticPath) {
  // Start, slip and reversals of the program excite oscillations of amplitude v sqrt(m/k),
  // so the error is of first order in the heating rate.
  const auto error = [](double seconds) {
    const Model model = bar(seconds);
    const double k = 70e9 * 9e-6 / 0.5;
    const double mass = 0.1;
    const Inertia inertia{Vector2d(mass, 0.0).head(1),
                          {},
                          Vector2d(2.0 * 0.5 * std::sqrt(k * mass / 3.0), 0.0).head(1),
                          {},
                          {}};
    MotionOptions options;
    options.steps = 20000;
    const Motion motion = simulate(model, inertia, options);
    const double jump = 30.0 * 0.5 / (70e9 * 9e-6);
    EXPECT_NEAR(residue(motion) / motion.states.back().joint_dissipation.sum(), 0.0, 1e-3);
    return std::abs(motion.states.back().displacement(0, 1) - jump) / jump;
  };
  const double fast = error(0.1);
  const double slow = error(1.0);
  EXPECT_LT(slow, 1e-3);
  EXPECT_NEAR(fast / slow, 10.0, 1.0);
}

TEST(Motion, RibMeetsTheLinkageThroughImpacts) {
  // Rib of the umbrella antenna without friction. The reference is the linkage's RK4 with 20 times
  // the steps. In the contact, implicit Euler is of first order.
  linkage::Linkage antenna;
  antenna.frame_length = 0.12;
  antenna.link_ab = {0.050, 0.5, 70e9, 9e-6, 23.75e-6, 0.3};
  antenna.link_bc = {0.100, 1.0, 70e9, 9e-6, 23.75e-6, 0.3};
  antenna.journal_radius = 5e-3;
  antenna.bearing_radius = 5.1e-3;
  const thermal::Program program = lasting(0.012, 60.0);
  const linkage::State start = linkage::initial_state(antenna, linkage::Start::matched,
                                                      program.temperature_rate(0.0), {1e-6, 0.0});
  const linkage::Run exact = linkage::simulate(antenna, program, start, {400000, 0});
  ASSERT_GT(exact.contacts, 0);

  Model model;
  model.programs = {program};
  const double x = 0.02875;
  const double y = std::sqrt(0.05 * 0.05 - x * x);
  model.nodes = {node("A", 0, 0, 0), node("C", 0.12, 0, 0), node("B", x, y, 2), node("J", x, y, 2)};
  model.links = {{"AB", 0, 2, 6.3e5, 0.05, 23.75e-6, 0, 1.0},
                 {"CJ", 1, 3, 6.3e5, 0.1, 23.75e-6, 0, 1.0}};
  ClearanceRevolute joint = testing::rib_joint();
  joint.hertz_stiffness = 4.0 / 3.0 * 70e9 / (2.0 * (1.0 - 0.09)) * std::sqrt(5e-3 * 5.1e-3 / 1e-4);
  model.joints = {joint};
  const auto error = [&](long steps) {
    MotionOptions options;
    options.steps = options.sample_every = steps;
    options.start = at_rest(model);
    for (const auto& [k, centre, velocity] :
         {std::tuple{2, start.bearing_centre, start.bearing_velocity},
          std::tuple{3, start.journal_centre, start.journal_velocity}}) {
      options.start->displacement.col(k).head<2>() =
          centre - model.nodes[static_cast<std::size_t>(k)].position.head<2>();
      options.start->velocity.col(k).head<2>() = velocity;
    }
    const Motion motion = simulate(model, {Eigen::Vector2d(0.5, 1.0), {}, {}, {}, {}}, options);
    const Vector2d at =
        model.nodes[3].position.head<2>() + motion.states.back().displacement.col(3).head<2>();
    return (at - exact.samples.back().state.journal_centre).norm();
  };
  const double coarse = error(20000);
  const double fine = error(40000);
  EXPECT_LT(fine, 2e-2 * 1e-4);  // of the play
  EXPECT_NEAR(coarse / fine, 2.0, 0.4);
}

/// Painlevé's rod: uniform, 1 m, 1 kg, inclined by 60°. Its tip moves along a rough floor, the
/// bottom of a bearing with a play of 100 m.
Model rod_on_floor(double friction) {
  Model model;
  model.programs = {lasting(1e-3)};
  const double angle = std::acos(0.5);
  model.nodes = {node("O", 0, 100.0, 0), node("tip", 0, 0, 2),
                 node("top", std::cos(angle), std::sin(angle), 2)};
  for (std::size_t i : {1u, 2u}) model.nodes[i].load = {0.0, -0.5 * 9.81, 0.0};
  model.links = {{"rod", 1, 2, 1e13, 1.0, 0.0, 0, 1.0}};
  ClearanceRevolute floor;
  floor.name = "floor";
  floor.bearing_node = 0;
  floor.journal_node = 1;
  floor.journal_radius = 5e-3;
  floor.radial_clearance = 100.0;
  floor.friction_coefficient = friction;
  model.joints = {floor};
  return model;
}

TEST(Motion, SlidesThatCannotGoOnAreNamed) {
  // Per newton of normal force the tip accelerates by 1 + 3 cos a (cos a -+ mu sin a) [1/kg]. At 60
  // degrees this is negative for mu > 1.347 if the tip moves towards the foot of the rod. The rod
  // is so stiff that it is rigid in steps of 10 us.
  const double speed = 1.0;
  const auto first_step = [&](double friction, double towards, long steps) {
    const Model model = rod_on_floor(friction);
    MotionOptions options;
    options.steps = steps;
    options.start = at_rest(model);
    options.start->velocity.row(0).tail(2).setConstant(towards * speed);
    return simulate(model, {Eigen::VectorXd::Constant(1, 1.0), {}, {}, {}, {}}, options);
  };
  const auto lost = [&](const Motion& motion, double towards) {
    return speed - towards * motion.moving[1].velocity(0, 1);
  };
  for (const long steps : {10L, 100L}) {
    const double h = 1e-3 / static_cast<double>(steps);
    const Motion jams = first_step(1.4, -1.0, steps);
    ASSERT_TRUE(jams.jammed) << steps;
    EXPECT_EQ(jams.jammed->joints, std::vector<int>{0});
    EXPECT_NEAR(jams.jammed->time, h, 1e-3 * h);  // immediately
    EXPECT_NEAR(lost(jams, -1.0), speed, 1e-3 * speed);
    // With smaller mu, or in the other direction, the rod continues to slide. Forces are large but
    // finite.
    const Motion slides = first_step(1.3, -1.0, steps);
    EXPECT_FALSE(slides.jammed) << steps;
    EXPECT_LT(lost(slides, -1.0), 1e3 * h);
    EXPECT_FALSE(first_step(1.4, 1.0, steps).jammed) << steps;
  }
}

TEST(Motion, StepsWhoseReactionsAreOpenAreNamed) {
  // Two sliders between the ground and one rigid node: nothing determines which one carries the
  // load.
  Model model = bar(0.01);
  model.programs = {lasting(0.01)};
  Slider twin = std::get<Slider>(model.joints[0]);
  twin.name = "T";
  model.nodes[1].load = {10.0, 0.0, 0.0};
  const auto run = [&](double tolerance = 0.0) {
    MotionOptions options;
    options.steps = 100;
    options.displacement_tolerance = tolerance;
    options.start = at_rest(model);
    return simulate(model, {Vector2d(0.1, 0.0).head(1), {}, {}, {}, {}}, options);
  };
  EXPECT_FALSE(run().undetermined);
  model.joints.push_back(twin);
  // No step is short enough to determine the statuses of both sliders, so step halving must end.
  for (const double tolerance : {0.0, 1e-9}) {
    const Motion motion = run(tolerance);
    ASSERT_TRUE(motion.undetermined);
    EXPECT_EQ(motion.undetermined->joints, (std::vector<int>{0, 1}));
    EXPECT_NEAR(motion.states.back().displacement(0, 1), 0.0,
                1e-12);  // merit 1e-10 of h f W, 1e-4 m/s
    EXPECT_LT(motion.factorizations, 30 * motion.steps);
  }
}

TEST(Motion, ReactionsOfWhatComesToRestTogetherAreNamed) {
  // The two sliders move and stop within one step. If one sticks, the slide of the other is zero,
  // which satisfies each of its statuses.
  Model model = bar(0.01);
  model.programs = {lasting(0.01)};
  Slider twin = std::get<Slider>(model.joints[0]);
  twin.name = "T";
  model.joints.push_back(twin);
  MotionOptions options;
  options.steps = 100;
  options.start = at_rest(model);
  options.start->velocity(0, 1) = 1.0;
  const Motion motion = simulate(model, {Vector2d(0.1, 0.0).head(1), {}, {}, {}, {}}, options);
  const auto rests = std::find_if(motion.events.begin(), motion.events.end(),
                                  [](const Event& one) { return one.after == JointStatus::stick; });
  ASSERT_NE(rests, motion.events.end());
  ASSERT_TRUE(motion.undetermined);
  EXPECT_EQ(motion.undetermined->joints, (std::vector<int>{0, 1}));
  EXPECT_NEAR(motion.undetermined->time, rests->time, 1e-9);
}

}  // namespace
}  // namespace statejump::truss
