// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/SparseCore>

#include "statejump/start_friction.hpp"
#include "statejump/truss/motion.hpp"

namespace statejump::truss {

/// Equations M q'' + K q + Cᵀλ = 0 and C q = 0 of small vibrations q about the equilibrium in which
/// the path of a truss begins. Every joint holds: sliders, hinges and latches do not move, and
/// journals and balls rest in their bearings without clearance. K is the stiffness of the elements
/// under their forces.
struct Linearised {
  Eigen::SparseMatrix<double> stiffness;    ///< K, symmetric [N/m].
  Eigen::SparseMatrix<double> mass;         ///< M, symmetric [kg].
  Eigen::SparseMatrix<double> constraints;  ///< C; rows may be zero or depend on others.
  /// Displacements [m] of all nodes (3 rows each), then their rotation vectors [rad] if the truss
  /// has rotations, as linear functions of q.
  Eigen::SparseMatrix<double> of_nodes;
};

/// @throws Failure if the truss has no equilibrium, kernel::OutOfRange for items out of range
Linearised linearise(const Model& model, const Inertia& inertia,
                     StartFriction start_friction = StartFriction::stuck);

}  // namespace statejump::truss
