// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <optional>
#include <vector>

#include "statejump/kernel/require.hpp"
#include "support.hpp"

namespace statejump::complementarity {
namespace {

using testing::random_problem;

/// Status of one contact in two dimensions.
enum class Guess { open, stick, slide_plus, slide_minus };

/// Reactions for the given statuses, if they satisfy all conditions. Uses no code of the solvers.
std::optional<Eigen::VectorXd> with_statuses(const Problem& problem,
                                             const std::vector<Guess>& guesses) {
  const Eigen::MatrixXd& w = std::get<Eigen::MatrixXd>(problem.delassus);
  const Eigen::Index size = problem.q.size();
  // The unknowns are (r, u). The equations are u - W r = q and two equations for each contact.
  Eigen::MatrixXd system = Eigen::MatrixXd::Zero(2 * size, 2 * size);
  Eigen::VectorXd right = Eigen::VectorXd::Zero(2 * size);
  system.topLeftCorner(size, size) = -w;
  system.topRightCorner(size, size).setIdentity();
  right.head(size) = problem.q;
  for (std::size_t k = 0; k < guesses.size(); ++k) {
    const Eigen::Index n = 2 * static_cast<Eigen::Index>(k);
    const double mu = problem.mu[static_cast<Eigen::Index>(k)];
    switch (guesses[k]) {
      case Guess::open:
        system(size + n, n) = 1.0;
        system(size + n + 1, n + 1) = 1.0;
        break;
      case Guess::stick:
        system(size + n, size + n) = 1.0;
        system(size + n + 1, size + n + 1) = 1.0;
        break;
      case Guess::slide_plus:
      case Guess::slide_minus:
        // Sliding along +t: the tangential reaction is -mu r_n.
        system(size + n, size + n) = 1.0;
        system(size + n + 1, n + 1) = 1.0;
        system(size + n + 1, n) = guesses[k] == Guess::slide_plus ? mu : -mu;
        break;
    }
  }
  const Eigen::FullPivLU<Eigen::MatrixXd> factors(system);
  if (!factors.isInvertible()) return {};
  const Eigen::VectorXd found = factors.solve(right);
  // Margin of the comparisons: far above rounding errors, far below the entries of order one.
  constexpr double margin = 1e-10;
  for (std::size_t k = 0; k < guesses.size(); ++k) {
    const Eigen::Index n = 2 * static_cast<Eigen::Index>(k);
    const double mu = problem.mu[static_cast<Eigen::Index>(k)];
    const double slide = found[size + n + 1];
    if (found[n] < -margin || found[size + n] < -margin) return {};
    if (std::abs(found[n + 1]) > mu * found[n] + margin) return {};
    if (guesses[k] == Guess::slide_plus && slide < -margin) return {};
    if (guesses[k] == Guess::slide_minus && slide > margin) return {};
  }
  return found.head(size);
}

/// Velocities u of all solutions of a problem with two contacts in two dimensions.
std::vector<Eigen::VectorXd> enumerated(const Problem& problem) {
  std::vector<Eigen::VectorXd> all;
  constexpr std::array guesses = {Guess::open, Guess::stick, Guess::slide_plus, Guess::slide_minus};
  for (const Guess first : guesses) {
    for (const Guess second : guesses) {
      if (const auto r = with_statuses(problem, {first, second})) {
        all.push_back(velocities(problem, *r));
      }
    }
  }
  return all;
}

TEST(TwoContacts, give_one_of_the_enumerated_solutions) {
  std::mt19937 random(4);
  int several = 0;
  for (int k = 0; k < 300; ++k) {
    const Problem problem = random_problem(2, 2, 4 + k % 3, 1.5, random);
    const std::vector<Eigen::VectorXd> all = enumerated(problem);
    ASSERT_FALSE(all.empty()) << "problem " << k;
    for (const Eigen::VectorXd& u : all) several += (u - all.front()).norm() > 1e-6;
    // Gauss-Seidel alone may cycle, so it is not tested here.
    for (const Method method : {Method::automatic, Method::lemke}) {
      Options options;
      options.method = method;
      const Solution solution = solve(problem, options);
      ASSERT_EQ(solution.status, Status::solved) << to_string(method) << ", problem " << k;
      double nearest = HUGE_VAL;
      for (const Eigen::VectorXd& u : all) {
        nearest = std::min(nearest, (u - solution.velocities).norm());
      }
      // Allowed error: merit tolerance 1e-10 times the condition number of W, which is below 1e5
      // here.
      EXPECT_LT(nearest, 1e-5 * problem.q.norm()) << to_string(method) << ", problem " << k;
    }
  }
  // With friction up to 1.5, some problems must have several solutions, which the enumeration must
  // find.
  EXPECT_GT(several, 0);
}

TEST(Newton, converges_where_gauss_seidel_has_begun) {
  std::mt19937 random(5);
  const Problem problem = random_problem(3, 20, 40, 0.5, random);
  Options options;
  options.method = Method::gauss_seidel;
  options.most_sweeps = 50;
  const Solution begun = solve(problem, options);
  options.method = Method::newton;
  options.guess = begun.reactions;
  const Solution solution = solve(problem, options);
  EXPECT_EQ(solution.status, Status::solved);
  EXPECT_LE(solution.iterations.newton, 10);
  EXPECT_EQ(solution.iterations.gauss_seidel, 0);
}

TEST(InteriorPoint, solves_from_a_cold_start) {
  std::mt19937 random(6);
  for (const double most_friction : {0.0, 0.3, 1.0}) {
    const Problem problem = random_problem(3, 15, 60, most_friction, random);
    Options options;
    options.method = Method::interior_point;
    // reached by the interior-point path alone, without final Newton steps
    options.tolerance = 1e-7;
    const Solution solution = solve(problem, options);
    EXPECT_EQ(solution.status, Status::solved)
        << "mu <= " << most_friction << ", merit " << solution.merit.largest();
    EXPECT_EQ(solution.method, Method::interior_point);
  }
}

TEST(InteriorPoint, goes_on_while_its_merit_falls) {
  // Forty contacts constrain as many dofs. The method updates lagged friction for up to fifty
  // steps. It needs 31 on average, and 50 without its safeguards against a stagnating residual.
  std::mt19937 random(10);
  Options options;
  options.method = Method::interior_point;
  int steps = 0;
  for (int run = 0; run < 24; ++run) {
    const Solution solution = solve(random_problem(3, 40, 40, 0.9, random), options);
    EXPECT_EQ(solution.status, Status::solved) << run;
    steps += solution.iterations.interior_point;
  }
  EXPECT_LE(steps, 24 * 40);
}

TEST(Lemke, is_for_the_plane) {
  std::mt19937 random(7);
  Options options;
  options.method = Method::lemke;
  EXPECT_THROW(solve(random_problem(3, 2, 6, 0.5, random), options), kernel::OutOfRange);
  for (const int freedoms : {3, 6, 20}) {
    const Solution solution = solve(random_problem(2, 8, freedoms, 1.0, random), options);
    EXPECT_EQ(solution.status, Status::solved) << freedoms << " freedoms";
    EXPECT_EQ(solution.iterations.interior_point, 0);
  }
}

TEST(Options, sweeps_that_are_too_few_leave_it_unsolved) {
  std::mt19937 random(8);
  Options options;
  options.method = Method::gauss_seidel;
  options.most_sweeps = 1;
  const Solution solution = solve(random_problem(3, 20, 30, 0.5, random), options);
  EXPECT_EQ(solution.status, Status::not_converged);
  EXPECT_EQ(solution.iterations.gauss_seidel, 1);
}

TEST(Options, progress_cancels) {
  std::mt19937 random(9);
  Options options;
  options.progress = [](double) { return false; };
  EXPECT_EQ(solve(random_problem(3, 20, 30, 0.5, random), options).status, Status::cancelled);
}

TEST(Options, out_of_range_are_refused) {
  std::mt19937 random(10);
  const Problem problem = random_problem(3, 2, 6, 0.5, random);
  Options options;
  options.tolerance = 0.0;
  EXPECT_THROW(solve(problem, options), kernel::OutOfRange);
  options = {};
  options.most_sweeps = -1;
  EXPECT_THROW(solve(problem, options), kernel::OutOfRange);
  options = {};
  options.guess = Eigen::VectorXd::Zero(5);
  EXPECT_THROW(solve(problem, options), kernel::OutOfRange);
  options.guess = Eigen::VectorXd::Constant(6, HUGE_VAL);
  EXPECT_THROW(solve(problem, options), kernel::OutOfRange);
}

}  // namespace
}  // namespace statejump::complementarity
