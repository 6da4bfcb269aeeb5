// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/SparseCore>
#include <vector>

#include "statejump/truss/motion.hpp"
#include "truss/system.hpp"

namespace statejump::truss::detail {

/// Links with prescribed rotation, as constraints on the velocities at the end of a step.
class Drives {
 public:
  /// @pre The arguments must outlive this object.
  /// @throws kernel::OutOfRange or std::invalid_argument with the name of the invalid drive
  Drives(const System& system, const std::vector<Drive>& drives);

  Eigen::Index count() const { return static_cast<Eigen::Index>(drives_->size()); }
  /// Derivatives of each link's angle with respect to the independent displacements [1/m]. They use
  /// the prescribed direction at the end of the step and the length at q.
  std::vector<Eigen::Triplet<double>> directions(const VectorXd& q, double to) const;
  /// Required angular velocity of each link at the end of the step [rad/s]: that of the program,
  /// plus half of the angle error at the start (positions q) divided by the step length.
  /// Displacements follow the mean velocity of a step, so an angle error vanishes within two steps.
  VectorXd targets(const VectorXd& q, double from, double to) const;

 private:
  Vector2d along(const Drive& drive, const VectorXd& q) const;
  double drawn_angle(const Drive& drive) const;

  const System* system_;
  const std::vector<Drive>* drives_;
};

}  // namespace statejump::truss::detail
