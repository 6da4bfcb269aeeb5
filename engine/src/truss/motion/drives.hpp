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
  /// @pre The arguments outlive this object.
  /// @throws kernel::OutOfRange, std::invalid_argument with the name of a drive
  Drives(const System& system, const std::vector<Drive>& drives);

  Eigen::Index count() const { return static_cast<Eigen::Index>(drives_->size()); }
  /// Derivatives of each link's angle with respect to the independent displacements [1/m]. The link
  /// has its prescribed direction at the end of the step and its length at q.
  std::vector<Eigen::Triplet<double>> directions(const VectorXd& q, double to) const;
  /// Angular velocities at the end of the step [rad/s]: those of the program, plus half of the
  /// angle error at the start (q) divided by the step. Positions follow the mean velocity of a
  /// step, so an angle error vanishes over two steps.
  VectorXd targets(const VectorXd& q, double from, double to) const;

 private:
  Vector2d along(const Drive& drive, const VectorXd& q) const;
  double drawn_angle(const Drive& drive) const;

  const System* system_;
  const std::vector<Drive>* drives_;
};

}  // namespace statejump::truss::detail
