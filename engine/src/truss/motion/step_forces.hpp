// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <utility>

#include "bodies.hpp"
#include "contacts.hpp"
#include "linear/sparse_factor.hpp"
#include "step_contacts.hpp"
#include "time_step.hpp"

namespace statejump::truss::detail {

/// Forces f(q, v) of a truss in a step, and the residual of its momentum balance.
///
/// f contains the forces of elements, loads, springs of joints and dashpots. The impulses r of
/// contacts are unknowns instead. At an iterate v the residual is M (v − v_from) − h (θ f + (1 − θ)
/// f0) − H r + B λ, with the impulses λ of the velocity constraints. The step is solved if the
/// residual vanishes to rounding and every contact satisfies its law.
class StepForces {
 public:
  /// @pre The arguments outlive this object.
  StepForces(const System& system, const Bodies& bodies, Contacts& contacts,
             const MotionState& state);
  StepForces(const StepForces&) = delete;
  StepForces& operator=(const StepForces&) = delete;

  const System& system() const { return system_; }
  const Bodies& bodies() const { return bodies_; }
  const Contacts& contacts() const { return contacts_; }
  Contacts& contacts() { return contacts_; }
  const MotionState& state() const { return state_; }

  /// Forces without dashpots and contacts [N].
  VectorXd elastic_force(const VectorXd& q, double time);
  /// elastic_force() of the last iterate.
  const VectorXd& last_elastic_force() const { return elastic_force_; }
  /// Forces at the beginning of the step, with dashpots [N].
  VectorXd force_before(const TimeStep& step) const;

  /// Evaluates gaps and directions of the contacts, as if all contacts were closed without force.
  void evaluate_contacts(const VectorXd& q, double time);
  /// Result of the last evaluate_contacts().
  const Assembly& joints() const { return joints_; }
  /// Forces of joints other than contact forces.
  const Assembly& evaluate_springs(const VectorXd& q, double time);
  /// The same, with the constraint forces of the last step; their stiffness is that of directions
  /// that rotate.
  const Assembly& evaluate_springs_with_holds(const VectorXd& q, double time);
  /// Result of the last evaluate_springs(), which move() calls for trusses with rotating
  /// constraints.
  const Assembly& springs() const { return springs_; }
  const Assembly& evaluate_elements(const VectorXd& q, double time);

  /// Gap of a contact after a displacement, extrapolated linearly along the directions of the step
  /// [m].
  /// @param way displacement from the middle of the step [m]
  double gap_after(const Contact& contact, const VectorXd& way) const;
  /// Rounding of lengths at the middle of a step [m].
  double rounding_at_middle(const TimeStep& step) const;

  /// Moves q according to the velocities of the step.
  /// @return residual of the momentum balance without contact impulses [N s]
  VectorXd move(TimeStep& step);
  /// Whether momentum balances, and whether elastic contacts satisfy their laws and not only the
  /// tangents.
  /// @param residual result of move()
  /// @param held impulses of the velocity constraints on the independent displacements [N s]
  /// @param on_statuses true: contacts in tension, and open contacts with penetration, are
  /// accepted, because their statuses are checked next
  bool balanced(const TimeStep& step, const VectorXd& residual, const VectorXd& held,
                const StepContacts& contacts, bool on_statuses) const;

 private:
  VectorXd unknowns_at(const VectorXd& q) const;
  void evaluate_springs_at(const VectorXd& z, double time);

  const System& system_;
  const Bodies& bodies_;
  Contacts& contacts_;
  const MotionState& state_;
  Assembly joints_;    ///< Gaps and directions at the middle of the step.
  Assembly springs_;   ///< Forces of joints other than contact forces.
  Assembly elements_;  ///< Stiffness at the middle of the step.
  Assembly forces_;    ///< Forces at an iterate; no Jacobian.
  VectorXd elastic_force_;
};

}  // namespace statejump::truss::detail
