// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/SparseLU>

#include "sparse_factor.hpp"

namespace statejump::linear {

struct SparseFactor::Factors {
  Eigen::SparseLU<Eigen::SparseMatrix<double>> lu;
  bool ordered = false;
};

SparseFactor::SparseFactor() : factors_(std::make_unique<Factors>()) {}
SparseFactor::~SparseFactor() = default;

bool SparseFactor::factorize(const Eigen::SparseMatrix<double>& matrix) {
  if (!factors_->ordered) factors_->lu.analyzePattern(matrix);
  factors_->ordered = true;
  factors_->lu.factorize(matrix);
  return factors_->lu.info() == Eigen::Success;
}

Eigen::VectorXd SparseFactor::solve(const Eigen::VectorXd& right_side) const {
  return factors_->lu.solve(right_side);
}

const char* SparseFactor::library() {
  return "SparseLU";
}

}  // namespace statejump::linear
