// SPDX-License-Identifier: GPL-3.0-or-later
#include "statejump/linkage/run.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstdio>
#include <stdexcept>

#include "umbrella.hpp"

namespace statejump::linkage {
namespace {

linkage::Run matched(const Linkage& model, const thermal::Program& program, int steps,
                     int sample_every = 0) {
  return simulate(model, program,
                  initial_state(model, Start::matched, program.temperature_rate(0.0)),
                  {steps, sample_every});
}

TEST(Run, MatchedStartMeetsFirstContact) {
  for (const double c : {0.05e-3, 0.10e-3, 0.15e-3, 0.20e-3}) {
    const linkage::Run run = matched(umbrella(c), heating(), 20000);
    ASSERT_TRUE(run.first_contact);
    EXPECT_NEAR(run.first_contact->temperature_change, c / (alpha * frame), 1e-6) << c;
    EXPECT_NEAR(run.first_contact->time, 0.005 * c / (alpha * frame), 1e-8) << c;
  }
  EXPECT_FALSE(matched(umbrella(0.30e-3), heating(), 20000).first_contact);
}

TEST(Run, ExpandingRadiiMoveFirstContact) {
  Linkage model = umbrella();
  model.journal_thermal_expansion = alpha;
  model.bearing_thermal_expansion = 2.0 * alpha;
  const linkage::Run run = matched(model, heating(), 20000);
  ASSERT_TRUE(run.first_contact);
  EXPECT_NEAR(run.first_contact->temperature_change, first_contact_temperature(model), 1e-6);
}

TEST(Run, StartFromRestRingsAsTheClosedFormSays) {
  // x'' = −ω² (x − v t) from rest gives x = v t − v/ω sin ω t along each link. So the distance of
  // the centres along AC differs from its thermal part by a few v/ω at most.
  const Linkage model = umbrella();
  const linkage::Run run = simulate(model, heating(), initial_state(model, Start::rest, 0.0));
  ASSERT_TRUE(run.first_contact);
  const double shift = run.first_contact->temperature_change - first_contact_temperature(model);
  EXPECT_NE(shift, 0.0);
  EXPECT_LT(std::abs(shift), 0.03);
}

double residue(const Linkage& model, double peak, int steps) {
  const linkage::Run run =
      simulate(model, heating(0.02, peak), initial_state(model, Start::rest, 0.0), {steps, 0});
  return std::abs(run.energy_residue);
}

TEST(Run, EnergyResidueOutOfContactIsOfFifthOrder) {
  // One RK4 step of a linear oscillator has a phase error of order (ω h)^5 and an amplitude error
  // of order (ω h)^6. The energy therefore drifts as h^5, one order better than the position.
  const double coarse = residue(umbrella(), 20.0, 1000);
  const double fine = residue(umbrella(), 20.0, 2000);
  const double order = std::log2(coarse / fine);
  std::printf("residue %.3g %.3g J, order %.2f\n", coarse, fine, order);
  EXPECT_GT(order, 4.8);
  EXPECT_LT(fine, 1e-6);
}

TEST(Run, EnergyResidueThroughContact) {
  // A step across the edge of contact has an error of order h^2.5 times a random factor, the edge's
  // position in the step. Over a factor of 4 in h, the observed order must be at least two.
  const double coarse = residue(umbrella(), 60.0, 8000);
  const double fine = residue(umbrella(), 60.0, 32000);
  const double order = 0.5 * std::log2(coarse / fine);
  std::printf("residue %.3g %.3g J, order %.2f\n", coarse, fine, order);
  EXPECT_GT(order, 2.0);
}

TEST(Run, AccountClosesWithEveryTerm) {
  Linkage model = umbrella();
  model.law.friction = kernel::laws::MindlinFriction{};
  model.law.friction_parameters.friction_coefficient = 0.3;
  model.axial_damping_ratio = 0.1;
  model.pin_damping = 0.01;
  model.torsion_stiffness = 1.0;
  model.journal_thermal_expansion = 0.5 * alpha;
  model.bearing_thermal_expansion = 0.6 * alpha;
  double previous = 0.0;
  for (const int steps : {10000, 40000}) {
    const linkage::Run run =
        simulate(model, heating(0.05), initial_state(model, Start::rest, 0.0), {steps, 0});
    const Account& account = run.samples.back().account;
    std::printf("steps %d: work %.4g axial %.3g pin %.3g friction %.3g residue %.3g J\n", steps,
                account.thermal_work, account.axial_dissipation, account.pin_dissipation,
                account.friction_dissipation, run.energy_residue);
    EXPECT_GT(account.axial_dissipation, 0.0);
    EXPECT_GT(account.pin_dissipation, 0.0);
    EXPECT_GT(account.friction_dissipation, 0.0);
    EXPECT_GT(run.contacts, 0);
    // At least first order: with four times the steps, at most half of the energy residue remains.
    if (previous > 0.0) {
      EXPECT_LT(std::abs(run.energy_residue), 0.5 * previous);
    }
    previous = std::abs(run.energy_residue);
  }
}

TEST(Run, FewestStepsAreThoseOfTheMethodsStability) {
  // Link AB is the stiffer one. With a third of its mass, x'' + 2 ζ ω x' + ω² x = 0. One RK4 step
  // multiplies its modes by 1 + z + z²/2 + z³/6 + z⁴/24, z = λ h. With the fewest accepted steps no
  // mode may grow. With slightly longer steps, a mode must grow.
  const double omega = std::sqrt(70e9 * 9e-6 / 0.05 / (0.5 / 3));
  const auto growth = [&](double zeta, double h) {
    const std::complex<double> root = std::sqrt(std::complex<double>(zeta * zeta - 1.0, 0.0));
    double largest = 0.0;
    for (const double sign : {-1.0, 1.0}) {
      const std::complex<double> z = h * omega * (-zeta + sign * root);
      largest = std::max(largest,
                         std::abs(1.0 + z * (1.0 + z / 2.0 * (1.0 + z / 3.0 * (1.0 + z / 4.0)))));
    }
    return largest;
  };
  for (const double zeta : {0.0, 0.3, 1.0, 1.2, 3.0}) {
    Linkage model = umbrella(0.3e-3);
    model.axial_damping_ratio = zeta;
    const thermal::Program program = heating(0.01, 1.0);
    const State rest = initial_state(model, Start::rest, 0.0);
    const auto is_taken = [&](int steps) {
      try {
        simulate(model, program, rest, {steps, 0});
      } catch (const std::invalid_argument&) {
        return false;
      }
      return true;
    };
    int few = 1, many = 10000;
    ASSERT_TRUE(is_taken(many));
    while (many - few > 1) (is_taken((few + many) / 2) ? many : few) = (few + many) / 2;
    EXPECT_LE(growth(zeta, 0.01 / many), 1.0) << zeta;
    // At ζ = 0.3, far from both axes of the stability region, the bound on the step is more
    // conservative.
    EXPECT_GT(growth(zeta, 0.01 / (0.85 * few)), 1.0) << zeta;
  }
}

TEST(Run, RepeatsBitForBitAndStopsWhenUnstable) {
  const linkage::Run first = matched(umbrella(), heating(), 20000, 100);
  const linkage::Run second = matched(umbrella(), heating(), 20000, 100);
  ASSERT_EQ(first.samples.size(), 201u);
  EXPECT_EQ(first.samples.back().state.journal_centre, second.samples.back().state.journal_centre);
  // For AB, ω = 8695 rad/s, so steps above 2.78/ω = 0.32 ms are rejected.
  const State rest = initial_state(umbrella(), Start::rest, 0.0);
  EXPECT_THROW(simulate(umbrella(), heating(), rest, {3120, 0}), std::invalid_argument);
  EXPECT_NO_THROW(simulate(umbrella(0.3e-3), heating(), rest, {3135, 0}));
  EXPECT_THROW(matched(umbrella(), heating(), 0), std::invalid_argument);
}

}  // namespace
}  // namespace statejump::linkage
