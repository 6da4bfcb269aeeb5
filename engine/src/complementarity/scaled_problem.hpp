// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <vector>

#include "cone.hpp"
#include "statejump/complementarity/problem.hpp"

namespace statejump::complementarity {

/// Merit::natural_map of reactions and their velocities.
double natural_map_merit(const Problem& problem, const Eigen::VectorXd& reactions,
                         const Eigen::VectorXd& velocities);

/// A dimensionless problem: W is divided by its mean diagonal entry, q by its mean entry. The
/// friction cones do not change.
class ScaledProblem {
 public:
  /// @param problem valid
  explicit ScaledProblem(const Problem& problem);

  int dimension() const { return dimension_; }
  Eigen::Index contacts() const { return mu_.size(); }
  const Eigen::VectorXd& mu() const { return mu_; }
  const Eigen::VectorXd& q() const { return q_; }
  const Delassus& delassus() const { return delassus_; }
  /// Diagonal block of W of each contact.
  const std::vector<BlockMatrix>& blocks() const { return blocks_; }

  /// W r.
  Eigen::VectorXd times(const Eigen::VectorXd& r) const;
  /// Adds W's columns of a contact times `delta` to u.
  void add_columns(Eigen::Index contact, const Block& delta, Eigen::VectorXd& u) const;
  /// Natural map divided by |q|.
  double merit(const Eigen::VectorXd& r, const Eigen::VectorXd& u) const {
    const double norm = natural_map_norm(dimension_, mu_, r, u);
    return norm > 0.0 ? norm / size_of_q_ : 0.0;
  }

  /// Ratio of the problem's reactions to the scaled ones.
  double reaction_unit() const { return reaction_unit_; }
  /// Ratio of the problem's velocities to the scaled ones.
  double velocity_unit() const { return velocity_unit_; }

 private:
  int dimension_;
  Delassus delassus_;
  Eigen::VectorXd q_;
  double size_of_q_ = 1.0;
  Eigen::VectorXd mu_;
  std::vector<BlockMatrix> blocks_;
  double reaction_unit_ = 1.0;
  double velocity_unit_ = 1.0;
};

}  // namespace statejump::complementarity
