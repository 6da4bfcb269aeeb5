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

/// The branches of many joints, found on one factorization.
///
/// A joint that goes from one branch with contact to another changes a few rows of the equations.
/// Linear in all else, they are condensed to those rows: one solution for each of them, and a set
/// of branches costs a dense system, a change of one branch a rank-one update of its inverse
/// (Sherman and Morrison). There pivots are cheap, so that one joint at a time may be changed where
/// all at once do not settle: block principal pivoting as long as each block leaves fewer
/// violations than there ever were, else the joint of the lowest number [1, 2]. For a P-matrix that
/// ends after finitely many pivots.
///
/// Joints that are open, or want to be, are left as they are.
///
/// [1] J. J. Júdice, F. M. Pires, Comput. Oper. Res. 21 (1994) 587-596.
/// [2] K. G. Murty, Linear Algebra Appl. 9 (1974) 65-108.
struct CondensedPivots {
  Statuses statuses;
  VectorXd step;  ///< That solves the linear equations on them.
};

/// @param joints that may change their branch
/// @returns nothing where the sets go round in a circle or leave the equations singular
std::optional<CondensedPivots> condensed_pivots(const System& system, const Linearized& of,
                                                const std::vector<int>& joints);

}  // namespace statejump::truss::detail
