// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <complex>
#include <memory>

namespace statejump::linear {

/// LU factors of a sparse complex matrix with a constant pattern. The class is the complex
/// counterpart of SparseFactor.
class ComplexFactor {
 public:
  ComplexFactor();
  ~ComplexFactor();
  ComplexFactor(ComplexFactor&&) noexcept;
  ComplexFactor& operator=(ComplexFactor&&) noexcept;
  ComplexFactor(const ComplexFactor&) = delete;
  ComplexFactor& operator=(const ComplexFactor&) = delete;

  /// Computes a fill-reducing order of a square, compressed pattern. Returns false if every order
  /// has a zero on the diagonal.
  bool analyze(const Eigen::SparseMatrix<double>& pattern);
  /// Factors a matrix whose entries are `values`, in the order of the pattern. The pivot positions
  /// are those of the first factorization. Returns false if a pivot is zero.
  bool factorize(const std::complex<double>* values);
  /// Solves in place.
  void solve(Eigen::VectorXcd& x) const;

 private:
  struct Factors;
  std::unique_ptr<Factors> factors_;
};

}  // namespace statejump::linear
