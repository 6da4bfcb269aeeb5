// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include "../support/argument.hpp"
#include "parts.hpp"
#include "statejump/failure.hpp"
#include "statejump/kernel/mindlin.hpp"
#include "truss/system.hpp"

namespace statejump::truss {
namespace {

using statejump::testing::Argument;
using statejump::testing::refused_argument;
using testing::node;
using testing::rib_joint;
using testing::triangle;

Slider& slider(Model& model, std::size_t i = 0) {
  return std::get<Slider>(model.joints[i]);
}

ClearanceRevolute& revolute(Model& model, std::size_t i = 0) {
  return std::get<ClearanceRevolute>(model.joints[i]);
}

/// Output of the first joint at a state.
double number(const Model& model, const State& state, std::string_view key) {
  return output(model, state, 0, key)[0];
}

double slide(const Model& model, const State& state) {
  return number(model, state, "slide_m");
}

Model bar() {
  return testing::sliding_bar();
}

/// Rib of two bars in a general configuration, with a clearance joint, a torsion spring and a
/// cable.
Model rib() {
  Model model;
  model.programs = {triangle(100.0)};
  model.nodes = {node("A", 0, 0, 0), node("C", 0.12, 0, 0), node("B", 0.02875, 0.0409, 2),
                 node("J", 0.02875, 0.0409, 2)};
  model.nodes[2].load = {1.0, -2.0, 0.0};
  model.links = {{"AB", 0, 2, 6.3e5, 0.05, 23.75e-6, 0, 1.0},
                 {"CJ", 1, 3, 6.3e5, 0.1, 23.75e-6, 0, 0.5}};
  model.springs = {{"tie", 1, 2, 1e3, 0.09, true}};
  model.torsion_springs = {{"flare", 0, 1, 1.0, 0.05, Eigen::Vector3d::UnitZ()}};
  ClearanceRevolute joint = rib_joint();
  joint.friction_coefficient = 0.15;
  joint.hertz_stiffness = 2.6e10;
  model.joints = {joint};
  return model;
}

Argument refused(const Model& model) {
  return refused_argument([&] { solve(model); });
}

TEST(Truss, BarJumpsByFrictionOverStiffness) {
  const Path path = solve(bar());
  const double jump = path.cycle_ends.back().displacement(0, 1);
  EXPECT_NEAR(jump, 30.0 * 0.5 / (70e9 * 9e-6), 1e-12 * jump);
  EXPECT_TRUE(path.complete);
}

TEST(Truss, SliderBetweenTwoNodesHoldsAcrossItsAxis) {
  // The same bar, but its block is on a carrier that a second bar supports. A lateral load is
  // transferred to the carrier.
  Model model = bar();
  model.nodes[1].freedoms = 2;
  model.nodes.push_back(node("D", 0.5, 0, 2));
  model.nodes.push_back(node("E", 0.5, -1, 0));
  model.nodes.push_back(node("F", 1.5, 0, 0));
  model.links.push_back({"ED", 3, 2, 6.3e5, 1.0, 0.0, 0, 1.0});
  model.links.push_back({"FD", 4, 2, 6.3e9, 1.0, 0.0, 0, 1.0});
  model.nodes[1].load = {0.0, -63.0, 0.0};
  slider(model).second = 2;
  const Path path = solve(model);
  const State& end = path.states.back();
  EXPECT_NEAR(element_output<Bar>(model, end)(0, 1), 63.0, 0.05);  // 0.05: the bars tilt by 1e-4
  EXPECT_NEAR(end.displacement(1, 1), end.displacement(1, 2), 1e-15);
  EXPECT_NEAR(std::abs(number(model, end, "slider_force_N")), 30.0, 1e-9);
}

/// Energy residue since the start, from heat, elastic energy and thermal work, relative to the
/// heat.
double relative_residue(const Path& path) {
  const State& start = path.states.front();
  const State& end = path.states.back();
  const double heat = end.joint_dissipation.sum();
  const double stored =
      end.elastic_energy + end.load_potential - start.elastic_energy - start.load_potential;
  return (end.thermal_work - stored - heat) / heat;
}

TEST(Truss, ElasticSliderBendsBeforeItSlips) {
  // Bar and contact act as springs in series until the force reaches f: (E A/l_T) (l0 α ΔT − s) =
  // k_t s.
  Model model = bar();
  const double stiffness = 1e7;
  slider(model).tangential_stiffness = stiffness;
  const Path path = solve(model);
  const double growth = 0.5 * 23.4e-6;
  const auto axial = [&](double change) { return 6.3e5 / (0.5 + growth * change); };
  for (const State& state : path.states) {
    if (state.time >= path.events.front().time) break;
    const double change = state.temperature_change;
    const double expected = axial(change) * growth * change / (axial(change) + stiffness);
    EXPECT_NEAR(slide(model, state), expected, 1e-12 * 30.0 / stiffness) << change;
  }
  // The block slips when (E A/l_T) (l0 α ΔT − f/k_t) = f. The event is located to 1e-9 of the
  // branch of 100 K.
  const double slip = path.events.front().temperature_change;
  EXPECT_EQ(path.events.front().after, JointStatus::slip_plus);
  EXPECT_NEAR(axial(slip) * (growth * slip - 30.0 / stiffness), 30.0, axial(0) * growth * 1e-7);
  // The block also slips back, so the jump is that of a rigid contact. The heat is f times the
  // plastic slides, i.e. without the elastic deflections f/k_t on heating and 2 f/k_t on cooling.
  const double jump = 30.0 * 0.5 / 6.3e5;
  EXPECT_NEAR(slide(model, path.states.back()), jump, 1e-12 * jump);
  double farthest = 0.0;
  for (const State& state : path.states) farthest = std::max(farthest, slide(model, state));
  const double slid = 2.0 * farthest - jump - 3.0 * 30.0 / stiffness;
  // If an event is located during stick near a reversal, its error is 1e-9 of the slide.
  EXPECT_NEAR(path.states.back().joint_dissipation[0], 30.0 * slid, 1e-7 * 30.0 * slid);
  // The thermal work uses the trapezoidal rule over 50 increments per branch, of second order. Its
  // error, 1e-3 of the expansion times the strain of 1e-3, is far below 1e-6 of the heat.
  EXPECT_LT(std::abs(relative_residue(path)), 1e-6);
}

TEST(Truss, ElasticSliderKeepsItsBendAtAStop) {
  // When the block reaches the stop, the force f deflects the contact spring. The block leaves the
  // stop when the force is f again, and slips back at −f.
  Model model = bar();
  const double stiffness = 1e7;
  const double stop = 4e-4;
  slider(model).tangential_stiffness = stiffness;
  slider(model).clearance_plus = stop;
  const Path path = solve(model);
  const std::vector<JointStatus> expected{JointStatus::slip_plus, JointStatus::stop_plus,
                                          JointStatus::stick, JointStatus::slip_minus};
  ASSERT_EQ(path.events.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) EXPECT_EQ(path.events[i].after, expected[i]);
  for (const State& state : path.states) {
    EXPECT_LE(slide(model, state), stop * (1 + 1e-12));
    if (state.time == path.events[3].time) {
      // Located to 1e-9 of the branch of 100 K.
      EXPECT_NEAR(slide(model, state), stop - 2.0 * 30.0 / stiffness, 1e-7 * 0.5 * 23.4e-6);
    }
  }
  EXPECT_NEAR(slide(model, path.states.back()), 30.0 * 0.5 / 6.3e5, 1e-15);
  EXPECT_LT(std::abs(relative_residue(path)), 1e-6);
}

/// Rib with an elastic contact, k_t/k_n of aluminium.
Model elastic_rib() {
  Model model = rib();
  revolute(model).mindlin_stiffness = 1.5 * 2.6e10 * 1.4 / 1.7;
  return model;
}

/// Slide between the two surfaces of the rib's joint from one state to another; see solve().
double surface_slide(const Model& model, const State& from, const State& to) {
  const auto& joint = std::get<ClearanceRevolute>(model.joints[0]);
  const auto angle = [](const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
    return std::atan2(a.x() * b.y() - a.y() * b.x(), a.dot(b));
  };
  const auto link = [&](const State& state, int far, int near) -> Eigen::Vector3d {
    return model.nodes[static_cast<std::size_t>(near)].position + state.displacement.col(near) -
           model.nodes[static_cast<std::size_t>(far)].position - state.displacement.col(far);
  };
  const Eigen::Vector3d before = output(model, from, 0, "eccentricity_m");
  const Eigen::Vector3d now = output(model, to, 0, "eccentricity_m");
  const double depth = now.norm() - joint.radial_clearance;
  return 0.5 * (before.norm() + now.norm()) * angle(before, now) +
         (joint.journal_radius - 0.5 * depth) * angle(link(from, 1, 3), link(to, 1, 3)) -
         (joint.journal_radius + joint.radial_clearance + 0.5 * depth) *
             angle(link(from, 0, 2), link(to, 0, 2));
}

TEST(Truss, ElasticRevoluteIsTheHistorySpringOfTheDem) {
  // The DEM's friction law, driven along the solver's path, must give the same friction force.
  Model model = elastic_rib();
  Options options;
  options.increments_per_branch = 2000;
  const Path path = solve(model, options);
  const auto stiffness = [&](const State& state) {
    const double depth = output(model, state, 0, "eccentricity_m").norm() - 1e-4;
    return revolute(model).mindlin_stiffness * std::sqrt(depth);
  };
  kernel::ContactHistory history;
  history.tangential_stiffness = stiffness(path.states[0]);
  double error = 0.0;
  double allowed = 0.0;
  double largest = 0.0;
  int sticks = 0;
  for (std::size_t i = 1; i < path.states.size(); ++i) {
    const State& state = path.states[i];
    const double slide = surface_slide(model, path.states[i - 1], state);
    const double before = history.tangential_stiffness;
    kernel::mindlin_step(stiffness(state), 0.15 * number(model, state, "normal_force_N"),
                         kernel::Vector3(slide, 0, 0), history);
    const double friction = -history.tangential_force.x();
    error = std::max(error, std::abs(friction - number(model, state, "friction_force_N")));
    largest = std::max(largest, std::abs(friction));
    // In a step, the DEM's law uses k_t at its end, whereas the solver uses the mean of 1/k_t.
    allowed += 0.5 * std::abs(1.0 - before / stiffness(state)) *
               std::abs(friction - number(model, path.states[i - 1], "friction_force_N"));
    if (state.joint_status[0] == JointStatus::stick) ++sticks;
  }
  EXPECT_GT(sticks, 100);
  EXPECT_LT(allowed, 1e-2 * largest);  // otherwise the comparison is meaningless
  EXPECT_LT(error, allowed + 1e-9 * largest);
}

TEST(Truss, ElasticRevoluteClosesItsBalance) {
  // With twenty times the increments, less than a hundredth of the energy residue remains.
  Options options;
  options.increments_per_branch = 50;
  const double coarse = relative_residue(solve(elastic_rib(), options));
  options.increments_per_branch = 1000;
  const double fine = relative_residue(solve(elastic_rib(), options));
  EXPECT_LT(std::abs(fine), 1e-6);
  EXPECT_LT(std::abs(fine), 1e-2 * std::abs(coarse) + 1e-9);
}

TEST(Truss, StiffContactsApproachRigidOnes) {
  Model model = rib();
  const Eigen::Matrix3Xd rigid = solve(model).states.back().displacement;
  Model soft = elastic_rib();
  const double elastic = revolute(soft).mindlin_stiffness;
  double last = 1.0;
  for (const double factor : {1.0, 10.0, 100.0}) {
    revolute(model).mindlin_stiffness = factor * elastic;
    const double apart = (solve(model).states.back().displacement - rigid).norm();
    // first order in 1/k_t: a tenth each time, plus higher orders
    EXPECT_LT(apart, 0.3 * last) << factor;
    last = apart;
  }
}

TEST(Truss, SlipThatTurnsRoundWithinAStepIsLocated) {
  // A block between two bars, one of which follows a sine program. The difference of their lengths
  // reverses in the middle of a branch, where no corner of a program shortens the step.
  Model model;
  model.programs = {triangle(100.0), triangle(100.0)};
  model.programs[1].shape = thermal::Shape::half_sine;
  model.nodes = {node("left", 0, 0, 0), node("block", 0.5, 0, 1), node("right", 1.0, 0, 0)};
  model.links = {{"first", 0, 1, 1e6, 0.5, 2e-5, 0, 1.0}, {"second", 1, 2, 1e6, 0.5, 2e-5, 1, 1.0}};
  Slider slider;
  slider.name = "S";
  slider.first = 1;
  slider.friction_force = 1.0;
  model.joints = {slider};
  const auto turns = [](const Path& path) {
    // The slide reverses at the start of the event's interval. The overshoot in it is below
    // rounding.
    std::vector<double> found;
    for (const Event& event : path.events) {
      if (event.before != JointStatus::stick) found.push_back(event.time - event.interval);
    }
    return found;
  };
  Options options;
  options.increments_per_branch = 400;
  const Path fine = solve(model, options);
  const double heat = fine.states.back().joint_dissipation[0];
  const std::vector<double> fine_turns = turns(fine);
  ASSERT_EQ(fine_turns.size(), 3u);  // one in each branch, and one at the corner between them
  for (const int increments : {1, 2, 5, 8, 30}) {
    for (const bool locate : {true, false}) {
      // Without event location, an increment over a whole branch shows no event: both ends have
      // equal positions.
      if (!locate && increments == 1) continue;
      options.locate_events = locate;
      options.increments_per_branch = increments;
      const Path path = solve(model, options);
      EXPECT_NEAR(path.states.back().joint_dissipation[0], heat, 1e-10 * heat) << increments;
      EXPECT_NEAR(slide(model, path.states.back()), slide(model, fine.states.back()), 1e-14)
          << increments;
      const std::vector<double> found = turns(path);
      ASSERT_EQ(found.size(), fine_turns.size()) << increments;
      for (std::size_t i = 0; i < found.size(); ++i) {
        // The overshoot, a slide of 1e-3 m times the squared delay, is below 1e3 roundings of 1e-18
        // m.
        EXPECT_NEAR(found[i], fine_turns[i], 1e-6) << increments;
      }
    }
  }
}

TEST(Truss, ContactThatComesAndGoesWithinAStepIsLocated) {
  // A journal between two bars; a third bar constrains it laterally. At both ends of a branch the
  // journal is at the centre of its bearing. In between it touches the bearing.
  Model model;
  model.programs = {triangle(100.0), triangle(100.0)};
  model.programs[1].shape = thermal::Shape::half_sine;
  model.nodes = {node("left", 0, 0, 0), node("journal", 0.5, 0, 2), node("right", 1.0, 0, 0),
                 node("bearing", 0.5, 0, 0), node("sky", 0.5, 0.5, 0)};
  model.links = {{"first", 0, 1, 1e6, 0.5, 2e-5, 0, 1.0},
                 {"second", 1, 2, 1e6, 0.5, 2e-5, 1, 1.0},
                 {"third", 1, 4, 1e6, 0.5, 0.0, 0, 1.0}};
  ClearanceRevolute joint = rib_joint();
  joint.journal_node = 1;
  joint.bearing_node = 3;
  joint.journal_link = joint.bearing_link = -1;
  joint.radial_clearance = 8e-5;
  joint.hertz_stiffness = 1e10;
  model.joints = {joint};
  Options options;
  options.increments_per_branch = 400;
  const Path fine = solve(model, options);
  ASSERT_EQ(fine.events.size(), 4u);  // touches and separates, in each branch
  for (const int increments : {1, 2, 5}) {
    options.increments_per_branch = increments;
    const Path path = solve(model, options);
    ASSERT_EQ(path.events.size(), fine.events.size()) << increments;
    for (std::size_t i = 0; i < path.events.size(); ++i) {
      // Located to 1e-9 of a branch of half a second.
      EXPECT_NEAR(path.events[i].time, fine.events[i].time, 1e-9) << increments;
      EXPECT_EQ(path.events[i].after == JointStatus::open, i % 2 == 1) << increments;
    }
  }
}

TEST(Truss, SlipEndsAtTheCornerHoweverLongTheIncrement) {
  // The slide reverses between two increments, each of which spans a whole branch. The short step
  // after the corner sticks first, so the path reports both slips and the stick between them.
  Options options;
  options.locate_events = false;
  for (const int increments : {1, 3}) {
    options.increments_per_branch = increments;
    const Path path = solve(bar(), options);
    const double length = 0.5;
    const auto held = std::find_if(path.events.begin(), path.events.end(), [](const Event& event) {
      return event.after == JointStatus::stick;
    });
    ASSERT_NE(held, path.events.end()) << increments;
    EXPECT_EQ(held->before, JointStatus::slip_plus);
    EXPECT_GT(held->time, 0.5);
    EXPECT_LE(held->time, 0.5 + 1.5 * options.event_tolerance * length);
    ASSERT_NE(held + 1, path.events.end());
    EXPECT_EQ((held + 1)->before, JointStatus::stick);
    EXPECT_EQ((held + 1)->after, JointStatus::slip_minus);
    // Solves: one at the start; in each branch one for the short step, plus the increments. None
    // searches an event.
    EXPECT_EQ(path.solves, 1 + 2 * (1 + increments));
  }
}

TEST(Truss, RibFollowsItsPathAndClosesItsBalance) {
  const Model model = rib();
  const Path path = solve(model);
  EXPECT_LT(path.largest_force_residual, 1e-11);
  for (const State& state : path.states) {
    EXPECT_LE(std::abs(number(model, state, "friction_force_N")),
              0.15 * number(model, state, "normal_force_N") + 1e-9);
    EXPECT_GT(number(model, state, "normal_force_N"), 0.0);
  }
}

TEST(Truss, JournalThatGrowsWorksAgainstTheForceThatPressesIt) {
  // A load presses a journal into a fixed bore. When the clearance grows, the journal moves along
  // with the load.
  Model model = rib();
  const double load = 50.0;
  model.nodes = {node("bore", 0, 0, 0), node("journal", 0, 0, 2), node("wall", -1, 0, 0)};
  model.nodes[1].load = {load, 0.0, 0.0};
  model.links.clear();
  model.torsion_springs.clear();
  model.springs = {{"spring", 2, 1, 1e3, 1.0, false}};
  ClearanceRevolute& joint = revolute(model);
  joint.journal_node = 1;
  joint.bearing_node = 0;
  joint.journal_link = joint.bearing_link = -1;
  joint.friction_coefficient = 0.0;
  joint.journal_thermal_expansion = 2e-5;
  joint.bearing_thermal_expansion = 1e-5;
  const double growth =
      1e-5 * (joint.journal_radius + joint.radial_clearance) - 2e-5 * joint.journal_radius;
  const Path path = solve(model);
  double largest = 0.0;
  for (const State& state : path.states) {
    const double stored = state.elastic_energy + state.load_potential -
                          path.states.front().elastic_energy - path.states.front().load_potential;
    // The spring carries 1e3 N/m times the clearance.
    const double pressed = load - 1e3 * joint.radial_clearance;
    const double work = -pressed * growth * state.temperature_change;
    EXPECT_NEAR(state.thermal_work, work, 1e-2 * std::abs(work) + 1e-18);
    EXPECT_NEAR(state.thermal_work, stored, 1e-12 * load * joint.radial_clearance);
    largest = std::max(largest, std::abs(work));
  }
  EXPECT_GT(largest, 1e-4 * load * joint.radial_clearance);  // otherwise the balance is meaningless
}

TEST(Truss, RibOfExpandingJournalsClosesItsBalance) {
  Model model = elastic_rib();
  revolute(model).journal_thermal_expansion = 3e-5;
  revolute(model).bearing_thermal_expansion = 1e-5;
  Options options;
  const double coarse = std::abs(relative_residue(solve(model, options)));
  options.increments_per_branch *= 4;
  const Path path = solve(model, options);
  const double fine = std::abs(relative_residue(path));
  EXPECT_LT(coarse, 1e-9);
  // Energy that a path may lose, in each of its branches.
  double work = 0.0;
  for (const State& state : path.states) work = std::max(work, std::abs(state.thermal_work));
  EXPECT_LT(fine,
            2.0 * options.energy_tolerance * work / path.states.back().joint_dissipation.sum());
}

TEST(Truss, ItemsOutOfRangeAreNamed) {
  const std::string clearance = "clearance at the program's worst temperature";
  Model model = bar();
  model.links[0].axial_stiffness = -1.0;
  EXPECT_EQ(refused(model), Argument("axial_stiffness", -1, "link 'AB'"));
  model = bar();
  slider(model).first = 7;
  EXPECT_EQ(refused(model), Argument("first node", 7, "slider 'S'"));
  model = bar();
  model.links[0].thermal_expansion = -0.02;
  EXPECT_EQ(refused(model), Argument("thermal_expansion", -0.02, "link 'AB'"));
  model = rib();
  revolute(model).journal_link = 0;
  EXPECT_EQ(refused(model), Argument("journal link", 0, "revolute 'joint'"));
  model = rib();
  revolute(model).bearing_thermal_expansion = -1e-3;
  EXPECT_EQ(refused(model).name, clearance);
  EXPECT_LT(refused(model).value, 0.0);
  // At the peak temperature the journal fills its bore exactly; powers of two avoid rounding.
  model = rib();
  model.programs = {triangle(64.0)};
  revolute(model).journal_radius = 0.5;
  revolute(model).journal_thermal_expansion = std::ldexp(1.0, -16);
  revolute(model).radial_clearance = std::ldexp(1.0, -11);
  EXPECT_EQ(refused(model), Argument(clearance, 0, "revolute 'joint'"));
}

FailureFields failure(const Model& model) {
  try {
    solve(model);
  } catch (const Failure& failed) {
    return failed.fields();
  }
  ADD_FAILURE() << "no failure";
  return {};
}

TEST(Truss, MechanismIsNamed) {
  Model model = rib();
  model.nodes[0].freedoms = 2;
  model.springs.clear();
  const FailureFields fields = failure(model);
  EXPECT_EQ(fields.kind, FailureKind::held_mechanism);
  EXPECT_EQ(static_cast<std::size_t>(fields.mode_count), fields.modes.size());
  ASSERT_FALSE(fields.modes.empty());
  EXPECT_FALSE(fields.more_modes);
  EXPECT_EQ(fields.time, 0.0);
  // With many free nodes the solver finds six modes, and the error states that there may be more.
  model = bar();
  for (int i = 0; i < 4; ++i) model.nodes.push_back(node("free" + std::to_string(i), i, 1, 2));
  const FailureFields many = failure(model);
  EXPECT_EQ(many.kind, FailureKind::held_mechanism);
  EXPECT_EQ(many.mode_count, 6);
  EXPECT_TRUE(many.more_modes);
}

TEST(Truss, EventsHaveTheStepInWhichTheyHappened) {
  Options options;
  options.event_tolerance = 1e-6;
  const Path path = solve(bar(), options);
  ASSERT_FALSE(path.events.empty());
  for (const Event& event : path.events) {
    // A branch lasts half a second. The sum of time and step is rounded.
    EXPECT_GT(event.interval, 0.0);
    EXPECT_LE(event.interval, 1.5 * options.event_tolerance * 0.5);
    EXPECT_NEAR(event.temperature_change, 200.0 * std::min(event.time, 1.0 - event.time), 1e-12);
  }
}

TEST(Truss, ProgressEndsAPath) {
  Options options;
  double last = 0.0;
  options.progress = [&](double share) {
    EXPECT_GE(share, last);
    last = share;
    return share < 0.3;
  };
  const Path path = solve(bar(), options);
  EXPECT_FALSE(path.complete);
  EXPECT_GE(last, 0.3);
  EXPECT_LT(last, 0.35);
  EXPECT_LT(path.states.back().time, 0.35);
  options.progress = [&](double share) {
    last = share;
    return true;
  };
  EXPECT_TRUE(solve(bar(), options).complete);
  EXPECT_EQ(last, 1.0);
}

TEST(Truss, LocalProblemsAreThoseThatThePathSolves) {
  Options options;
  options.problem_times = {0.1, 0.6};
  for (const Model& model : {bar(), elastic_rib()}) {
    const Path path = solve(model, options);
    ASSERT_EQ(path.problems.size(), 2u);
    for (const LocalProblem& local : path.problems) {
      const complementarity::Problem& problem = local.problem;
      EXPECT_EQ(local.joints, std::vector<int>{0});
      ASSERT_EQ(problem.contacts(), 1);
      // Forces are in equilibrium to 1e-12. Closures are solved to 1e-13 of the displacements,
      // which are a hundred times larger than those of one step.
      EXPECT_LT(complementarity::merit(problem, local.reactions).largest(), 1e-9);
      EXPECT_LT((complementarity::velocities(problem, local.reactions) - local.velocities).norm(),
                1e-12 * problem.q.norm());
      EXPECT_GT(std::abs(local.reactions[1]), 0.0);
    }
  }
  // At 0.1 s and 20 K the block slides. W is the compliance of the bar at this temperature, and
  // friction is 30 N.
  const LocalProblem local = solve(bar(), options).problems[0];
  const auto& w = std::get<Eigen::MatrixXd>(local.problem.delassus);
  EXPECT_NEAR(w(1, 1), 0.5 * (1.0 + 23.4e-6 * 20.0) / 6.3e5, 1e-12 / 6.3e5);
  EXPECT_NEAR(std::abs(local.reactions[1]), 30.0, 1e-9);
  EXPECT_EQ(local.reactions[0] * local.problem.mu[0], 30.0);
}

TEST(Truss, RoundingGoesWithTheLargestDisplacementOfThePath) {
  const Model model = bar();
  const detail::System system(model);
  Eigen::VectorXd z = Eigen::VectorXd::Zero(system.unknowns());
  z.tail(system.unknowns() - 1).setConstant(30.0);  // forces do not count
  // For zero displacements the reach is the largest thermal strain, 23.4e-6/K times 100 K, times
  // the size of the truss.
  EXPECT_DOUBLE_EQ(system.reach(z), 23.4e-4 * system.size());
  EXPECT_DOUBLE_EQ(system.rounding(z).length, detail::closure_tolerance * system.reach(z));
  EXPECT_DOUBLE_EQ(system.rounding(z).force, system.stiffness_scale() * system.rounding(z).length);
  z[0] = -1e-2;
  EXPECT_EQ(system.reach(z), 1e-2);
  // A diverging iteration must not enlarge its own tolerance.
  z[0] = 1e9;
  EXPECT_EQ(system.reach(z), system.size());
}

TEST(Truss, JointThatNothingLoadsIsSlack) {
  Model model = rib();
  model.nodes[2].load.setZero();
  model.torsion_springs.clear();
  model.springs.clear();
  // Stress-free lengths equal to the reference configuration: no pin force.
  for (Bar& link : model.links) {
    link.stress_free_length = (model.nodes[static_cast<std::size_t>(link.second)].position -
                               model.nodes[static_cast<std::size_t>(link.first)].position)
                                  .norm();
  }
  const Path path = solve(model);
  ASSERT_EQ(path.notes.size(), 1u);
  const Note& note = path.notes[0];
  EXPECT_EQ(note.kind, NoteKind::slack);
  EXPECT_EQ(note.time, 0.0);
  ASSERT_EQ(note.joints.size(), 1u);
  EXPECT_EQ(note.joints[0].kind, "revolute");
  EXPECT_EQ(note.joints[0].name, "joint");
  // Only rounding errors of the stiffest link's force.
  EXPECT_LT(element_output<Bar>(model, path.states.back()).cwiseAbs().maxCoeff(), 1e-6);
}

/// The bar with a second, independent one that follows another program.
Model two_programs(double period, int cycles, double other_period, int other_cycles) {
  Model model = bar();
  model.nodes.push_back(node("C", 0, 1, 0));
  model.nodes.push_back(node("D", 0.5, 1, 1));
  model.links.push_back({"CD", 2, 3, 6.3e5, 0.5, 23.4e-6, 1, 1.0});
  model.programs = {triangle(100.0), triangle(50.0)};
  model.programs[0].period = period;
  model.programs[0].cycles = cycles;
  model.programs[1].period = other_period;
  model.programs[1].cycles = other_cycles;
  return model;
}

TEST(Truss, ProgramsNeedNotLastEquallyLongToTheLastBit) {
  ASSERT_NE(3 * 0.1, 0.3);
  for (const bool longer_first : {false, true}) {
    const Path path =
        solve(longer_first ? two_programs(0.1, 3, 0.3, 1) : two_programs(0.3, 1, 0.1, 3));
    EXPECT_EQ(path.cycle_ends.size(), longer_first ? 4u : 2u);
    // After both programs the free bar has its initial length, to the rounding of its force.
    EXPECT_NEAR(path.states.back().displacement(0, 3), 0.0, 1e-16);
    EXPECT_EQ(path.states.back().temperature_change, 0.0);
  }
  EXPECT_EQ(refused(two_programs(0.1, 3, 0.31, 1)), Argument("duration of a program", 0.31));
}

TEST(Truss, CornersThatNearlyCoincideAreOne) {
  // Eight cycles of 0.15 s have 16 corners. The ends of four cycles of 0.3 s nearly coincide with
  // some of them.
  ASSERT_NE(3 * 0.3 + 0.15, 7 * 0.15);
  for (const bool longer_first : {false, true}) {
    const Model model =
        longer_first ? two_programs(0.3, 4, 0.15, 8) : two_programs(0.15, 8, 0.3, 4);
    Options options;
    options.locate_events = false;
    const Path path = solve(model, options);
    EXPECT_EQ(path.states.size(), 1u + 16u * 50u);
    EXPECT_EQ(path.cycle_ends.size(), longer_first ? 5u : 9u);
    for (const State& end : path.cycle_ends) EXPECT_EQ(end.temperature_change, 0.0);
  }
}

}  // namespace
}  // namespace statejump::truss
