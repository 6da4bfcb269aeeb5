// SPDX-License-Identifier: GPL-3.0-or-later
// Right-hand side of the ODE at single states: forces derive from the energy, powers balance it.
#include "linkage/rates.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "umbrella.hpp"

namespace statejump::linkage {
namespace {

using detail::AllTerms;

/// States with open contact and with contact on several sides, with strained and moving links.
std::vector<State> states(const Linkage& model) {
  std::vector<State> found;
  for (const double angle : {0.3, 2.0, 4.5}) {
    for (const double overlap : {-2e-5, 3e-7}) {
      State state = initial_state(model, Start::rest, 0.0);
      const Eigen::Vector2d way(std::cos(angle), std::sin(angle));
      state.bearing_centre += Eigen::Vector2d(3e-6, -2e-6);
      state.journal_centre = state.bearing_centre + (model.radial_clearance() + overlap) * way;
      state.bearing_velocity = {0.2, -0.1};
      state.journal_velocity = {0.13, 0.07};
      found.push_back(state);
    }
  }
  return found;
}

Linkage sprung() {
  Linkage model = umbrella();
  model.torsion_stiffness = 0.3;
  model.torsion_free_angle = 1.5;
  return model;
}

AllTerms::Vector rates_of(const Linkage& model, const State& state,
                          const detail::Temperature& heat) {
  AllTerms::Vector rate{};
  detail::rates<AllTerms>(detail::constants(model), detail::pack<AllTerms>(state), heat, state,
                          rate);
  return rate;
}

TEST(LinkageRates, ForcesAreTheSlopesOfTheEnergy) {
  const Linkage model = sprung();
  const double change = 20.0;
  for (const State& state : states(model)) {
    const AllTerms::Vector rate = rates_of(model, state, {change, 0.0});
    for (int i = 0; i < 4; ++i) {
      const auto moved = [&](double by) {
        State there = state;
        (i < 2 ? there.bearing_centre : there.journal_centre)[i % 2] += by;
        const Energy e = energy(model, there, change);
        return e.axial + e.contact + e.torsion;
      };
      // Central differences of fourth order. Hertz's force is smooth: the edge of contact is 30
      // steps away.
      const double h = 1e-8;
      const double slope =
          (8.0 * (moved(h) - moved(-h)) - (moved(2.0 * h) - moved(-2.0 * h))) / (12.0 * h);
      const double mass = (i < 2 ? model.link_ab.mass : model.link_bc.mass) / 3.0;
      // Rounding of energies of at most 1 J (1e-16 J) divided by the step gives 1e-8 N.
      EXPECT_NEAR(mass * rate[static_cast<std::size_t>(4 + i)], -slope,
                  1e-7 + 1e-5 * std::abs(slope))
          << i;
    }
    EXPECT_EQ(rate[0], state.bearing_velocity.x());
    EXPECT_EQ(rate[3], state.journal_velocity.y());
  }
}

TEST(LinkageRates, PowersCloseTheAccountAtEveryInstant) {
  // Compares the rate of change of the energy, due to motion and heating, with the powers.
  for (const char* friction : {"none", "ambrosio"}) {
    Linkage model = sprung();
    model.law = kernel::laws::joint_law({"hertz_internal", "hunt_crossley", friction, "material"});
    model.law.friction_parameters = {0.3, 1e-3, 1.0};
    model.axial_damping_ratio = 0.2;
    model.pin_damping = 0.05;
    model.journal_thermal_expansion = 0.5 * alpha;
    model.bearing_thermal_expansion = 0.9 * alpha;
    const detail::Temperature heat{20.0, 400.0};
    for (State state : states(model)) {
      state.impact_speed = 0.1;
      const AllTerms::Vector rate = rates_of(model, state, heat);
      const auto later = [&](double time) {
        State there = state;
        there.bearing_centre += time * Eigen::Vector2d(rate[0], rate[1]);
        there.journal_centre += time * Eigen::Vector2d(rate[2], rate[3]);
        there.bearing_velocity += time * Eigen::Vector2d(rate[4], rate[5]);
        there.journal_velocity += time * Eigen::Vector2d(rate[6], rate[7]);
        return energy(model, there, heat.change + time * heat.rate).sum();
      };
      const double h = 1e-8;
      const double power = (later(h) - later(-h)) / (2.0 * h);
      const double lost = rate[detail::axial_heat] + rate[detail::pin_heat] +
                          rate[detail::friction_heat] + rate[detail::impact_heat];
      const double scale = std::abs(rate[detail::thermal_work]) + lost;
      // Allowed: rounding of energies of 1 J (1e-16 J) divided by the step, plus the second-order
      // error.
      EXPECT_NEAR(power, rate[detail::thermal_work] - lost, 1e-7 + 1e-6 * scale) << friction;
      EXPECT_GT(rate[detail::axial_heat], 0.0);
      EXPECT_GT(rate[detail::pin_heat], 0.0);
      const Joint joint = joint_state(model, state, heat.change, heat.rate);
      const bool touches = joint.penetration_depth > 0.0;
      EXPECT_EQ(rate[detail::impact_heat] != 0.0, touches);
      EXPECT_EQ(rate[detail::friction_heat] > 0.0, touches && friction != std::string("none"));
    }
  }
}

}  // namespace
}  // namespace statejump::linkage
