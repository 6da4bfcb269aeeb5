// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <type_traits>
#include <utility>
#include <vector>

#include "linear/sparse_factor.hpp"
#include "statejump/truss/joints/interface.hpp"
#include "truss/dof_map.hpp"

namespace statejump::truss {

/// Unit in which the residual of a row is measured.
enum class RowUnit : unsigned char { balance, closure, force };

/// Residual and Jacobian of all equations, as sums of entries. Every evaluation writes its entries
/// in the same order. The first evaluation records their positions, so later evaluations need no
/// search. The entries are divided into strands, see AssemblyStrand. Strands that share no position
/// may be written at the same time.
class Assembly {
 public:
  explicit Assembly(Eigen::Index unknowns)
      : residual(unknowns), units(static_cast<std::size_t>(unknowns), RowUnit::balance) {}
  /// Creates an assembly that sums the product of the Jacobian and a vector instead of the
  /// Jacobian. The vector must outlive the assembly.
  explicit Assembly(const Eigen::VectorXd& along) : Assembly(along.size()) {
    along_ = &along;
    product = residual = Eigen::VectorXd::Zero(along.size());
  }

  /// Lists every entry of the Jacobian separately, without sums.
  static Assembly listing(Eigen::Index unknowns) {
    Assembly made(unknowns);
    made.lists_ = true;
    made.residual.setZero();
    return made;
  }

  /// Adds up residuals only, for callers that need no Jacobian.
  static Assembly without_jacobian(Eigen::Index unknowns) {
    Assembly made(unknowns);
    made.residual_only_ = true;
    return made;
  }
  bool residual_only() const { return residual_only_; }
  /// Whether the next evaluations update the Jacobian.
  void want_jacobian(bool wanted) { residual_only_ = !wanted; }

  /// Whether this evaluation records the positions of entries.
  bool records() const {
    return slots_ == nullptr && !residual_only_ && !lists_ && along_ == nullptr;
  }

  std::size_t entries_of_jacobian() const { return slots_->inner.size(); }

  /// Begins an evaluation.
  void clear();
  /// Builds the pattern from the recorded positions.
  void record();

  Eigen::VectorXd residual;
  Eigen::Matrix3Xd moved;  ///< Displacements of all nodes at the evaluated state [m].
  /// The last updated Jacobian. All copies of an assembly share its pattern.
  linear::SparseView jacobian() const {
    return {residual.size(),      residual.size(),      values_.size(),
            slots_->outer.data(), slots_->inner.data(), values_.data()};
  }
  Eigen::VectorXd product;                      ///< Jacobian times the vector.
  std::vector<Eigen::Triplet<double>> entries;  ///< Entries of the Jacobian, if listed.
  std::vector<RowUnit> units;                   ///< Of every row.
  double largest_force = 0.0;                   ///< Largest force of an element or a joint [N].
  std::size_t pieces = 0;  ///< Hash of the active branches of all piecewise laws; 0: none.

 private:
  friend class AssemblyStrand;
  /// Pattern of the Jacobian, and for each written entry its position in the pattern.
  struct Slots {
    std::vector<int> outer, inner;   ///< Compressed columns of the Jacobian.
    std::vector<int> entries;        ///< For every run, the index of its first entry.
    std::vector<std::size_t> begin;  ///< First run of every strand.
  };
  bool residual_only_ = false;
  bool lists_ = false;
  const Eigen::VectorXd* along_ = nullptr;
  /// Consecutive rows of a column of the Jacobian, whose entries are contiguous.
  struct Run {
    int row, column, length;
  };
  std::vector<Run> runs_;
  std::vector<std::size_t> begin_;      // first run of every strand
  std::shared_ptr<const Slots> slots_;  ///< Recorded pattern, shared by all copies.
  Eigen::VectorXd values_;              ///< Entries of the Jacobian.
};

/// Writes one part of an assembly. Every evaluation must write the same positions in the same
/// order.
class AssemblyStrand {
 public:
  /// @param which number of the strand. In the evaluation that records positions, strands must be
  /// created in ascending order
  AssemblyStrand(Assembly& to, std::size_t which) : to_(&to) {
    if (to.slots_ != nullptr) {
      slot_ = to.slots_->entries.data() + to.slots_->begin[which];
      values_ = to.values_.data();
    } else if (to.records()) {
      to.begin_.push_back(to.runs_.size());
    }
  }
  /// Merges force scale and active branches into the assembly. Call it for strands in ascending
  /// order.
  void end() {
    to_->largest_force = std::max(to_->largest_force, largest_force_);
    to_->pieces = to_->pieces * hash_factor_ + pieces_;
  }

  bool residual_only() const { return to_->residual_only_; }
  const Eigen::Matrix3Xd& moved() const { return to_->moved; }
  void residual(int row, double value) { to_->residual[row] += value; }
  /// Adds a force along a free direction of a node.
  void residual(const NodeDofs& at, int direction, double value) {
    at.each_term(direction, [&](int row, double factor) { residual(row, factor * value); });
  }
  void unit(int row, RowUnit unit) { to_->units[static_cast<std::size_t>(row)] = unit; }
  /// Includes a force [N] in the largest force, which scales rounding and force balance.
  void carries(double force) { largest_force_ = std::max(largest_force_, std::abs(force)); }
  /// Reports the active branch of a piecewise law.
  void piece(std::size_t which) {
    pieces_ = hash_base * pieces_ + which;
    hash_factor_ *= hash_base;
  }

  void add(int row, int column, double value) {
    if (residual_only()) return;
    if (slot_ == nullptr) return elsewhere(row, column, value);
    values_[*slot_++] += value;
  }
  /// Adds a block column by column: `value(row within the block, column within the block)`.
  template <class Value>
  void block(int row, int rows, int column, int columns, Value&& value) {
    if (residual_only() || rows == 0) return;
    if (slot_ == nullptr) return block_elsewhere(row, rows, column, columns, value);
    const int* slot = slot_;
    const auto add_up = [&](auto of_rows, auto of_columns) {
      for (int j = 0; j < of_columns; ++j) {
        double* run = values_ + *slot++;
        for (int i = 0; i < of_rows; ++i) run[i] += value(i, j);
      }
    };
    // Most nodes are free in space or in a plane. Loops of constant length are faster.
    if (rows == 2 && columns == 2) {
      add_up(std::integral_constant<int, 2>(), std::integral_constant<int, 2>());
    } else if (rows == 3 && columns == 3) {
      add_up(std::integral_constant<int, 3>(), std::integral_constant<int, 3>());
    } else {
      add_up(rows, columns);
    }
    slot_ += columns;
  }
  /// Adds a block for the free directions of two nodes. `value(i, j)`: direction i of the row node,
  /// j of the column node.
  template <class Value>
  void block(const NodeDofs& rows, const NodeDofs& columns, Value&& value) {
    if (rows.sums == nullptr && columns.sums == nullptr) {
      return block(rows.row, rows.freedoms, columns.row, columns.freedoms, value);
    }
    if (residual_only()) return;
    for (int j = 0; j < columns.freedoms; ++j) {
      for (int i = 0; i < rows.freedoms; ++i) {
        const double entry = value(i, j);
        rows.each_term(i, [&](int row, double by_row) {
          columns.each_term(j, [&](int column, double by_column) {
            add(row, column, by_row * by_column * entry);
          });
        });
      }
    }
  }
  /// Adds a block of zeros.
  void zeros(const NodeDofs& rows, const NodeDofs& columns) {
    if (rows.sums == nullptr && columns.sums == nullptr) {
      return zeros(rows.row, rows.freedoms, columns.row, columns.freedoms);
    }
    block(rows, columns, [](int, int) { return 0.0; });
  }
  /// Skips the positions of a block of zeros. Adding zeros would not change the sums, not even
  /// their signs: a sum that begins at +0 is never −0.
  void zeros(int row, int rows, int column, int columns) {
    if (slot_ == nullptr) return block(row, rows, column, columns, [](int, int) { return 0.0; });
    if (!residual_only() && rows > 0) slot_ += columns;
  }

 private:
  /// Handles the slow cases: positions are not recorded yet, or no summed Jacobian is needed.
  [[gnu::noinline]] void elsewhere(int row, int column, double value) {
    if (to_->lists_) {
      to_->entries.emplace_back(row, column, value);
    } else if (to_->along_ != nullptr) {
      to_->product[row] += value * (*to_->along_)[column];
    } else {
      to_->runs_.push_back({row, column, 1});
    }
  }
  template <class Value>
  [[gnu::noinline]] void block_elsewhere(int row, int rows, int column, int columns,
                                         Value&& value) {
    for (int j = 0; j < columns; ++j) {
      if (to_->records()) {
        to_->runs_.push_back({row, column + j, rows});
        continue;
      }
      for (int i = 0; i < rows; ++i) elsewhere(row + i, column + j, value(i, j));
    }
  }

  static constexpr std::size_t hash_base = 1000003;
  Assembly* to_;
  double* values_ = nullptr;   ///< Entries of the Jacobian.
  const int* slot_ = nullptr;  ///< Next position; null: nothing is recorded.
  double largest_force_ = 0.0;
  std::size_t pieces_ = 0;
  std::size_t hash_factor_ = 1;
};

/// Adds the contributions of a joint to the assembly, in the rows and columns of its nodes and
/// forces.
class JointWriter {
 public:
  explicit JointWriter(AssemblyStrand& strand) : to_(&strand) {}

  std::array<NodeDofs, most_joint_nodes> places;
  int first_force = 0;

  /// Adds the force [N] of the joint on a node.
  void force(std::size_t node, const Eigen::Vector3d& value) {
    const NodeDofs& at = places[node];
    for (int i = 0; i < at.freedoms; ++i) {
      to_->residual(at, i, at.directions->col(i).dot(value));
    }
  }
  bool residual_only() const { return to_->residual_only(); }
  /// Adds the derivative of one node's force with respect to another node's displacement [N/m].
  void block(std::size_t by_node, std::size_t of_node, const Eigen::Matrix3d& value) {
    if (to_->residual_only()) return;
    const NodeDofs& rows = places[by_node];
    const NodeDofs& columns = places[of_node];
    Eigen::Matrix3d image;
    for (int j = 0; j < columns.freedoms; ++j) image.col(j) = value * columns.directions->col(j);
    to_->block(rows, columns,
               [&](int i, int j) { return rows.directions->col(i).dot(image.col(j)); });
  }
  /// Derivative of a row with respect to a node's displacement.
  void row(int row, std::size_t node, const Eigen::Vector3d& gradient) {
    if (to_->residual_only()) return;
    const NodeDofs& at = places[node];
    to_->block(own(row), at, [&](int, int j) { return at.directions->col(j).dot(gradient); });
  }
  /// Adds the derivative of a node's force with respect to a force of the joint [-].
  void column(std::size_t node, int force, const Eigen::Vector3d& gradient) {
    if (to_->residual_only()) return;
    const NodeDofs& at = places[node];
    to_->block(at, own(force), [&](int i, int) { return at.directions->col(i).dot(gradient); });
  }
  /// Adds the derivative of a row with respect to a force of the joint.
  void corner(int row, int force, double value) {
    to_->add(first_force + row, first_force + force, value);
  }
  /// Sets the residual of a row as a closure error [m].
  void closure(int row, double value) { set(row, value, RowUnit::closure); }
  /// Sets the residual of a row as a difference of forces [N].
  void balance(int row, double value) { set(row, value, RowUnit::force); }
  /// Includes a force [N] in the largest force, which scales rounding and force balance.
  void carries(double force) { to_->carries(force); }
  /// Reports the active branch of a piecewise law.
  void piece(std::size_t which) { to_->piece(which); }
  /// Constrains the first two nodes along a direction; one of the joint's forces enforces the
  /// constraint.
  void hold(int row, const Eigen::Vector3d& along, double force, double apart) {
    closure(row, apart);
    this->row(row, 0, along);
    this->row(row, 1, -along);
    this->force(0, force * along);
    this->force(1, -force * along);
    column(0, row, along);
    column(1, row, -along);
    corner(row, row, 0.0);
    carries(force);
  }

 private:
  friend class PlanarWriter;
  /// The dof of a force.
  NodeDofs own(int force) const { return {first_force + force, 1}; }
  void set(int row, double value, RowUnit unit) {
    to_->residual(first_force + row, value);
    to_->unit(first_force + row, unit);
  }
  AssemblyStrand* to_;
};

/// JointWriter for a joint with forces and slides in a plane. Vectors are components along the two
/// directions of the plane.
class PlanarWriter {
 public:
  PlanarWriter(JointWriter& to, const Eigen::Matrix<double, 3, 2>& plane) : to_(&to) {
    for (std::size_t k = 0; k < seen_.size(); ++k) {
      const NodeDofs& at = to.places[k];
      for (int i = 0; i < at.freedoms; ++i) {
        seen_[k].col(i) = plane.transpose() * at.directions->col(i);
      }
    }
  }

  /// From here on, the first component of vectors at a site is along a gradient, and the second one
  /// is omitted. An angle of a node has such a gradient.
  void along(std::size_t site, const Eigen::Vector3d& gradient) {
    const NodeDofs& at = to_->places[site];
    for (int i = 0; i < at.freedoms; ++i) {
      seen_[site].col(i) << gradient.dot(at.directions->col(i)), 0.0;
    }
  }

  void force(std::size_t node, const Eigen::Vector2d& value) {
    const NodeDofs& at = to_->places[node];
    for (int i = 0; i < at.freedoms; ++i) {
      to_->to_->residual(at, i, seen_[node].col(i).dot(value));
    }
  }
  void block(std::size_t by_node, std::size_t of_node, const Eigen::Matrix2d& value) {
    const NodeDofs& rows = to_->places[by_node];
    const NodeDofs& columns = to_->places[of_node];
    Directions image;
    for (int j = 0; j < columns.freedoms; ++j) image.col(j) = value * seen_[of_node].col(j);
    to_->to_->block(rows, columns,
                    [&](int i, int j) { return seen_[by_node].col(i).dot(image.col(j)); });
  }
  void no_block(std::size_t by_node, std::size_t of_node) {
    to_->to_->zeros(to_->places[by_node], to_->places[of_node]);
  }
  void row(int row, std::size_t node, const Eigen::Vector2d& gradient) {
    to_->to_->block(to_->own(row), to_->places[node],
                    [&](int, int j) { return seen_[node].col(j).dot(gradient); });
  }
  void column(std::size_t node, int force, const Eigen::Vector2d& gradient) {
    to_->to_->block(to_->places[node], to_->own(force),
                    [&](int i, int) { return seen_[node].col(i).dot(gradient); });
  }

 private:
  using Directions = Eigen::Matrix<double, 2, 3>;
  JointWriter* to_;
  /// In-plane components of the nodes' free directions.
  std::array<Directions, most_joint_nodes> seen_;
};

}  // namespace statejump::truss
