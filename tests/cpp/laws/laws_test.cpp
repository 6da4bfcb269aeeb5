// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <boost/math/quadrature/gauss_kronrod.hpp>
#include <boost/math/tools/toms748_solve.hpp>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include "../support/argument.hpp"
#include "statejump/kernel/laws/joint_law.hpp"
#include "statejump/kernel/laws/registry.hpp"

namespace statejump::kernel::laws {
namespace {

using statejump::testing::Argument;
using statejump::testing::refused_argument;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double infinity = std::numeric_limits<double>::infinity();

// Paper, Table 2: R1 = 5 mm, c = 0.1 mm, E = 70 GPa, nu = 0.3; L = 10 mm for the line contacts.
const NormalGeometry joint{5e-3, 5.1e-3, 0.01};
const NormalMaterial aluminium{70e9 / (2.0 * 0.91)};

// R2 - R1 of rounded radii has an error of 4e-15 c, which the laws amplify at most threefold.
constexpr double rounding = 3e-14;

NormalState at(const std::string& name, double depth) {
  return evaluate(normal_law(name), depth, joint, aluminium);
}

void expect_relative(double value, double expected, double tolerance, const char* what) {
  EXPECT_NEAR(value, expected, tolerance * std::abs(expected)) << what;
}

// Expected K by 40-digit arithmetic. At delta = 1 um, F = K 1e-9.
TEST(NormalLaws, HertzAtTable2) {
  expect_relative(at("hertz_paper", 1e-6).force, 2.576765e9 * 1e-9, 2e-7, "external K");
  expect_relative(at("hertz_internal", 1e-6).force, 25.896166508620712701, rounding, "internal K");
  expect_relative(at("hertz_internal", 1e-6).contact_width, std::sqrt(0.255 * 1e-6), rounding, "a");
}

// Expected force: root (25 digits) of the printed relation delta(f) by bisection in ln f. Expected
// stiffness: derivative of that relation. Expected energy: F delta minus the integral of delta dF
// by quadrature.
TEST(NormalLaws, LineContactsAgainstHighPrecision) {
  const NormalState johnson = at("johnson", 1e-5);
  expect_relative(johnson.force, 2947.2120306520961, rounding, "F");
  expect_relative(johnson.stiffness, 389797977.078890389, rounding, "k");
  expect_relative(johnson.elastic_energy, 0.0129389022106475615, rounding, "U");
  const NormalState deep = at("johnson", 5e-5);
  expect_relative(deep.force, 41573.0584663178223, rounding, "F");
  // At this depth u - 1 = 0.26, so the rounding error of dR is amplified 15-fold
  expect_relative(deep.stiffness, 2665982167.80889568, 15 * rounding, "k");
  const NormalState esdu = at("esdu_78035", 1e-5);
  expect_relative(esdu.force, 1838.66469143979695, rounding, "F");
  expect_relative(esdu.stiffness, 216866870.684932528, rounding, "k");
  expect_relative(esdu.elastic_energy, 0.00849385432061475483, rounding, "U");
}

// Independent values. The depth follows from the gap at phi = 0: Persson's pressure, integrated to
// 25 digits with the logarithmic Green's function. The stiffness is a central difference (1e-11),
// the energy a quadrature of delta dF. epsilon is the half angle of the contact arc.
TEST(NormalLaws, PerssonAgainstPressureIntegral) {
  const NormalState light = at("persson", 1e-6);
  expect_relative(light.force, 174.320828198019069, rounding, "F");
  expect_relative(light.stiffness, 203574203.527, 1e-11, "k");
  expect_relative(light.contact_width, 5e-3 * 0.07584710941753771, rounding, "a");
  const NormalState middle = at("persson", 1e-5);
  expect_relative(middle.force, 2888.11191338636448, rounding, "F");
  expect_relative(middle.stiffness, 372317808.425, 1e-11, "k");
  const NormalState deep = at("persson", 1e-4);
  expect_relative(deep.force, 62509.3440127231171, rounding, "F");
  expect_relative(deep.stiffness, 791976264.042, 1e-11, "k");
  expect_relative(deep.contact_width, 5e-3 * 1.01068068732851, rounding, "a");
  expect_relative(deep.elastic_energy, 2.6982981204902, rounding, "U");
}

// Persson's depth is defined to equal Johnson's at light load, so the ratio of forces tends to 1 as
// delta/dR -> 0.
TEST(NormalLaws, PerssonTendsToJohnson) {
  for (const double depth : {1e-14, 1e-11, 1e-9, 1e-8}) {
    const double ratio = at("persson", depth).force / at("johnson", depth).force;
    EXPECT_NEAR(ratio, 1.0, depth / joint.clearance() + rounding) << depth;
  }
}

// Over the range of each law: F and a are positive and increase; stiffness and energy agree with
// differences and quadrature of F.
class EveryNormalLaw : public ::testing::TestWithParam<const char*> {};

TEST_P(EveryNormalLaw, IsMonotoneAndConsistent) {
  const NormalLaw law = normal_law(GetParam());
  const double top = std::min(largest_depth(law, joint), 20 * joint.clearance());
  const auto force = [&](double x) { return evaluate(law, x, joint, aluminium).force; };
  NormalState before{0.0, 0.0, 0.0, 0.0};
  for (const double part : {1e-9, 1e-6, 1e-4, 1e-3, 1e-2, 0.1, 0.3, 0.6, 0.8, 0.9}) {
    const double depth = part * top;
    const NormalState state = evaluate(law, depth, joint, aluminium);
    EXPECT_GT(state.force, before.force);
    EXPECT_GT(state.contact_width, before.contact_width);
    EXPECT_GT(state.elastic_energy, before.elastic_energy);
    EXPECT_GT(state.stiffness, before.stiffness);
    // error of the central difference: h^2 F'''/(6 F') <= h^2 (a few)/(1 - part)^2, plus rounding
    // 1e-14/h
    const double h = 1e-5;
    const double slope = (force(depth * (1 + h)) - force(depth * (1 - h))) / (2 * h * depth);
    expect_relative(slope, state.stiffness, 2e-8, "dF/d(delta)");
    // substituting x = depth s^2 removes Hertz's square root; the remaining logarithm needs 61
    // points
    const double energy = boost::math::quadrature::gauss_kronrod<double, 61>::integrate(
        [&](double s) { return 2.0 * s * depth * force(depth * s * s); }, 0.0, 1.0, 8, 1e-12);
    expect_relative(energy, state.elastic_energy, 1e-10, "energy");
    before = state;
  }
}

TEST_P(EveryNormalLaw, GapGivesZeroAndNanIsRefused) {
  const NormalLaw law = normal_law(GetParam());
  for (const double depth : {0.0, -0.0, -1e-6, -infinity}) {
    const NormalState state = evaluate(law, depth, joint, aluminium);
    EXPECT_EQ(state.force, 0.0);
    EXPECT_EQ(state.stiffness, 0.0);
    EXPECT_EQ(state.contact_width, 0.0);
    EXPECT_EQ(state.elastic_energy, 0.0);
  }
  EXPECT_THROW(evaluate(law, nan, joint, aluminium), std::domain_error);
  EXPECT_THROW(evaluate(law, infinity, joint, aluminium), std::domain_error);
  const NormalState least =
      evaluate(law, std::numeric_limits<double>::denorm_min(), joint, aluminium);
  EXPECT_TRUE(std::isfinite(least.force) && least.force >= 0.0);
}

TEST_P(EveryNormalLaw, EdgeOfRange) {
  const NormalLaw law = normal_law(GetParam());
  const double limit = largest_depth(law, joint);
  if (std::isinf(limit)) return;
  const NormalState inside = evaluate(law, limit * (1 - 1e-12), joint, aluminium);
  EXPECT_TRUE(std::isfinite(inside.force) && inside.force > 0.0);
  EXPECT_GT(inside.stiffness, 0.0);
  try {
    evaluate(law, limit * (1 + 1e-12), joint, aluminium);
    FAIL() << "accepted";
  } catch (const DepthOutOfRange& refused) {
    EXPECT_EQ(refused.law(), GetParam());
    EXPECT_EQ(refused.depth(), limit * (1 + 1e-12));
    EXPECT_DOUBLE_EQ(refused.limit(), limit);
  }
}

INSTANTIATE_TEST_SUITE_P(Catalogue, EveryNormalLaw,
                         ::testing::Values("hertz_paper", "hertz_internal", "johnson", "esdu_78035",
                                           "persson"),
                         [](const auto& law) { return std::string(law.param); });

// At u = 1, force over depth has a turning point, at f = 4 pi E* dR/e^2 (Johnson) and 4 pi E* dR
// (ESDU). Near it 1 - f/f_max = sqrt(2 (1 - delta/delta_max)), i.e. 1.4e-6 in force for 1e-12 in
// depth.
TEST(NormalLaws, TurningPoints) {
  const double load =
      4.0 * std::acos(-1.0) * aluminium.effective_young_modulus * joint.clearance() * joint.length;
  const double inside = 1 - 1e-12;
  expect_relative(at("johnson", 4 * std::exp(-2.0) * joint.clearance() * inside).force,
                  load * std::exp(-2.0), 1e-5, "johnson");
  expect_relative(at("esdu_78035", 4 * joint.clearance() * inside).force, load, 1e-5, "esdu");
}

TEST(NormalLaws, BadInputIsNamed) {
  EXPECT_NO_THROW(validate(joint, aluminium));
  EXPECT_THROW(validate({0.0, 1.0, 1.0}, aluminium), std::invalid_argument);
  EXPECT_THROW(validate({1.0, 1.0, 1.0}, aluminium), std::invalid_argument);
  EXPECT_THROW(validate({1.0, 2.0, 0.0}, aluminium), std::invalid_argument);
  EXPECT_THROW(validate(joint, {nan}), std::invalid_argument);
}

// Restitution of an impact m delta'' = -F, by RK4 until the force vanishes. Compare with the
// integral in damped_force().
double impact_restitution(const NormalLaw& law, double ratio, double v0) {
  const double mass = 1.0;
  const auto acceleration = [&](double x, double v) {
    return -damped_force(evaluate(law, x, joint, aluminium).force, ratio, v) / mass;
  };
  double x = 0.0;
  double v = v0;
  const double dt = 2e-8 / v0;  // depths of at least 10 um: at least some 500 steps
  for (int i = 0; i < 10000000; ++i) {
    const double a1 = acceleration(x, v);
    const double v2 = v + 0.5 * dt * a1;
    const double a2 = acceleration(x + 0.5 * dt * v, v2);
    const double v3 = v + 0.5 * dt * a2;
    const double a3 = acceleration(x + 0.5 * dt * v2, v3);
    const double v4 = v + dt * a3;
    const double a4 = acceleration(x + dt * v3, v4);
    x += dt / 6 * (v + 2 * v2 + 2 * v3 + v4);
    v += dt / 6 * (a1 + 2 * a2 + 2 * a3 + a4);
    if (x <= 0.0) return -v / v0;
  }
  return nan;
}

double expected_restitution(double a) {
  if (a == 0.0) return 1.0;
  const double lost = a - std::log1p(a);
  const auto f = [&](double e) { return -a * e - std::log1p(-a * e) - lost; };
  std::uintmax_t n = 100;
  const auto root = boost::math::tools::toms748_solve(
      f, 1e-9, std::min(1.0, (1 - 1e-12) / a), boost::math::tools::eps_tolerance<double>(48), n);
  return root.first;
}

TEST(Dissipation, ImpactReturnsTheRestitutionOfItsEnergyIntegral) {
  for (const char* normal : {"hertz_internal", "persson"}) {
    for (const std::string& name : law_names<DissipationLaw>()) {
      for (const double e : {0.3, 0.9}) {
        const double v0 = 0.2;
        const double ratio = damping_ratio(dissipation_law(name), {e, v0});
        // F starts like delta^1.5 or delta/ln delta, so RK4 loses its order at first contact; an
        // error of 1e-5 remains
        EXPECT_NEAR(impact_restitution(normal_law(normal), ratio, v0),
                    expected_restitution(ratio * v0), 1e-5)
            << normal << ", " << name << ", e = " << e;
      }
    }
  }
}

TEST(Dissipation, SmallLossLimit) {
  const double lost = 1e-5;  // second-order term: 1e-5 relative, times a small factor
  const auto slope = [&](const char* name) {
    return (1 - expected_restitution(damping_ratio(dissipation_law(name), {1 - lost, 1.0}))) / lost;
  };
  EXPECT_NEAR(slope("lankarani_nikravesh"), 1.0, 1e-4);
  EXPECT_NEAR(slope("hunt_crossley"), 1.0, 1e-4);
  EXPECT_NEAR(slope("flores"), 16.0 / 15.0, 1e-4);
  EXPECT_EQ(damping_ratio(dissipation_law("none"), {0.5, 1.0}), 0.0);
}

TEST(Dissipation, PointValuesClipAndBadInput) {
  const ImpactParameters impact{0.8, 0.5};
  EXPECT_NEAR(damping_ratio(dissipation_law("lankarani_nikravesh"), impact), 0.54, 1e-15);
  EXPECT_NEAR(damping_ratio(dissipation_law("hunt_crossley"), impact), 0.6, 1e-15);
  EXPECT_NEAR(damping_ratio(dissipation_law("flores"), impact), 0.8, 1e-15);
  EXPECT_EQ(damped_force(10.0, 0.6, 1.0), 16.0);
  EXPECT_EQ(damped_force(10.0, 0.6, -100.0), 0.0);
  for (const double e : {-0.1, 1.1, nan}) {
    EXPECT_THROW(validate(ImpactParameters{e, 1.0}), std::invalid_argument) << e;
  }
  for (const double v : {0.0, -1.0, infinity, nan}) {
    EXPECT_THROW(validate(ImpactParameters{0.5, v}), std::invalid_argument) << v;
  }
  EXPECT_NO_THROW(validate(ImpactParameters{1.0, 1.0}));
}

/// A prepared law returns the same damping as an unprepared one, for the prepared and for other
/// coefficients of restitution. Some laws have nothing to prepare.
TEST(Dissipation, WhatIsPreparedAnswersTheSame) {
  for (const std::string& name : law_names<DissipationLaw>()) {
    DissipationLaw prepared = dissipation_law(name);
    prepare(prepared, 0.6);
    for (const double e : {0.6, 0.3, 1.0}) {
      EXPECT_EQ(damping_ratio(prepared, {e, 0.5}), damping_ratio(dissipation_law(name), {e, 0.5}))
          << name << ", " << e;
    }
  }
  ExactRestitution none;
  none.prepare(0.0);
  EXPECT_EQ(none({0.0, 1.0}), ExactRestitution{}({0.0, 1.0}));
}

/// Free impact: v dv/(1 + lambda v) = -(F/m) d(delta), integrated from touch to separation. With
/// the elastic energy w = V(delta)/(m v0^2) and v0 = 1, dw = -v dv/(1 + a v). Approach and rebound
/// cover the same range of w.
TEST(Dissipation, ExactRestitutionReturnsWhatIsAsked) {
  for (const double e : {1.0, 0.999, 0.9, 0.8, 0.6, 0.4, 0.2, 0.1}) {
    const double a = damping_ratio(dissipation_law("exact_restitution"), {e, 1.0});
    // Simpson's rule with many steps, for e >= 0.1: smaller e bring the limit too close to the pole
    // a e = 1
    const auto depth = [a](double from, double to) {  // w(v): integral of v/(1 + a v) dv
      const int n = 200000;
      const double h = (to - from) / n;
      double sum = 0.0;
      for (int i = 0; i <= n; ++i) {
        const double v = from + i * h;
        sum += (i == 0 || i == n ? 1.0 : i % 2 ? 4.0 : 2.0) * v / (1.0 + a * v);
      }
      return sum * h / 3.0;
    };
    EXPECT_NEAR(depth(0.0, 1.0), -depth(-e, 0.0), 1e-9) << e;
  }
  EXPECT_EQ(damping_ratio(dissipation_law("exact_restitution"), {1.0, 1.0}), 0.0);
  // the law replaces e = 0 by 1e-6, a very strong damper for which a e -> 1 from below
  EXPECT_NEAR(damping_ratio(dissipation_law("exact_restitution"), {0.0, 1.0}), 1e6, 1.0);
  EXPECT_NEAR(damping_ratio(dissipation_law("exact_restitution"), {0.7, 0.5}),
              2.0 * ExactRestitution::coefficient(0.7), 1e-14);
  JointLaw law;
  law.restitution = 0.0;
  EXPECT_THROW(validate(law), std::invalid_argument);
  law.dissipation = dissipation_law("exact_restitution");
  EXPECT_NO_THROW(validate(law));
}

TEST(Friction, AmbrosioRampAndCreep) {
  const FrictionLaw law = friction_law("ambrosio");
  const FrictionParameters parameters{0.3, 1e-3, 3e-3};
  ContactHistory history;
  const auto force = [&](double v) {
    return evaluate(law, parameters,
                    {100.0, 1e6, Vector3(0.6 * v, -0.8 * v, 0.0), 1e-4, Vector3::UnitZ()}, history);
  };
  for (const double v : {0.0, 5e-4, 1e-3}) EXPECT_EQ(force(v).force_on_1.norm(), 0.0) << v;
  const FrictionResponse half = force(2e-3);
  EXPECT_NEAR(half.force_on_1.x(), -9.0, 1e-12);
  EXPECT_NEAR(half.force_on_1.y(), 12.0, 1e-12);
  EXPECT_NEAR(half.dissipation, 15.0 * 2e-3 * 1e-4, 1e-18);
  for (const double v : {3e-3, 1.0}) EXPECT_NEAR(force(v).force_on_1.norm(), 30.0, 1e-12) << v;
  EXPECT_FALSE(has(law, Trait::holds_static_load));
}

// A mass under half of the Coulomb limit. Laws with memory hold it, `ambrosio` lets it creep at v0
// + (v1 - v0)/2, and `none` lets it accelerate.
TEST(Friction, StaticLoad) {
  const FrictionParameters parameters{0.3, 1e-4, 1e-3};
  for (const std::string& name : law_names<FrictionLaw>()) {
    const FrictionLaw law = friction_law(name);
    ContactHistory history;
    double v = 0.0;
    double x = 0.0;
    const double dt = 1e-5;
    for (int i = 0; i < 100000; ++i) {
      const FrictionResponse response =
          evaluate(law, parameters, {100.0, 1e5, Vector3(v, 0, 0), dt, Vector3::UnitZ()}, history);
      // dashpot with critical damping of the oscillation of the sticking mass
      const double damping = has(law, Trait::has_memory) ? 2 * std::sqrt(1e5) : 0.0;
      v += dt * (15.0 + response.force_on_1.x() - damping * v);
      x += dt * v;
    }
    if (name == "mindlin") {
      EXPECT_NEAR(x, 15.0 / 1e5, 1e-10);
      EXPECT_NEAR(v, 0.0, 1e-10);
    } else if (name == "mindlin_deresiewicz") {  // 3 mu F_N/(2 k_t) (1 - (1/2)^(2/3))
      EXPECT_NEAR(x, 4.5e-4 * (1.0 - std::pow(0.5, 2.0 / 3.0)), 1e-10);
      EXPECT_NEAR(v, 0.0, 1e-10);
    } else if (name == "ambrosio") {
      EXPECT_NEAR(v, 5.5e-4, 1e-9);
    } else {
      EXPECT_NEAR(v, 15.0, 1e-9);
    }
  }
}

// A contact that opened keeps neither spring nor axis; it behaves like a contact that never
// touched.
TEST(Friction, OpenContactForgets) {
  const FrictionParameters parameters{0.3, 0.0, 1e-3};
  for (const char* name : {"mindlin", "mindlin_deresiewicz"}) {
    ContactHistory history;
    const FrictionKinematics touching{100.0, 1e6, Vector3(0.01, -0.02, 0.0), 1e-3,
                                      Vector3::UnitZ()};
    evaluate(friction_law(name), parameters, touching, history);
    EXPECT_GT(history.tangential_force.norm(), 0.0) << name;
    evaluate(friction_law(name), parameters,
             {0.0, 0.0, Vector3(0.01, 0.0, 0.0), 1e-3, Vector3::UnitZ()}, history);
    EXPECT_EQ(history.tangential_force, Vector3(Vector3::Zero())) << name;
    EXPECT_EQ(history.tangential_axis, Vector3(Vector3::Zero())) << name;
    EXPECT_EQ(history.memory.size(), 0) << name;
  }
}

// An initial force at a constant ratio to the load causes no slip of annuli, so the law keeps the
// given force.
TEST(Friction, PartialSlipBeginsWithoutSlipWhereLoadedObliquely) {
  const FrictionParameters parameters{0.3, 0.0, 1e-3};
  const double stiffness = 1e6;
  const double limit = 30.0;
  const Vector3 force(6.0, -8.0, 0.0);
  const FrictionKinematics held{100.0, stiffness, Vector3(7.0, 7.0, 0.0), 0.5, Vector3::UnitZ()};
  ContactHistory history = MindlinDeresiewiczFriction{}.preloaded(parameters, force, held);
  EXPECT_LT((history.tangential_force - force).norm(), 1e-12 * limit);
  EXPECT_FALSE(history.slipping);
  FrictionKinematics still = held;
  still.tangential_velocity = Vector3::Zero();
  const FrictionResponse at_rest =
      evaluate(friction_law("mindlin_deresiewicz"), parameters, still, history);
  EXPECT_LT((at_rest.force_on_1 - force).norm(), 1e-12 * limit);
}

TEST(Friction, BadInput) {
  EXPECT_NO_THROW(validate(FrictionParameters{0.3, 0.0, 1e-3}));
  EXPECT_THROW(validate(FrictionParameters{-0.1, 0.0, 1e-3}), std::invalid_argument);
  EXPECT_THROW(validate(FrictionParameters{0.3, -1e-9, 1e-3}), std::invalid_argument);
  EXPECT_THROW(validate(FrictionParameters{0.3, 1e-3, 1e-3}), std::invalid_argument);
  EXPECT_THROW(validate(FrictionParameters{0.3, 0.0, nan}), std::invalid_argument);
  EXPECT_THROW(validate(FrictionParameters{0.3, 0.0, infinity}), std::invalid_argument);
}

class JointMotion : public ::testing::Test {
 protected:
  const Vector3 axis = Vector3::UnitZ();
  BodyMotion journal{{0.9e-4, 0.7e-4, 0.0}, {0.3, -0.2, 0.0}, {0, 0, 4.0}};
  BodyMotion bearing{{0, 0, 0}, {-0.1, 0.5, 0.0}, {0, 0, -7.0}};
  JointContact contact() const {
    return revolute_contact(journal, joint.journal_radius, bearing, joint.bearing_radius, axis);
  }
};

// Compares the velocity of eq. (15) with a numerical derivative of the points of eq. (14).
TEST_F(JointMotion, PaperVelocityIsTheDerivativeOfThePoints) {
  const auto points = [&](double time) {
    const Vector3 c = journal.position + time * journal.velocity;
    const Vector3 d = bearing.position + time * bearing.velocity;
    const Vector3 n = (c - d).normalized();
    return Vector3(c + joint.journal_radius * n - d - joint.bearing_radius * n);
  };
  const double h = 1e-9;  // relative to |d|/|d'| = 1e-4 s: h^2 1e8 = 1e-10; rounding 1e-18/h = 1e-9
  const Vector3 difference = (points(h) - points(-h)) / (2 * h);
  const Vector3 v = PaperVelocity{}.velocity(contact(), journal, bearing, axis);
  EXPECT_LT((v - difference).norm(), 1e-8);
}

// Concentric bodies without clearance touch all around. The normal is arbitrary and no sliding
// direction exists. The law must not divide by the eccentricity.
TEST_F(JointMotion, PaperVelocityOfConcentricPartsHasNoTangentialPart) {
  JointContact c = contact();
  c.eccentricity = 0.0;
  for (const double depth : {-1e-4, 0.0, 1e-6}) {
    c.penetration_depth = depth;
    const Vector3 relative = journal.velocity - bearing.velocity;
    EXPECT_LT(
        (PaperVelocity{}.velocity(c, journal, bearing, axis) - relative.dot(c.normal) * c.normal)
            .norm(),
        1e-15);
    const Vector3 force(120.0, -45.0, 0.0);
    const Wrench wrench = PaperVelocity{}.wrench(c, force, axis);
    EXPECT_LT((wrench.force_1 - force.dot(c.normal) * c.normal).norm(), 1e-13);
    EXPECT_EQ(wrench.force_2, -wrench.force_1);
  }
}

// The contact force at the relative velocity has the same power as the wrench on the bodies.
TEST_F(JointMotion, WrenchIsTheTransposeOfTheVelocity) {
  const Vector3 force(120.0, -45.0, 0.0);
  const auto check = [&](const auto& law, const char* name) {
    const Vector3 v = law.velocity(contact(), journal, bearing, axis);
    const Wrench w = law.wrench(contact(), force, axis);
    const double power = w.force_1.dot(journal.velocity) +
                         w.torque_1.dot(journal.angular_velocity) +
                         w.force_2.dot(bearing.velocity) + w.torque_2.dot(bearing.angular_velocity);
    EXPECT_NEAR(power, force.dot(v), 1e-13 * 120.0) << name;
  };
  check(MaterialVelocity{}, "material");
  check(PaperVelocity{}, "paper");
}

// The paper's two forces leave the moment delta n x F_t unbalanced. The forces of `material`
// balance.
TEST_F(JointMotion, MomentBalance) {
  const JointContact c = contact();
  const Vector3 force(120.0, -45.0, 0.0);
  const auto moment = [&](const Wrench& w) {
    return Vector3(w.torque_1 + w.torque_2 + cross(journal.position, w.force_1) +
                   cross(bearing.position, w.force_2));
  };
  EXPECT_LT(moment(MaterialVelocity{}.wrench(c, force, axis)).norm(), 1e-14);
  const Vector3 left = c.penetration_depth * cross(c.normal, force);
  EXPECT_GT(left.norm(), 1e-4);
  EXPECT_LT((moment(PaperVelocity{}.wrench(c, force, axis)) - left).norm(), 1e-16);
}

TEST(Registry, NamesInfosAndUnknownName) {
  EXPECT_EQ(law_names<NormalLaw>().size(), 5U);
  for (const std::string& name : law_names<NormalLaw>()) {
    EXPECT_EQ(law_info(normal_law(name)).name, name);
  }
  for (const std::string& name : law_names<DissipationLaw>()) {
    EXPECT_EQ(law_info(dissipation_law(name)).name, name);
  }
  for (const std::string& name : law_names<FrictionLaw>()) {
    EXPECT_EQ(law_info(friction_law(name)).name, name);
  }
  for (const std::string& name : law_names<TangentialVelocityLaw>()) {
    EXPECT_EQ(law_info(tangential_velocity_law(name)).name, name);
  }
  const Argument refused = refused_argument([] { normal_law("jonson"); });
  EXPECT_EQ(refused, Argument("normal_law", "jonson"));
  EXPECT_EQ(refused.range, "one of hertz_paper, hertz_internal, johnson, esdu_78035, persson");
}

}  // namespace
}  // namespace statejump::kernel::laws
