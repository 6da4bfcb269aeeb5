// SPDX-License-Identifier: GPL-3.0-or-later
#include "regions.hpp"

#include <algorithm>
#include <cstddef>
#include <set>

#include "numerics/lists.hpp"
#include "parts.hpp"

namespace statejump::truss::detail {

namespace {

using numerics::Lists;

/// Smallest number of elements and joints in a region. Their assembly takes about ten times as long
/// as starting a thread.
constexpr std::size_t least_parts = 2000;
/// Largest number of regions: even distribution, and few items between regions.
constexpr std::size_t most_regions = 64;

/// The nodes whose dofs determine the motion of a constrained node.
std::set<int> moving_with(const DofMap& dofs, const NodeDofs& at) {
  std::set<int> found;
  for (int i = 0; i < at.freedoms; ++i) {
    at.each_term(i, [&](int row, double) { found.insert(dofs.node_of(row)); });
  }
  return found;
}

/// The free nodes of every element (type by type), then of every joint.
Lists moving_nodes(const DofMap& dofs, const ElementFrames& elements,
                   const std::vector<JointFrame>& joints) {
  Lists made;
  const auto add = [&](const auto& frames) {
    for (const auto& frame : frames) {
      for (const int node : frame.nodes) {
        const NodeDofs& at = dofs.at(node);
        if (at.sums == nullptr) {
          if (at.freedoms > 0) made.push_back(node);
          continue;
        }
        // Its entries belong to the nodes whose dofs determine its motion.
        for (const int other : moving_with(dofs, at)) {
          made.push_back(other);
          if (dofs.has_rotations()) made.push_back(other + static_cast<int>(dofs.sites() / 2));
        }
      }
      made.end_list();
    }
  };
  std::apply([&](const auto&... lists) { (add(lists), ...); }, elements);
  add(joints);
  return made;
}

/// Assigns every node to a region; −1: fixed node. A breadth-first search orders the nodes. This
/// order is divided into parts with equal numbers of elements and joints.
std::vector<int> cut(const Lists& nodes_of, std::size_t nodes, std::size_t regions) {
  const Lists parts_of = nodes_of.inverted(nodes);
  std::vector<int> region(nodes, -1);
  std::size_t passed = 0;
  for (const int node : numerics::breadth_first(parts_of, nodes_of)) {
    const auto parts =
        static_cast<std::size_t>(parts_of.end(index(node)) - parts_of.begin(index(node)));
    if (parts > 0) region[index(node)] = static_cast<int>(passed * regions / nodes_of.numbers());
    passed += parts;
  }
  return region;
}

}  // namespace

Regions regions_of(const Model& model, const DofMap& dofs, const ElementFrames& elements,
                   const std::vector<JointFrame>& joints) {
  const Lists nodes_of = moving_nodes(dofs, elements, joints);
  const std::size_t count = std::min(most_regions, nodes_of.size() / least_parts);
  Regions made;
  std::vector<int> region_of_node(dofs.sites(), -1);
  if (count > 1) {
    made.apart.resize(count);
    region_of_node = cut(nodes_of, dofs.sites(), count);
  }
  const auto region = [&](int which) -> Region& {
    return which < 0 ? made.between : made.apart[index(which)];
  };
  std::size_t part = 0;
  const auto share_out = [&](std::size_t parts, auto&& list_of) {
    for (std::size_t i = 0; i < parts; ++i, ++part) {
      int of = -1;
      bool inside = true;
      for (const int* node = nodes_of.begin(part); node != nodes_of.end(part); ++node) {
        const int its = region_of_node[index(*node)];
        inside = inside && (of < 0 || its == of);
        of = its;
      }
      list_of(region(inside ? of : -1)).push_back(static_cast<int>(i));
    }
  };
  for_each_element_type([&]<std::size_t k>(std::integral_constant<std::size_t, k>) {
    share_out(std::get<k>(elements).size(),
              [](Region& at) -> std::vector<int>& { return at.elements[k]; });
  });
  share_out(joints.size(), [](Region& at) -> std::vector<int>& { return at.joints; });
  for (std::size_t n = 0; n < model.nodes.size(); ++n) {
    if (model.nodes[n].load.isZero(0.0)) continue;
    const bool is_constrained = dofs.at(static_cast<int>(n)).sums != nullptr;
    region(is_constrained ? -1 : region_of_node[n]).loaded.push_back(static_cast<int>(n));
  }
  if (!dofs.has_rotations()) return made;
  for (std::size_t n = 0; n < model.nodes.size(); ++n) {
    const int site = rotation_site(model, static_cast<int>(n));
    if (model.nodes[n].moment.isZero(0.0) || dofs.at(site).freedoms == 0) continue;
    const bool is_constrained = dofs.at(site).sums != nullptr;
    region(is_constrained ? -1 : region_of_node[index(site)]).loaded.push_back(site);
  }
  return made;
}

}  // namespace statejump::truss::detail
