// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <Eigen/LU>
#include <cmath>
#include <random>
#include <vector>

#include "statejump/complementarity/solve.hpp"

namespace statejump::complementarity::testing {

/// One contact in three dimensions with a full matrix W.
inline Problem one_contact(const Eigen::Vector3d& q, double mu) {
  Eigen::Matrix3d w;
  w << 2.0, 0.3, -0.2, 0.3, 1.5, 0.1, -0.2, 0.1, 1.0;
  return {3, Eigen::MatrixXd(w), q, Eigen::VectorXd::Constant(1, mu)};
}

/// Random problem with W = H H^T for bodies with `freedoms` degrees of freedom, u = H v. Since u =
/// 0 is attainable, a solution exists (Acary and Cadoux 2013).
inline Problem random_problem(int dimension, int contacts, int freedoms, double most_friction,
                              std::mt19937& random) {
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform;
  const Eigen::MatrixXd h =
      Eigen::MatrixXd::NullaryExpr(contacts * dimension, freedoms, [&] { return normal(random); });
  const Eigen::VectorXd v = Eigen::VectorXd::NullaryExpr(freedoms, [&] { return normal(random); });
  return {dimension, Eigen::MatrixXd(h * h.transpose()), h * v,
          Eigen::VectorXd::NullaryExpr(contacts, [&] { return most_friction * uniform(random); })};
}

}  // namespace statejump::complementarity::testing
