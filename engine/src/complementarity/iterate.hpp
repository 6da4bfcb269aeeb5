// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <utility>

#include "scaled_problem.hpp"

namespace statejump::complementarity {

/// Reactions and the quantities derived from them.
struct Iterate {
  Iterate(const ScaledProblem& problem, Eigen::VectorXd reactions)
      : r(std::move(reactions)), u(problem.times(r) + problem.q()), merit(problem.merit(r, u)) {}

  Eigen::VectorXd r;
  Eigen::VectorXd u;
  double merit;
};

}  // namespace statejump::complementarity
