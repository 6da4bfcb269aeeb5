// SPDX-License-Identifier: GPL-3.0-or-later
// find_active_set() on linear complementarity problems z >= 0, w = M z + q >= 0, z w = 0, which
// have exactly one solution if M is a P-matrix.
#include "active_set.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <random>
#include <utility>
#include <vector>

namespace statejump::truss::detail {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using Statuses = std::vector<bool>;  // true: z >= 0 and w = 0; false: z = 0

class Complementarity {
 public:
  using Changes = std::vector<std::pair<std::size_t, bool>>;

  Complementarity(MatrixXd m, VectorXd q)
      : m_(std::move(m)),
        q_(std::move(q)),
        solved_(static_cast<std::size_t>(q_.size())),
        next_(solved_) {
    solve();
  }

  const Statuses& key() const { return next_; }
  Changes violated() const {
    Changes found;
    for (std::size_t i = 0; i < solved_.size(); ++i) {
      const double held = solved_[i] ? z_[static_cast<Index>(i)] : w_[static_cast<Index>(i)];
      if (held < 0.0) found.emplace_back(i, !solved_[i]);
    }
    return found;
  }
  bool change(const Changes& changes, const PivotSearch<Statuses>& search) {
    (search.pivot() == Pivot::single ? singles : blocks) += 1;
    next_ = solved_;
    for (const auto& [i, status] : changes) next_[i] = status;
    return true;
  }
  bool solve() {
    solved_ = next_;
    MatrixXd matrix = MatrixXd::Identity(q_.size(), q_.size());
    VectorXd right = VectorXd::Zero(q_.size());
    for (Index i = 0; i < q_.size(); ++i) {
      if (!solved_[static_cast<std::size_t>(i)]) continue;
      matrix.row(i) = m_.row(i);
      right[i] = -q_[i];
    }
    z_ = matrix.fullPivLu().solve(right);
    w_ = m_ * z_ + q_;
    return true;
  }
  /// Largest violation of the inequalities and of complementarity.
  double violation() const {
    const double negative = std::max(-z_.minCoeff(), -w_.minCoeff());
    return std::max(negative, z_.cwiseProduct(w_).cwiseAbs().maxCoeff());
  }

  int blocks = 0;
  int singles = 0;

 private:
  MatrixXd m_;
  VectorXd q_;
  Statuses solved_, next_;
  VectorXd z_, w_;
};

class ActiveSet : public testing::TestWithParam<Blocks> {};

TEST_P(ActiveSet, SolvesProblemsWithAPMatrix) {
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  const auto draw = [&] { return normal(random); };
  int blocks = 0, singles = 0;
  for (int problem = 0; problem < 200; ++problem) {
    const Index n = 3 + problem % 6;
    const MatrixXd root = MatrixXd::NullaryExpr(n, n, draw);
    const MatrixXd skew = 3.0 * MatrixXd::NullaryExpr(n, n, draw);
    // A matrix with positive definite symmetric part is a P-matrix. For about a tenth of these
    // matrices block pivoting alone cycles, because their antisymmetric part dominates.
    const MatrixXd m = 0.1 * (root * root.transpose() + MatrixXd::Identity(n, n)) + skew -
                       MatrixXd(skew.transpose());
    Complementarity system(m, VectorXd::NullaryExpr(n, draw));
    ASSERT_TRUE(find_active_set(system, GetParam())) << "problem " << problem;
    // The matrices have entries of order 10 to 100 and condition numbers up to a few thousand.
    EXPECT_LT(system.violation(), 1e-9) << "problem " << problem;
    blocks += system.blocks;
    singles += system.singles;
  }
  EXPECT_GT(blocks, 200);
  EXPECT_GT(singles, 0);  // both types of pivots are tested
}

TEST_P(ActiveSet, EndsWhereNoStatusesSolveTheProblem) {
  // The problem w = -z - 1 has no solution: z = 0 makes w negative, w = 0 makes z negative.
  Complementarity system(MatrixXd::Constant(1, 1, -1.0), VectorXd::Constant(1, -1.0));
  EXPECT_FALSE(find_active_set(system, GetParam()));
}

TEST_P(ActiveSet, MakesNoMoreSinglePivotsThanAllowed) {
  Complementarity system(MatrixXd::Constant(1, 1, -1.0), VectorXd::Constant(1, -1.0));
  EXPECT_FALSE(find_active_set(system, GetParam(), 0));
  EXPECT_EQ(system.singles, 0);
}

INSTANTIATE_TEST_SUITE_P(Blocks, ActiveSet,
                         testing::Values(Blocks::while_fewer, Blocks::until_repeated,
                                         Blocks::until_ever_repeated),
                         [](const auto& tested) {
                           return tested.param == Blocks::while_fewer      ? "WhileFewer"
                                  : tested.param == Blocks::until_repeated ? "UntilRepeated"
                                                                           : "UntilEverRepeated";
                         });

}  // namespace
}  // namespace statejump::truss::detail
