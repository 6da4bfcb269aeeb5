// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <memory>

namespace statejump::linear {

/// Compressed sparse matrix that is kept elsewhere.
using SparseView = Eigen::Map<const Eigen::SparseMatrix<double>>;

/// LU factors of a sparse square matrix whose stored entries never change. One source file per
/// library: KLU where SuiteSparse is installed, else Eigen's SparseLU. (CHOLMOD factorises
/// symmetric matrices only; Coulomb slip is not symmetric.) The result does not depend on the
/// number of threads: large matrices are cut in two halves whatever there are, see HalvedOrder.
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
  /// @param most_growth how far rows may be multiplied before they are taken from others where the
  /// pivots of the last matrix are kept, which takes a fraction of the time of new ones
  bool factorize(const Eigen::Ref<const Eigen::SparseMatrix<double>>& matrix,
                 double most_growth = stable_growth);
  /// Takes the order of another one, of a matrix of the same pattern, if it has one that can be
  /// shared.
  void order_like(const SparseFactor& other);
  /// Lets go of the factors, not of the order: the next ones take no longer than new pivots do.
  void release();
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
  /// As far as KLU itself lets a pivot do.
  static constexpr double stable_growth = 1e3;
  /// For who refines what he solves: half of the digits are left.
  static constexpr double refined_growth = 6.7e7;

 private:
  struct Factors;
  std::unique_ptr<Factors> factors_;
};

}  // namespace statejump::linear
