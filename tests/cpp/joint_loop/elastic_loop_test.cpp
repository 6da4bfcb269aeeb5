// SPDX-License-Identifier: GPL-3.0-or-later
#include "statejump/joint_loop/elastic_loop.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <stdexcept>
#include <string>

#include "linkage/umbrella.hpp"
#include "statejump/failure.hpp"
#include "statejump/linkage/run.hpp"
#include "support/argument.hpp"

namespace statejump::joint_loop {
namespace {

using linkage::alpha;
using linkage::frame;
using linkage::heating;
using linkage::umbrella;
using statejump::testing::Argument;
using statejump::testing::refused_argument;

using Eigen::Vector2d;

constexpr auto rigid = TangentialCompliance::rigid;
constexpr auto mindlin = TangentialCompliance::mindlin;

/// The torsion spring's stress-free angle is not the ideal flare angle, so the spring always loads
/// the joint.
linkage::Linkage biased(double mu, double bias = 0.05, double stiffer = 1.0) {
  linkage::Linkage model = umbrella();
  model.law.friction = kernel::laws::friction_law(mu > 0.0 ? "mindlin" : "none");
  model.law.friction_parameters.friction_coefficient = mu;
  model.torsion_stiffness = 1.0;
  model.torsion_free_angle = umbrella().free_angle() + bias;
  model.link_ab.young_modulus *= stiffer;
  model.link_bc.young_modulus *= stiffer;
  return model;
}

/// A model without default values, which could hide errors: paper's radius, expanding radii,
/// unequal links.
linkage::Linkage expanding(double mu) {
  linkage::Linkage model = biased(mu, -0.05);
  model.law.normal = kernel::laws::normal_law("hertz_paper");
  model.journal_thermal_expansion = 0.5 * alpha;
  model.bearing_thermal_expansion = 2.0 * alpha;
  model.link_bc.thermal_expansion = 0.8 * alpha;
  model.link_bc.young_modulus = 50e9;
  return model;
}

linkage::Linkage with_partial_slip(linkage::Linkage model) {
  model.law.friction = kernel::laws::friction_law("mindlin_deresiewicz");
  return model;
}

// Rounding errors are 1e-16 for angles of order 1, and 1e-16 m for the closure of links of 0.05 m.
constexpr double angle_rounding = 1e-14;

/// Equilibrium at a point by virtual work: for each coordinate of the link tips, the gradient of
/// energy() equals F_t times the gradient of the material slide at the contact. Returns the largest
/// difference [N].
double out_of_balance(const linkage::Linkage& model, const ElasticJointPoint& point) {
  linkage::State at;
  at.bearing_centre = point.bearing_centre;
  at.journal_centre = point.journal_centre;
  const auto coordinate = [](linkage::State& state, int i) -> double& {
    return i < 2 ? state.bearing_centre[i] : state.journal_centre[i - 2];
  };
  const auto potential = [&](int i, double shift) {
    linkage::State state = at;
    coordinate(state, i) += shift;
    return energy(model, state, point.temperature_change).sum();
  };
  const Vector2d d = at.journal_centre - at.bearing_centre;
  const Vector2d n = d.normalized();
  const Vector2d t(-n.y(), n.x());
  const auto turn = [](const Vector2d& r) -> Vector2d {  // ∂θ/∂(tip)
    return Vector2d(-r.y(), r.x()) / r.squaredNorm();
  };
  const double r1 =
      model.journal_radius * (1.0 + model.journal_thermal_expansion * point.temperature_change);
  const double r2 =
      model.bearing_radius * (1.0 + model.bearing_thermal_expansion * point.temperature_change);
  const double half = 0.5 * (d.norm() - (r2 - r1));
  Eigen::Vector4d slide;
  slide << -t - (r2 + half) * turn(at.bearing_centre),
      t + (r1 - half) * turn(at.journal_centre - Vector2d(model.frame_length, 0.0));
  double largest = 0.0;
  for (int i = 0; i < 4; ++i) {
    // Central differences with h and 2h at δ = 1e-7 m. The truncation error h^4/30 V''''', with
    // V''''' ~ δ^-2.5, is 1e-8 N. Rounding adds errors over h: of positions, 1e-17 m times 1 N, and
    // of the spring energy, 1e-19 J.
    const double h = 1e-9;
    const double gradient = (8.0 * (potential(i, h) - potential(i, -h)) -
                             (potential(i, 2.0 * h) - potential(i, -2.0 * h))) /
                            (12.0 * h);
    largest = std::max(largest, std::abs(gradient - point.tangential_force * slide[i]));
  }
  return largest;
}

TEST(ElasticLoop, PointsAreEquilibriaByVirtualWork) {
  for (const linkage::Linkage& model : {biased(0.0), biased(0.3), expanding(0.0), expanding(0.3)}) {
    for (const TangentialCompliance compliance : {rigid, mindlin}) {
      const ElasticLoop loop = elastic_loop(model, heating(), {8, compliance});
      for (const ElasticJointPoint& point : loop.points) {
        EXPECT_GT(point.normal_force, 0.5);
        EXPECT_LT(out_of_balance(model, point), 1e-7);
        // A single contact point makes the joint force parallel to AC, also for elastic links.
        EXPECT_NEAR(std::atan2(point.tangential_force, point.normal_force), point.contact_angle,
                    1e-12);
        EXPECT_LE(std::abs(point.tangential_force),
                  model.friction_coefficient() * point.normal_force * (1.0 + 1e-12));
      }
      EXPECT_LT(loop.largest_force_residual, 1e-12);
      EXPECT_LT(loop.largest_closure_residual, 2.4e-16);
      // Limit for steps of 12 K. With a wrong Jacobian, Newton's method converges only linearly.
      EXPECT_LE(loop.most_iterations, 6);
    }
  }
}

TEST(ElasticLoop, LoadedStateIsAtRestForTheDynamics) {
  for (linkage::Linkage model : {biased(0.3), expanding(0.3)}) {
    for (const double phi : {-0.2, 0.0, 0.1}) {
      const linkage::State state = loaded_state(model, phi);
      const linkage::Joint joint = joint_state(model, state, 0.0, 0.0);
      EXPECT_NEAR(std::atan2(state.contact.tangential_force.x(), joint.normal_force), phi, 1e-9);
      EXPECT_EQ(state.impact_speed, model.law.smallest_impact_speed);  // in contact for a long time
      model.axial_damping_ratio = 0.1;
      const thermal::Program hold = heating(0.02, 0.0);
      const linkage::State end = simulate(model, hold, state, {2000, 0}).samples.back().state;
      // Positions are rounded to 1e-17 m. Times k_T, this leaves an unbalanced force of 1e-10 N. In
      // the softest mode, a rotation of the contact angle with about F/c = 1e4 N/m, it causes 1e-14
      // m.
      EXPECT_LT((end.bearing_centre - state.bearing_centre).norm(), 1e-13);
      EXPECT_LT((end.journal_centre - state.journal_centre).norm(), 1e-13);
      EXPECT_NEAR(end.contact.tangential_force.x(), state.contact.tangential_force.x(), 1e-6);
    }
  }
}

TEST(ElasticLoop, TendsToTheRigidLoop) {
  // Depth δ ~ E^(-2/3) and elongation e ~ E^(-1) are comparable at E. With stiffness factor s, the
  // distance to the rigid loop is D = A s^(-2/3) (1 + B s^(-1/3)), |B| of order 1; 1.5 is allowed.
  // A tenfold s divides D by 10^(2/3) (1 + B s^(-1/3))/(1 + B (10 s)^(-1/3)).
  for (const double mu : {0.15, 0.3}) {
    const RigidLoop limit = rigid_loop(biased(mu), heating());
    const auto distance = [&](double stiffer) -> Eigen::Array3d {
      const ElasticLoop loop = elastic_loop(biased(mu, 0.05, stiffer), heating());
      EXPECT_EQ(loop.events.size(), limit.events.size());
      return {loop.theta2_jump() - limit.theta2_jump(), loop.theta4_jump() - limit.theta4_jump(),
              loop.events[1].temperature_change - limit.events[1].temperature_change};
    };
    const Eigen::Array3d soft = distance(1e3);
    const Eigen::Array3d stiff = distance(1e4);
    const Eigen::Array3d stiffest = distance(1e5);
    const double power = std::pow(10.0, 2.0 / 3.0);
    const double step = 1.5 * (1.0 - std::pow(10.0, -1.0 / 3.0));
    for (int i = 0; i < 3; ++i) {
      std::printf("mu %.2f: distance %.4g %.4g %.4g, ratios %.4f %.4f\n", mu, soft[i], stiff[i],
                  stiffest[i], soft[i] / stiff[i], stiff[i] / stiffest[i]);
      EXPECT_NEAR(soft[i] / stiff[i], power, power * step * std::pow(1e3, -1.0 / 3.0));
      EXPECT_NEAR(stiff[i] / stiffest[i], power, power * step * std::pow(1e4, -1.0 / 3.0));
    }
  }
}

TEST(ElasticLoop, EnoughFrictionLeavesNoJump) {
  for (const linkage::Linkage& model : {biased(0.6), expanding(0.6)}) {
    const ElasticLoop loop = elastic_loop(model, heating());
    double largest = 0.0;
    for (const ElasticJointPoint& point : loop.points) {
      EXPECT_EQ(point.motion, JointMotion::roll);
      largest = std::max(largest, std::abs(point.contact_angle));
    }
    EXPECT_GT(largest, 0.1);
    EXPECT_NEAR(loop.theta2_jump(), 0.0, angle_rounding);
    EXPECT_NEAR(loop.theta4_jump(), 0.0, angle_rounding);
    EXPECT_EQ(loop.events.size(), 3u);
  }
  // The angle must not drift: the rolled arc is measured from the start of rolling, not
  // accumulated.
  EXPECT_NEAR(elastic_loop(biased(0.6), heating(), {100000, rigid}).theta2_jump(), 0.0, 1e-15);
  // Mindlin's spring leaves a small jump: loading keeps its force, unloading keeps its slide.
  const ElasticLoop loop = elastic_loop(biased(0.6), heating(), {2000, mindlin});
  EXPECT_GT(std::abs(loop.theta2_jump()), 1e-10);
  EXPECT_LT(std::abs(loop.theta2_jump()), 1e-8);
}

TEST(ElasticLoop, WithoutFrictionThereIsNoJump) {
  for (const linkage::Linkage& model : {biased(0.0), expanding(0.0)}) {
    const ElasticLoop loop = elastic_loop(model, heating());
    for (const ElasticJointPoint& point : loop.points) EXPECT_EQ(point.tangential_force, 0.0);
    EXPECT_NEAR(loop.theta2_jump(), 0.0, angle_rounding);
    EXPECT_NEAR(loop.theta4_jump(), 0.0, angle_rounding);
    EXPECT_LT(loop.journal_jump().norm(), 1e-15);
  }
}

double theta2_of(const linkage::State& state) {
  return std::atan2(state.bearing_centre.y(), state.bearing_centre.x());
}

TEST(ElasticLoop, JumpThatEndsInSlipIsThatBetweenTwoEquilibria) {
  // During slip the state depends only on ΔT, not on the history or the number of steps.
  const linkage::Linkage model = biased(0.15);
  const double expected =
      theta2_of(loaded_state(model, -std::atan(0.15))) - theta2_of(loaded_state(model));
  for (const TangentialCompliance compliance : {rigid, mindlin}) {
    for (const int samples : {1, 100, 2000}) {
      const ElasticLoop loop = elastic_loop(model, heating(), {samples, compliance});
      EXPECT_NEAR(loop.theta2_jump(), expected, angle_rounding) << samples;
      ASSERT_EQ(loop.events.size(), 5u);  // roll, slip; at the corner roll, slip; end
      EXPECT_EQ(loop.events[1].motion, JointMotion::slip);
      EXPECT_EQ(loop.events[2].motion, JointMotion::roll);
      EXPECT_EQ(loop.events[3].motion, JointMotion::slip);
      for (const ElasticJointPoint& point : loop.points) {
        const double limit = 0.15 * point.normal_force;
        const bool corner = point.temperature_change == 100.0;
        EXPECT_EQ(point.slipping(),
                  !corner && std::abs(std::abs(point.tangential_force) - limit) < 1e-9 * limit)
            << point.temperature_change;
      }
      if (samples < 2000) continue;
      for (const ElasticJointPoint& event : loop.events) {
        std::printf("%-5s %13.9f K  phi %9.6f  depth %.6g m  F_N %.6f N  F_t %9.6f N\n",
                    to_string(event.motion), event.temperature_change, event.contact_angle,
                    event.depth, event.normal_force, event.tangential_force);
      }
      std::printf("jump theta2 %.9g theta4 %.9g rad\n", loop.theta2_jump(), loop.theta4_jump());
    }
  }
}

TEST(ElasticLoop, StepsMayBeLongerThanTheRollBetweenTwoLimits) {
  // At the turning point the tangential force is at one limit, one step later beyond the other.
  // After the first cycle, the events roll, slip, roll, slip repeat at the same temperatures.
  constexpr int cycles = 20;
  for (const double mu : {0.002, 0.005, 0.01, 0.02, 0.05}) {
    for (const TangentialCompliance compliance : {rigid, mindlin}) {
      thermal::Program program = heating();
      program.cycles = cycles;
      const ElasticLoop loop = elastic_loop(biased(mu), program, {3, compliance});
      ASSERT_EQ(loop.events.size(), 4u * cycles + 1u) << mu;
      for (std::size_t i = 4; i < loop.events.size(); ++i) {
        const ElasticJointPoint& event = loop.events[i];
        EXPECT_EQ(event.slipping(), i % 2 == 1 || i == 4u * cycles);
        if (i < 8) continue;
        // φ is accurate to 1e-14. φ and F_t/F_N change by 4e-3 per kelvin, so ΔT is accurate to
        // 1e-11 K.
        EXPECT_NEAR(event.temperature_change, loop.events[i - 4].temperature_change, 1e-10);
      }
    }
  }
}

TEST(ElasticLoop, IncrementsAreOfSecondOrder) {
  // At the end of the cycle the journal rolls, so the result depends on the whole path before.
  // Halving the step divides the error by 4. The shortened step before slip changes this ratio by
  // 1/N, N = number of steps up to slip.
  for (const TangentialCompliance compliance : {rigid, mindlin}) {
    Eigen::Array2d values[4];
    for (int i = 0; i < 4; ++i) {
      const ElasticLoop loop = elastic_loop(biased(0.3), heating(), {20 << i, compliance});
      ASSERT_EQ(loop.events.size(), 4u);  // roll, slip; at the corner roll; end
      values[i] = {loop.theta2_jump(), loop.events[1].temperature_change};
    }
    for (int i = 0; i < 2; ++i) {
      const Eigen::Array2d ratio = (values[i] - values[i + 1]) / (values[i + 1] - values[i + 2]);
      std::printf("ratios %.4f %.4f\n", ratio[0], ratio[1]);
      const double band = 4.0 / (0.81 * (20 << i));  // slip starts at 81 K
      EXPECT_NEAR(ratio[0], 4.0, band);
      EXPECT_NEAR(ratio[1], 4.0, band);
    }
    const ElasticLoop loop = elastic_loop(biased(0.3), heating(), {2000, compliance});
    std::printf("slip %.9f K, jump theta2 %.9g theta4 %.9g rad\n",
                loop.events[1].temperature_change, loop.theta2_jump(), loop.theta4_jump());
  }
}

linkage::Linkage with_radii_at(const linkage::Linkage& model, double temperature_change) {
  linkage::Linkage now = model;
  now.journal_radius *= 1.0 + model.journal_thermal_expansion * temperature_change;
  now.bearing_radius *= 1.0 + model.bearing_thermal_expansion * temperature_change;
  now.journal_thermal_expansion = now.bearing_thermal_expansion = 0.0;
  return now;
}

/// Mindlin's k_t [N/m] with 1/G* = sum of (2 - nu)/G over both bodies, G = E/2.6 (nu = 0.3).
double contact_stiffness(const linkage::Linkage& model, const ElasticJointPoint& point) {
  const linkage::Linkage now = with_radii_at(model, point.temperature_change);
  const bool internal = has(model.law.normal, kernel::laws::Trait::accepts_bulging_wall);
  const double sum = now.bearing_radius + (internal ? -1.0 : 1.0) * now.journal_radius;
  const double radius = now.journal_radius * now.bearing_radius / sum;
  const double soft = 1.0 / model.link_ab.young_modulus + 1.0 / model.link_bc.young_modulus;
  return 8.0 / (2.6 * 1.7 * soft) * std::sqrt(radius * point.depth);
}

/// Plastic part of the slide between two adjacent points [m].
double plastic_slide(const linkage::Linkage& model, const ElasticJointPoint& a,
                     const ElasticJointPoint& b, TangentialCompliance compliance) {
  const linkage::Linkage middle =
      with_radii_at(model, 0.5 * (a.temperature_change + b.temperature_change));
  const double depth = 0.5 * (a.depth + b.depth);
  const double slide = (middle.radial_clearance() + depth) * (b.contact_angle - a.contact_angle) +
                       (middle.journal_radius - 0.5 * depth) * (b.theta4 - a.theta4) -
                       (middle.bearing_radius + 0.5 * depth) * (b.theta2 - a.theta2);
  if (compliance == rigid) return slide;
  const double k_a = contact_stiffness(model, a);
  const double k_b = contact_stiffness(model, b);
  return slide + (k_b < k_a ? b.tangential_force / k_b - a.tangential_force / k_a
                            : 2.0 * (b.tangential_force - a.tangential_force) / (k_a + k_b));
}

TEST(ElasticLoop, PartialSlipIsItsLawAlongThePath) {
  for (const linkage::Linkage& model :
       {with_partial_slip(biased(0.3)), with_partial_slip(expanding(0.2)),
        with_partial_slip(biased(0.45))}) {
    for (const double phi : {0.0, 0.15}) {
      const ElasticLoop loop = elastic_loop(model, heating(), {200, mindlin}, phi);
      kernel::PartialSlipMemory memory;
      const ElasticJointPoint* before = nullptr;
      for (const ElasticJointPoint& point : loop.points) {
        EXPECT_LT(out_of_balance(model, point), 1e-7);
        const double edge = contact_stiffness(model, point);
        const double slide = before == nullptr ? -1.5 * point.tangential_force / edge
                                               : plastic_slide(model, *before, point, rigid);
        const kernel::PartialSlipResponse answer = kernel::partial_slip_step(
            edge, model.friction_coefficient() * point.normal_force, {slide, 0.0}, memory);
        // Tolerance: the closure residual times the stiffness of all annuli.
        EXPECT_NEAR(answer.force.a, -point.tangential_force, 2.4e-16 * edge);
        before = &point;
      }
      EXPECT_LE(loop.most_iterations, 8);  // one step may cross several kinks of the law
    }
  }
}

TEST(ElasticLoop, IncrementsOfPartialSlipAreOfSecondOrder) {
  // With partial slip the onset of gross slip is not located. Its increment is a chord like any
  // other increment.
  for (const double mu : {0.3, 0.45}) {
    const auto jump = [&](int samples) {
      return elastic_loop(with_partial_slip(biased(mu)), heating(), {samples, mindlin})
          .theta2_jump();
    };
    const double limit = jump(2560);
    for (const int samples : {10, 20}) {
      const double fine = jump(2 * samples) - limit;
      const double ratio = (jump(samples) - limit) / fine;
      const double rounding = 5.0 * 2.3e-16 / std::abs(fine);  // one bit of each angle, of order 1
      EXPECT_NEAR(ratio, 4.0, 4.0 / samples + rounding) << mu << ", " << samples;
      EXPECT_LT(rounding, 2.5);
    }
  }
}

TEST(ElasticLoop, PartialSlipLeavesAJumpThoughNothingSlips) {
  // Rigid bodies roll forth and back without loss, but here annuli at the rim of the contact slip.
  const linkage::Linkage model = with_partial_slip(biased(0.45));
  EXPECT_LT(std::abs(elastic_loop(biased(0.45), heating(), {400, rigid}).theta2_jump()), 1e-15);
  const ElasticLoop loop = elastic_loop(model, heating(), {400, mindlin});
  for (const ElasticJointPoint& point : loop.points) EXPECT_EQ(point.motion, JointMotion::roll);
  EXPECT_GT(std::abs(loop.theta2_jump()), 4e-8);
}

/// `model` with an expansion of BC for which slip at contact angle φ reverses at 50 K if all bodies
/// are rigid. The slip rate is R1 dθ4/dΔT − R2 dθ2/dΔT.
linkage::Linkage turning_at_50_kelvin(linkage::Linkage model, double phi) {
  const linkage::Linkage middle = with_radii_at(model, 50.0);
  const auto turns = [&](double heat) {
    const JointPoint point = joint_point(with_radii_at(model, heat), heat, -1, phi);
    return middle.journal_radius * point.theta4 - middle.bearing_radius * point.theta2;
  };
  double low = -10.0;
  double high = 10.0;
  for (int i = 0; i < 60; ++i) {
    const double expansion = 0.5 * (low + high);
    model.link_bc.thermal_expansion = expansion * alpha;
    const double slope =
        8.0 * (turns(51.0) - turns(49.0)) - (turns(52.0) - turns(48.0));  // fourth-order difference
    (slope > 0.0 ? low : high) = expansion;
  }
  return model;
}

TEST(ElasticLoop, SlipMayEndWithinABranch) {
  const double phi = -std::atan(0.15);
  const auto run = [phi](const linkage::Linkage& model, int samples,
                         TangentialCompliance compliance) {
    const ElasticLoop loop = elastic_loop(model, heating(), {samples, compliance}, phi);
    EXPECT_EQ(loop.events.size(), 4u);  // slip, roll, corner, end
    EXPECT_EQ(loop.events[0].motion, JointMotion::slip);
    EXPECT_EQ(loop.events[1].motion, JointMotion::roll);
    return loop;
  };
  linkage::Linkage grows = biased(0.15);
  grows.bearing_thermal_expansion = -2.0 * alpha;
  grows.journal_thermal_expansion = -2.5 * alpha;
  for (const linkage::Linkage& start : {biased(0.15), grows}) {
    const linkage::Linkage model = turning_at_50_kelvin(start, phi);
    for (const TangentialCompliance compliance : {rigid, mindlin}) {
      const ElasticLoop loop = run(model, 100, compliance);
      const double end = loop.events[1].temperature_change;
      const int last = static_cast<int>(end) - 1;
      ASSERT_EQ(loop.points[last].temperature_change, last);
      // Extrapolates ΔT to zero rate of plastic slide with a parabola through three steps. The
      // changing radii change the slope of the rate by α ΔT R/c, 1e-3 per kelvin; the third-order
      // error is 1e-4 K.
      Eigen::Matrix3d powers;
      Eigen::Vector3d heats;
      for (int i = 0; i < 3; ++i) {
        const int from = last - 1 - 4 * i;
        const double rate =
            plastic_slide(model, loop.points[from], loop.points[from + 1], compliance);
        EXPECT_LT(rate * loop.points[from].tangential_force, 0.0);  // friction resists
        heats[i] = from + 0.5;
        powers.row(i) << 1.0, rate * 1e11, rate * rate * 1e22;
      }
      const double expected = powers.partialPivLu().solve(heats)[0];
      std::printf("slip ends at %.9f K, from the slide %.9f K\n", end, expected);
      EXPECT_NEAR(end, expected, 2e-4);
      // The event is a root of the rate, so its only error is rounding: 1e-18 m/K divided by 1e-12
      // m/K².
      EXPECT_NEAR(run(model, 7, compliance).events[1].temperature_change, end, 1e-5);
    }
    // Deviation: δ/c = 1e-7 while the slope changes by α ΔT = 1e-3 over 50 K, i.e. 5e-3 K if no
    // errors cancel.
    linkage::Linkage stiff = model;
    stiff.link_ab.young_modulus *= 1e6;
    stiff.link_bc.young_modulus *= 1e6;
    EXPECT_NEAR(run(stiff, 100, rigid).events[1].temperature_change, 50.0, 5e-3);
  }
}

TEST(ElasticLoop, SeparatesWhereTheForceVanishes) {
  // Without force nothing is deformed, so the rigid closed form holds. F_N decreases by K_M
  // d(α)/dΔT / height, about 5e-3 N/K. The solver therefore reaches its smallest force, 7e-12 N,
  // 2e-9 K early. The test allows twice that plus 1e-10 K for rounding.
  const double bias = 4e-3;
  const RigidLoop limit = rigid_loop(biased(0.0, bias), heating(1.0, -100.0));
  const ElasticLoop loop = elastic_loop(biased(0.0, bias), heating(1.0, -100.0));
  const double slope = loop.points.front().normal_force / -limit.points.back().temperature_change;
  ASSERT_TRUE(loop.separated);
  ASSERT_TRUE(limit.separated);
  EXPECT_EQ(loop.events.back().motion, JointMotion::separated);
  EXPECT_NEAR(loop.points.back().temperature_change, limit.points.back().temperature_change,
              2.0 * loop.points.back().normal_force / slope + 1e-10);
  EXPECT_LT(loop.points.back().normal_force, 1e-11);
  // Separation during slip: where the force vanishes, no spurious end of slip may appear, for any
  // step size. Newton's method may fail slightly earlier, so a factor of ten is allowed.
  for (const double mu : {0.005, 0.05}) {
    const RigidLoop slips = rigid_loop(biased(mu, bias), heating(1.0, -100.0));
    for (const int samples : {3, 200}) {
      const ElasticLoop slipping =
          elastic_loop(biased(mu, bias), heating(1.0, -100.0), {samples, rigid});
      ASSERT_EQ(slipping.events.size(), 3u);
      EXPECT_NEAR(slipping.points.back().temperature_change, slips.points.back().temperature_change,
                  2e-8);
    }
  }
  // With more friction the joint rolls until it separates. The depth changes the angle by the
  // fraction δ/c = 2.5e-4.
  for (const TangentialCompliance compliance : {rigid, mindlin}) {
    const RigidLoop rolls = rigid_loop(biased(0.6, bias), heating(1.0, -100.0));
    const ElasticLoop rolling =
        elastic_loop(biased(0.6, bias), heating(1.0, -100.0), {2000, compliance});
    ASSERT_TRUE(rolling.separated);
    ASSERT_EQ(rolling.events.size(), 2u);
    EXPECT_NEAR(rolling.points.back().contact_angle, rolls.points.back().contact_angle,
                1e-3 * std::abs(rolls.points.back().contact_angle));
  }
}

TEST(ElasticLoop, SlowDampedDynamicsTendsToIt) {
  // Velocities vanish as 1/T for duration T, so the error is A/T + B/T^2 + ... The test assumes
  // that B/T relative to A is at most A/T relative to the jump, i.e. that the lag is of second
  // order. (This fails if the static path nearly reaches the friction limit, because the dynamics
  // may then slip.)
  for (linkage::Linkage model :
       {biased(0.15), biased(0.3), expanding(0.2), with_partial_slip(biased(0.3))}) {
    model.axial_damping_ratio = 0.1;
    model.pin_damping = 0.1;
    const ElasticLoop loop = elastic_loop(model, heating(), {2000, mindlin});
    const double jump = loop.theta2_jump();
    const double other = elastic_loop(model, heating(), {2000, rigid}).theta2_jump();
    const linkage::State start = loaded_state(model);
    double error[3];
    for (int i = 0; i < 3; ++i) {
      const double duration = 4 << i;
      const linkage::Run run =
          simulate(model, heating(duration), start, {static_cast<int>(duration / 4e-5), 0});
      EXPECT_EQ(run.contacts, 0);  // the contact never opened
      error[i] = theta2_of(run.samples.back().state) - theta2_of(start) - jump;
    }
    std::printf(
        "jump %.9g (rigid compliance %.9g): dynamics off by %.4g %.4g %.4g, ratios %.4f "
        "%.4f, extrapolated %.2g\n",
        jump, other, error[0], error[1], error[2], error[0] / error[1], error[1] / error[2],
        2.0 * error[2] - error[1]);
    EXPECT_NEAR(error[0] / error[1], 2.0, 2.0 * std::abs(error[0] / jump));
    EXPECT_NEAR(error[1] / error[2], 2.0, 2.0 * std::abs(error[1] / jump));
    // Allowed error without the A/T term. After a final roll it is small enough to distinguish the
    // two compliances.
    const double rest = error[1] * error[1] / std::abs(jump);
    EXPECT_LT(std::abs(2.0 * error[2] - error[1]), rest);
    if (loop.events.back().motion == JointMotion::roll) {
      EXPECT_GT(std::abs(other - jump), 5.0 * rest);
    } else {
      EXPECT_NEAR(other, jump, angle_rounding);
    }
  }
}

TEST(ElasticLoop, SlowDampedDynamicsCreepsAsMuchWithPartialSlip) {
  // Without gross slip the motion does not lag behind a friction limit, so the error is A/T^2 +
  // B/T^3 + ... for duration T. Richardson extrapolation leaves the B term, below a quarter of the
  // last error.
  linkage::Linkage model = with_partial_slip(biased(0.4));
  model.axial_damping_ratio = 0.1;
  model.pin_damping = 0.1;
  const double jump = elastic_loop(model, heating(), {2000, mindlin}).theta2_jump();
  const linkage::State start = loaded_state(model);
  double error[2];
  for (int i = 0; i < 2; ++i) {
    const double duration = 8 << i;
    const linkage::Run run =
        simulate(model, heating(duration), start, {static_cast<int>(duration / 4e-5), 0});
    error[i] = theta2_of(run.samples.back().state) - theta2_of(start) - jump;
  }
  EXPECT_LT(std::abs(error[1]), 0.3 * std::abs(jump));
  EXPECT_LT(std::abs(4.0 * error[1] - error[0]) / 3.0, 0.25 * std::abs(error[1]));
}

/// The argument that elastic_loop() rejects.
Argument refused(const linkage::Linkage& model, double contact_angle,
                 const ElasticLoopOptions& options = {}) {
  return refused_argument([&] { elastic_loop(model, heating(), options, contact_angle); });
}

TEST(ElasticLoop, RefusesWhatItCannotAnswer) {
  EXPECT_EQ(refused(umbrella(), 0.0), Argument("torsion_stiffness", 0));
  const double ideal = biased(0.1, 0.0).torsion_free_angle;
  EXPECT_EQ(refused(biased(0.1, 0.0), 0.0), Argument("torsion_free_angle", ideal));
  EXPECT_EQ(refused(biased(0.1), 0.2), Argument("contact_angle", 0.2));
  EXPECT_EQ(refused(biased(0.1), 0.0, {0, rigid}), Argument("samples", 0));
  linkage::Linkage model = biased(0.1);
  model.law.normal = kernel::laws::normal_law("persson");
  EXPECT_EQ(refused(model, 0.0), Argument("normal", "persson"));
  model = biased(0.1);
  model.law.tangential_velocity = kernel::laws::tangential_velocity_law("paper");
  EXPECT_EQ(refused(model, 0.0), Argument("tangential_velocity", "paper"));
  model = biased(0.1);
  model.journal_thermal_expansion = 1e-3;  // 0.5 mm in 100 K
  const Argument closed = refused(model, 0.0);
  EXPECT_EQ(closed.name, "radial clearance");
  EXPECT_LT(closed.value, 0.0);
  // The loop must reject a spring that would crush the links, instead of reporting a wrong number.
  model = biased(0.1);
  model.torsion_stiffness = 1e9;
  try {
    loaded_state(model);
    FAIL() << "accepted";
  } catch (const Failure& failure) {
    const FailureFields& fields = failure.fields();
    EXPECT_EQ(fields.kind, FailureKind::not_converged);
    EXPECT_EQ(fields.temperature_change, 0.0);
    ASSERT_EQ(fields.numbers.size(), 2u);
    EXPECT_EQ(fields.numbers[0].first, "force_residual");
    EXPECT_EQ(fields.numbers[1].first, "closure_residual_m");
    EXPECT_NE(fields.sought, "");
  }
}

}  // namespace
}  // namespace statejump::joint_loop
