// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <map>
#include <vector>

#include "statejump/truss/model.hpp"

namespace statejump::truss::detail {

/// Index of a site's displacement along one of its free directions.
inline int place_of(int site, int direction) {
  return 3 * site + direction;
}

/// Displacements that constraints determine, expressed as sums of independent displacements.
///
/// Dependent displacements are eliminated: all displacements are T q, and the matrices of the
/// solver are TᵀKT and TᵀMT. Lagrange multipliers would keep K and M unchanged. But each multiplier
/// would add a row without stiffness and mass to every matrix, with these effects:
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
  /// Sum of each dependent displacement, by its index: indices and factors of independent
  /// displacements.
  std::map<int, std::map<int, double>> sums;
  std::vector<int> redundant;  ///< Indices of constraints that follow from others.
};

/// Eliminates one constraint after another by Gauss–Jordan elimination. The pivot is the
/// displacement with the largest factor, so that factors do not grow. Among equal factors it is the
/// one in the fewest sums, so that chains remain sparse. The constraints of the model precede the
/// ties() of its joints.
Elimination eliminate(const Model& model);

}  // namespace statejump::truss::detail
