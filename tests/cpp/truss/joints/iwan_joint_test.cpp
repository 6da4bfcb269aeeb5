// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <stdexcept>
#include <string>

#include "gradients.hpp"
#include "heated_bar.hpp"
#include "statejump/truss/path.hpp"

namespace statejump::truss {
namespace {

using testing::heated_bar;

IwanJoint joint() {
  IwanJoint made;
  made.name = std::string("joint");
  made.first = 1;
  made.tangent_stiffness = 2e7;
  made.slip_force = 120.0;
  made.exponent = -0.4;
  made.stiffness_ratio = 0.7;
  return made;
}

/// Closed form of the backbone curve (first loading) [N].
double backbone(const IwanJoint& of, double slide) {
  const double last = of.last_reach();
  const double share = std::min(slide / last, 1.0);
  return of.tangent_stiffness * last *
         (share -
          std::pow(share, of.exponent + 2.0) / ((1.0 + of.stiffness_ratio) * (of.exponent + 2.0)));
}

/// Backbone curve of the discrete elements [N].
double polygon(const IwanJoint& of, double slide) {
  double force = 0.0;
  for (const IwanJoint::Jenkins& one : of.jenkins()) {
    force += one.stiffness * std::min(slide, one.reach);
  }
  return force;
}

double slide(const Model& model, const State& state) {
  return output(model, state, 0, "iwan_slide_m")[0];
}

double force(const Model& model, const State& state) {
  return output(model, state, 0, "iwan_force_N")[0];
}

double rounding(const IwanJoint& of) {
  return 1e-12 * of.slip_force;
}

TEST(IwanJoint, GradientsAreThoseOfItsForces) {
  Model model = heated_bar(joint(), 100.0, 1);
  model.nodes[0].freedoms = model.nodes[1].freedoms = 3;
  model.nodes[1].position = {0.1, 0.0, 0.0};
  model.links[0].axial_stiffness = 1e2;
  model.links[0].stress_free_length = 0.1;
  IwanJoint between = joint();
  between.second = 0;
  between.axis = Eigen::Vector3d(1.0, 2.0, 2.0) / 3.0;
  between.elements = 5;
  model.joints = {between};
  const detail::System system(model);
  Eigen::VectorXd z = Eigen::VectorXd::LinSpaced(system.unknowns(), 1e-6, 9e-6);
  z[6] = 12.0;
  // From `before` to z, some Jenkins elements slip and others stick.
  Eigen::VectorXd before = 0.5 * z;
  check_gradients(model, z, before,
                  {JointStatus::stick, JointStatus::slip_plus, JointStatus::slip_minus}, 1e-9,
                  1e-4);
}

TEST(IwanJoint, ElementsHaveStiffnessSlipForceAndBackboneOfTheClosedForm) {
  for (const double spacing : {1.0, 1.2}) {
    double before = 0.0;
    for (const int elements : {10, 20, 40}) {
      IwanJoint one = joint();
      one.spacing = spacing;
      one.elements = elements;
      const double last = one.last_reach();
      EXPECT_NEAR(polygon(one, 1e-6 * one.jenkins().front().reach),
                  one.tangent_stiffness * 1e-6 * one.jenkins().front().reach, 1e-18);
      EXPECT_NEAR(polygon(one, last), one.slip_force, rounding(one));
      EXPECT_NEAR(polygon(one, 3.0 * last), one.slip_force, rounding(one));
      double largest = 0.0;
      for (int i = 0; i <= 20000; ++i) {
        const double more = polygon(one, last * i / 20000) - backbone(one, last * i / 20000);
        EXPECT_GE(more, -rounding(one));
        largest = std::max(largest, more);
      }
      // The samples are dense enough to miss the largest error by at most 1 %.
      EXPECT_LE(largest, one.slack() + rounding(one));
      EXPECT_GE(largest, 0.99 * one.slack());
      // A polygon of tangents has a second-order error in the length of its intervals.
      if (spacing == 1.0 && before > 0.0) {
        EXPECT_LT(one.slack(), before / 2.6);
      }
      before = one.slack();
    }
  }
}

TEST(IwanJoint, PathFollowsMasingsRule) {
  // Two cycles: heating drives the joint into macroslip, cooling drives it back.
  const IwanJoint one = joint();
  const Model model = heated_bar(one, 100.0, 2);
  const Path path = solve(model);
  double top_slide = 0.0;
  double top_force = 0.0;
  double bottom_slide = 0.0;
  double bottom_force = 0.0;
  int half = 0;
  for (std::size_t i = 0; i < path.states.size(); ++i) {
    const State& state = path.states[i];
    const double s = slide(model, state);
    const double f = force(model, state);
    const int now = std::min(3, static_cast<int>(2.0 * state.time - 1e-12));
    if (now != half) {
      const State& turn = path.states[i - 1];
      (now % 2 == 1 ? top_slide : bottom_slide) = slide(model, turn);
      (now % 2 == 1 ? top_force : bottom_force) = force(model, turn);
      half = now;
    }
    const double expected = half == 0       ? polygon(one, s)
                            : half % 2 == 1 ? top_force - 2 * polygon(one, 0.5 * (top_slide - s))
                            // inside the loop, until it joins the backbone curve again
                            : s < top_slide
                                ? bottom_force + 2 * polygon(one, 0.5 * (s - bottom_slide))
                                : polygon(one, s);
    EXPECT_NEAR(f, expected, 1e-9 * one.slip_force) << state.time;
  }
  EXPECT_EQ(half, 3);
  EXPECT_NEAR(top_force, one.slip_force, rounding(one));
}

TEST(IwanJoint, IncrementsDoNotMatterAndEnergyIsKept) {
  const IwanJoint one = joint();
  const Model model = heated_bar(one, 60.0, 2);
  std::vector<State> ends;
  std::vector<double> residues;
  for (const int increments : {3, 50, 100, 200}) {
    Options options;
    options.increments_per_branch = increments;
    const Path path = solve(model, options);
    const State& end = path.states.back();
    ends.push_back(end);
    residues.push_back((end.thermal_work - end.elastic_energy - end.joint_dissipation[0]) /
                       end.joint_dissipation[0]);
    EXPECT_NEAR(slide(model, end), slide(model, ends.front()),
                1e-9 * std::abs(slide(model, ends.front())));
    EXPECT_NEAR(end.joint_dissipation[0], ends.front().joint_dissipation[0],
                1e-9 * ends.front().joint_dissipation[0]);
  }
  // The quadrature of the thermal work crosses corners of the polygon, so its error is of second
  // order.
  EXPECT_LT(std::abs(residues[1]), 1e-4);
  EXPECT_LT(std::abs(residues[3]), 0.5 * std::abs(residues[1]));
}

TEST(IwanJoint, HeatOfSmallCyclesGoesWithTheForceToThreePlusChi) {
  IwanJoint one = joint();
  one.spacing = 1.05;
  one.elements = 300;
  const double chi = one.exponent;
  const double last = one.last_reach();
  std::vector<double> forces;
  std::vector<double> heats;
  double share = 0.0;
  for (const double largest : {0.01, 0.02, 0.04}) {
    const Model model = heated_bar(one, largest, 2);
    const Path path = solve(model);
    const State& start = path.cycle_ends[1];
    const State& end = path.cycle_ends[2];
    const State* top = &start;
    for (const State& state : path.states) {
      if (force(model, state) > force(model, *top)) top = &state;
    }
    forces.push_back(0.5 * (force(model, *top) - force(model, end)));
    heats.push_back(end.joint_dissipation[0] - start.joint_dissipation[0]);
    // Heat: ∫ 4 φ (u − φ) R φ^χ dφ from 0 to u. The interval length φ/20 causes a second-order
    // error.
    const double amplitude = 0.5 * (slide(model, *top) - slide(model, end));
    share = std::pow(amplitude / last, chi + 1.0);
    const double closed = 4.0 * one.tangent_stiffness / (1.0 + one.stiffness_ratio) * share *
                          (chi + 1.0) / ((chi + 2.0) * (chi + 3.0)) * amplitude * amplitude;
    EXPECT_NEAR(heats.back(), closed, 0.05 * 0.05 * closed);
  }
  // For the force K_T u (1 − c (u/φm)^(χ + 1)), the exponent of u differs from 1 by `bent`.
  const double bent = (chi + 1.0) * share / ((1.0 + one.stiffness_ratio) * (chi + 2.0));
  for (std::size_t i = 0; i + 1 < forces.size(); ++i) {
    const double slope = std::log(heats[i + 1] / heats[i]) / std::log(forces[i + 1] / forces[i]);
    EXPECT_NEAR(slope, 3.0 + chi, 1.1 * (3.0 + chi) * bent + 0.05 * 0.05) << forces[i];
  }
}

TEST(IwanJoint, ItemsOutOfRangeAreNamed) {
  const auto refused = [](auto change) {
    Model model = heated_bar(joint(), 100.0, 1);
    change(std::get<IwanJoint>(model.joints[0]));
    EXPECT_THROW(model.validate(), std::invalid_argument);
  };
  refused([](IwanJoint& one) { one.exponent = -1.0; });
  refused([](IwanJoint& one) { one.exponent = 0.1; });
  refused([](IwanJoint& one) { one.elements = 0; });
  refused([](IwanJoint& one) { one.spacing = 0.9; });
  refused([](IwanJoint& one) { one.elements = 400; });
  refused([](IwanJoint& one) { one.second = 1; });
}

}  // namespace
}  // namespace statejump::truss
