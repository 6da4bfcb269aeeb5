// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <array>
#include <map>
#include <memory>
#include <vector>

namespace statejump::truss {

struct Model;

/// A term factor · dof[row] of a sum.
struct DofTerm {
  int row;
  double factor;
};
/// The translations of a node along its free directions, each expressed as a sum of dofs.
using DofSums = std::array<std::vector<DofTerm>, 3>;

/// Degrees of freedom of one site, which is the position of a node or its rotation: displacements
/// along the first `freedoms` of its free directions. A default object has no dofs and represents
/// the ground.
struct NodeDofs {
  int row = 0;  ///< Index of its first own dof.
  int freedoms = 0;
  const Eigen::Matrix3d* directions = nullptr;
  /// Translations of a node with constraints as sums of dofs. Null: each translation is a dof of
  /// the node.
  const DofSums* sums = nullptr;

  /// Whether a translation is itself a dof, and not a sum or a multiple of dofs.
  bool is_own(int direction, int dof) const {
    if (sums == nullptr) return true;
    const auto& terms = (*sums)[static_cast<std::size_t>(direction)];
    return terms.size() == 1 && terms.front().row == dof && terms.front().factor == 1.0;
  }

  /// Calls `use(row, factor)` for every dof that contributes to a translation along a free
  /// direction.
  template <class Use>
  void each_term(int direction, Use&& use) const {
    if (sums == nullptr) return use(row + direction, 1.0);
    for (const DofTerm& term : (*sums)[static_cast<std::size_t>(direction)]) {
      use(term.row, term.factor);
    }
  }
};

namespace detail {

struct Elimination;

/// Numbering of the independent degrees of freedom of all nodes, node after node: its translations,
/// then its rotations. Constraints determine the dependent ones; see Elimination. Sites are
/// numbered as by rotation_site(); a model without rotations has no sites of rotations.
class DofMap {
 public:
  /// @pre The model outlives this object.
  explicit DofMap(const Model& model);
  /// @param rotates whether a node has rotations
  DofMap(const Model& model, const std::vector<bool>& rotates);

  int dofs() const { return dofs_; }
  /// Dofs of a site; −1: the ground.
  const NodeDofs& at(int site) const {
    return site < 0 ? sites_.back() : sites_[static_cast<std::size_t>(site)];
  }
  std::size_t sites() const { return sites_.size() - 1; }
  bool has_rotations() const { return sites() > count_; }
  /// The node to which a dof belongs.
  int node_of(int dof) const;
  /// Displacement of a site at unknowns z [m].
  Eigen::Vector3d displacement(int node, const Eigen::VectorXd& z) const;
  /// Displacements of all sites at unknowns z [m].
  void displacements(const Eigen::VectorXd& z, Eigen::Matrix3Xd& moved) const;
  /// The dofs for displacements of all sites that satisfy the constraints.
  Eigen::VectorXd dofs_at(const Eigen::Matrix3Xd& moved) const;
  /// Adds a force [N] on a node to `to`, the vector of forces on the dofs.
  void add_force(int node, const Eigen::Vector3d& force, Eigen::VectorXd& to) const;
  /// Whether any dof moves two nodes relative to each other along a direction.
  bool moves_apart(int first, int second, const Eigen::Vector3d& direction) const;
  /// Translations of a node along its free directions at unknowns z.
  static Eigen::Vector3d along_directions(const NodeDofs& at, const Eigen::VectorXd& z);

 private:
  void add_sums(const Elimination& eliminated);

  std::vector<NodeDofs> sites_;                         // one per site, then the ground
  std::size_t count_ = 0;                               // of nodes
  std::shared_ptr<const std::map<int, DofSums>> sums_;  // of constrained nodes
  int dofs_ = 0;
};

}  // namespace detail
}  // namespace statejump::truss
