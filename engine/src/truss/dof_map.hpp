// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <vector>

namespace statejump::truss {

struct Model;

/// Degrees of freedom of one node: translations in the first `freedoms` of its free directions,
/// then its rotations. None by default, as of the ground.
struct NodeDofs {
  int row = 0;       ///< Of the first dof.
  int freedoms = 0;  ///< Translations.
  const Eigen::Matrix3d* directions = nullptr;
  int rotations = 0;  ///< 3 where an element has 6 dofs per node, else 0.
};

namespace detail {

/// Numbering of the degrees of freedom of all nodes, node after node.
class DofMap {
 public:
  /// The model must outlive it.
  explicit DofMap(const Model& model);
  /// @param rotates whether a node has rotations
  DofMap(const Model& model, const std::vector<bool>& rotates);

  int dofs() const { return dofs_; }
  /// Of a node; −1: the ground.
  const NodeDofs& at(int node) const {
    return node < 0 ? nodes_.back() : nodes_[static_cast<std::size_t>(node)];
  }
  /// Node of a dof.
  int node_of(int dof) const;
  /// Translation of a node at unknowns z [m].
  Eigen::Vector3d displacement(int node, const Eigen::VectorXd& z) const;
  /// Those of all nodes.
  void displacements(const Eigen::VectorXd& z, Eigen::Matrix3Xd& moved) const;

 private:
  std::vector<NodeDofs> nodes_;  // then the ground
  int dofs_ = 0;
};

}  // namespace detail
}  // namespace statejump::truss
