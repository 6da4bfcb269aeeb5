// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>

#include "statejump/complementarity/problem.hpp"

namespace statejump::complementarity {

/// Solution method.
enum class Method : unsigned char {
  automatic,       ///< The other methods in turn; see solve().
  gauss_seidel,    ///< Contact by contact, each solved exactly. Slow but robust.
  newton,          ///< Semismooth Newton on the Alart-Curnier equations.
  interior_point,  ///< Path-following on De Saxcé's second-order cones.
  lemke            ///< Pivoting; dimension 2 only.
};

/// "automatic", "gauss_seidel", …: the enumerator's name.
const char* to_string(Method method);

enum class Status : unsigned char {
  solved,         ///< Merit::largest() <= tolerance.
  not_converged,  ///< No method reached the tolerance. A solution may exist or not.
  cancelled       ///< The progress callback returned false.
};

/// "solved", "not_converged", "cancelled": the enumerator's name.
const char* to_string(Status status);

struct Options {
  double tolerance = 1e-10;  ///< On Merit::largest(), > 0.
  Method method = Method::automatic;
  int most_sweeps = 5000;  ///< Largest number of Gauss-Seidel sweeps, >= 0.
  /// Initial reactions; zero if empty.
  std::optional<Eigen::VectorXd> guess = {};
  /// Progress callback that receives the best merit so far. If it returns false, the solve is
  /// cancelled.
  std::function<bool(double)> progress = {};
};

struct Iterations {
  int gauss_seidel = 0;    ///< Sweeps over all contacts.
  int newton = 0;          ///< Linear systems solved.
  int interior_point = 0;  ///< Linear systems factored.
  int pivots = 0;          ///< In Lemke's table.
};

struct Solution {
  Eigen::VectorXd reactions;   ///< Best reactions found.
  Eigen::VectorXd velocities;  ///< W reactions + q.
  Merit merit;
  Iterations iterations;
  Status status = Status::not_converged;
  /// The method that found the reactions: never `automatic`.
  Method method = Method::gauss_seidel;
};

/// Solves a local frictional contact problem.
///
/// If W is rank-deficient, several reactions may give nearly the same velocities; solve() returns
/// one of them. The method `automatic` starts with Gauss-Seidel sweeps and continues with Newton.
/// If that fails, it tries the interior point, then further sweeps. In planar problems it also
/// tries Lemke: in small ones before the interior point, in larger ones after it.
/// @throws kernel::OutOfRange as validate(); also for a tolerance <= 0, sweeps < 0, a guess of
/// wrong size or with values that are not finite, and Lemke in dimension 3
Solution solve(const Problem& problem, const Options& options = {});

}  // namespace statejump::complementarity
