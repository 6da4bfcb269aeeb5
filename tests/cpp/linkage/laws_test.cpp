// SPDX-License-Identifier: GPL-3.0-or-later
// Every law of the catalogue in the dynamics of the rib; adaptive steps compared with fixed ones.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <stdexcept>
#include <string>

#include "statejump/failure.hpp"
#include "statejump/linkage/run.hpp"
#include "umbrella.hpp"

namespace statejump::linkage {
namespace {

Linkage with_laws(const kernel::laws::JointLawNames& names, double restitution = 0.8) {
  Linkage model = umbrella();
  model.law = kernel::laws::joint_law(names);
  model.law.restitution = restitution;
  model.law.friction_parameters = {0.3, 1e-5, 1e-4};
  model.axial_damping_ratio = 0.1;
  return model;
}

linkage::Run run(const Linkage& model, int steps, double duration = 0.05) {
  return simulate(model, heating(duration), initial_state(model, Start::rest, 0.0), {steps, 0});
}

TEST(LinkageLaws, AccountClosesForEveryCombination) {
  using namespace kernel::laws;
  for (const std::string& normal : law_names<NormalLaw>()) {
    for (const std::string& dissipation : law_names<DissipationLaw>()) {
      for (const std::string& friction : law_names<FrictionLaw>()) {
        for (const std::string& velocity : law_names<TangentialVelocityLaw>()) {
          const Linkage model = with_laws({normal, dissipation, friction, velocity});
          const std::string which = normal + " " + dissipation + " " + friction + " " + velocity;
          if (!incompatibility(model.law).empty()) {  // incompatible laws are rejected
            EXPECT_THROW(run(model, 40000), std::invalid_argument) << which;
            continue;
          }
          const linkage::Run fine = run(model, 40000);
          ASSERT_GT(fine.contacts, 0) << which;
          // Impact speed and slip limit are located to one step, so the energy balance is of second
          // order in ω h = 0.0125. ω = 1e4 rad/s is the contact frequency of journal and links.
          const double scale = fine.samples.back().account.dissipation();
          EXPECT_LT(std::abs(fine.energy_residue), 1.6e-4 * scale) << which;
          EXPECT_EQ(fine.samples.back().account.impact_dissipation > 0.0, dissipation != "none")
              << which;
          EXPECT_EQ(fine.samples.back().account.friction_dissipation > 0.0, friction != "none")
              << which;
        }
      }
    }
  }
}

TEST(LinkageLaws, PaperVelocityDoesNotSeeTheSpins) {
  // The centres have no relative motion, but journal and bearing rotate against each other. Only
  // `material` then has friction.
  Linkage model = with_laws({"hertz_internal", "none", "ambrosio", "paper"});
  State state = initial_state(model, Start::rest, 0.0, {1e-4, 0.0});
  const Eigen::Vector2d ab = state.bearing_centre;
  state.journal_centre.x() += 1e-8;
  state.bearing_velocity = {-ab.y(), ab.x()};  // 1 rad/s about A, the same for both tips
  state.journal_velocity = state.bearing_velocity;
  EXPECT_DOUBLE_EQ(joint_state(model, state, 0.0, 0.0).tangential_force, 0.0);
  model.law.tangential_velocity = kernel::laws::MaterialVelocity{};
  const Joint joint = joint_state(model, state, 0.0, 0.0);
  EXPECT_GT(joint.normal_force, 0.0);
  EXPECT_DOUBLE_EQ(std::abs(joint.tangential_force), 0.3 * joint.normal_force);
}

TEST(LinkageLaws, StateSaysWhatTheJointDoes) {
  const Linkage model = with_laws({"hertz_internal", "hunt_crossley", "mindlin", "material"});
  State state = initial_state(model, Start::rest, 0.0, {1e-4, 0.0});
  state.journal_centre.x() += 1e-8;
  state.contact.tangential_force = {0.5, 0.0, 0.0};
  for (const bool slipping : {false, true}) {
    state.contact.slipping = slipping;
    const Joint joint = joint_state(model, state, 0.0, 0.0);
    EXPECT_EQ(joint.slipping, slipping);
    EXPECT_EQ(joint.tangential_force, 0.5);
    EXPECT_NEAR(joint.penetration_depth, 1e-8, 1e-15);
  }
  // A run sets the impact speed at first contact and at no other time.
  const linkage::Run done =
      simulate(model, heating(0.05), initial_state(model, Start::rest, 0.0), {20000, 1});
  int touching = 0;
  for (const Sample& s : done.samples) {
    const Joint joint = joint_state(model, s.state, s.temperature_change, 0.0);
    touching += joint.penetration_depth > 0.0;
    ASSERT_EQ(s.state.impact_speed > 0.0, joint.penetration_depth > 0.0) << s.time;
  }
  EXPECT_GT(touching, 10);
}

TEST(LinkageLaws, FrictionSeesTheMaterialAtTheContactPoint) {
  // Each link rotates about its pin. The friction of `ambrosio` grows from 0 at 1e-5 m/s to
  // Coulomb's at 1e-4 m/s, so its value reveals the sliding velocity.
  const Linkage model = with_laws({"hertz_internal", "none", "ambrosio", "material"});
  State state = initial_state(model, Start::rest, 0.0, {1e-4, 0.0});
  state.journal_centre.x() += 1e-8;
  const Eigen::Vector2d ab = state.bearing_centre;
  const Eigen::Vector2d bc = state.journal_centre - Eigen::Vector2d(frame, 0.0);
  for (const double turn_ab : {0.0, 8e-4}) {
    for (const double turn_bc : {7e-4, -9e-4}) {
      state.bearing_velocity = turn_ab * Eigen::Vector2d(-ab.y(), ab.x());
      state.journal_velocity = turn_bc * Eigen::Vector2d(-bc.y(), bc.x());
      // Velocity along (0, 1) at the contact point half-way between the surfaces, 5.1 mm + 5 nm
      // from the bearing's centre.
      const double speed = turn_bc * (bc.x() + 5e-3 - 5e-9) - turn_ab * (ab.x() + 5.1e-3 + 5e-9);
      const double share = (std::abs(speed) - 1e-5) / 9e-5;
      ASSERT_TRUE(share > 0.1 && share < 0.99) << share;
      const Joint joint = joint_state(model, state, 0.0, 0.0);
      EXPECT_NEAR(joint.tangential_force, -std::copysign(0.3 * share, speed) * joint.normal_force,
                  1e-9 * joint.normal_force);
    }
  }
}

TEST(LinkageLaws, RunThatStartsInContactSaysSo) {
  const Linkage model = with_laws({"hertz_internal", "hunt_crossley", "none", "material"});
  State state = initial_state(model, Start::rest, 0.0, {1e-4, 0.0});
  state.journal_centre.x() += 1e-8;
  const thermal::Program program = heating(0.05, 1.0);
  for (const linkage::Run& run :
       {simulate(model, program, state, {20000, 0}), simulate_adaptive(model, program, state)}) {
    ASSERT_TRUE(run.first_contact);
    EXPECT_EQ(run.first_contact->time, 0.0);
    EXPECT_EQ(run.first_contact->temperature_change, 0.0);
  }
}

TEST(LinkageLaws, DepthOutsideTheRangeStopsWithTheInstant) {
  // Johnson's formula is valid up to a depth of 4 e^-2 ΔR = 0.54 ΔR, which the fast journal
  // exceeds.
  const Linkage model = with_laws({"johnson", "none", "none", "material"});
  State state = initial_state(model, Start::rest, 0.0);
  state.journal_velocity = {200.0, 0.0};
  try {
    simulate(model, heating(0.05), state, {100000, 0});
    FAIL() << "no error";
  } catch (const Failure& failure) {
    const FailureFields& fields = failure.fields();
    EXPECT_EQ(fields.kind, FailureKind::law_left_range);
    ASSERT_EQ(fields.numbers.size(), 2u);
    EXPECT_GT(fields.numbers[0].second, fields.numbers[1].second);  // depth and limit
    EXPECT_EQ(fields.numbers[0].first, "penetration_depth_m");
    EXPECT_EQ(fields.cause.find("johnson: "), 0u) << fields.cause;
    ASSERT_TRUE(fields.time && fields.temperature_change);
    EXPECT_GT(*fields.time, 0.0);
    // Triangle of 100 K within 0.05 s.
    EXPECT_NEAR(*fields.temperature_change, *fields.time / 0.025 * 100.0, 1e-9);
  }
}

TEST(LinkageLaws, StateThatCeasesToBeFiniteStopsWithTheInstant) {
  const Linkage model = with_laws({"hertz_internal", "none", "none", "material"});
  State state = initial_state(model, Start::rest, 0.0);
  state.journal_velocity = {1e300, 0.0};
  try {
    simulate(model, heating(0.05), state, {100000, 0});
    FAIL() << "no error";
  } catch (const Failure& failure) {
    EXPECT_EQ(failure.fields().kind, FailureKind::not_finite);
    EXPECT_NE(remedy(failure.fields()), "");
  }
}

TEST(LinkageAdaptive, AgreesWithFixedStepsUntilTheLargestTemperature) {
  // Damping limits the growth of errors, so both methods converge to the same solution.
  for (const char* friction : {"none", "ambrosio"}) {
    const Linkage model = with_laws({"hertz_internal", "hunt_crossley", friction, "material"});
    const State start = initial_state(model, Start::rest, 0.0);
    const linkage::Run fixed = simulate(model, heating(0.05, 50.0), start, {400000, 4000});
    const linkage::Run adaptive =
        simulate_adaptive(model, heating(0.05, 50.0), start, {1e-10, 100});
    ASSERT_EQ(fixed.samples.size(), adaptive.samples.size());
    double largest = 0.0;
    for (std::size_t i = 0; i < fixed.samples.size(); ++i) {
      EXPECT_NEAR(fixed.samples[i].time, adaptive.samples[i].time, 1e-12);
      largest = std::max(largest, (fixed.samples[i].state.journal_centre -
                                   adaptive.samples[i].state.journal_centre)
                                      .norm());
    }
    std::printf("%s: %g m apart, %ld steps, %d and %d contacts, residue %g J\n", friction, largest,
                adaptive.steps, adaptive.contacts, fixed.contacts, adaptive.energy_residue);
    EXPECT_EQ(fixed.contacts, adaptive.contacts);
    // Fixed steps locate the impact speed, and thus the dissipation, with an error of order h: 1e-7
    // s of 1e-3 s.
    EXPECT_LT(largest, 1e-4 * model.radial_clearance());
  }
}

TEST(LinkageAdaptive, FirstContactAndEnergy) {
  for (const double c : {0.05e-3, 0.10e-3, 0.15e-3, 0.20e-3}) {
    const Linkage model = umbrella(c);
    const linkage::Run result = simulate_adaptive(
        model, heating(), initial_state(model, Start::matched, 200.0), {1e-10, 0});
    ASSERT_TRUE(result.first_contact);
    EXPECT_NEAR(result.first_contact->temperature_change, c / (alpha * frame), 1e-6) << c;
    EXPECT_EQ(result.samples.size(), 2u);
  }
  // The error per step is proportional to the tolerance, the step length to its power -1/5. Over
  // three decades of the tolerance the residue decreases by 250, less an effect of random phases.
  double coarse = 0.0;
  for (const double tolerance : {1e-7, 1e-10}) {
    const Linkage model = umbrella();
    const linkage::Run result = simulate_adaptive(
        model, heating(0.05), initial_state(model, Start::rest, 0.0), {tolerance, 0});
    std::printf("tolerance %g: %ld steps, residue %g J\n", tolerance, result.steps,
                result.energy_residue);
    if (coarse > 0.0) {
      EXPECT_LT(std::abs(result.energy_residue), coarse / 20.0);
    }
    coarse = std::abs(result.energy_residue);
  }
}

TEST(LinkageAdaptive, RefusesFrictionThatRemembers) {
  const Linkage model = with_laws({"hertz_internal", "none", "mindlin", "material"});
  const State start = initial_state(model, Start::rest, 0.0);
  EXPECT_THROW(simulate_adaptive(model, heating(), start), std::invalid_argument);
  EXPECT_THROW(simulate_adaptive(umbrella(), heating(), start, {1e-20, 0}), std::invalid_argument);
  EXPECT_THROW(simulate_adaptive(umbrella(), heating(), start, {1e-9, -1}), std::invalid_argument);
}

TEST(Start, RefusesPenetration) {
  EXPECT_THROW(initial_state(umbrella(), Start::rest, 0.0, {1.1e-4, 0.0}), std::invalid_argument);
}

}  // namespace
}  // namespace statejump::linkage
