// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/SparseCore>

#include "statejump/truss/model.hpp"
#include "truss/dof_map.hpp"

namespace statejump::truss::detail {

/// Displacements [m] of all nodes (3 rows each), then their rotation vectors [rad] if the truss has
/// rotations, as linear functions of the dofs.
Eigen::SparseMatrix<double> of_nodes(const Model& model, const DofMap& dofs);

}  // namespace statejump::truss::detail
