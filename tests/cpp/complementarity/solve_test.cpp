// SPDX-License-Identifier: GPL-3.0-or-later
#include "statejump/complementarity/solve.hpp"

#include <gtest/gtest.h>

#include "statejump/kernel/require.hpp"
#include "support.hpp"

namespace statejump::complementarity {
namespace {

using testing::one_contact;
using testing::random_problem;

// Tolerance for results of a 3 x 3 system with condition number 3: a few roundings plus 100 times
// the merit tolerance 1e-10. In practice Newton's method ends far below that tolerance.
constexpr double tight = 1e-9;

TEST(OneContact, opens_where_nothing_presses) {
  const Solution solution = solve(one_contact({0.1, -3.0, 2.0}, 0.5));
  EXPECT_EQ(solution.status, Status::solved);
  EXPECT_EQ(solution.reactions.norm(), 0.0);
  EXPECT_EQ(solution.velocities, (Eigen::Vector3d{0.1, -3.0, 2.0}));
}

TEST(OneContact, sticks_inside_the_cone) {
  const Problem problem = one_contact({-1.0, 0.1, 0.05}, 0.5);
  const Solution solution = solve(problem);
  ASSERT_EQ(solution.status, Status::solved);
  const Eigen::Vector3d expected =
      -std::get<Eigen::MatrixXd>(problem.delassus).inverse() * problem.q;
  EXPECT_LT((solution.reactions - expected).norm(), tight);
  EXPECT_LT(solution.velocities.norm(), tight);
}

TEST(OneContact, slides_against_its_velocity) {
  // Closed form for W = w I: r_n = -q_n/w, r_t = -mu r_n q_t/|q_t|, |u_t| = |q_t| - w mu r_n.
  const double w = 4.0;
  const Problem problem = {3, Eigen::MatrixXd(w * Eigen::Matrix3d::Identity()),
                           Eigen::Vector3d(-2.0, 3.0, -4.0), Eigen::VectorXd::Constant(1, 0.25)};
  const Solution solution = solve(problem);
  ASSERT_EQ(solution.status, Status::solved);
  const Eigen::Vector3d expected(0.5, -0.125 * 0.6, 0.125 * 0.8);
  EXPECT_LT((solution.reactions - expected).norm(), tight);
  EXPECT_NEAR(solution.velocities.tail(2).norm(), 5.0 - w * 0.125, tight);
}

TEST(OneContact, without_friction_has_no_tangential_reaction) {
  const Solution solution = solve(one_contact({-1.0, 2.0, 2.0}, 0.0));
  ASSERT_EQ(solution.status, Status::solved);
  EXPECT_NEAR(solution.reactions[0], 0.5, tight);
  EXPECT_EQ(solution.reactions.tail(2).norm(), 0.0);
}

TEST(Problem, without_friction_has_its_one_solution) {
  // Two coupled contacts, of which one opens: if both were closed, one reaction would be tensile.
  for (const int d : {2, 3}) {
    Problem problem{d, Eigen::MatrixXd::Identity(2 * d, 2 * d), Eigen::VectorXd::Zero(2 * d),
                    Eigen::VectorXd::Zero(2)};
    auto& w = std::get<Eigen::MatrixXd>(problem.delassus);
    w(0, d) = w(d, 0) = 0.8;
    problem.q[0] = -1.0;
    problem.q[d] = -0.5;
    Eigen::VectorXd exact = Eigen::VectorXd::Zero(2 * d);
    exact[0] = 1.0;
    EXPECT_EQ(merit(problem, exact).largest(), 0.0);
    // A tensile reaction is not a solution.
    Eigen::VectorXd pulls = Eigen::VectorXd::Zero(2 * d);
    pulls[0] = 0.6 / 0.36;
    pulls[d] = -0.3 / 0.36;
    EXPECT_GT(merit(problem, pulls).largest(), 0.1);
    for (const Method method : {Method::automatic, Method::gauss_seidel, Method::interior_point}) {
      Options options;
      options.method = method;
      const Solution solution = solve(problem, options);
      EXPECT_EQ(solution.status, Status::solved) << to_string(method);
      EXPECT_NEAR(solution.reactions[0], 1.0, 1e-9);
      EXPECT_NEAR(solution.velocities[d], 0.3, 1e-9);
    }
  }
}

TEST(Problem, without_contacts_is_solved) {
  const Solution solution =
      solve({3, Eigen::MatrixXd(0, 0), Eigen::VectorXd(0), Eigen::VectorXd(0)});
  EXPECT_EQ(solution.status, Status::solved);
  EXPECT_EQ(solution.merit.largest(), 0.0);
}

TEST(Problem, has_the_same_scaled_merit_in_other_units) {
  std::mt19937 random(1);
  Problem problem = random_problem(3, 5, 9, 1.0, random);
  const Eigen::VectorXd r = Eigen::VectorXd::LinSpaced(15, -1.0, 1.0);
  const double before = merit(problem, r).scaled;
  // Change of units to millimetres and kilonewtons.
  std::get<Eigen::MatrixXd>(problem.delassus) *= 1e6;
  problem.q *= 1e3;
  const double after = merit(problem, r * 1e-3).scaled;
  // At most five hundred roundings.
  EXPECT_NEAR(before, after, 1e-13);
  EXPECT_GT(before, 0.01);
}

TEST(Problem, refuses_what_does_not_fit) {
  Problem problem = one_contact({-1.0, 0.0, 0.0}, 0.5);
  problem.mu[0] = -0.1;
  EXPECT_THROW(solve(problem), kernel::OutOfRange);
  problem.mu[0] = 0.5;
  problem.q[1] = std::nan("");
  EXPECT_THROW(solve(problem), kernel::OutOfRange);
  problem.q = Eigen::VectorXd::Zero(4);
  EXPECT_THROW(solve(problem), kernel::OutOfRange);
  problem = one_contact({-1.0, 0.0, 0.0}, 0.5);
  problem.dimension = 4;
  EXPECT_THROW(solve(problem), kernel::OutOfRange);
  problem = one_contact({-1.0, 0.0, 0.0}, 0.5);
  std::get<Eigen::MatrixXd>(problem.delassus)(2, 0) = HUGE_VAL;
  EXPECT_THROW(solve(problem), kernel::OutOfRange);
}

TEST(Problem, without_a_solution_is_said_to_be_not_converged) {
  // q presses the contact together, but no force moves it (W = 0), so there is no solution.
  for (const int dimension : {2, 3}) {
    const Solution solution =
        solve({dimension, Eigen::MatrixXd(Eigen::MatrixXd::Zero(dimension, dimension)),
               -Eigen::VectorXd::Unit(dimension, 0), Eigen::VectorXd::Constant(1, 0.5)});
    EXPECT_EQ(solution.status, Status::not_converged);
    EXPECT_GT(solution.merit.largest(), 1e-3);
    // All available methods were tried.
    EXPECT_GT(solution.iterations.interior_point, 0);
    EXPECT_EQ(solution.iterations.pivots > 0, dimension == 2);
  }
}

TEST(Problem, dense_and_sparse_agree) {
  std::mt19937 random(2);
  Problem problem = random_problem(3, 12, 60, 0.8, random);
  const Solution dense = solve(problem);
  problem.delassus =
      Eigen::SparseMatrix<double>(std::get<Eigen::MatrixXd>(problem.delassus).sparseView());
  const Solution sparse = solve(problem);
  ASSERT_EQ(dense.status, Status::solved);
  ASSERT_EQ(sparse.status, Status::solved);
  EXPECT_LT((dense.velocities - sparse.velocities).norm(), 1e-8 * problem.q.norm());
}

TEST(Random, problems_of_any_rank_are_solved) {
  std::mt19937 random(3);
  for (const int dimension : {2, 3}) {
    for (const int contacts : {1, 2, 5, 20}) {
      for (const double share : {0.4, 0.9, 2.0}) {
        const int freedoms = std::max(1, static_cast<int>(share * contacts * dimension));
        const Problem problem = random_problem(dimension, contacts, freedoms, 1.0, random);
        const Solution solution = solve(problem);
        EXPECT_EQ(solution.status, Status::solved)
            << dimension << "-D, " << contacts << " contacts, " << freedoms << " freedoms, merit "
            << solution.merit.largest();
        EXPECT_LE(merit(problem, solution.reactions).largest(), 1e-10);
      }
    }
  }
}

}  // namespace
}  // namespace statejump::complementarity
