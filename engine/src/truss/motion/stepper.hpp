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
/// A step of Moreau and Jean's scheme with θ finds velocities v, displacements q and impulses r of
/// the contacts at its end:
///
///   M (v − v0) = h (θ f(q, v) + (1 − θ) f0) + H r,   q = q0 + h (θ v + (1 − θ) v0),
///
/// with Signorini's condition and Coulomb's law between u = Hᵀ v and r. Directions H are those of
/// the middle of the step. Backward differentiation has the same equations from another beginning
/// (TimeStep). StatusSearch finds the statuses of the contacts, on which the equations are smooth;
/// ContactProblem solves the steps where it does not. The step is then committed.
class Stepper {
 public:
  /// All arguments must outlive it.
  Stepper(const System& system, const Bodies& bodies, const MotionOptions& options);
  Stepper(const Stepper&) = delete;
  Stepper& operator=(const Stepper&) = delete;

  /// Sets positions and velocities, at rest in their contacts where a quasi-static state is given.
  void begin(const VectorXd& q, const VectorXd& v, const State* equilibrium);
  /// One step to this time; only a step that is made changes the stepper. False where a contact
  /// ends elsewhere than the directions of the step lead. @throws Failure if it has no solution
  /// that is found
  bool advance(double to);
  /// The same by implicit Euler with a matrix that is positive definite, for a step that was not
  /// found otherwise. False also where its statuses are not found and `give_up`.
  bool advance_damped(double to, bool give_up);
  /// The same by backward differentiation, not yet taken: the error of displacements [m]. Of
  /// second order where the step before was one of these. Without a number where its statuses were
  /// not found and `give_up`, which saves the contact problem. @throws Failure as advance()
  std::optional<double> attempt(double to, bool give_up);
  /// Takes what was attempted last.
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
  /// The step before the next one, for backward differentiation.
  struct Before {
    double length = 0.0;  ///< [s]; 0: none, or velocities jump.
    VectorXd q;           ///< Where it began.
    VectorXd v;
  };

  /// A step of Moreau and Jean to this time.
  TimeStep begin_step(double to);
  StepContacts contacts_of(const TimeStep& step);
  /// Finds the end of a step; none where its statuses are not found and `give_up`.
  std::optional<StepContacts> find(TimeStep& step, bool give_up);
  /// Whether round contacts end where the directions of the step lead: of a step that is long
  /// beside their motion they do not, and its forces make energy.
  bool keeps_directions(const TimeStep& step) const;
  /// Depth at the end of a step of rigid contacts that its middle did not know closed [m].
  double deepest(const TimeStep& step) const;
  /// Takes a step: state, memories, energies.
  void commit(const TimeStep& step, const StepContacts& contacts);
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
