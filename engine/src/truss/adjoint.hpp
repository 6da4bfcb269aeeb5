// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <map>
#include <memory>
#include <utility>
#include <vector>

#include "linear/sparse_factor.hpp"
#include "local_joint.hpp"
#include "path_record.hpp"
#include "statejump/truss/gradient.hpp"

namespace statejump::truss::detail {

/// A truss in the variants in which a path solves it: with part of its loads, or without friction.
class Variants {
 public:
  explicit Variants(const Model& model) : model_(&model) {}
  /// The truss as a step solved it.
  const System& of(const RecordedStep& step);

 private:
  struct Variant {
    std::unique_ptr<const Model> model;
    std::unique_ptr<const System> system;
  };
  const Model* model_;
  std::map<std::pair<double, bool>, Variant> made_;
};

/// Multipliers of the Lagrangian of OutputDerivative, and its summands.
class AdjointPath {
 public:
  AdjointPath(std::shared_ptr<const PathRecord> record,
              const std::vector<Eigen::Matrix3Xd>& covectors);
  VectorXd summands(const Model& changed) const;
  int solutions() const { return static_cast<int>(balances_.size()); }
  int events() const { return static_cast<int>(guards_.size()); }
  int kinks() const { return kinks_; }

 private:
  /// Equations of a step, times −w.
  struct Balance {
    std::size_t step;
    VectorXd w;
  };
  /// Memory of a joint at the start of a step, times its multipliers.
  struct Memory {
    std::size_t step;
    int joint;
    VectorXd multiplier;
  };
  /// Condition of an event: a row of the status after it, at the state before it.
  struct Guard {
    std::size_t step;
    int joint;
    JointStatus after;
    int row;  ///< Among the forces of the joint.
    double weight;
  };
  /// Displacements at a step, times a covector [1/m].
  struct Output {
    std::size_t step;
    Eigen::Matrix3Xd covector;
  };
  class Sweep;

  std::shared_ptr<const PathRecord> record_;
  std::unique_ptr<Variants> recorded_;  ///< Of the recorded truss.
  std::vector<Balance> balances_;
  std::vector<Memory> memories_;
  std::vector<Guard> guards_;
  std::vector<Output> outputs_;
  int kinks_ = 0;
};

}  // namespace statejump::truss::detail
