// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <vector>

#include "linear/sparse_factor.hpp"
#include "system.hpp"

namespace statejump::truss::detail {

/// Equations linearised at a state.
struct Linearized {
  const VectorXd& z;
  double time;
  const StepStart& start;
  JointModel model;
  double opening;
  const Statuses& statuses;             ///< Statuses on which the Jacobian was factored.
  const linear::SparseFactor& factors;  ///< Factors of the Jacobian.
  const VectorXd& step;                 ///< Newton step that solves the linearised equations.
};

/// Statuses of many joints, found with one factorization.
///
/// If a joint changes from one closed status to another, only a few rows of the linear equations
/// change. The equations are condensed to these rows (Schur complement), with one solution per row.
/// A set of statuses then costs one dense system, and a change of one status a rank-one update of
/// its inverse (Sherman and Morrison). Pivots are cheap, so single pivots are affordable if block
/// pivots fail; see find_active_set().
///
/// Joints that are open, or request to open, keep their status.
struct SchurActiveSet {
  Statuses statuses;
  VectorXd step;  ///< Solution of the linear equations on these statuses.
};

/// @param joints that may change their status
/// @returns nothing if the statuses cycle or the equations become singular
std::optional<SchurActiveSet> schur_active_set(const System& system, const Linearized& of,
                                               const std::vector<int>& joints);

}  // namespace statejump::truss::detail
