// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <memory>

namespace statejump::linear {

/// LU factors of a sparse square matrix whose pattern never changes. One source file per library:
/// KLU where SuiteSparse is installed, else Eigen's SparseLU. (CHOLMOD factorises symmetric
/// matrices only; Coulomb slip is not symmetric.) The result does not depend on a number of threads:
/// factors are made by one.
class SparseFactor {
 public:
  SparseFactor();
  ~SparseFactor();
  SparseFactor(const SparseFactor&) = delete;
  SparseFactor& operator=(const SparseFactor&) = delete;

  /// Factors the matrix; orders it at the first call. False if it is singular to rounding: if a
  /// pivot is not above singular_pivot times the largest entry that its column had.
  ///
  /// Such a pivot is what cancellation left of the column. The ratio of the smallest to the largest
  /// pivot, as klu_rcond() gives it, says less: columns of metres and of newtons lie 1e-7 apart.
  bool factorize(const Eigen::SparseMatrix<double>& matrix);
  /// Solution of the factored system.
  Eigen::VectorXd solve(const Eigen::VectorXd& right_side) const;
  /// Cost of a factorization in that of a solution: entries of the factors if all their columns and
  /// rows have as many.
  double solutions_per_factorization() const;
  /// Sign of the determinant of the factored matrix, 1 or -1.
  int determinant_sign() const;
  /// "KLU" or "SparseLU".
  static const char* library();

  /// Pivot over its column [-]: an elimination leaves a few roundings of 1.1e-16 of a column that
  /// depends on others.
  static constexpr double singular_pivot = 4.5e-16;

 private:
  struct Factors;
  std::unique_ptr<Factors> factors_;
};

}  // namespace statejump::linear
