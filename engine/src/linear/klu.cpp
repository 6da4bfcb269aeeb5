// SPDX-License-Identifier: GPL-3.0-or-later
#include <klu.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <list>
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

/// If the fill of L divided by the fill that AMD predicted exceeds this ratio, COLAMD is tried as
/// well.
constexpr double exceeded_fill = 2.0;
/// A new pattern also gets the positions of the last one, if its positions divided by its nonzero
/// entries do not exceed this ratio. Iterates with different zeros then share an order.
constexpr double widest = 1.5;
/// Columns that a thread takes at once.
constexpr std::size_t columns_at_once = 20000;

/// Whether a permutation is odd. A cycle of length n consists of n - 1 transpositions.
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
    // Initial memory of the factors, as a multiple of the memory of the matrix entries. KLU's
    // default, ten times this value, is gigabytes for a large truss. KLU enlarges it on demand.
    common.initmem = 1.0;
  }
  Factors(const Factors&) = delete;
  Factors& operator=(const Factors&) = delete;

  /// Computes factors with new pivots.
  bool choose_pivots(int* columns, int* rows, double* values) {
    halves.end();
    now.odd_permutation.reset();
    now.numeric.reset(klu_factor(columns, rows, values, now.order->symbolic, &common));
    if (now.numeric == nullptr || common.status != KLU_OK) return false;
    halves.begin(*now.numeric, *now.order->symbolic, now.order->halves);
    return true;
  }

  /// Computes factors of a small matrix in the order of COLAMD, and keeps them if they have fewer
  /// entries. In AMD's order, row exchanges for pivots cause far more fill than predicted.
  bool choose_order(double* values) {
    const std::shared_ptr<const Order> first = now.order;
    const double foreseen = first->symbolic->lnz;  // negative for COLAMD, which predicts no fill
    if (foreseen < 0.0 || now.numeric->lnz <= exceeded_fill * foreseen || now.settled == first)
      return true;
    const int filled = now.numeric->lnz + now.numeric->unz;
    now.order = std::make_shared<const Order>(size, *first->pattern, Ordering::colamd, common);
    const bool is_better = now.order->symbolic != nullptr &&
                           choose_pivots(now.order->columns(), now.order->rows(), values) &&
                           now.numeric->lnz + now.numeric->unz < filled;
    if (is_better) return true;
    now.order = now.settled = first;
    return choose_pivots(now.order->columns(), now.order->rows(), values);
  }

  /// Whether every pivot exceeds the rounding errors of its column within the same diagonal block.
  /// @param growth factor by which rounding errors may have grown before the pivot
  bool has_pivots(const Matrix& matrix, double growth) const {
    const double least = singular_pivot * growth;
    const double* pivots = static_cast<const double*>(now.numeric->Udiag);
    // KLU divides every row by its largest entry. It stores these entries in the order of the
    // pivots.
    const double* row_size = now.numeric->Rs;
    std::atomic<bool> has = true;
    for (int block = 0; block < now.order->symbolic->nblocks; ++block) {
      const int first = now.order->symbolic->R[block];
      each_in_parallel(static_cast<std::size_t>(now.order->symbolic->R[block + 1] - first),
                       columns_at_once, [&](std::size_t in_block) {
                         const int k = first + static_cast<int>(in_block);
                         // Sufficient if the entries of the column are at most 1.
                         if (std::abs(pivots[k]) > least) return;
                         double largest = 0.0;
                         for (Matrix::InnerIterator it(matrix, now.order->symbolic->Q[k]); it;
                              ++it) {
                           const int pivot = now.numeric->Pinv[it.row()];
                           if (pivot < first) continue;
                           largest = std::max(largest, std::abs(it.value()) / row_size[pivot]);
                         }
                         if (!(std::abs(pivots[k]) > least * largest)) has = false;
                       });
    }
    return has;
  }

  /// Factors a matrix of the same pattern with the last pivots. Returns false if the elimination
  /// multiplies a row by more than `most`, or if a pivot does not exceed rounding times that
  /// factor. New pivots then show whether the matrix is singular.
  bool keeps_pivots(int* columns, int* rows, double* values, const Matrix& matrix, double most) {
    if (now.numeric == nullptr) return false;
    if (halves.are_halved()) {
      if (!halves.refactor(columns, rows, values, *now.numeric, *now.order->symbolic)) return false;
    } else {
      const int made =
          klu_refactor(columns, rows, values, now.order->symbolic, now.numeric.get(), &common);
      if (made == 0 || common.status != KLU_OK) return false;
    }
    const double growth = std::max(1.0, largest_of_lower());
    // Growth in two successive pivots multiplies.
    return growth <= most && has_pivots(matrix, growth * growth);
  }

  /// The largest entry of L, or NaN if any entry is NaN. It is read from KLU's storage (rows of a
  /// column, then entries), because klu_extract() would copy L.
  double largest_of_lower() const {
    double largest = 0.0;
    for (int block = 0; block < now.order->symbolic->nblocks; ++block) {
      const auto first = static_cast<std::size_t>(now.order->symbolic->R[block]);
      const auto length = static_cast<std::size_t>(now.order->symbolic->R[block + 1]) - first;
      if (length < 2) continue;
      auto* units = static_cast<double*>(now.numeric->LUbx[block]);
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
    const FactorColumn lower(units, now.numeric->Lip, now.numeric->Llen, static_cast<int>(column));
    double largest = 0.0;
    for (int i = 0; i < lower.length; ++i) raise(largest, std::abs(lower.entries[i]));
    return largest;
  }

  /// Positions of the nonzero entries of a matrix, by columns.
  struct Pattern {
    std::vector<int> columns, rows;

    /// @param other pattern whose positions are included; null: none
    explicit Pattern(const Matrix& matrix, const Pattern* other = nullptr) : columns{0} {
      for (Eigen::Index column = 0; column < matrix.outerSize(); ++column) {
        const auto k = static_cast<std::size_t>(column);
        auto at = other == nullptr ? 0 : static_cast<std::size_t>(other->columns[k]);
        const auto end = other == nullptr ? 0 : static_cast<std::size_t>(other->columns[k + 1]);
        for (Matrix::InnerIterator it(matrix, column); it; ++it) {
          while (at < end && other->rows[at] < it.row()) ++at;
          const bool is_included = at < end && other->rows[at] == it.row();
          if (is_included || it.value() != 0.0) rows.push_back(static_cast<int>(it.row()));
        }
        columns.push_back(static_cast<int>(rows.size()));
      }
    }

    /// Copies the entries of a matrix to their positions. Returns false if an entry has no
    /// position, or if less than half of the positions are used: a new order then saves time.
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

  /// AMD orders the pattern of the matrix plus its transpose; its fill is smallest if all pivots
  /// stay on the diagonal. COLAMD bounds the fill for any row exchanges.
  enum class Ordering : unsigned char { amd, colamd };

  /// Order of a pattern. The object in it belongs to KLU's C interface, which allocates and frees
  /// it.
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

  struct FreeNumeric {
    void operator()(klu_numeric* numeric) const {
      klu_common defaults;
      klu_defaults(&defaults);
      klu_free_numeric(&numeric, &defaults);
    }
  };

  /// An order, with the last factors that use it. Entries that are zero at some iterates make the
  /// pattern alternate, often between the first and the later iterations of a solve.
  struct Kept {
    std::shared_ptr<const Order> order;    ///< Shared and only read.
    std::shared_ptr<const Order> settled;  ///< Order that COLAMD did not improve.
    std::unique_ptr<klu_numeric, FreeNumeric> numeric;
    std::optional<bool> odd_permutation;  ///< Parity of rows and columns together, once computed.
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
      if (now.order == nullptr) {
        now.order = std::make_shared<const Order>(size, all.columns, all.rows, common);
      }
      if (now.order->symbolic != nullptr) return all;
    } else {
      choose_kept(matrix);
      if (now.order->symbolic != nullptr)
        return Arrays{now.order->columns(), now.order->rows(), entries.data()};
    }
    now.order = nullptr;
    return std::nullopt;
  }

  /// Selects factors whose pattern has a position for every entry of a small matrix. It prefers the
  /// present factors, then those used last. If none fit, it starts a new order.
  void choose_kept(const Matrix& matrix) {
    if (now.order != nullptr && now.order->pattern->take(matrix, entries)) return;
    if (now.order != nullptr) others.push_front(std::move(now));
    const auto found = std::find_if(others.begin(), others.end(), [&](const Kept& one) {
      return one.order->pattern->take(matrix, entries);
    });
    if (found != others.end()) {
      now = std::move(*found);
      others.erase(found);
    } else {
      Pattern pattern(matrix);
      if (!others.empty()) {
        Pattern wide(matrix, &*others.front().order->pattern);
        const double most = widest * static_cast<double>(pattern.rows.size());
        if (static_cast<double>(wide.rows.size()) <= most) pattern = std::move(wide);
      }
      pattern.take(matrix, entries);
      now = Kept{};
      now.order = std::make_shared<const Order>(size, std::move(pattern), Ordering::amd, common);
    }
    if (others.size() > most_others) others.pop_back();
  }

  /// Largest number of further orders of a small matrix that are kept with their factors.
  static constexpr std::size_t most_others = 4;

  klu_common common{};
  Kept now;
  std::list<Kept> others;       ///< Of a small matrix, the one used last first.
  std::vector<double> entries;  ///< Entries of a small matrix, in the positions of its pattern.
  HalvedFactors halves;
  int size = 0;
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
  if (f.now.order->pattern && !f.choose_order(of->values)) return false;
  return f.has_pivots(matrix, 1.0);
}

void SparseFactor::order_like(const SparseFactor& other) {
  if (other.factors_->now.order == nullptr || factors_->now.numeric != nullptr) return;
  factors_->now.order = other.factors_->now.order;
}

void SparseFactor::release() {
  factors_->halves.end();
  factors_->now.numeric.reset();
  factors_->others.clear();
}

Eigen::VectorXd SparseFactor::solve(const Eigen::VectorXd& right_side) const {
  Eigen::VectorXd result = right_side;
  Factors& f = *factors_;
  if (f.size == 0) return result;
  if (f.halves.are_halved()) {
    f.halves.solve(*f.now.numeric, *f.now.order->symbolic, result.data());
  } else {
    klu_solve(f.now.order->symbolic, f.now.numeric.get(), f.size, 1, result.data(), &f.common);
  }
  return result;
}

double SparseFactor::solutions_per_factorization() const {
  if (factors_->size == 0) return 1.0;
  const double lower = factors_->now.numeric->lnz;
  const double upper = factors_->now.numeric->unz;
  return lower * upper / factors_->size / (lower + upper);
}

int SparseFactor::determinant_sign() const {
  Factors& f = *factors_;
  if (f.size == 0) return 1;
  // KLU divides rows by positive numbers, which keeps the sign of the determinant. The permutations
  // of rows and of columns may each reverse it.
  if (!f.now.odd_permutation) {
    f.now.odd_permutation =
        odd(f.now.numeric->Pnum, f.size) != odd(f.now.order->symbolic->Q, f.size);
  }
  bool negative = *f.now.odd_permutation;
  const double* pivots = static_cast<const double*>(f.now.numeric->Udiag);
  for (int k = 0; k < f.size; ++k) negative = negative != (pivots[k] < 0.0);
  return negative ? -1 : 1;
}

const char* SparseFactor::library() {
  return "KLU";
}

}  // namespace statejump::linear
