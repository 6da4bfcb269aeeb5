// SPDX-License-Identifier: GPL-3.0-or-later
// A rib and a tripod with balls in motion, for the tests of several schemes.
#pragma once

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "../joints/ball_models.hpp"
#include "scenes.hpp"

namespace statejump::truss::scenes {

/// Masses of testing::rib(), with dashpots in its contact and its pins.
inline Inertia rib_inertia() {
  Inertia inertia = masses(Eigen::VectorXd::Constant(5, 0.05));
  inertia.joint_damping = Eigen::VectorXd::Constant(1, 2.0 * 0.1 * std::sqrt(0.025));
  inertia.pin_damping = Eigen::Vector2d(1e-2, 1e-2);
  return inertia;
}

/// Masses of testing::tripod(), with dashpots in its links and its contact.
inline Inertia tripod_inertia() {
  Inertia inertia = masses(Eigen::VectorXd::Constant(8, 0.5));
  inertia.link_damping = Eigen::VectorXd::Constant(4, 60.0);
  inertia.joint_damping = Eigen::VectorXd::Constant(1, 2.0 * 0.1 * std::sqrt(0.25));
  return inertia;
}

/// Relative difference of the displacements of two states.
inline double apart(const State& state, const State& exact) {
  return (state.displacement - exact.displacement).norm() / exact.displacement.norm();
}

/// Expects that the rib with a ball, in a rotated plane, moves like the rib with a journal.
/// @param run simulates a rib and returns ten samples
/// @param moved, heat allowed differences, relative to the largest displacement and to the friction
///     heat
template <class Run>
void expect_ball_moves_as_journal(Run&& run, double moved, double heat) {
  using Eigen::Matrix3d;
  const Matrix3d turned =
      Eigen::AngleAxisd(2.1, Eigen::Vector3d(1.0, -2.0, 0.5).normalized()).toRotationMatrix();
  const Motion ball = run(testing::rib(true, turned));
  const Motion journal = run(testing::rib(false, Matrix3d::Identity()));
  ASSERT_EQ(ball.states.size(), journal.states.size());
  const double largest = journal.states[5].displacement.norm();
  for (std::size_t i = 0; i < ball.states.size(); ++i) {
    const Eigen::Matrix3Xd difference =
        turned.transpose() * ball.states[i].displacement - journal.states[i].displacement;
    EXPECT_LT(difference.norm(), moved * largest) << "sample " << i;
  }
  const double dissipated = journal.states.back().joint_dissipation[0];
  EXPECT_GT(dissipated, 0.0);
  EXPECT_NEAR(ball.states.back().joint_dissipation[0], dissipated, heat * dissipated);
}

}  // namespace statejump::truss::scenes
