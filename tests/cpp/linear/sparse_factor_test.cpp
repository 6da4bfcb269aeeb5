// SPDX-License-Identifier: GPL-3.0-or-later
#include "linear/sparse_factor.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <string>

namespace statejump::linear {
namespace {

Eigen::SparseMatrix<double> sparse(const Eigen::MatrixXd& dense) {
  return dense.sparseView();
}

TEST(SparseFactor, SolvesWhatItFactors) {
  Eigen::Matrix3d dense;
  dense << 0.0, 2.0, 1.0, 3.0, 0.0, 0.5, 1.0, 1.0, 0.0;
  SparseFactor factor;
  ASSERT_TRUE(factor.factorize(sparse(dense)));
  const Eigen::Vector3d right(1.0, -2.0, 0.25);
  // The condition number is 4, so the errors are a few ulps.
  EXPECT_LT((dense * factor.solve(right) - right).norm(), 1e-14);
}

TEST(SparseFactor, FactorsAnEmptyMatrix) {
  SparseFactor factor;
  ASSERT_TRUE(factor.factorize(Eigen::SparseMatrix<double>(0, 0)));
  EXPECT_EQ(factor.solve(Eigen::VectorXd(0)).size(), 0);
  EXPECT_EQ(factor.determinant_sign(), 1);
  EXPECT_EQ(factor.solutions_per_factorization(), 1.0);
}

TEST(SparseFactor, NamesAMatrixThatIsSingularToRounding) {
  // The third row is twice the second minus the first. No entry is a binary fraction, so
  // elimination gives a pivot of 1e-17 instead of zero.
  Eigen::Matrix3d dense;
  dense << 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9;
  SparseFactor factor;
  EXPECT_FALSE(factor.factorize(sparse(dense)));
  // Chain of springs without a support, hence singular. One stiffness is a sum of rounded thirds.
  const double k = 1.0 / 3.0;
  dense << k, -k, 0.0, -k, k + 0.7, -0.7, 0.0, -0.7, 0.7;
  SparseFactor chain;
  EXPECT_FALSE(chain.factorize(sparse(dense)));
}

TEST(SparseFactor, TellsTheSignOfTheDeterminant) {
  // A matrix of blocks for which KLU finds a block triangular form, tested with all permutations of
  // its rows.
  Eigen::Matrix4d dense;
  dense << 2.0, 1.0, 0.3, 0.0, 1.0, -3.0, 0.0, 0.2, 0.0, 0.0, 0.5, 4.0, 0.0, 0.0, 1.0, 0.25;
  std::array<int, 4> order{0, 1, 2, 3};
  do {
    Eigen::Matrix4d rows;
    for (int i = 0; i < 4; ++i) rows.row(i) = dense.row(order[static_cast<std::size_t>(i)]);
    SparseFactor factor;
    ASSERT_TRUE(factor.factorize(sparse(rows)));
    EXPECT_EQ(factor.determinant_sign(), rows.determinant() < 0.0 ? -1 : 1);
  } while (std::next_permutation(order.begin(), order.end()));
}

TEST(SparseFactor, ChoosesOtherPivotsWhereThoseOfTheLastMatrixDoNotServe) {
  // All three matrices have the same pattern. The first one has its pivots on the diagonal. In the
  // second, the diagonal is 1e-14 of the other entries and would leave two correct digits. In the
  // third, the diagonal is zero.
  Eigen::Matrix3d dense;
  dense << 4.0, 1.0, 0.5, 1.0, 5.0, 1.0, 0.25, 1.0, 3.0;
  SparseFactor factor;
  ASSERT_TRUE(factor.factorize(sparse(dense)));
  const Eigen::Vector3d right(1.0, -2.0, 0.25);
  for (const double small : {1e-14, 0.0}) {
    const Eigen::SparseMatrix<double> pattern = sparse(dense);
    Eigen::SparseMatrix<double> next = pattern;
    next.coeffRef(0, 0) = small;
    next.coeffRef(1, 1) = small;
    next.coeffRef(2, 2) = small;
    ASSERT_TRUE(factor.factorize(next));
    EXPECT_LT((next * factor.solve(right) - right).norm(), 1e-14);
    EXPECT_EQ(factor.determinant_sign(), Eigen::Matrix3d(next).determinant() < 0.0 ? -1 : 1);
    // Return to the first matrix.
    ASSERT_TRUE(factor.factorize(pattern));
    EXPECT_LT((dense * factor.solve(right) - right).norm(), 1e-14);
  }
  // A singular matrix is reported, and the next one is solved.
  Eigen::SparseMatrix<double> singular = sparse(dense);
  for (int column = 0; column < 3; ++column) {
    singular.coeffRef(2, column) = 2.0 * singular.coeff(0, column);
  }
  EXPECT_FALSE(factor.factorize(singular));
  ASSERT_TRUE(factor.factorize(sparse(dense)));
  EXPECT_LT((dense * factor.solve(right) - right).norm(), 1e-14);
}

TEST(SparseFactor, KeepsPivotsThatLeaveHalfOfTheDigitsForWhoRefines) {
  Eigen::Matrix3d dense;
  dense << 4.0, 1.0, 0.5, 1.0, 5.0, 1.0, 0.25, 1.0, 3.0;
  SparseFactor factor;
  ASSERT_TRUE(factor.factorize(sparse(dense)));
  // In the next matrix the reused first pivot is only 1/30,000 of the other entries.
  Eigen::SparseMatrix<double> next = sparse(dense);
  next.coeffRef(0, 0) = 1.0 / 30000.0;
  const Eigen::Vector3d right(1.0, -2.0, 0.25);
  ASSERT_TRUE(factor.factorize(next, SparseFactor::refined_growth));
  Eigen::Vector3d found = factor.solve(right);
  if (std::string(SparseFactor::library()) == "KLU") {
    // Rounding errors grow by 30,000 to 7e-12; with new pivots they would be 1e-16.
    EXPECT_GT((next * found - right).norm(), 1e-14);
  }
  EXPECT_LT((next * found - right).norm(), 1e-11);
  EXPECT_EQ(factor.determinant_sign(), Eigen::Matrix3d(next).determinant() < 0.0 ? -1 : 1);
  found -= factor.solve(next * found - right);
  EXPECT_LT((next * found - right).norm(), 1e-15);
  // With such pivots this matrix is singular to working accuracy, so it must be reported as
  // singular.
  Eigen::SparseMatrix<double> singular = next;
  for (int column = 0; column < 3; ++column) {
    singular.coeffRef(2, column) = 0.7 * next.coeff(0, column) + 0.3 * next.coeff(1, column);
  }
  EXPECT_FALSE(factor.factorize(singular, SparseFactor::refined_growth));
  ASSERT_TRUE(factor.factorize(next));
  EXPECT_LT((next * factor.solve(right) - right).norm(), 1e-15);
}

TEST(SparseFactor, SharesItsOrderAndLetsGoOfItsFactors) {
  Eigen::Matrix3d dense;
  dense << 0.0, 2.0, 1.0, 3.0, 0.0, 0.5, 1.0, 1.0, 0.0;
  const Eigen::Vector3d right(1.0, -2.0, 0.25);
  SparseFactor second;
  {
    SparseFactor first;
    ASSERT_TRUE(first.factorize(sparse(dense)));
    second.order_like(first);
  }
  for (int round = 0; round < 2; ++round) {
    ASSERT_TRUE(second.factorize(sparse(dense)));
    EXPECT_LT((dense * second.solve(right) - right).norm(), 1e-14);
    second.release();
  }
}

TEST(SparseFactor, TakesColumnsOfDifferentUnits) {
  // Rows of a stiff element in newtons and in metres: the smallest pivot is 1e-18 of the largest,
  // but regular.
  Eigen::Matrix2d dense;
  dense << 1e9, 1.0, 1.0, -1e-9;
  SparseFactor factor;
  ASSERT_TRUE(factor.factorize(sparse(dense)));
  const Eigen::Vector2d right(1.0, 1e-9);
  EXPECT_LT((dense * factor.solve(right) - right).norm(), 1e-15);
  // A soft mode of relative stiffness 1e-12, as in a long ring. Rounding leaves four correct
  // digits.
  dense << 1.0, 1.0, 1.0, 1.0 + 1e-12;
  SparseFactor soft;
  EXPECT_TRUE(soft.factorize(sparse(dense)));
}

}  // namespace
}  // namespace statejump::linear
