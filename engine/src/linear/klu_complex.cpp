// SPDX-License-Identifier: GPL-3.0-or-later
#include <klu.h>

#include <vector>

#include "complex_factor.hpp"

namespace statejump::linear {

namespace {

/// KLU expects complex numbers as non-const pairs of doubles, but does not write to them.
double* pairs(const std::complex<double>* values) {
  return const_cast<double*>(reinterpret_cast<const double*>(values));
}

}  // namespace

struct ComplexFactor::Factors {
  Factors() {
    klu_defaults(&common);
    common.ordering = 1;  // COLAMD, as for real matrices
  }
  ~Factors() { clear(); }
  Factors(const Factors&) = delete;
  Factors& operator=(const Factors&) = delete;

  void clear() {
    klu_z_free_numeric(&numeric, &common);
    klu_free_symbolic(&symbolic, &common);
  }

  // KLU's C interface allocates and frees its own objects.
  klu_common common{};
  klu_symbolic* symbolic = nullptr;
  klu_numeric* numeric = nullptr;
  std::vector<int> columns, rows;
};

ComplexFactor::ComplexFactor() : factors_(std::make_unique<Factors>()) {}
ComplexFactor::~ComplexFactor() = default;
ComplexFactor::ComplexFactor(ComplexFactor&&) noexcept = default;
ComplexFactor& ComplexFactor::operator=(ComplexFactor&&) noexcept = default;

bool ComplexFactor::analyze(const Eigen::SparseMatrix<double>& pattern) {
  Factors& f = *factors_;
  f.clear();
  f.columns.assign(pattern.outerIndexPtr(), pattern.outerIndexPtr() + pattern.cols() + 1);
  f.rows.assign(pattern.innerIndexPtr(), pattern.innerIndexPtr() + pattern.nonZeros());
  f.symbolic =
      klu_analyze(static_cast<int>(pattern.rows()), f.columns.data(), f.rows.data(), &f.common);
  return f.symbolic != nullptr;
}

bool ComplexFactor::factorize(const std::complex<double>* values) {
  Factors& f = *factors_;
  if (f.numeric != nullptr) {
    return klu_z_refactor(f.columns.data(), f.rows.data(), pairs(values), f.symbolic, f.numeric,
                          &f.common) != 0;
  }
  f.numeric = klu_z_factor(f.columns.data(), f.rows.data(), pairs(values), f.symbolic, &f.common);
  if (f.numeric != nullptr && f.common.status == KLU_OK) return true;
  klu_z_free_numeric(&f.numeric, &f.common);
  return false;
}

void ComplexFactor::solve(Eigen::VectorXcd& x) const {
  Factors& f = *factors_;
  klu_z_solve(f.symbolic, f.numeric, static_cast<int>(x.size()), 1, pairs(x.data()), &f.common);
}

}  // namespace statejump::linear
