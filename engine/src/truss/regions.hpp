// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <vector>

#include "dof_map.hpp"
#include "statejump/truss/joints/interface.hpp"
#include "statejump/truss/model.hpp"

namespace statejump::truss::detail {

/// Part of a truss: indices of its elements and joints in the model, in ascending order.
struct Region {
  std::vector<int> loaded;                               ///< Nodes with a load.
  std::array<std::vector<int>, element_types> elements;  ///< Of each type.
  std::vector<int> joints;
};

/// Division of a truss for parallel assembly: regions that share no free nodes, and the elements
/// and joints between them, which are assembled afterwards. The division, and thus the order of
/// sums, depends only on the truss, not on the number of threads.
struct Regions {
  std::vector<Region> apart;  ///< Regions; a small truss has none.
  Region between;
};

Regions regions_of(const Model& model, const DofMap& dofs, const ElementFrames& elements,
                   const std::vector<JointFrame>& joints);

}  // namespace statejump::truss::detail
