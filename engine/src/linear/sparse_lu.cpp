// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/SparseLU>
#include <algorithm>
#include <cmath>

#include "complex_factor.hpp"
#include "sparse_factor.hpp"

namespace statejump::linear {

namespace {

using Matrix = Eigen::Ref<const Eigen::SparseMatrix<double>>;

/// Eigen's factors with access to the pivots.
struct Lu : Eigen::SparseLU<Eigen::SparseMatrix<double>> {
  /// Whether every pivot exceeds the rounding of its column.
  bool has_pivots(const Matrix& matrix) const {
    for (Eigen::Index j = 0; j < matrix.cols(); ++j) {
      double largest = 0.0;
      for (Matrix::InnerIterator it(matrix, j); it; ++it) {
        largest = std::max(largest, std::abs(it.value()));
      }
      const Eigen::Index k = m_perm_c.indices()[j];
      for (typename SCMatrix::InnerIterator it(m_Lstore, k); it; ++it) {
        if (it.index() != k) continue;
        if (!(std::abs(it.value()) > SparseFactor::singular_pivot * largest)) return false;
        break;
      }
    }
    return true;
  }
};

}  // namespace

struct SparseFactor::Factors {
  Lu lu;
  bool ordered = false;
  bool empty = false;  // of a matrix without rows, which Eigen does not factor
};

SparseFactor::SparseFactor() : factors_(std::make_unique<Factors>()) {}
SparseFactor::~SparseFactor() = default;

bool SparseFactor::factorize(const Matrix& matrix, double /*most_growth*/) {
  factors_->empty = matrix.rows() == 0;
  if (factors_->empty) return true;
  if (!factors_->ordered) factors_->lu.analyzePattern(matrix);
  factors_->ordered = true;
  factors_->lu.factorize(matrix);
  return factors_->lu.info() == Eigen::Success && factors_->lu.has_pivots(matrix);
}

void SparseFactor::order_like(const SparseFactor& /*other*/) {}

void SparseFactor::release() {
  factors_ = std::make_unique<Factors>();
}

Eigen::VectorXd SparseFactor::solve(const Eigen::VectorXd& right_side) const {
  if (factors_->empty) return right_side;
  return factors_->lu.solve(right_side);
}

double SparseFactor::solutions_per_factorization() const {
  if (factors_->empty) return 1.0;
  const auto lower = static_cast<double>(factors_->lu.nnzL());
  const auto upper = static_cast<double>(factors_->lu.nnzU());
  return lower * upper / static_cast<double>(factors_->lu.rows()) / (lower + upper);
}

int SparseFactor::determinant_sign() const {
  return !factors_->empty && factors_->lu.signDeterminant() < 0.0 ? -1 : 1;
}

const char* SparseFactor::library() {
  return "SparseLU";
}

struct ComplexFactor::Factors {
  Eigen::SparseMatrix<std::complex<double>> matrix;
  Eigen::SparseLU<Eigen::SparseMatrix<std::complex<double>>> lu;
};

ComplexFactor::ComplexFactor() : factors_(std::make_unique<Factors>()) {}
ComplexFactor::~ComplexFactor() = default;
ComplexFactor::ComplexFactor(ComplexFactor&&) noexcept = default;
ComplexFactor& ComplexFactor::operator=(ComplexFactor&&) noexcept = default;

bool ComplexFactor::analyze(const Eigen::SparseMatrix<double>& pattern) {
  factors_->matrix = pattern.cast<std::complex<double>>();
  factors_->lu.analyzePattern(factors_->matrix);
  return true;
}

bool ComplexFactor::factorize(const std::complex<double>* values) {
  std::copy_n(values, factors_->matrix.nonZeros(), factors_->matrix.valuePtr());
  factors_->lu.factorize(factors_->matrix);
  return factors_->lu.info() == Eigen::Success;
}

void ComplexFactor::solve(Eigen::VectorXcd& x) const {
  x = Eigen::VectorXcd(factors_->lu.solve(x));
}

}  // namespace statejump::linear
