// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/SparseCore>
#include <vector>

#include "drives.hpp"
#include "step_forces.hpp"

namespace statejump::truss::detail {

/// Linear constraints Bᵀ v = w on the velocities at the end of a step: first those of joints that
/// constrain two nodes, then those of drives. Columns are scaled to the step matrix, so that pivots
/// are comparable.
class VelocityConstraints {
 public:
  /// @pre The arguments outlive this object.
  VelocityConstraints(const StepForces& forces, const std::vector<Drive>& drives);

  Eigen::Index count() const;
  Eigen::Index drive_count() const { return drives_.count(); }
  /// Sets the columns for a step, with a scale.
  void set(const TimeStep& step, double scale);

  const Eigen::SparseMatrix<double>& columns() const { return columns_; }  ///< B
  const VectorXd& speeds() const { return speeds_; }                       ///< w
  double scale() const { return scale_; }

 private:
  const StepForces& forces_;
  Drives drives_;
  Eigen::SparseMatrix<double> columns_;
  VectorXd speeds_;
  double scale_ = 1.0;
};

}  // namespace statejump::truss::detail
