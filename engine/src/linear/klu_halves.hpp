// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <klu.h>

#include <cstddef>
#include <vector>

namespace statejump::linear {

/// Order of the columns of a large matrix in two halves that share no row, and then what separates
/// them: of a ring two cross-sections. Neither half's factors depend on the other's, so that two
/// threads work at once where KLU has one; what each adds up in which order depends on the matrix
/// alone, not on the number of threads.
struct HalvedOrder {
  int second = 0;     ///< Where the second half begins among the pivots.
  int separator = 0;  ///< Where the separator begins; 0: the matrix is not cut.

  bool is_cut() const { return separator > 0; }

  /// Columns below which a factorization takes less than some ten times as long as starting a
  /// thread.
  static constexpr int least_columns = 10000;
};

/// Orders a block for KLU (`user_order`): in two halves, each by COLAMD, if it is large and its
/// separator narrow. @param common whose `user_data` is a HalvedOrder that is told of the cut
int order_in_halves(int size, int* columns, int* rows, int* order, klu_common* common);

/// A column of L or U as KLU keeps it: first the rows, then the entries.
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

/// Makes and uses factors of a matrix that was ordered in halves, by the formulas and in the
/// storage of KLU (T. A. Davis, E. Palamadai Natarajan, ACM Trans. Math. Softw. 37 (2010) 36):
/// refactor() gives what klu_refactor() gives, to the last bit.
class HalvedFactors {
 public:
  /// Looks at factors that klu_factor() has made. Where pivots do not keep to the halves, or there
  /// are none, all is left to KLU.
  void begin(klu_numeric& numeric, const klu_symbolic& symbolic, const HalvedOrder& order);
  void end() { order_ = {}; }
  bool are_halved() const { return order_.is_cut(); }

  /// Factors a matrix of the same pattern with the pivots there are; false if one is 0.
  bool refactor(const int* columns, const int* rows, const double* values, klu_numeric& numeric,
                const klu_symbolic& symbolic);
  /// Solves for the right-hand side in x.
  void solve(klu_numeric& numeric, const klu_symbolic& symbolic, double* x) const;

 private:
  HalvedOrder order_;
  std::vector<double> row_size_;  // the largest entry of every row
  std::vector<double> work_;      // of the second half; KLU has one itself
};

}  // namespace statejump::linear
