// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <map>
#include <vector>

#include "statejump/truss/model.hpp"

namespace statejump::truss::detail {

/// Index of a node's displacement along one of its free directions.
inline int place_of(int node, int direction) {
  return 3 * node + direction;
}

/// The displacements that constraints determine, as sums of independent ones.
///
/// Dependent displacements are eliminated: all displacements are T q, and the matrices of the
/// solver are TᵀKT and TᵀMT. Lagrange multipliers would keep K and M unchanged. But each would add
/// a row without stiffness and mass to every matrix, with these effects:
///
/// - the number of negative pivots would no longer be that of unstable modes,
/// - the proximal terms of slack trusses and the shifts of the search for mechanisms would need
///   exceptions,
/// - motion would be a differential-algebraic system of index 3, whose positions drift.
///
/// After elimination, solver and integrators use independent displacements only, and constraints
/// hold to rounding at every state. The cost is fill: a constraint of n terms makes a block of n²
/// entries for each element at its dependent node.
struct Elimination {
  /// For the index of each dependent displacement: indices and factors of the independent ones.
  std::map<int, std::map<int, double>> sums;
  std::vector<int> redundant;  ///< Indices of constraints that follow from others.
};

/// Gauss–Jordan elimination, one constraint after another. The pivot is the largest factor, so that
/// no factor grows. Among equal factors the pivot is the one used in the fewest sums, so that
/// chains stay sparse.
Elimination eliminate(const Model& model);

}  // namespace statejump::truss::detail
