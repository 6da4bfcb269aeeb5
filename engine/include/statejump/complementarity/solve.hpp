// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>

#include "statejump/complementarity/problem.hpp"

namespace statejump::complementarity {

/// A way to solve a problem.
enum class Method : unsigned char {
  automatic,       ///< The others in turn; see solve().
  gauss_seidel,    ///< Contact by contact, each solved exactly. Slow but sure progress.
  newton,          ///< Semismooth Newton on the Alart-Curnier equations.
  interior_point,  ///< Path-following on De Saxcé's second-order cones.
  lemke            ///< Pivoting; dimension 2 only.
};

/// "automatic", "gauss_seidel", …: the enumerator's name.
const char* to_string(Method method);

enum class Status : unsigned char {
  solved,         ///< Merit::largest() <= tolerance.
  not_converged,  ///< No method came to the tolerance. Whether a solution exists is not known.
  cancelled       ///< The caller's progress function ended it.
};

/// "solved", "not_converged", "cancelled": the enumerator's name.
const char* to_string(Status status);

struct Options {
  double tolerance = 1e-10;  ///< On Merit::largest(), > 0.
  Method method = Method::automatic;
  int most_sweeps = 5000;  ///< Of Gauss-Seidel, >= 0.
  /// Reactions to begin with; zero without.
  std::optional<Eigen::VectorXd> guess = {};
  /// Called now and then with the best merit so far; returning false ends the solve.
  std::function<bool(double)> progress = {};
};

struct Iterations {
  int gauss_seidel = 0;    ///< Sweeps over all contacts.
  int newton = 0;          ///< Linear systems solved.
  int interior_point = 0;  ///< Linear systems factored.
  int pivots = 0;          ///< Of Lemke's table.
};

struct Solution {
  Eigen::VectorXd reactions;   ///< Best that was found.
  Eigen::VectorXd velocities;  ///< W reactions + q.
  Merit merit;
  Iterations iterations;
  Status status = Status::not_converged;
  /// What found the reactions: never `automatic`.
  Method method = Method::gauss_seidel;
};

/// Solves a local frictional contact problem.
///
/// Where W is rank-deficient the velocities are determined further than the reactions; of several
/// solutions one is given. `automatic` sweeps by Gauss-Seidel, hands over to Newton, falls back to
/// the interior point (in planar problems to Lemke, before it or after by size), and sweeps on.
/// @throws kernel::OutOfRange as validate(); for a tolerance <= 0, sweeps < 0, a guess of another
/// size or that is not finite, Lemke in dimension 3
Solution solve(const Problem& problem, const Options& options = {});

}  // namespace statejump::complementarity
