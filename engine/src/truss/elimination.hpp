// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <map>
#include <vector>

#include "statejump/truss/model.hpp"

namespace statejump::truss::detail {

/// Place of a displacement of a node along one of its free directions among those of all nodes.
inline int place_of(int node, int direction) {
  return 3 * node + direction;
}

/// The displacements that constraints give, as sums of independent ones.
///
/// Dependent displacements are eliminated: all displacements are T q, the matrices of the solver
/// TᵀKT and TᵀMT. Lagrange multipliers would keep K and M as they are. But each would add a row
/// without stiffness and mass to every matrix: the number of negative pivots would no longer be
/// that of unstable modes, the proximal terms of slack trusses and the shifts of the search for
/// mechanisms would need exceptions, and motion would be a differential-algebraic system of index
/// 3, whose positions drift. After elimination, solver and integrators see independent
/// displacements alone, and constraints hold to rounding at every state. The price is that an
/// equation of n terms makes a block of n² entries for each element at its dependent node.
struct Elimination {
  /// Factors of independent displacements by their places, for each dependent place.
  std::map<int, std::map<int, double>> sums;
  std::vector<int> redundant;  ///< Constraints.
};

/// Gauss–Jordan elimination, constraint after constraint. The pivot is the largest factor, so that
/// no factor grows; of several such ones the one in the fewest sums, so that chains stay sparse.
Elimination eliminate(const Model& model);

}  // namespace statejump::truss::detail
