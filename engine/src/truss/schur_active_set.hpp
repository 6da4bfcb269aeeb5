// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <vector>

#include "linear/sparse_factor.hpp"
#include "system.hpp"

namespace statejump::truss::detail {

/// Equations at a state, by what a Newton step from there knows of them.
struct Linearized {
  const VectorXd& z;
  double time;
  const StepStart& start;
  JointModel model;
  double opening;
  const Statuses& statuses;             ///< On which they were factored.
  const linear::SparseFactor& factors;  ///< Of their Jacobian.
  const VectorXd& step;                 ///< That solves them.
};

/// The statuses of many joints, found on one factorization.
///
/// A joint that changes from one status with contact to another changes a few rows of the
/// equations. Linear in all else, they are condensed to those rows, their Schur complement: one
/// solution for each of them. Statuses then cost a dense system, a change of one status a rank-one
/// update of its inverse (Sherman and Morrison). There pivots are cheap, so that one joint at a
/// time may change where all at once do not settle; see find_active_set().
///
/// Joints that are open, or request to be, keep that.
struct SchurActiveSet {
  Statuses statuses;
  VectorXd step;  ///< That solves the linear equations on them.
};

/// @param joints that may change their status
/// @returns nothing where the statuses cycle or leave the equations singular
std::optional<SchurActiveSet> schur_active_set(const System& system, const Linearized& of,
                                               const std::vector<int>& joints);

}  // namespace statejump::truss::detail
