// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "contact_problem.hpp"
#include "energy_account.hpp"
#include "painleve.hpp"
#include "reaction_uniqueness.hpp"
#include "status_search.hpp"

namespace statejump::truss::detail {

/// Integrates a truss in motion, one step after the other; see simulate().
///
/// A Moreau–Jean step with θ finds the velocities v, displacements q and contact impulses r at its
/// end:
///
///   M (v − v0) = h (θ f(q, v) + (1 − θ) f0) + H r,   q = q0 + h (θ v + (1 − θ) v0),
///
/// with Signorini's condition and Coulomb's law between u = Hᵀ v and r. The directions H are those
/// of the middle of the step. Backward differentiation has the same equations with other starting
/// values (TimeStep). StatusSearch finds the statuses, for which the equations are smooth. If it
/// fails, ContactProblem solves the step. A solved step is committed.
class Stepper {
 public:
  /// @pre The arguments outlive this object.
  Stepper(const System& system, const Bodies& bodies, const MotionOptions& options);
  Stepper(const Stepper&) = delete;
  Stepper& operator=(const Stepper&) = delete;

  /// Sets positions and velocities. If a quasi-static state is given, contacts start at rest with
  /// the forces of that state.
  void begin(const VectorXd& q, const VectorXd& v, const State* equilibrium);
  /// Takes one step to the time `to`. The state changes only if the step succeeds. Returns false if
  /// a contact's gap differs from the prediction with the directions at mid-step.
  /// @throws Failure if no solution is found
  bool advance(double to);
  /// Like advance(), by implicit Euler with a positive definite matrix, for steps without another
  /// solution. With `give_up`, it also returns false if the statuses are not found.
  bool advance_damped(double to, bool give_up);
  /// Attempts a step of backward differentiation without committing it. Returns the error of the
  /// displacements [m]. The step is second-order accurate if the last step was of this type too.
  /// With `give_up`, the result is empty if the statuses are not found; the contact problem is not
  /// tried.
  /// @throws Failure as advance()
  std::optional<double> attempt(double to, bool give_up);
  /// Commits the attempted step.
  void accept();

  const VectorXd& velocity() const { return state_.v; }
  double time() const { return state_.time; }
  const Statuses& statuses() const { return state_.origin.statuses; }
  const EnergyAccount& account() const { return account_; }
  const VectorXd& drive_moment() const { return drive_moment_; }
  double kinetic_energy() const { return 0.5 * state_.v.dot(bodies_.mass() * state_.v); }
  void describe(State& state) const;
  const std::optional<Undetermined>& undetermined() const { return uniqueness_.found(); }
  const std::optional<Undetermined>& jammed() const { return painleve_.found(); }
  long iterations() const { return contact_problem_.iterations(); }
  long factorizations() const { return matrix_.factorizations(); }
  double largest_merit() const { return contact_problem_.largest_merit(); }

 private:
  /// The last step, for backward differentiation.
  struct Before {
    double length = 0.0;  ///< [s]; 0: no last step, or velocities jumped.
    VectorXd q;           ///< State at its start.
    VectorXd v;
  };

  /// Initial values of a Moreau–Jean step to this time.
  TimeStep begin_step(double to);
  StepContacts contacts_of(const TimeStep& step);
  /// Solves a step and returns its contacts; empty if `give_up` is set and the statuses are not
  /// found.
  std::optional<StepContacts> find(TimeStep& step, bool give_up);
  /// Whether the final gaps of round contacts agree with the prediction from the middle of the
  /// step. In a step that is too long they do not, and contact forces create energy.
  bool keeps_directions(const TimeStep& step) const;
  /// Largest penetration at the end of a step [m], over all rigid contacts that were open at the
  /// middle of the step.
  double deepest(const TimeStep& step) const;
  /// Commits a step: state, memory, energies.
  void commit(const TimeStep& step, const StepContacts& contacts);
  /// Writes the forces of all joints into the unknowns z, and their statuses.
  void write_forces(VectorXd& z, Statuses& statuses) const;
  void note_statuses();

  const System& system_;
  const Bodies& bodies_;
  const MotionOptions& options_;
  MotionState state_;
  Contacts contacts_;
  StepForces forces_;
  StepMatrix matrix_;
  StatusSearch search_;
  ContactProblem contact_problem_;
  ReactionUniqueness uniqueness_;
  PainleveCheck painleve_;
  EnergyAccount account_;
  VectorXd drive_moment_;  ///< Of each drive in the last step [N m].
  Before before_;
  std::optional<std::pair<TimeStep, StepContacts>> attempted_;
  long steps_ = 0;
};

}  // namespace statejump::truss::detail
