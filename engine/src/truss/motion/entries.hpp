// SPDX-License-Identifier: GPL-3.0-or-later
// Entries of sparse matrices, and where they are.
#pragma once

#include <Eigen/SparseCore>
#include <algorithm>

namespace statejump::truss::detail {

/// Place of an entry among those of a compressed matrix.
inline Eigen::Index place(const Eigen::SparseMatrix<double>& matrix, Eigen::Index row,
                          Eigen::Index column) {
  const int* inner = matrix.innerIndexPtr();
  const int* first = inner + matrix.outerIndexPtr()[column];
  const int* last = inner + matrix.outerIndexPtr()[column + 1];
  return std::lower_bound(first, last, static_cast<int>(row)) - inner;
}

/// Calls `visit(row, column, value)` for the entries of a matrix that are among the first `size`
/// rows and columns.
template <class Matrix, class Visit>
void each_entry(const Matrix& matrix, Eigen::Index size, Visit&& visit) {
  for (Eigen::Index j = 0; j < size; ++j) {
    for (typename Matrix::InnerIterator it(matrix, j); it; ++it) {
      if (it.row() < size) visit(it.row(), j, it.value());
    }
  }
}

}  // namespace statejump::truss::detail
