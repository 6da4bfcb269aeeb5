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

/// A truss divided into regions without common free nodes, which can be assembled at the same time,
/// and the items between them, which are assembled afterwards. The order of sums in a row depends
/// on the division, and the division depends on the truss alone. Results therefore do not depend on
/// the number of threads.
struct Regions {
  std::vector<Region> apart;  ///< None of a small truss.
  Region between;
};

Regions regions_of(const Model& model, const DofMap& dofs, const ElementFrames& elements,
                   const std::vector<JointFrame>& joints);

}  // namespace statejump::truss::detail
