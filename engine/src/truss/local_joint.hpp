// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <vector>

#include "path_record.hpp"
#include "system.hpp"

namespace statejump::truss::detail {

/// A joint at a recorded state as a function of its own unknowns: displacements of its sites, three
/// each, then its forces.
class LocalJoint {
 public:
  static constexpr int forces_from = 3 * most_joint_nodes;
  static constexpr int size = forces_from + most_joint_forces;

  /// The joint at the end of a step.
  /// @param of_pieces the truss that determines the active branch of a piecewise law; null:
  /// `system`
  LocalJoint(const System& system, const RecordedStep& step, int joint, double time,
             const System* of_pieces = nullptr)
      : LocalJoint(system, joint, step.z, time, step.start, step.joints, step.opening, of_pieces) {}
  LocalJoint(const System& system, int joint, const VectorXd& z, double time,
             const StepStart& start, JointModel model, double opening,
             const System* of_pieces = nullptr);

  const Trial& trial() const { return trial_; }
  int memory_size() const { return memory_size_; }
  VectorXd memory() const { return Eigen::Map<const VectorXd>(trial_.history, memory_size_); }
  /// The trial with changed unknowns.
  Trial moved(const VectorXd& local) const;
  /// Unknowns of a vector of the whole truss. Displacements are in space, not along free
  /// directions.
  VectorXd local(const VectorXd& z) const;
  /// Adds a covector of local unknowns to one of the whole truss.
  void add(const VectorXd& covector, VectorXd& to) const;

  /// Residuals of a status: forces on the sites, then its rows.
  VectorXd residual(const Trial& at, JointStatus status,
                    std::vector<RowUnit>* units = nullptr) const;
  /// Product of residuals with a vector of the whole truss, in the form of local().
  double work(const VectorXd& along, const Trial& at, JointStatus status) const {
    return along.dot(residual(at, status));
  }
  /// Memory at the start of the next step.
  VectorXd commit(const Trial& at, JointStatus status) const;
  /// Memory at the start of a path.
  VectorXd begin(const Trial& at, JointStatus status) const;

  int slide_row() const;
  const Joint& joint() const { return *joint_; }
  int forces() const { return trial_.frame.forces; }

  /// Calls `use(k, steps)` for every unknown k. `steps` are first steps for its differences.
  template <class Use>
  void each_unknown(double length, double force, Use&& use) const {
    for (int k = 0; k < 3 * trial_.frame.node_count; ++k) {
      if (trial_.frame.nodes[index(k / 3)] >= 0) use(k, length, length);
    }
    for (int k = 0; k < forces(); ++k) {
      use(forces_from + k, std::abs(trial_.force[index(k)]), force);
    }
  }

 private:
  const System* system_;
  const Joint* joint_;
  int first_force_;
  int memory_size_ = 0;
  std::array<NodeDofs, most_joint_nodes> places_;
  Trial trial_;
};

}  // namespace statejump::truss::detail
