// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <vector>

#include "system.hpp"

namespace statejump::truss::detail {

namespace {

using ByRows = Eigen::SparseMatrix<double, Eigen::RowMajor>;

/// Sums the entries of a sparse column.
class Column {
 public:
  explicit Column(Eigen::Index size) : value_(VectorXd::Zero(size)), met_(index(size), false) {}

  void add(Eigen::Index row, double value) {
    if (!met_[index(row)]) rows_.push_back(static_cast<int>(row));
    met_[index(row)] = true;
    value_[row] += value;
  }
  std::size_t entries() const { return rows_.size(); }
  /// Writes rows and values, rows ascending.
  void write(int* rows, double* values) {
    std::sort(rows_.begin(), rows_.end());
    for (const int row : rows_) {
      *rows++ = row;
      *values++ = value_[row];
    }
  }
  void clear() {
    for (const int row : rows_) {
      met_[index(row)] = false;
      value_[row] = 0.0;
    }
    rows_.clear();
  }

 private:
  static std::size_t index(Eigen::Index row) { return static_cast<std::size_t>(row); }

  VectorXd value_;
  std::vector<bool> met_;
  std::vector<int> rows_;
};

}  // namespace

Eigen::SparseMatrix<double> System::penalty_stiffness(const VectorXd& z, double time,
                                                      const Statuses& statuses, JointModel joints,
                                                      double held, double slack) const {
  Assembly at = assembly();
  StepStart start = begin(z, time, statuses, 1.0);
  start.slack_stiffness = slack;
  evaluate(z, time, start, statuses, joints, 1.0, at);
  const linear::SparseView jacobian = at.jacobian();
  const Eigen::Index n = displacements_;
  const ByRows above = jacobian.block(0, 0, n, n).triangularView<Eigen::StrictlyUpper>();
  // Joint forces are condensed, which turns every constrained direction into a penalty spring. Rows
  // without a constraint have no entries. Gradients of closures in metres are of order one.
  const ByRows holds = jacobian.block(n, 0, unknowns_ - n, n);
  const double stiffness = held * stiffness_scale_;
  Column column(n);
  const auto add_up = [&](Eigen::Index j) {
    column.clear();
    for (linear::SparseView::InnerIterator it(jacobian, j); it; ++it) {
      if (it.row() >= n) {
        for (ByRows::InnerIterator of(holds, it.row() - n); of; ++of) {
          if (of.col() >= j) column.add(of.col(), stiffness * it.value() * of.value());
        }
      } else if (it.row() >= j) {
        // Half of the entry and half of its transpose.
        column.add(it.row(), it.row() == j ? it.value() : 0.5 * it.value());
      }
    }
    for (ByRows::InnerIterator it(above, j); it; ++it) column.add(it.col(), 0.5 * it.value());
  };
  Eigen::SparseMatrix<double> lower(n, n);
  int* begins = lower.outerIndexPtr();
  for (Eigen::Index j = 0; j < n; ++j) {
    add_up(j);
    begins[j + 1] = begins[j] + static_cast<int>(column.entries());
  }
  lower.resizeNonZeros(begins[n]);
  for (Eigen::Index j = 0; j < n; ++j) {
    add_up(j);
    column.write(lower.innerIndexPtr() + begins[j], lower.valuePtr() + begins[j]);
  }
  return lower;
}

}  // namespace statejump::truss::detail
