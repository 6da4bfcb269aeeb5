// SPDX-License-Identifier: GPL-3.0-or-later
#include "radau.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

namespace statejump::truss::detail {

namespace {

// In long double, so that the coefficients are exact to double.
using Real = long double;
using Matrix = Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic>;
using Vector = Eigen::Matrix<Real, Eigen::Dynamic, 1>;

/// Difference P_s − P_{s−1} of Legendre polynomials at 2x − 1. Its zeros are the nodes of the
/// method.
Real nodal(int s, Real x) {
  const Real y = 2 * x - 1;
  Real before = 1;
  Real now = y;
  for (int k = 2; k <= s; ++k) {
    const Real next = ((2 * k - 1) * y * now - (k - 1) * before) / static_cast<Real>(k);
    before = now;
    now = next;
  }
  return now - before;
}

Vector nodes(int s) {
  Vector found(s);
  // Distances of the zeros exceed 1/s², also at the ends.
  const int places = 20 * s * s;
  int count = 0;
  for (int k = 0; k + 1 < places && count + 1 < s; ++k) {
    Real first = static_cast<Real>(k) / places;
    Real last = static_cast<Real>(k + 1) / places;
    if (nodal(s, first) * nodal(s, last) > 0) continue;
    for (int halving = 0; halving < 70; ++halving) {
      const Real middle = (first + last) / 2;
      (nodal(s, first) * nodal(s, middle) > 0 ? first : last) = middle;
    }
    found[count++] = (first + last) / 2;
  }
  found[s - 1] = 1;
  return found;
}

}  // namespace

Radau::Radau(int stages) {
  const Vector node = nodes(stages);
  // A integrates powers of c exactly (collocation).
  Matrix power(stages, stages);     // c_j^(k − 1)
  Matrix integral(stages, stages);  // c_i^k / k
  for (int k = 0; k < stages; ++k) {
    for (int j = 0; j < stages; ++j) {
      power(k, j) = std::pow(node[j], static_cast<Real>(k));
      integral(k, j) = power(k, j) * node[j] / (k + 1);
    }
  }
  const Eigen::FullPivLU<Matrix> powers(power);
  const Matrix made = powers.solve(integral).transpose();
  const Matrix inverted = made.inverse();
  c = node.cast<double>();
  a = made.cast<double>();
  inverse = inverted.cast<double>();

  const Eigen::EigenSolver<Matrix> modes(inverted);
  const auto vectors = modes.eigenvectors().eval();
  const auto back = vectors.inverse().eval();
  for (Eigen::Index k = 0; k < stages; ++k) {
    const std::complex<Real> value = modes.eigenvalues()[k];
    if (value.imag() == 0) {
      eigenvalue = static_cast<double>(value.real());
      from_mode = vectors.col(k).real().cast<double>();
      to_mode = back.row(k).real().cast<double>();
    } else if (value.imag() > 0) {
      pairs.push_back({std::complex<double>(value), vectors.col(k).cast<std::complex<double>>(),
                       back.row(k).cast<std::complex<double>>()});
    }
  }
  // Quadrature weights of order s, if the start is an additional node with weight 1/λ.
  Vector integrals(stages);
  for (int k = 0; k < stages; ++k) integrals[k] = 1 / static_cast<Real>(k + 1);
  integrals[0] -= 1 / static_cast<Real>(eigenvalue);
  const Vector weights = powers.solve(integrals);
  embedded = ((weights.transpose() - made.row(stages - 1)) * inverted).transpose().cast<double>();
}

}  // namespace statejump::truss::detail
