// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <complex>
#include <memory>

namespace statejump::linear {

/// LU factors of a sparse complex matrix whose pattern never changes: see SparseFactor, of which
/// this is the complex one.
class ComplexFactor {
 public:
  ComplexFactor();
  ~ComplexFactor();
  ComplexFactor(ComplexFactor&&) noexcept;
  ComplexFactor& operator=(ComplexFactor&&) noexcept;
  ComplexFactor(const ComplexFactor&) = delete;
  ComplexFactor& operator=(const ComplexFactor&) = delete;

  /// Orders a square pattern, compressed. False if no order leaves a diagonal.
  bool analyze(const Eigen::SparseMatrix<double>& pattern);
  /// Factors of the values of the pattern's entries, in their order. Pivots are those of the first
  /// values. False if one of them is zero.
  bool factorize(const std::complex<double>* values);
  /// Solves in place.
  void solve(Eigen::VectorXcd& x) const;

 private:
  struct Factors;
  std::unique_ptr<Factors> factors_;
};

}  // namespace statejump::linear
