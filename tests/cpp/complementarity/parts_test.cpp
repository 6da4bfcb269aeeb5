// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the parts of the solver one by one. Together they hide each other's faults, because a
// method that fails is followed by another one.
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <utility>

#include "complementarity/block_system.hpp"
#include "complementarity/interior_point.hpp"
#include "complementarity/lemke.hpp"
#include "complementarity/newton.hpp"
#include "complementarity/one_contact.hpp"
#include "support.hpp"

namespace statejump::complementarity {
namespace {

using testing::random_problem;

Problem sparse_of(Problem problem) {
  problem.delassus =
      Eigen::SparseMatrix<double>(std::get<Eigen::MatrixXd>(problem.delassus).sparseView());
  return problem;
}

/// Matrix W of a scaled problem, computed column by column from products with unit vectors.
Eigen::MatrixXd whole(const ScaledProblem& problem) {
  const Eigen::Index size = problem.q().size();
  Eigen::MatrixXd w(size, size);
  for (Eigen::Index i = 0; i < size; ++i) w.col(i) = problem.times(Eigen::VectorXd::Unit(size, i));
  return w;
}

TEST(Parts, ScaledProblemIsTheProblemInOtherUnits) {
  std::mt19937 random(5);
  for (const int dimension : {2, 3}) {
    const Problem dense = random_problem(dimension, 4, 9, 2.0, random);
    for (const Problem& problem : {dense, sparse_of(dense)}) {
      const ScaledProblem scaled(problem);
      const Eigen::MatrixXd w = whole(scaled);
      const double unit = scaled.velocity_unit() / scaled.reaction_unit();
      EXPECT_LT((unit * w - std::get<Eigen::MatrixXd>(dense.delassus)).norm(), 1e-13 * unit * 12);
      EXPECT_LT((scaled.velocity_unit() * scaled.q() - dense.q).norm(), 1e-14 * dense.q.norm());
      for (Eigen::Index i = 0; i < scaled.contacts(); ++i) {
        const BlockMatrix& block = scaled.blocks()[static_cast<std::size_t>(i)];
        const Eigen::Index at = i * dimension;
        EXPECT_EQ(block.topLeftCorner(dimension, dimension), w.block(at, at, dimension, dimension));
        if (dimension == 2) {
          EXPECT_EQ(block.col(2), Block::Unit(2));
          EXPECT_EQ(block.row(2), Block::Unit(2).transpose());
        }
        const Block delta(0.3, -0.7, dimension == 3 ? 1.1 : 0.0);
        Eigen::VectorXd u = scaled.q();
        scaled.add_columns(i, delta, u);
        const Eigen::VectorXd added = w.middleCols(at, dimension) * delta.head(dimension);
        EXPECT_LT((u - scaled.q() - added).norm(), 1e-14 * (1.0 + added.norm()));
      }
    }
  }
}

TEST(Parts, BlockSystemSolvesItsEquations) {
  std::mt19937 random(6);
  std::normal_distribution<double> normal;
  for (const int dimension : {2, 3}) {
    const Problem dense = random_problem(dimension, 5, 20, 1.0, random);
    for (const Problem& problem : {dense, sparse_of(dense)}) {
      const ScaledProblem scaled(problem);
      const Eigen::MatrixXd w = whole(scaled);
      BlockRows rows;
      std::vector<Block> right;
      for (const Eigen::Index contact : {0, 2, 3}) {
        rows.contacts.push_back(contact);
        const auto block = [&] {
          BlockMatrix made = BlockMatrix::Identity();
          for (int i = 0; i < dimension; ++i) {
            for (int j = 0; j < dimension; ++j) made(i, j) += 0.3 * normal(random);
          }
          return made;
        };
        rows.a.push_back(block());
        rows.b.push_back(block());
        right.emplace_back(normal(random), normal(random), dimension == 3 ? normal(random) : 0.0);
      }
      const auto found = BlockSystem(scaled, rows).solve(right);
      ASSERT_TRUE(found.has_value());
      const Eigen::VectorXd u = w * *found;
      for (const Eigen::Index idle : {1, 4}) {
        EXPECT_EQ(found->segment(idle * dimension, dimension).norm(), 0.0);
      }
      for (std::size_t k = 0; k < rows.contacts.size(); ++k) {
        const Eigen::Index at = rows.contacts[k] * dimension;
        const Eigen::VectorXd left =
            rows.a[k].topLeftCorner(dimension, dimension) * u.segment(at, dimension) +
            rows.b[k].topLeftCorner(dimension, dimension) * found->segment(at, dimension);
        // These random systems have at most 15 unknowns and condition numbers up to a few thousand.
        EXPECT_LT((left - right[k].head(dimension)).norm(), 1e-11);
      }
    }
  }
}

TEST(Parts, ContactThatDoesNotApproachCarriesNothing) {
  // With a friction coefficient of 4, the coupling of W also permits a second solution: the contact
  // holds itself without load.
  BlockMatrix w = BlockMatrix::Identity() * 3.0;
  w(0, 1) = w(1, 0) = 1.0;
  for (const double apart : {0.0, 1e-3}) {
    for (const double sliding : {-1.0, 0.0, 1.0}) {
      Block r = Block::Ones();
      ASSERT_TRUE(solve_one_contact(w, Block(apart, sliding, 0.0), 4.0, 1e-12, r));
      EXPECT_EQ(r.norm(), 0.0) << apart << " " << sliding;
    }
  }
}

TEST(Parts, OneContactIsSolvedByItself) {
  // The random contacts are open, stuck or sliding. W has full rank, so the solution is exact to
  // rounding.
  std::mt19937 random(6);
  int held[3] = {0, 0, 0};
  for (int run = 0; run < 300; ++run) {
    Problem problem = random_problem(3, 1, 9, 1.5, random);
    problem.q *= std::pow(10.0, run % 7 - 3);  // reactions of various magnitudes
    const BlockMatrix w = std::get<Eigen::MatrixXd>(problem.delassus);
    Block r;
    ASSERT_TRUE(solve_one_contact(w, problem.q, problem.mu[0], 0.0, r));
    EXPECT_LT(merit(problem, r).largest(), 1e-13) << run;
    const bool sticks = (w * r + problem.q).norm() < 1e-12 * problem.q.norm();
    ++held[r[0] == 0.0 ? 0 : sticks ? 1 : 2];
  }
  for (const int count : held) EXPECT_GT(count, 20);
}

TEST(Parts, LemkeSolvesByItself) {
  std::mt19937 random(9);
  for (int run = 0; run < 40; ++run) {
    Problem problem = random_problem(2, 6, run % 2 == 0 ? 24 : 7, 1.0, random);
    const ScaledProblem scaled(problem);
    int pivots = 0;
    const auto reactions = lemke(scaled, 200, pivots);
    ASSERT_TRUE(reactions) << run;
    // Lemke's method makes about twenty pivots on a table with entries of order 1. Their condition
    // numbers multiply.
    EXPECT_LT(Iterate(scaled, *reactions).merit, 1e-9) << run;
    EXPECT_GT(pivots, 0);
    // Now all contacts separate even without friction: the reactions are zero and no pivot is
    // needed.
    for (Eigen::Index i = 0; i < 6; ++i) problem.q.segment<2>(2 * i) = Eigen::Vector2d::UnitX();
    pivots = 0;
    const auto none = lemke(ScaledProblem(problem), 200, pivots);
    ASSERT_TRUE(none);
    EXPECT_EQ(none->norm(), 0.0);
    EXPECT_EQ(pivots, 0);
  }
}

/// Merit that a single method reaches without help from other methods, and its number of steps.
struct Reached {
  double merit;
  int steps;
};

Reached by_interior_point(const ScaledProblem& problem, int most) {
  InteriorPoint path(problem);
  Reached best{std::numeric_limits<double>::infinity(), 0};
  while (best.steps < most && best.merit > 1e-6) {
    if (path.advance() == 0.0) break;
    ++best.steps;
    best.merit = std::min(best.merit, Iterate(problem, path.reactions()).merit);
  }
  return best;
}

TEST(Parts, InteriorPointConvergesByItself) {
  std::mt19937 random(7);
  // With a wrong search direction the method may still converge, but in more steps. The present
  // averages are 5.7, 7.6 and 9.5 steps; the limits are a third higher.
  for (const auto& [most_friction, usual] :
       {std::pair{0.0, 7.5}, std::pair{0.9, 10.0}, std::pair{4.0, 12.5}}) {
    int steps = 0;
    for (int run = 0; run < 20; ++run) {
      const int dimension = 2 + run % 2;
      const ScaledProblem problem(random_problem(dimension, 6, 24, most_friction, random));
      const Reached reached = by_interior_point(problem, 100);
      EXPECT_LE(reached.merit, 1e-6) << most_friction << " run " << run;
      steps += reached.steps;
    }
    EXPECT_LE(steps, 20 * usual) << most_friction;
  }
}

TEST(Parts, NewtonConvergesFromNearby) {
  std::mt19937 random(8);
  std::normal_distribution<double> normal;
  for (int run = 0; run < 20; ++run) {
    const Problem dense = random_problem(2 + run % 2, 6, 24, 1.0, random);
    const ScaledProblem problem(run % 4 < 2 ? dense : sparse_of(dense));
    InteriorPoint path(problem);
    for (int k = 0; k < 100 && Iterate(problem, path.reactions()).merit > 1e-4; ++k) {
      if (path.advance() == 0.0) break;
    }
    const Iterate from(problem, path.reactions());
    ASSERT_LE(from.merit, 1e-4) << run;
    int counted = 0;
    EXPECT_LE(newton(problem, from, 6, 1e-13, counted).merit, 1e-13) << run;
  }
}

}  // namespace
}  // namespace statejump::complementarity
