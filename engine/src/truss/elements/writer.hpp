// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <vector>

#include "truss/dof_map.hpp"
#include "truss/joints/writer.hpp"

namespace statejump::truss {

/// Adds the forces of elements on nodes, and their derivatives, to the rows of the nodes' dofs.
/// Node −1, the ground, has no rows. Forces on sites of rotations are moments over Node::arm [N].
class ElementWriter {
 public:
  ElementWriter(const detail::DofMap& dofs, AssemblyStrand& to) : dofs_(&dofs), to_(&to) {}

  const NodeDofs& at(int node) const { return dofs_->at(node); }
  bool residual_only() const { return to_->residual_only(); }
  /// Adds the force [N] of the element on a node.
  void force(int node, const Eigen::Vector3d& value) {
    const NodeDofs& dofs = at(node);
    for (int i = 0; i < dofs.freedoms; ++i) {
      to_->residual(dofs, i, dofs.directions->col(i).dot(value));
    }
  }
  /// Adds the derivative of one node's force with respect to another node's displacement. `value(i,
  /// j)`: direction i of the force, direction j of the displacement.
  template <class Value>
  void block(int row_node, int column_node, Value&& value) {
    to_->block(at(row_node), at(column_node), value);
  }
  /// Adds the derivative of the force on one site with respect to the displacement of another.
  void matrix(int row_site, int column_site, const Eigen::Matrix3d& value) {
    if (residual_only()) return;
    const NodeDofs& rows = at(row_site);
    const NodeDofs& columns = at(column_site);
    if (rows.freedoms == 0 || columns.freedoms == 0) return;
    const Eigen::Matrix3d seen = rows.directions->transpose() * value * *columns.directions;
    to_->block(rows, columns, [&](int i, int j) { return seen(i, j); });
  }
  /// Components of a vector along the free directions of a node.
  Eigen::Vector3d seen(int node, const Eigen::Vector3d& vector) const {
    return at(node).directions->transpose() * vector;
  }
  /// Includes a force [N] in the largest force, which scales rounding and force balance.
  void carries(double force) { to_->carries(force); }
  /// Reports the active branch of a piecewise law.
  void piece(std::size_t which) { to_->piece(which); }

 private:
  const detail::DofMap* dofs_;
  AssemblyStrand* to_;
};

/// Lists the entries of a matrix that acts on translations.
class MatrixWriter {
 public:
  MatrixWriter(const detail::DofMap& dofs, std::vector<Eigen::Triplet<double>>& to)
      : dofs_(&dofs), to_(&to) {}

  /// Adds the derivative of a force on one node with respect to the motion of another.
  void block(int row_node, int column_node, const Eigen::Matrix3d& value) {
    const NodeDofs& rows = dofs_->at(row_node);
    const NodeDofs& columns = dofs_->at(column_node);
    for (int j = 0; j < columns.freedoms; ++j) {
      const Eigen::Vector3d image = value * columns.directions->col(j);
      for (int i = 0; i < rows.freedoms; ++i) {
        const double entry = rows.directions->col(i).dot(image);
        rows.each_term(i, [&](int row, double by_row) {
          columns.each_term(j, [&](int column, double by_column) {
            to_->emplace_back(row, column, by_row * by_column * entry);
          });
        });
      }
    }
  }
  /// Adds a resistance against the relative motion of two nodes.
  void between(int first, int second, const Eigen::Matrix3d& value) {
    block(first, first, value);
    block(second, second, value);
    block(first, second, -value);
    block(second, first, -value);
  }

 private:
  const detail::DofMap* dofs_;
  std::vector<Eigen::Triplet<double>>* to_;
};

}  // namespace statejump::truss
