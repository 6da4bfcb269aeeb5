// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <utility>

#include "bodies.hpp"
#include "contacts.hpp"
#include "linear/sparse_factor.hpp"
#include "step_contacts.hpp"
#include "time_step.hpp"

namespace statejump::truss::detail {

/// Forces f(q, v) of a truss in a step, and what a step has to balance.
///
/// Elements, loads, springs of joints and dashpots are in f; contacts are not, their impulses r are
/// unknowns of the step. At an iterate v the step lacks the momentum
/// M (v − v_from) − h (θ f + (1 − θ) f0) − H r + B λ, with the impulses λ of the velocity
/// constraints. It is solved where this vanishes to rounding and every contact is on its law.
class StepForces {
 public:
  /// All arguments must outlive it.
  StepForces(const System& system, const Bodies& bodies, Contacts& contacts,
             const MotionState& state);
  StepForces(const StepForces&) = delete;
  StepForces& operator=(const StepForces&) = delete;

  const System& system() const { return system_; }
  const Bodies& bodies() const { return bodies_; }
  const Contacts& contacts() const { return contacts_; }
  Contacts& contacts() { return contacts_; }
  const MotionState& state() const { return state_; }

  /// Without dashpots and contacts [N].
  VectorXd elastic_force(const VectorXd& q, double time);
  /// Those of the last iterate.
  const VectorXd& last_elastic_force() const { return elastic_force_; }
  /// Forces where the step begins, with dashpots [N].
  VectorXd force_before(const TimeStep& step) const;

  /// Gaps and directions of the contacts, all of them closed and free of force.
  void evaluate_contacts(const VectorXd& q, double time);
  /// As evaluated last.
  const Assembly& joints() const { return joints_; }
  /// Forces of joints besides their contacts.
  const Assembly& evaluate_springs(const VectorXd& q, double time);
  const Assembly& evaluate_elements(const VectorXd& q, double time);

  /// Gap of a contact by the directions of the step [m]. @param way from its middle [m]
  double gap_after(const Contact& contact, const VectorXd& way) const;
  /// Rounding of lengths at the middle of a step [m].
  double rounding_at_middle(const TimeStep& step) const;

  /// Moves q to where the step's velocities lead. @return momentum that it lacks without impulses
  /// [N s]
  VectorXd move(TimeStep& step);
  /// Whether momentum balances and elastic contacts are on their laws, not only on the tangents.
  /// @param residual of move()
  /// @param constraints B, see VelocityConstraints
  /// @param on_statuses a contact may pull, or be open where it closes: its status is checked next
  bool balanced(const TimeStep& step, const VectorXd& residual,
                const Eigen::SparseMatrix<double>& constraints, const StepContacts& contacts,
                bool on_statuses) const;

 private:
  VectorXd unknowns_at(const VectorXd& q) const;

  const System& system_;
  const Bodies& bodies_;
  Contacts& contacts_;
  const MotionState& state_;
  Assembly joints_;    ///< Gaps and directions at the middle of the step.
  Assembly springs_;   ///< Forces of joints besides their contacts.
  Assembly elements_;  ///< Stiffness at the middle of the step.
  Assembly forces_;    ///< Forces at an iterate; no Jacobian.
  VectorXd elastic_force_;
};

}  // namespace statejump::truss::detail
