// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <memory>

namespace statejump::linear {

/// View of a compressed sparse matrix.
using SparseView = Eigen::Map<const Eigen::SparseMatrix<double>>;

/// LU factors of a sparse square matrix whose pattern never changes. One source file per library:
/// KLU if SuiteSparse is installed, else Eigen's SparseLU. (CHOLMOD factorises symmetric matrices
/// only; Coulomb slip is not symmetric.) The result does not depend on the number of threads: a
/// large matrix is always divided into two halves, see HalvedOrder.
class SparseFactor {
 public:
  SparseFactor();
  ~SparseFactor();
  SparseFactor(const SparseFactor&) = delete;
  SparseFactor& operator=(const SparseFactor&) = delete;

  /// Factors the matrix; the first call orders it. Returns false if the matrix is singular to
  /// rounding: if a pivot is not above singular_pivot times the largest entry of its column.
  ///
  /// Such a pivot is the rounding of a cancellation. klu_rcond(), the ratio of the smallest to the
  /// largest pivot, is no such test: columns in metres and in newtons differ by 1e-7 anyway.
  /// @param most_growth largest factor by which the last pivots may multiply a row. Within it the
  /// last pivots are kept, which takes a fraction of the time of new ones
  bool factorize(const Eigen::Ref<const Eigen::SparseMatrix<double>>& matrix,
                 double most_growth = stable_growth);
  /// Reuses the order of another factorization with the same pattern, if that order can be shared.
  void order_like(const SparseFactor& other);
  /// Frees the factors and keeps the order: the next factorisation takes no longer than one with
  /// new pivots.
  void release();
  /// Solution of the factored system.
  Eigen::VectorXd solve(const Eigen::VectorXd& right_side) const;
  /// Cost of a factorisation in units of a solution, estimated from the number of entries as if all
  /// columns and rows had equally many.
  double solutions_per_factorization() const;
  /// Sign of the determinant of the factored matrix, 1 or -1.
  int determinant_sign() const;
  /// "KLU" or "SparseLU".
  static const char* library();

  /// Pivot over the largest entry of its column [-]. In a dependent column, elimination leaves a
  /// few roundings of 1.1e-16.
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
