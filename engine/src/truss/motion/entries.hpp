// SPDX-License-Identifier: GPL-3.0-or-later
// Access to the entries of sparse matrices.
#pragma once

#include <Eigen/SparseCore>
#include <algorithm>

namespace statejump::truss::detail {

/// Index of an entry among the entries of a compressed matrix.
inline Eigen::Index place(const Eigen::SparseMatrix<double>& matrix, Eigen::Index row,
                          Eigen::Index column) {
  const int* inner = matrix.innerIndexPtr();
  const int* first = inner + matrix.outerIndexPtr()[column];
  const int* last = inner + matrix.outerIndexPtr()[column + 1];
  return std::lower_bound(first, last, static_cast<int>(row)) - inner;
}

/// Calls `visit(row, column, value)` for the entries in the first `size` rows and columns of a
/// matrix.
template <class Matrix, class Visit>
void each_entry(const Matrix& matrix, Eigen::Index size, Visit&& visit) {
  for (Eigen::Index j = 0; j < size; ++j) {
    for (typename Matrix::InnerIterator it(matrix, j); it; ++it) {
      if (it.row() < size) visit(it.row(), j, it.value());
    }
  }
}

}  // namespace statejump::truss::detail
