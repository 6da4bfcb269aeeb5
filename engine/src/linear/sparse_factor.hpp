// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <memory>

namespace statejump::linear {

/// View of a compressed sparse matrix.
using SparseView = Eigen::Map<const Eigen::SparseMatrix<double>>;

/// LU factors of a sparse square matrix whose pattern never changes. The implementation uses KLU if
/// SuiteSparse is installed, otherwise Eigen's SparseLU. (CHOLMOD factorises symmetric matrices
/// only; Coulomb slip is not symmetric.) The result does not depend on the number of threads: a
/// large matrix is always divided into two halves, see HalvedOrder.
class SparseFactor {
 public:
  SparseFactor();
  ~SparseFactor();
  SparseFactor(const SparseFactor&) = delete;
  SparseFactor& operator=(const SparseFactor&) = delete;

  /// Factors the matrix; the first call orders it. Returns false if the matrix is singular to
  /// rounding: that is, if a pivot does not exceed singular_pivot times the largest entry of its
  /// column.
  ///
  /// A smaller pivot is the rounding of a cancellation. klu_rcond(), the ratio of the smallest to
  /// the largest pivot, cannot replace this test, because columns in metres and in newtons differ
  /// by a factor of 1e-7 anyway.
  /// @param most_growth largest factor by which the last pivots may multiply a row. If no row
  /// exceeds it, the last pivots are kept, which takes a fraction of the time of new pivots
  bool factorize(const Eigen::Ref<const Eigen::SparseMatrix<double>>& matrix,
                 double most_growth = stable_growth);
  /// Reuses the order of `other`, which has the same pattern, if its order can be shared.
  void order_like(const SparseFactor& other);
  /// Frees the factors but keeps the order. The next factorisation therefore takes only as long as
  /// one with new pivots.
  void release();
  /// Solution of the factored system.
  Eigen::VectorXd solve(const Eigen::VectorXd& right_side) const;
  /// Cost of a factorisation divided by the cost of a solution. Estimated as if all columns and
  /// rows had equally many entries.
  double solutions_per_factorization() const;
  /// Sign of the determinant of the factored matrix, 1 or -1.
  int determinant_sign() const;
  /// "KLU" or "SparseLU".
  static const char* library();

  /// Ratio of pivot to largest entry of its column up to which the matrix is singular [-]. A
  /// dependent column leaves a few roundings of 1.1e-16.
  static constexpr double singular_pivot = 4.5e-16;
  /// The growth that KLU itself allows.
  static constexpr double stable_growth = 1e3;
  /// For callers that refine their solutions: half of the digits remain.
  static constexpr double refined_growth = 6.7e7;

 private:
  struct Factors;
  std::unique_ptr<Factors> factors_;
};

}  // namespace statejump::linear
