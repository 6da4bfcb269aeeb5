// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <klu.h>

#include <cstddef>
#include <vector>

namespace statejump::linear {

/// Column order of a large matrix: two halves that share no row, then the separator between them
/// (for a ring-shaped truss two cross-sections). The factors of the halves are independent, so two
/// threads can compute them, unlike in KLU. The order of all sums depends only on the matrix, not
/// on the number of threads.
struct HalvedOrder {
  int second = 0;     ///< First pivot of the second half.
  int separator = 0;  ///< First pivot of the separator; 0: the matrix is not divided.

  bool is_cut() const { return separator > 0; }

  /// Matrices with fewer columns are not divided: factors take less than ten times the start of a
  /// thread.
  static constexpr int least_columns = 10000;
};

/// Orders a block for KLU (`user_order`). A large block with a narrow separator is divided into two
/// halves, each ordered by COLAMD.
/// @param common its `user_data` is a HalvedOrder that receives the result
int order_in_halves(int size, int* columns, int* rows, int* order, klu_common* common);

/// A column of L or U in KLU's storage, where the row indices precede the entries.
struct FactorColumn {
  int length;
  const int* rows;
  double* entries;

  FactorColumn(double* units, const int* begins, const int* lengths, int column)
      : length(lengths[column]) {
    double* begin = units + begins[column];
    rows = reinterpret_cast<const int*>(begin);
    entries = begin + (static_cast<std::size_t>(length) * sizeof(int) + sizeof(double) - 1) /
                          sizeof(double);
  }
};

/// Factors of a matrix ordered in halves, with the formulas and the storage of KLU (T. A. Davis, E.
/// Palamadai Natarajan, ACM Trans. Math. Softw. 37 (2010) 36). refactor() and klu_refactor() give
/// identical results, bit for bit.
class HalvedFactors {
 public:
  /// Examines factors computed by klu_factor(). If a pivot leaves its half, or the order has no
  /// halves, only KLU is used from then on.
  void begin(klu_numeric& numeric, const klu_symbolic& symbolic, const HalvedOrder& order);
  void end() { order_ = {}; }
  bool are_halved() const { return order_.is_cut(); }

  /// Factors a matrix of the same pattern with the existing pivots; returns false if a pivot is 0.
  bool refactor(const int* columns, const int* rows, const double* values, klu_numeric& numeric,
                const klu_symbolic& symbolic);
  /// Solves for the right-hand side in x.
  void solve(klu_numeric& numeric, const klu_symbolic& symbolic, double* x) const;

 private:
  HalvedOrder order_;
  std::vector<double> row_size_;  // the largest entry of every row
  std::vector<double> work_;      // for the second half; KLU has its own
};

}  // namespace statejump::linear
