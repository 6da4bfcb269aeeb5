// SPDX-License-Identifier: GPL-3.0-or-later
#include "linear/klu_halves.hpp"

#include <gtest/gtest.h>

#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <random>
#include <vector>

#include "linear/sparse_factor.hpp"

namespace statejump::linear {
namespace {

using Matrix = Eigen::SparseMatrix<double>;

/// Matrix of a ring of nodes. The two unknowns of each node are coupled to those of both
/// neighbours. A multiplier constrains a combination of them, which gives zeros on the diagonal and
/// entries of order 1e7 and 1.
Matrix ring(int nodes, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> entry(0.5, 1.5);
  std::vector<Eigen::Triplet<double>> entries;
  for (int node = 0; node < nodes; ++node) {
    const int next = (node + 1) % nodes;
    for (int i = 0; i < 2; ++i) {
      const int row = 3 * node + i;
      for (int j = 0; j < 2; ++j) {
        entries.emplace_back(row, 3 * node + j, 1e7 * entry(random) * (i == j ? 4.0 : 1.0));
        entries.emplace_back(row, 3 * next + j, -1e7 * entry(random));
        entries.emplace_back(3 * next + i, 3 * node + j, -1e7 * entry(random));
      }
      entries.emplace_back(row, 3 * node + 2, entry(random));
      entries.emplace_back(3 * node + 2, row, entry(random));
    }
  }
  Matrix made(3 * nodes, 3 * nodes);
  made.setFromTriplets(entries.begin(), entries.end());
  return made;
}

/// KLU factorization of a matrix, ordered in halves.
struct Klu {
  explicit Klu(Matrix matrix) : of(std::move(matrix)) {
    klu_defaults(&common);
    common.ordering = 3;
    common.user_order = order_in_halves;
    common.user_data = &order;
    symbolic = klu_analyze(size(), columns(), rows(), &common);
    numeric = klu_factor(columns(), rows(), of.valuePtr(), symbolic, &common);
  }
  ~Klu() {
    klu_free_numeric(&numeric, &common);
    klu_free_symbolic(&symbolic, &common);
  }
  Klu(const Klu&) = delete;
  Klu& operator=(const Klu&) = delete;

  int size() const { return static_cast<int>(of.rows()); }
  int* columns() { return of.outerIndexPtr(); }
  int* rows() { return of.innerIndexPtr(); }
  /// All entries of the factors, column by column, followed by KLU's row scaling.
  std::vector<double> all() {
    const auto entries = static_cast<std::size_t>(numeric->lnz + numeric->unz);
    std::vector<int> begins(2 * index(size() + 1)), rows_of(entries);
    std::vector<double> found(entries + index(size()));
    double* upper = found.data() + numeric->lnz;
    EXPECT_TRUE(klu_extract(numeric, symbolic, begins.data(), rows_of.data(), found.data(),
                            begins.data() + size() + 1, rows_of.data() + numeric->lnz, upper,
                            nullptr, nullptr, nullptr, nullptr, nullptr, upper + numeric->unz,
                            nullptr, &common));
    return found;
  }
  static std::size_t index(int i) { return static_cast<std::size_t>(i); }

  Matrix of;
  klu_common common{};
  HalvedOrder order;
  klu_symbolic* symbolic = nullptr;
  klu_numeric* numeric = nullptr;
};

TEST(KluHalves, ARingIsCutAtTwoPlaces) {
  Klu made(ring(5000, 1));
  ASSERT_EQ(made.symbolic->nblocks, 1);
  ASSERT_TRUE(made.order.is_cut());
  EXPECT_EQ(made.order.second, made.size() / 2);
  // Each node is coupled to both neighbours. The separator therefore has two nodes at each cut of
  // the ring, plus the node that is cut.
  EXPECT_LE(made.size() - made.order.separator, 2 * 3 * 3);
  HalvedFactors halves;
  halves.begin(*made.numeric, *made.symbolic, made.order);
  EXPECT_TRUE(halves.are_halved());
  // If pivots are not confined to the halves, the order is wrong, and begin() must detect it.
  HalvedOrder wrong = made.order;
  wrong.second += 3;
  halves.begin(*made.numeric, *made.symbolic, wrong);
  EXPECT_FALSE(halves.are_halved());
}

TEST(KluHalves, FactorsAreThoseOfKluToTheLastBit) {
  Klu by_klu(ring(5000, 1));
  Klu in_halves(ring(5000, 1));
  HalvedFactors halves;
  halves.begin(*in_halves.numeric, *in_halves.symbolic, in_halves.order);
  ASSERT_TRUE(halves.are_halved());
  Matrix next = ring(5000, 2);
  ASSERT_NE(Klu(next).all(), by_klu.all());
  ASSERT_TRUE(klu_refactor(by_klu.columns(), by_klu.rows(), next.valuePtr(), by_klu.symbolic,
                           by_klu.numeric, &by_klu.common));
  ASSERT_TRUE(halves.refactor(next.outerIndexPtr(), next.innerIndexPtr(), next.valuePtr(),
                              *in_halves.numeric, *in_halves.symbolic));
  EXPECT_EQ(in_halves.all(), by_klu.all());

  // Both solutions are equal except for the order in which the halves are added to the separator.
  const Eigen::VectorXd right = Eigen::VectorXd::LinSpaced(next.rows(), -1.0, 2.0);
  Eigen::VectorXd one = right, other = right;
  klu_solve(by_klu.symbolic, by_klu.numeric, by_klu.size(), 1, one.data(), &by_klu.common);
  halves.solve(*in_halves.numeric, *in_halves.symbolic, other.data());
  EXPECT_LT((one - other).lpNorm<Eigen::Infinity>(), 1e-12 * one.lpNorm<Eigen::Infinity>());
}

TEST(KluHalves, APivotOfZeroIsTold) {
  Klu made(ring(5000, 1));
  HalvedFactors halves;
  halves.begin(*made.numeric, *made.symbolic, made.order);
  for (const int column : {0, made.size() / 2, made.size() - 1}) {
    Matrix singular = ring(5000, 2);
    for (Matrix::InnerIterator it(singular, made.symbolic->Q[column]); it; ++it)
      it.valueRef() = 0.0;
    EXPECT_FALSE(halves.refactor(singular.outerIndexPtr(), singular.innerIndexPtr(),
                                 singular.valuePtr(), *made.numeric, *made.symbolic))
        << column;
  }
}

TEST(KluHalves, WhatHangsTogetherEverywhereIsNotCut) {
  // Every fortieth node also depends on a remote node, so no narrow separator exists.
  Matrix matrix = ring(4000, 1);
  std::vector<Eigen::Triplet<double>> more;
  std::mt19937 random(3);
  std::uniform_int_distribution<int> far(0, 3999);
  for (int node = 0; node < 4000; node += 40) more.emplace_back(3 * node, 3 * far(random), 1e3);
  Matrix tangled(matrix.rows(), matrix.cols());
  tangled.setFromTriplets(more.begin(), more.end());
  const Klu made(matrix + tangled);
  EXPECT_FALSE(made.order.is_cut());
  ASSERT_NE(made.numeric, nullptr);
}

TEST(SparseFactor, LargeMatricesAreSolvedAsWell) {
  SparseFactor factor;
  for (const unsigned seed : {1u, 2u, 3u}) {
    const Matrix matrix = ring(5000, seed);
    ASSERT_TRUE(factor.factorize(matrix));
    const Eigen::VectorXd right = Eigen::VectorXd::LinSpaced(matrix.rows(), -1.0, 2.0);
    const Eigen::VectorXd solution = factor.solve(right);
    const Eigen::VectorXd left = matrix * solution - right;
    const Eigen::VectorXd added = matrix.cwiseAbs() * solution.cwiseAbs() + right.cwiseAbs();
    // Allowed backward error: rounding of six to eight entries per row, times the growth that
    // reused pivots may cause.
    const double rounding = 8.0 * SparseFactor::stable_growth * 1.1e-16;
    EXPECT_LT((left.array() / added.array()).abs().maxCoeff(), rounding);
  }
}

}  // namespace
}  // namespace statejump::linear
