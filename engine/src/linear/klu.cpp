// SPDX-License-Identifier: GPL-3.0-or-later
#include <klu.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "klu_halves.hpp"
#include "numerics/raise.hpp"
#include "parallel.hpp"
#include "sparse_factor.hpp"

namespace statejump::linear {

namespace {

using numerics::raise;
using Matrix = Eigen::Ref<const Eigen::SparseMatrix<double>>;

/// Fill of L over the fill that AMD predicted, above which COLAMD is tried as well.
constexpr double exceeded_fill = 2.0;
/// Columns that a thread takes at once.
constexpr std::size_t columns_at_once = 20000;

/// Whether a permutation is odd: a cycle of length n is n - 1 transpositions.
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
    // Initial size of the factors over the entries of the matrix. The default of KLU is ten times
    // as much, gigabytes for a large truss. KLU enlarges the factors on demand.
    common.initmem = 1.0;
  }
  ~Factors() { klu_free_numeric(&numeric, &common); }
  Factors(const Factors&) = delete;
  Factors& operator=(const Factors&) = delete;

  /// Computes factors with new pivots.
  bool choose_pivots(int* columns, int* rows, double* values) {
    halves.end();
    klu_free_numeric(&numeric, &common);
    odd_permutation.reset();
    numeric = klu_factor(columns, rows, values, order->symbolic, &common);
    if (numeric == nullptr || common.status != KLU_OK) return false;
    halves.begin(*numeric, *order->symbolic, order->halves);
    return true;
  }

  /// Computes factors of a small matrix in the order of COLAMD, and keeps them if they have fewer
  /// entries. AMD's order fills far more than predicted if rows are exchanged for pivots.
  bool choose_order(double* values) {
    const std::shared_ptr<const Order> first = order;
    const double foreseen = first->symbolic->lnz;  // negative for COLAMD, which predicts no fill
    if (foreseen < 0.0 || numeric->lnz <= exceeded_fill * foreseen || settled == first) return true;
    const int filled = numeric->lnz + numeric->unz;
    order = std::make_shared<const Order>(size, *first->pattern, Ordering::colamd, common);
    const bool is_better = order->symbolic != nullptr &&
                           choose_pivots(order->columns(), order->rows(), values) &&
                           numeric->lnz + numeric->unz < filled;
    if (is_better) return true;
    order = settled = first;
    return choose_pivots(order->columns(), order->rows(), values);
  }

  /// Whether every pivot exceeds the rounding of its column, within its diagonal block.
  /// @param growth possible growth of rounding errors before the pivot
  bool has_pivots(const Matrix& matrix, double growth) const {
    const double least = singular_pivot * growth;
    const double* pivots = static_cast<const double*>(numeric->Udiag);
    // KLU divides every row by its largest entry, in the order of the pivots.
    const double* row_size = numeric->Rs;
    std::atomic<bool> has = true;
    for (int block = 0; block < order->symbolic->nblocks; ++block) {
      const int first = order->symbolic->R[block];
      each_in_parallel(static_cast<std::size_t>(order->symbolic->R[block + 1] - first),
                       columns_at_once, [&](std::size_t in_block) {
                         const int k = first + static_cast<int>(in_block);
                         // Sufficient if the entries of the column are at most 1.
                         if (std::abs(pivots[k]) > least) return;
                         double largest = 0.0;
                         for (Matrix::InnerIterator it(matrix, order->symbolic->Q[k]); it; ++it) {
                           const int pivot = numeric->Pinv[it.row()];
                           if (pivot < first) continue;
                           largest = std::max(largest, std::abs(it.value()) / row_size[pivot]);
                         }
                         if (!(std::abs(pivots[k]) > least * largest)) has = false;
                       });
    }
    return has;
  }

  /// Factors a matrix of the same pattern with the last pivots. False if rows are multiplied by
  /// more than `most`, or if a pivot does not exceed the rounding amplified by that factor. New
  /// pivots then show whether the matrix is singular.
  bool keeps_pivots(int* columns, int* rows, double* values, const Matrix& matrix, double most) {
    if (numeric == nullptr) return false;
    if (halves.are_halved()) {
      if (!halves.refactor(columns, rows, values, *numeric, *order->symbolic)) return false;
    } else {
      const int made = klu_refactor(columns, rows, values, order->symbolic, numeric, &common);
      if (made == 0 || common.status != KLU_OK) return false;
    }
    const double growth = std::max(1.0, largest_of_lower());
    // Growth in two successive pivots multiplies.
    return growth <= most && has_pivots(matrix, growth * growth);
  }

  /// The largest entry of L; NaN if any entry is NaN. Reads KLU's storage, in which the rows of a
  /// column precede its entries, because klu_extract() copies all of L.
  double largest_of_lower() const {
    double largest = 0.0;
    for (int block = 0; block < order->symbolic->nblocks; ++block) {
      const auto first = static_cast<std::size_t>(order->symbolic->R[block]);
      const auto length = static_cast<std::size_t>(order->symbolic->R[block + 1]) - first;
      if (length < 2) continue;
      auto* units = static_cast<double*>(numeric->LUbx[block]);
      std::vector<double> of_piece((length + columns_at_once - 1) / columns_at_once, 0.0);
      in_parallel(of_piece.size(), [&](std::size_t piece) {
        const std::size_t begin = first + piece * columns_at_once;
        const std::size_t end = std::min(begin + columns_at_once, first + length);
        for (std::size_t k = begin; k < end; ++k) raise(of_piece[piece], column_of_lower(units, k));
      });
      for (const double one : of_piece) raise(largest, one);
    }
    return largest;
  }
  double column_of_lower(double* units, std::size_t column) const {
    const FactorColumn lower(units, numeric->Lip, numeric->Llen, static_cast<int>(column));
    double largest = 0.0;
    for (int i = 0; i < lower.length; ++i) raise(largest, std::abs(lower.entries[i]));
    return largest;
  }

  /// Positions of the nonzero entries of a matrix, by columns.
  struct Pattern {
    std::vector<int> columns, rows;

    explicit Pattern(const Matrix& matrix) : columns{0} {
      for (Eigen::Index column = 0; column < matrix.outerSize(); ++column) {
        for (Matrix::InnerIterator it(matrix, column); it; ++it) {
          if (it.value() != 0.0) rows.push_back(static_cast<int>(it.row()));
        }
        columns.push_back(static_cast<int>(rows.size()));
      }
    }

    /// Copies the entries of a matrix to their positions. False if an entry has no position, or if
    /// less than half of the positions are used, so that a new order pays off.
    bool take(const Matrix& matrix, std::vector<double>& values) const {
      values.assign(rows.size(), 0.0);
      std::size_t used = 0;
      for (Eigen::Index column = 0; column < matrix.outerSize(); ++column) {
        auto at = static_cast<std::size_t>(columns[static_cast<std::size_t>(column)]);
        const auto end = static_cast<std::size_t>(columns[static_cast<std::size_t>(column) + 1]);
        for (Matrix::InnerIterator it(matrix, column); it; ++it) {
          if (it.value() == 0.0) continue;
          while (at < end && rows[at] < it.row()) ++at;
          if (at == end || rows[at] != it.row()) return false;
          values[at] = it.value();
          ++used;
        }
      }
      return 2 * used >= rows.size();
    }
  };

  /// AMD orders the pattern of the matrix plus its transpose, with the least fill if pivots stay on
  /// the diagonal. COLAMD bounds the fill for any row exchanges.
  enum class Ordering : unsigned char { amd, colamd };

  /// Order of a pattern. KLU's C interface allocates and frees its own objects.
  struct Order {
    Order(int size, Pattern of, Ordering ordering, klu_common common) : pattern(std::move(of)) {
      common.ordering = ordering == Ordering::amd ? 0 : 1;
      symbolic = klu_analyze(size, columns(), rows(), &common);
    }
    /// Order of a large matrix, whose entries are used in place.
    Order(int size, int* columns, int* rows, klu_common common) {
      common.ordering = 3;
      common.user_order = order_in_halves;
      common.user_data = &halves;
      symbolic = klu_analyze(size, columns, rows, &common);
    }
    ~Order() {
      klu_common defaults;
      klu_defaults(&defaults);
      klu_free_symbolic(&symbolic, &defaults);
    }
    Order(const Order&) = delete;
    Order& operator=(const Order&) = delete;

    // KLU takes no const pointers, see Arrays.
    int* columns() const { return const_cast<int*>(pattern->columns.data()); }
    int* rows() const { return const_cast<int*>(pattern->rows.data()); }

    std::optional<Pattern> pattern;  ///< Empty: the pattern of the matrix itself.
    HalvedOrder halves;
    klu_symbolic* symbolic = nullptr;
  };

  /// Arguments of KLU for a matrix. KLU takes no const pointers, but does not write to them.
  struct Arrays {
    int* columns;
    int* rows;
    double* values;
  };

  /// The matrix in an order; empty if it has none.
  std::optional<Arrays> ordered(const Matrix& matrix) {
    if (size >= HalvedOrder::least_columns) {
      const Arrays all{const_cast<int*>(matrix.outerIndexPtr()),
                       const_cast<int*>(matrix.innerIndexPtr()),
                       const_cast<double*>(matrix.valuePtr())};
      if (order == nullptr) {
        order = std::make_shared<const Order>(size, all.columns, all.rows, common);
      }
      if (order->symbolic != nullptr) return all;
    } else {
      if (order == nullptr || !order->pattern->take(matrix, entries)) {
        klu_free_numeric(&numeric, &common);
        Pattern pattern(matrix);
        pattern.take(matrix, entries);
        order = std::make_shared<const Order>(size, std::move(pattern), Ordering::amd, common);
      }
      if (order->symbolic != nullptr)
        return Arrays{order->columns(), order->rows(), entries.data()};
    }
    order = nullptr;
    return std::nullopt;
  }

  klu_common common{};
  std::shared_ptr<const Order> order;    ///< Shared and only read.
  std::shared_ptr<const Order> settled;  ///< Order that COLAMD did not improve.
  std::vector<double> entries;  ///< Entries of a small matrix, in the positions of its pattern.
  klu_numeric* numeric = nullptr;
  HalvedFactors halves;
  int size = 0;
  std::optional<bool> odd_permutation;  ///< Parity of rows and columns together, once computed.
};

SparseFactor::SparseFactor() : factors_(std::make_unique<Factors>()) {}
SparseFactor::~SparseFactor() = default;

bool SparseFactor::factorize(const Matrix& matrix, double most_growth) {
  Factors& f = *factors_;
  f.size = static_cast<int>(matrix.rows());
  if (f.size == 0) return true;  // KLU accepts no empty matrix
  const std::optional<Factors::Arrays> of = f.ordered(matrix);
  if (!of) return false;
  if (f.keeps_pivots(of->columns, of->rows, of->values, matrix, most_growth)) return true;
  if (!f.choose_pivots(of->columns, of->rows, of->values)) return false;
  if (f.order->pattern && !f.choose_order(of->values)) return false;
  return f.has_pivots(matrix, 1.0);
}

void SparseFactor::order_like(const SparseFactor& other) {
  if (other.factors_->order == nullptr || factors_->numeric != nullptr) return;
  factors_->order = other.factors_->order;
}

void SparseFactor::release() {
  factors_->halves.end();
  klu_free_numeric(&factors_->numeric, &factors_->common);
}

Eigen::VectorXd SparseFactor::solve(const Eigen::VectorXd& right_side) const {
  Eigen::VectorXd result = right_side;
  Factors& f = *factors_;
  if (f.size == 0) return result;
  if (f.halves.are_halved()) {
    f.halves.solve(*f.numeric, *f.order->symbolic, result.data());
  } else {
    klu_solve(f.order->symbolic, f.numeric, f.size, 1, result.data(), &f.common);
  }
  return result;
}

double SparseFactor::solutions_per_factorization() const {
  if (factors_->size == 0) return 1.0;
  const double lower = factors_->numeric->lnz;
  const double upper = factors_->numeric->unz;
  return lower * upper / factors_->size / (lower + upper);
}

int SparseFactor::determinant_sign() const {
  Factors& f = *factors_;
  if (f.size == 0) return 1;
  // Rows are divided by positive numbers; both permutations make the matrix block triangular.
  if (!f.odd_permutation) {
    f.odd_permutation = odd(f.numeric->Pnum, f.size) != odd(f.order->symbolic->Q, f.size);
  }
  bool negative = *f.odd_permutation;
  const double* pivots = static_cast<const double*>(f.numeric->Udiag);
  for (int k = 0; k < f.size; ++k) negative = negative != (pivots[k] < 0.0);
  return negative ? -1 : 1;
}

const char* SparseFactor::library() {
  return "KLU";
}

}  // namespace statejump::linear
