// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <vector>

#include "dof_map.hpp"
#include "statejump/truss/joints/interface.hpp"
#include "statejump/truss/model.hpp"

namespace statejump::truss::detail {

/// Items of a truss, by their indices in the model, each list in ascending order.
struct Region {
  std::vector<int> loaded;                               ///< Nodes with a load.
  std::array<std::vector<int>, element_types> elements;  ///< Of each type.
  std::vector<int> joints;
};

/// Division of a truss for parallel assembly: regions without common free nodes, and the items
/// between them, which are assembled afterwards. The division, and with it the order of sums in a
/// row, depends on the truss alone. Results therefore do not depend on the number of threads.
struct Regions {
  std::vector<Region> apart;  ///< Regions; a small truss has none.
  Region between;
};

Regions regions_of(const Model& model, const DofMap& dofs, const ElementFrames& elements,
                   const std::vector<JointFrame>& joints);

}  // namespace statejump::truss::detail
