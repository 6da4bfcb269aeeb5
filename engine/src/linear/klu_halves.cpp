// SPDX-License-Identifier: GPL-3.0-or-later
#include "klu_halves.hpp"

#include <Eigen/OrderingMethods>
#include <Eigen/SparseCore>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <utility>

#include "numerics/lists.hpp"
#include "parallel.hpp"

namespace statejump::linear {

namespace {

/// The separator has at most one column per this many columns of the matrix. Its long columns wait
/// for both halves.
constexpr int columns_of_one = 1000;

std::size_t index(int i) {
  return static_cast<std::size_t>(i);
}

enum ColumnSet : unsigned char { first_half, second_half, separator };

/// Assigns every column to a set. A column of the second half that shares a row with the first half
/// belongs to the separator.
std::vector<ColumnSet> cut(int size, const int* columns, const int* rows) {
  const numerics::Lists rows_of({columns, columns + size + 1}, {rows, rows + columns[size]});
  const numerics::Lists columns_of = rows_of.inverted(index(size));
  const std::vector<int> order = numerics::breadth_first(rows_of, columns_of);
  std::vector<ColumnSet> part(index(size), second_half);
  for (int k = 0; k < size / 2; ++k) part[index(order[index(k)])] = first_half;
  const auto of_first = [&](int column) { return part[index(column)] == first_half; };
  for (std::size_t row = 0; row < columns_of.size(); ++row) {
    const int* begin = columns_of.begin(row);
    const int* end = columns_of.end(row);
    if (std::none_of(begin, end, of_first)) continue;
    for (const int* column = begin; column != end; ++column) {
      if (!of_first(*column)) part[index(*column)] = separator;
    }
  }
  return part;
}

/// Appends these columns to an order, by COLAMD.
int* order_columns(const std::vector<int>& which, int size, const int* columns, const int* rows,
                   int* order) {
  const auto count = static_cast<int>(which.size());
  if (count == 0) return order;
  Eigen::SparseMatrix<double> piece(size, count);
  int* begins = piece.outerIndexPtr();
  for (int k = 0; k < count; ++k) {
    const int column = which[index(k)];
    begins[k + 1] = begins[k] + columns[column + 1] - columns[column];
  }
  piece.resizeNonZeros(begins[count]);
  for (int k = 0; k < count; ++k) {
    const int column = which[index(k)];
    std::copy(rows + columns[column], rows + columns[column + 1],
              piece.innerIndexPtr() + begins[k]);
  }
  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> places;
  Eigen::COLAMDOrdering<int>()(piece, places);
  for (int k = 0; k < count; ++k) order[places.indices()[k]] = which[index(k)];
  return order + count;
}

/// The factors of a matrix with one block.
struct Factored {
  explicit Factored(klu_numeric& of)
      : numeric(of),
        units(static_cast<double*>(of.LUbx[0])),
        pivots(static_cast<double*>(of.Udiag)) {}

  FactorColumn lower(int k) const { return {units, numeric.Lip, numeric.Llen, k}; }
  FactorColumn upper(int k) const { return {units, numeric.Uip, numeric.Ulen, k}; }

  klu_numeric& numeric;
  double* units;
  double* pivots;
};

}  // namespace

int order_in_halves(int size, int* columns, int* rows, int* order, klu_common* common) {
  auto& halved = *static_cast<HalvedOrder*>(common->user_data);
  halved = {};
  std::array<std::vector<int>, 3> parts;
  if (size >= HalvedOrder::least_columns) {
    const std::vector<ColumnSet> part = cut(size, columns, rows);
    for (int k = 0; k < size; ++k) parts[part[index(k)]].push_back(k);
  }
  const bool is_narrow = parts[separator].size() * columns_of_one <= index(size);
  if (size < HalvedOrder::least_columns || !is_narrow || parts[second_half].empty()) {
    parts = {};
    parts[first_half].resize(index(size));
    std::iota(parts[first_half].begin(), parts[first_half].end(), 0);
  } else {
    halved.second = static_cast<int>(parts[first_half].size());
    halved.separator = halved.second + static_cast<int>(parts[second_half].size());
  }
  for (const std::vector<int>& part : parts) {
    order = order_columns(part, size, columns, rows, order);
  }
  return -1;  // the number of entries of the factors is unknown
}

void HalvedFactors::begin(klu_numeric& numeric, const klu_symbolic& symbolic,
                          const HalvedOrder& order) {
  order_ = symbolic.nblocks == 1 ? order : HalvedOrder{};
  if (!order_.is_cut()) return;
  const Factored of(numeric);
  const auto keeps = [](const FactorColumn& column, auto&& is_own) {
    return std::all_of(column.rows, column.rows + column.length, is_own);
  };
  std::array<bool, 2> own{true, true};
  in_parallel(2, [&](std::size_t half) {
    const int begin = half == 0 ? 0 : order_.second;
    const int end = half == 0 ? order_.second : order_.separator;
    const auto is_own = [&](int k) { return (k >= begin && k < end) || k >= order_.separator; };
    for (int k = begin; k < end && own[half]; ++k) {
      own[half] = keeps(of.lower(k), is_own) && keeps(of.upper(k), is_own);
    }
  });
  if (!own[0] || !own[1]) order_ = {};
}

bool HalvedFactors::refactor(const int* columns, const int* rows, const double* values,
                             klu_numeric& numeric, const klu_symbolic& symbolic) {
  const int n = symbolic.n;
  const std::size_t length = index(n);
  row_size_.assign(length, 0.0);
  work_.assign(length, 0.0);
  // Largest entry of each row: one thread per half of the columns.
  in_parallel(2, [&](std::size_t half) {
    double* largest = half == 0 ? row_size_.data() : work_.data();
    const int middle = columns[n / 2];
    for (int p = half == 0 ? 0 : middle; p < (half == 0 ? middle : columns[n]); ++p) {
      largest[rows[p]] = std::max(largest[rows[p]], std::abs(values[p]));
    }
  });
  constexpr std::size_t rows_at_once = 100000;
  double* first_work = static_cast<double*>(numeric.Xwork);
  each_in_parallel(length, rows_at_once, [&](std::size_t i) {
    row_size_[i] = std::max(row_size_[i], work_[i]);
    if (row_size_[i] == 0.0) row_size_[i] = 1.0;
    work_[i] = 0.0;
    first_work[i] = 0.0;
  });
  each_in_parallel(length, rows_at_once,
                   [&](std::size_t k) { numeric.Rs[k] = row_size_[index(numeric.Pnum[k])]; });

  const Factored of(numeric);
  const auto factor_columns = [&](int begin, int end, double* x) {
    for (int k = begin; k < end; ++k) {
      const int column = symbolic.Q[k];
      for (int p = columns[column]; p < columns[column + 1]; ++p) {
        x[numeric.Pinv[rows[p]]] = values[p] / row_size_[index(rows[p])];
      }
      const FactorColumn upper = of.upper(k);
      for (int i = 0; i < upper.length; ++i) {
        const int j = upper.rows[i];
        const double by = x[j];
        x[j] = 0.0;
        upper.entries[i] = by;
        const FactorColumn lower = of.lower(j);
        for (int p = 0; p < lower.length; ++p) x[lower.rows[p]] -= lower.entries[p] * by;
      }
      const double pivot = x[k];
      x[k] = 0.0;
      if (pivot == 0.0) return false;
      of.pivots[k] = pivot;
      const FactorColumn lower = of.lower(k);
      for (int p = 0; p < lower.length; ++p) {
        lower.entries[p] = x[lower.rows[p]] / pivot;
        x[lower.rows[p]] = 0.0;
      }
    }
    return true;
  };
  std::array<bool, 2> made{};
  in_parallel(2, [&](std::size_t half) {
    made[half] = half == 0 ? factor_columns(0, order_.second, first_work)
                           : factor_columns(order_.second, order_.separator, work_.data());
  });
  return made[0] && made[1] && factor_columns(order_.separator, n, first_work);
}

void HalvedFactors::solve(klu_numeric& numeric, const klu_symbolic& symbolic, double* x) const {
  const int n = symbolic.n;
  const Factored of(numeric);
  double* y = static_cast<double*>(numeric.Xwork);
  const auto begin_of = [&](std::size_t half) { return half == 0 ? 0 : order_.second; };
  const auto end_of = [&](std::size_t half) {
    return half == 0 ? order_.second : order_.separator;
  };
  const auto load = [&](int begin, int end) {
    for (int k = begin; k < end; ++k) y[k] = x[numeric.Pnum[k]] / numeric.Rs[k];
  };
  const auto forward = [&](int k, double* to_separator) {
    const double by = y[k];
    const FactorColumn lower = of.lower(k);
    for (int p = 0; p < lower.length; ++p) {
      const int row = lower.rows[p];
      (row < order_.separator ? y[row] : to_separator[row - order_.separator]) -=
          lower.entries[p] * by;
    }
  };
  const auto backward = [&](int begin, int end) {
    for (int k = end - 1; k >= begin; --k) {
      const double by = y[k] /= of.pivots[k];
      const FactorColumn upper = of.upper(k);
      for (int p = 0; p < upper.length; ++p) y[upper.rows[p]] -= upper.entries[p] * by;
    }
  };
  std::array<std::vector<double>, 2> to_separator;
  in_parallel(2, [&](std::size_t half) {
    to_separator[half].assign(index(n - order_.separator), 0.0);
    load(begin_of(half), end_of(half));
    for (int k = begin_of(half); k < end_of(half); ++k) forward(k, to_separator[half].data());
  });
  load(order_.separator, n);
  double* of_separator = y + order_.separator;
  for (std::size_t i = 0; i < to_separator[0].size(); ++i) {
    of_separator[i] += to_separator[0][i] + to_separator[1][i];
  }
  for (int k = order_.separator; k < n; ++k) forward(k, of_separator);
  backward(order_.separator, n);
  in_parallel(2, [&](std::size_t half) {
    backward(begin_of(half), end_of(half));
    for (int k = begin_of(half); k < end_of(half); ++k) x[symbolic.Q[k]] = y[k];
  });
  for (int k = order_.separator; k < n; ++k) x[symbolic.Q[k]] = y[k];
}

}  // namespace statejump::linear
