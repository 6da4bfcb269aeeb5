// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/SparseCore>
#include <vector>

#include "drives.hpp"
#include "step_forces.hpp"

namespace statejump::truss::detail {

/// Linear constraints Bᵀ v = w on the velocities at the end of a step: first those of joints that
/// constrain two nodes along constant directions, then those whose directions rotate with the nodes
/// (Contacts::turning_holds()), then those of drives. Columns are scaled to the step matrix, so
/// that pivots are comparable.
///
/// The constraint c(q) = 0 of a rotating direction has B = ∂c/∂q at the end of the step, and w
/// removes half of the error of c at the start within the step. Its impulse acts along the mean
/// θ B + (1 − θ) B0 of the directions at both ends. The work of the impulse and the error of c
/// within a step are then of third order for θ = 1/2.
class VelocityConstraints {
 public:
  /// @pre The arguments outlive this object.
  VelocityConstraints(StepForces& forces, const std::vector<Drive>& drives);

  Eigen::Index count() const;
  Eigen::Index drive_count() const { return drives_.count(); }
  /// Evaluates rotating directions at the start of a step.
  void begin();
  /// Sets the columns for a step, with a scale. Rotating directions are those at the middle of the
  /// step.
  void set(const TimeStep& step, double scale);
  /// Sets rotating directions to an iterate, after StepForces::move().
  void follow();

  const Eigen::SparseMatrix<double>& columns() const { return columns_; }  ///< B
  const VectorXd& speeds() const { return speeds_; }                       ///< w
  double scale() const { return scale_; }
  /// Residual w − Bᵀ v of the constraints, scaled as their columns.
  VectorXd lack(const TimeStep& step) const { return speeds_ - columns_.transpose() * step.v; }
  /// Whether the constraints hold, given this residual.
  /// @param drift rounding error of speeds [m/s]
  bool met(const TimeStep& step, const VectorXd& lack, double drift) const;
  /// Impulses on the independent displacements in a step [N s].
  VectorXd push(const TimeStep& step) const;
  /// Forces of the rotating constraints in a step [N].
  VectorXd turning_forces(const TimeStep& step) const;

 private:
  /// Number of constraints with constant directions.
  Eigen::Index constant_count() const {
    return static_cast<Eigen::Index>(forces_.contacts().holds().size());
  }
  Eigen::Index turning_count() const {
    return static_cast<Eigen::Index>(forces_.contacts().turning_holds().size());
  }
  /// Entries of rotating directions in the Jacobian of the joints, as columns from `first` on.
  void append_turning(const Assembly& joints, Eigen::Index first, double scale,
                      std::vector<Eigen::Triplet<double>>& entries) const;
  /// Fills the columns, with rotating directions from the Jacobian of the joints.
  void fill(const Assembly& joints);

  StepForces& forces_;
  Drives drives_;
  Eigen::SparseMatrix<double> columns_;
  VectorXd speeds_;
  double scale_ = 1.0;
  std::vector<Eigen::Triplet<double>> constant_;  ///< Entries of all other columns.
  Eigen::SparseMatrix<double> start_columns_;     ///< Rotating directions at the start of the step.
  VectorXd start_closure_;                        ///< Errors of their constraints there [m].
};

}  // namespace statejump::truss::detail
