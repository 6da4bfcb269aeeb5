// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/SparseCore>
#include <vector>

#include "statejump/truss/motion.hpp"
#include "truss/system.hpp"

namespace statejump::truss::detail {

/// Masses and dashpots of a truss, for its independent displacements.
class Bodies {
 public:
  /// @pre The arguments must outlive this object.
  /// @throws kernel::OutOfRange if the number of values is wrong or a value is negative
  Bodies(const System& system, const Inertia& inertia);

  const Eigen::SparseMatrix<double>& mass() const { return mass_; }
  bool damped() const { return !dashpots_.empty(); }
  const VectorXd& joint_damping() const { return joint_damping_; }

  /// Values of a step for the dashpots.
  struct Step {
    double from;
    double to;
    std::vector<double> growth_rate = {};  ///< Of every dashpot's stress-free length [m/s].
  };
  Step step(double from, double to) const;
  /// Forces of the dashpots on the independent displacements [N]. Stress-free lengths grow at the
  /// mean rate of the step, because the actual rate jumps at corners of a program.
  VectorXd force(const VectorXd& q, const VectorXd& v, const Step& step) const;
  /// −∂force/∂v at q.
  Eigen::SparseMatrix<double> damping(const VectorXd& q) const;
  /// The entries of the damping matrix, always in the same order. Several entries at one position
  /// are summed.
  std::vector<Eigen::Triplet<double>> damping_entries(const VectorXd& q) const;
  /// Entries of the geometric stiffness of all links in compression, at positions q and a time,
  /// with opposite sign.
  std::vector<Eigen::Triplet<double>> compression_entries(const VectorXd& q, double time) const;
  /// Heat of the dashpots in a step, and the work that the temperature does on them [J].
  struct Work {
    double heat = 0.0;
    double thermal = 0.0;
  };
  Work work(const VectorXd& q0, const VectorXd& v0, const VectorXd& q1, const VectorXd& v1,
            const Step& step, double theta) const;

  /// Independent displacements from displacements or velocities of the nodes, and back.
  VectorXd free_part(const Eigen::Matrix3Xd& of_nodes) const {
    return system_->dofs().dofs_at(of_nodes);
  }
  Eigen::Matrix3Xd of_nodes(const VectorXd& free) const { return system_->displacements(free); }

 private:
  struct Rate {
    Vector3d direction;
    double length;
    double strain_rate;  // L' − l_T' [m/s]
    Vector3d across;     // [m/s]
  };
  /// From positions and velocities of all nodes.
  Rate rate(const Dashpot& dashpot, const Eigen::Matrix3Xd& moved, const Eigen::Matrix3Xd& velocity,
            double growth_rate) const;

  const System* system_;
  std::vector<Dashpot> dashpots_;
  Eigen::SparseMatrix<double> mass_;
  VectorXd joint_damping_;
};

}  // namespace statejump::truss::detail
