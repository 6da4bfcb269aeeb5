// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <complex>
#include <vector>

namespace statejump::truss::detail {

/// Radau IIA with s stages, s odd: collocation method of order 2s − 1, L-stable. Its last stage is
/// the end of the step [1]. A⁻¹ = T Λ T⁻¹ has one real eigenvalue and complex pairs; one of each
/// pair is stored.
///
/// [1] E. Hairer, G. Wanner, Solving Ordinary Differential Equations II, Springer 1996, IV.5, IV.8.
struct Radau {
  explicit Radau(int stages);

  Eigen::VectorXd c;  ///< Times of the stages over the step.
  Eigen::MatrixXd a;
  Eigen::MatrixXd inverse;  ///< A⁻¹
  /// Weights of the stages' increments in the difference between this method and the embedded
  /// method of order s. The embedded method also uses h/λ times the rate at the start.
  Eigen::VectorXd embedded;

  double eigenvalue = 0.0;     ///< λ, the real eigenvalue.
  Eigen::VectorXd from_mode;   ///< Column of T for λ.
  Eigen::RowVectorXd to_mode;  ///< Row of T⁻¹ for λ.
  struct Pair {
    std::complex<double> eigenvalue;  ///< Positive imaginary part.
    Eigen::VectorXcd from_mode;
    Eigen::RowVectorXcd to_mode;
  };
  std::vector<Pair> pairs;
};

}  // namespace statejump::truss::detail
