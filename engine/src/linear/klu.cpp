// SPDX-License-Identifier: GPL-3.0-or-later
#include <klu.h>

#include "sparse_factor.hpp"

namespace statejump::linear {

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

  // KLU's C interface allocates and frees these itself.
  klu_common common{};
  klu_symbolic* symbolic = nullptr;
  klu_numeric* numeric = nullptr;
  int size = 0;
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
  klu_free_numeric(&f.numeric, &f.common);
  f.numeric = klu_factor(columns, rows, values, f.symbolic, &f.common);
  return f.numeric != nullptr && f.common.status == KLU_OK;
}

Eigen::VectorXd SparseFactor::solve(const Eigen::VectorXd& right_side) const {
  Eigen::VectorXd result = right_side;
  klu_solve(factors_->symbolic, factors_->numeric, factors_->size, 1, result.data(),
            &factors_->common);
  return result;
}

const char* SparseFactor::library() {
  return "KLU";
}

}  // namespace statejump::linear
