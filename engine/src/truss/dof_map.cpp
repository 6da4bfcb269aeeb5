// SPDX-License-Identifier: GPL-3.0-or-later
#include "dof_map.hpp"

#include <algorithm>

#include "parallel.hpp"
#include "statejump/truss/model.hpp"

namespace statejump::truss::detail {

namespace {

/// Copying as many displacements takes some ten times as long as starting a thread.
constexpr std::size_t nodes_at_once = 50000;

/// Whether an element at a node has 6 dofs per node, for every node.
std::vector<bool> rotating_nodes(const Model& model) {
  std::vector<bool> rotates(model.nodes.size(), false);
  const auto ask = [&]<class Type>(const std::vector<Type>& elements) {
    if constexpr (Type::dofs_per_node == 6) {
      for (const Type& one : elements) {
        for (const int node : one.frame(model).nodes) {
          if (node >= 0) rotates[static_cast<std::size_t>(node)] = true;
        }
      }
    }
  };
  std::apply([&](const auto&... lists) { (ask(lists), ...); }, model.lists());
  return rotates;
}

}  // namespace

DofMap::DofMap(const Model& model) : DofMap(model, rotating_nodes(model)) {}

DofMap::DofMap(const Model& model, const std::vector<bool>& rotates) {
  nodes_.reserve(model.nodes.size() + 1);
  for (const Node& node : model.nodes) {
    const int rotations = rotates[nodes_.size()] ? 3 : 0;
    nodes_.push_back({dofs_, node.freedoms, &node.free_directions.matrix(), rotations});
    dofs_ += node.freedoms + rotations;
  }
  nodes_.emplace_back();
}

int DofMap::node_of(int dof) const {
  const auto nodes = nodes_.end() - 1;
  const auto after = std::upper_bound(nodes_.begin(), nodes, dof,
                                      [](int row, const NodeDofs& at) { return row < at.row; });
  return static_cast<int>(after - nodes_.begin()) - 1;
}

Eigen::Vector3d DofMap::displacement(int node, const Eigen::VectorXd& z) const {
  const NodeDofs& at = nodes_[static_cast<std::size_t>(node)];
  const double* along = z.data() + at.row;
  switch (at.freedoms) {
    case 3:
      return along[0] * at.directions->col(0) + along[1] * at.directions->col(1) +
             along[2] * at.directions->col(2);
    case 2:
      return along[0] * at.directions->col(0) + along[1] * at.directions->col(1);
    case 1:
      return along[0] * at.directions->col(0);
    default:
      return Eigen::Vector3d::Zero();
  }
}

void DofMap::displacements(const Eigen::VectorXd& z, Eigen::Matrix3Xd& moved) const {
  moved.resize(3, static_cast<Eigen::Index>(nodes_.size() - 1));
  each_in_parallel(nodes_.size() - 1, nodes_at_once, [&](std::size_t i) {
    moved.col(static_cast<Eigen::Index>(i)) = displacement(static_cast<int>(i), z);
  });
}

}  // namespace statejump::truss::detail
