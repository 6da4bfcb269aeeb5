// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <vector>

#include "dof_map.hpp"
#include "statejump/truss/joints/interface.hpp"
#include "statejump/truss/model.hpp"

namespace statejump::truss::detail {

/// Parts of a truss, by their indices in the model, each list in ascending order.
struct Region {
  std::vector<int> loaded;                               ///< Nodes with a load.
  std::array<std::vector<int>, element_types> elements;  ///< Of each type.
  std::vector<int> joints;
};

/// A truss cut into regions that share no node that moves, so that they may be assembled at the
/// same time, and the parts between them, which are assembled after them. What is added to a row of
/// the equations in which order depends on the cut, and the cut on the truss alone: results do not
/// depend on the number of threads.
struct Regions {
  std::vector<Region> apart;  ///< None of a small truss.
  Region between;
};

Regions regions_of(const Model& model, const DofMap& dofs, const ElementFrames& elements,
                   const std::vector<JointFrame>& joints);

}  // namespace statejump::truss::detail
