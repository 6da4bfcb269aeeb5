// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/OrderingMethods>
#include <Eigen/SparseCore>
#include <cmath>
#include <complex>
#include <cstddef>
#include <vector>

namespace statejump::linear {

/// L D Lᵀ of a sparse matrix that equals its transpose, real or complex (not its conjugate),
/// without pivoting, row by row along the elimination tree [1]. For matrices whose real and
/// imaginary parts are definite, where that is stable; whoever iterates with the factors sees where
/// it is not.
///
/// [1] T. A. Davis, Direct Methods for Sparse Linear Systems, SIAM 2006, chapter 4.
template <class Scalar>
class SymmetricFactor {
 public:
  using Vector = Eigen::Matrix<Scalar, Eigen::Dynamic, 1>;

  /// Orders a pattern, compressed, both triangles.
  void analyze(const Eigen::SparseMatrix<double>& pattern) {
    const auto n = static_cast<std::size_t>(pattern.rows());
    Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> inverse;
    Eigen::AMDOrdering<int>()(pattern, inverse);
    place_.resize(n);
    for (std::size_t k = 0; k < n; ++k) {
      const auto of = static_cast<Eigen::Index>(k);
      place_[static_cast<std::size_t>(inverse.indices()[of])] = of;
    }
    // inverse() of what Eigen returns: place_[k] is the column that comes k-th.
    std::vector<std::size_t> rank(n);
    for (std::size_t k = 0; k < n; ++k) rank[static_cast<std::size_t>(place_[k])] = k;
    begin_.assign(1, 0);
    row_.clear();
    source_.clear();
    for (std::size_t k = 0; k < n; ++k) {
      const int first = pattern.outerIndexPtr()[place_[k]];
      const int last = pattern.outerIndexPtr()[place_[k] + 1];
      for (int p = first; p < last; ++p) {
        const std::size_t i = rank[static_cast<std::size_t>(pattern.innerIndexPtr()[p])];
        if (i > k) continue;
        row_.push_back(i);
        source_.push_back(static_cast<std::size_t>(p));
      }
      begin_.push_back(row_.size());
    }
    grow_tree(n);
  }

  /// Factors of the values of the pattern's entries. False if a pivot is none.
  bool factorize(const Scalar* values) {
    const std::size_t n = place_.size();
    std::vector<std::size_t> filled(n, 0);
    std::vector<std::size_t> seen(n, n);
    std::vector<std::size_t> stack(n);
    std::vector<std::size_t> path(n);
    work_.assign(n, Scalar(0));
    for (std::size_t k = 0; k < n; ++k) {
      // What the k-th row reaches in the tree, from the leaves on.
      std::size_t top = n;
      seen[k] = k;
      for (std::size_t p = begin_[k]; p < begin_[k + 1]; ++p) {
        std::size_t i = row_[p];
        work_[i] += values[source_[p]];
        std::size_t length = 0;
        for (; seen[i] != k; i = parent_[i]) {
          path[length++] = i;
          seen[i] = k;
        }
        while (length > 0) stack[--top] = path[--length];
      }
      Scalar pivot = work_[k];
      work_[k] = Scalar(0);
      for (; top < n; ++top) {
        const std::size_t i = stack[top];
        const Scalar entry = work_[i];
        work_[i] = Scalar(0);
        const std::size_t end = lower_begin_[i] + filled[i];
        for (std::size_t p = lower_begin_[i]; p < end; ++p)
          work_[lower_row_[p]] -= product(lower_[p], entry);
        const Scalar factor = entry * inverse_pivot_[i];
        pivot -= factor * entry;
        lower_row_[end] = k;
        lower_[end] = factor;
        ++filled[i];
      }
      inverse_pivot_[k] = Scalar(1) / pivot;
      if (!std::isfinite(std::abs(inverse_pivot_[k]))) return false;
    }
    return true;
  }

  /// Solves in place.
  void solve(Vector& x) const {
    const std::size_t n = place_.size();
    solved_.resize(n);
    for (std::size_t k = 0; k < n; ++k) solved_[k] = x[place_[k]];
    for (std::size_t k = 0; k < n; ++k) {
      for (std::size_t p = lower_begin_[k]; p < lower_begin_[k + 1]; ++p) {
        solved_[lower_row_[p]] -= product(lower_[p], solved_[k]);
      }
    }
    for (std::size_t k = n; k-- > 0;) {
      solved_[k] *= inverse_pivot_[k];
      for (std::size_t p = lower_begin_[k]; p < lower_begin_[k + 1]; ++p) {
        solved_[k] -= product(lower_[p], solved_[lower_row_[p]]);
      }
    }
    for (std::size_t k = 0; k < n; ++k) x[place_[k]] = solved_[k];
  }

 private:
  static double product(double a, double b) { return a * b; }
  /// Without the search for infinities that the operator has.
  static std::complex<double> product(const std::complex<double>& a,
                                      const std::complex<double>& b) {
    return {a.real() * b.real() - a.imag() * b.imag(), a.real() * b.imag() + a.imag() * b.real()};
  }
  /// Elimination tree and places of L.
  void grow_tree(std::size_t n) {
    parent_.assign(n, n);
    std::vector<std::size_t> seen(n, n);
    std::vector<std::size_t> count(n, 0);
    for (std::size_t k = 0; k < n; ++k) {
      seen[k] = k;
      for (std::size_t p = begin_[k]; p < begin_[k + 1]; ++p) {
        for (std::size_t i = row_[p]; seen[i] != k; i = parent_[i]) {
          if (parent_[i] == n) parent_[i] = k;
          ++count[i];
          seen[i] = k;
        }
      }
    }
    lower_begin_.assign(1, 0);
    for (const std::size_t entries : count) lower_begin_.push_back(lower_begin_.back() + entries);
    lower_row_.resize(lower_begin_.back());
    lower_.resize(lower_begin_.back());
    inverse_pivot_.resize(n);
  }

  std::vector<Eigen::Index> place_;                ///< Column of the matrix that comes k-th.
  std::vector<std::size_t> begin_, row_, source_;  ///< Of the upper triangle in that order.
  std::vector<std::size_t> parent_;
  std::vector<std::size_t> lower_begin_, lower_row_;
  std::vector<Scalar> lower_;
  std::vector<Scalar> inverse_pivot_;
  std::vector<Scalar> work_;
  mutable std::vector<Scalar> solved_;
};

}  // namespace statejump::linear
