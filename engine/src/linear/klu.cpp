// SPDX-License-Identifier: GPL-3.0-or-later
#include <klu.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <vector>

#include "parallel.hpp"
#include "sparse_factor.hpp"

namespace statejump::linear {

namespace {

/// Columns that a thread takes at once.
constexpr std::size_t columns_at_once = 20000;

/// Whether a permutation is an odd one: a cycle of n takes n - 1 exchanges.
bool odd(const int* permutation, int size) {
  std::vector<bool> seen(static_cast<std::size_t>(size), false);
  bool is_odd = false;
  for (int start = 0; start < size; ++start) {
    for (int k = start; !seen[static_cast<std::size_t>(k)]; k = permutation[k]) {
      seen[static_cast<std::size_t>(k)] = true;
      if (k != start) is_odd = !is_odd;
    }
  }
  return is_odd;
}

}  // namespace

struct SparseFactor::Factors {
  Factors() {
    klu_defaults(&common);
    // Columns ordered by COLAMD, whose fill stays bounded when rows are exchanged: lines of joints
    // have zeros on the diagonal. AMD, the default, filled a ring of 100 joints ten times as much.
    common.ordering = 1;
  }
  ~Factors() {
    klu_free_numeric(&numeric, &common);
    klu_free_symbolic(&symbolic, &common);
  }
  Factors(const Factors&) = delete;
  Factors& operator=(const Factors&) = delete;

  /// New factors, their pivots chosen anew.
  bool choose_pivots(int* columns, int* rows, double* values) {
    klu_free_numeric(&numeric, &common);
    numeric = klu_factor(columns, rows, values, symbolic, &common);
    if (numeric == nullptr || common.status != KLU_OK) return false;
    pivot_of_row.resize(static_cast<std::size_t>(size));
    for (int k = 0; k < size; ++k) {
      pivot_of_row[static_cast<std::size_t>(numeric->Pnum[k])] = k;
    }
    odd_permutation = odd(numeric->Pnum, size) != odd(symbolic->Q, size);
    return true;
  }

  /// Whether every pivot is more than rounding of its column, within its diagonal block.
  bool has_pivots(const Eigen::SparseMatrix<double>& matrix) const {
    const double* pivots = static_cast<const double*>(numeric->Udiag);
    // KLU divides every row by its largest entry, in the order of the pivots.
    const double* row_size = numeric->Rs;
    std::atomic<bool> has = true;
    for (int block = 0; block < symbolic->nblocks; ++block) {
      const int first = symbolic->R[block];
      each_in_parallel(static_cast<std::size_t>(symbolic->R[block + 1] - first), columns_at_once,
                       [&](std::size_t in_block) {
                         const int k = first + static_cast<int>(in_block);
                         double largest = 0.0;
                         for (Eigen::SparseMatrix<double>::InnerIterator it(matrix, symbolic->Q[k]);
                              it; ++it) {
                           const int pivot = pivot_of_row[static_cast<std::size_t>(it.row())];
                           if (pivot < first) continue;
                           largest = std::max(largest, std::abs(it.value()) / row_size[pivot]);
                         }
                         if (!(std::abs(pivots[k]) > singular_pivot * largest)) has = false;
                       });
    }
    return has;
  }

  /// Factors a matrix of the same pattern with the pivots that the last one had, which takes a
  /// fraction of the time. Only where KLU could have chosen them itself: no entry of L is beyond
  /// what its tolerance lets it take for a pivot.
  bool keeps_pivots(int* columns, int* rows, double* values) {
    if (numeric == nullptr) return false;
    if (klu_refactor(columns, rows, values, symbolic, numeric, &common) == 0) return false;
    if (common.status != KLU_OK) return false;
    return lower_within(1.0 / common.tol);
  }

  /// Whether no entry of L is beyond a bound. They are read where KLU has them, of every column
  /// first the rows, then the entries: klu_extract() copies all of L.
  bool lower_within(double most) const {
    for (int block = 0; block < symbolic->nblocks; ++block) {
      if (symbolic->R[block + 1] - symbolic->R[block] < 2) continue;
      const double* units = static_cast<const double*>(numeric->LUbx[block]);
      for (int k = symbolic->R[block]; k < symbolic->R[block + 1]; ++k) {
        const auto length = static_cast<std::size_t>(numeric->Llen[k]);
        const std::size_t rows = (length * sizeof(int) + sizeof(double) - 1) / sizeof(double);
        const double* entries = units + numeric->Lip[k] + rows;
        if (!std::all_of(entries, entries + length,
                         [most](double entry) { return std::abs(entry) <= most; })) {
          return false;
        }
      }
    }
    return true;
  }

  // KLU's C interface allocates and frees these itself.
  klu_common common{};
  klu_symbolic* symbolic = nullptr;
  klu_numeric* numeric = nullptr;
  int size = 0;
  std::vector<int> pivot_of_row;
  bool odd_permutation = false;  ///< Of rows and columns together.
};

SparseFactor::SparseFactor() : factors_(std::make_unique<Factors>()) {}
SparseFactor::~SparseFactor() = default;

bool SparseFactor::factorize(const Eigen::SparseMatrix<double>& matrix) {
  Factors& f = *factors_;
  // KLU takes its arrays without const but writes to none of them.
  int* columns = const_cast<int*>(matrix.outerIndexPtr());
  int* rows = const_cast<int*>(matrix.innerIndexPtr());
  double* values = const_cast<double*>(matrix.valuePtr());
  f.size = static_cast<int>(matrix.rows());
  if (f.symbolic == nullptr) {
    f.symbolic = klu_analyze(f.size, columns, rows, &f.common);
    if (f.symbolic == nullptr) return false;
  }
  if (f.keeps_pivots(columns, rows, values) && f.has_pivots(matrix)) return true;
  return f.choose_pivots(columns, rows, values) && f.has_pivots(matrix);
}

Eigen::VectorXd SparseFactor::solve(const Eigen::VectorXd& right_side) const {
  Eigen::VectorXd result = right_side;
  klu_solve(factors_->symbolic, factors_->numeric, factors_->size, 1, result.data(),
            &factors_->common);
  return result;
}

double SparseFactor::solutions_per_factorization() const {
  const double lower = factors_->numeric->lnz;
  const double upper = factors_->numeric->unz;
  return lower * upper / factors_->size / (lower + upper);
}

int SparseFactor::determinant_sign() const {
  const Factors& f = *factors_;
  // Rows are divided by positive numbers; both permutations make the matrix block triangular.
  bool negative = f.odd_permutation;
  const double* pivots = static_cast<const double*>(f.numeric->Udiag);
  for (int k = 0; k < f.size; ++k) negative = negative != (pivots[k] < 0.0);
  return negative ? -1 : 1;
}

const char* SparseFactor::library() {
  return "KLU";
}

}  // namespace statejump::linear
