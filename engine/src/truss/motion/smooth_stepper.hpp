// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <complex>
#include <memory>
#include <optional>
#include <vector>

#include "bodies.hpp"
#include "contacts.hpp"
#include "energy_account.hpp"
#include "friction_element.hpp"
#include "linear/complex_factor.hpp"
#include "linear/sparse_factor.hpp"
#include "radau.hpp"
#include "rods.hpp"

namespace statejump::truss::detail {

/// A truss in motion whose friction acts in series with springs: between changes of statuses its
/// equations M v' = f(q, v, t), q' = v are smooth, and steps are of Radau IIA. A step is tried on
/// the branches that hold at its start; where one of them ends within it, whoever asks tries again
/// up to there, so that the order is kept over changes of branches.
class SmoothStepper {
 public:
  /// One for a truss of links whose contacts are all such, and whose freedoms all have mass; else
  /// none. All arguments must outlive it.
  /// @param stages of Radau IIA, odd
  static std::unique_ptr<SmoothStepper> of(const System& system, const Bodies& bodies,
                                           const Inertia& inertia, const MotionOptions& options,
                                           int stages = 5);

  /// Sets places and velocities, contacts as a quasi-static state has them if it is given.
  void begin(const VectorXd& q, const VectorXd& v, const State* equilibrium);

  /// The next corner of a program [s].
  double smooth_until() const { return smooth_until_; }
  /// Tries a step on the present branches, up to smooth_until() at most; what displacements are off
  /// by [m]. Nothing if it does not converge.
  std::optional<double> attempt(double to);
  /// What attempt() gives goes with this power of the length.
  double error_power() const { return static_cast<double>(radau_.c.size()) + 1.0; }
  /// Time at which the first branch ends in the attempted step; none if all last [s].
  std::optional<double> first_change() const { return first_change_; }
  /// Takes the step that was attempted last.
  void accept();
  /// Changes the branches that were found to end here. How many.
  int turn();
  /// Joint of the contact whose branch ended first in a step; for messages.
  int turning_joint() const { return friction_elements_[first_to_turn_].joint; }

  double time() const { return time_; }
  const VectorXd& velocity() const { return v_; }
  const Statuses& statuses() const { return statuses_; }
  const EnergyAccount& account() const { return account_; }
  double kinetic_energy() const { return 0.5 * v_.dot(bodies_->mass() * v_); }
  /// The state where it is, of which joints take note.
  void describe(State& state);
  long factorizations() const { return factorizations_; }

 private:
  using Complex = std::complex<double>;

  SmoothStepper(const System& system, const Bodies& bodies, const Inertia& inertia,
                const MotionOptions& options, std::vector<FrictionElement> elements, int stages);

  // The iteration matrix.
  void make_pattern(const Eigen::SparseMatrix<double>& damping);
  void renew_tangents();
  /// K and C with the springs and dashpots of the contacts that stick.
  void add_contacts();
  /// Factors of M + g C + g² K for all g = h/λ. False if one of them is singular.
  bool factorize(double h);

  /// Solves the stages by Newton's method. False if that does not converge.
  bool solve_stages();
  /// Adds its correction to the stages' velocities; the largest of all [m/s].
  double correct(const Eigen::MatrixXd& residual);
  /// What displacements are off by, from the embedded method [m].
  double error();
  /// f of links, loads, dashpots and contacts on their branches [N].
  void force(const Rods::ConstColumn& q, const Rods::ConstColumn& v, double time, VectorXd& to);
  void find_change();
  double time_of(Eigen::Index stage) const {
    return stage + 1 == radau_.c.size() ? to_ : time_ + radau_.c[stage] * (to_ - time_);
  }
  /// Slide of a contact since the start of the step at a place [m].
  double slide(std::size_t contact, const Rods::ConstColumn& q) const {
    return friction_elements_[contact].seen(q) - slide_from_[static_cast<Eigen::Index>(contact)];
  }
  /// A new start of a step. @param anew forces or rates have jumped
  void start_from_here(bool anew);
  const Rods::Heat& heat_at(double time);
  void book();
  /// Forces of the joints and statuses as they are.
  void write();

  const System* system_;
  const Bodies* bodies_;
  const MotionOptions* options_;
  const Radau radau_;
  Contacts contacts_;
  std::vector<FrictionElement> friction_elements_;
  std::vector<double> corners_;  ///< Of all programs [s].
  Assembly bars_;                ///< Stiffness.
  Rods rods_;
  VectorXd loads_;  ///< On the free displacements [N].
  linear::SparseFactor mass_factor_;

  Eigen::SparseMatrix<double> stiffness_;  ///< Its places are those of all matrices.
  VectorXd mass_entries_;                  ///< Of M, C and K in these places.
  VectorXd damping_entries_;
  VectorXd stiffness_entries_;
  VectorXd sticking_damping_;  ///< C with the contacts that stick; K with them is `stiffness_`.
  std::vector<Eigen::Index> damping_places_;
  std::vector<Eigen::Index> stiffness_places_;
  std::vector<Eigen::Index> contact_places_;  ///< Of d dᵀ of one contact after the other.
  linear::SparseFactor factor_;
  std::vector<linear::ComplexFactor> pair_factors_;
  double factor_h_ = 0.0;          ///< Of the factors [s]; 0: none.
  bool tangents_are_new_ = false;  ///< Of the start of this step.
  double contraction_ = 1.0;       ///< Of corrections, as measured last.
  int trusted_ = 0;                ///< Steps since then.

  // Where it is, the start of the next step.
  double time_ = 0.0;
  VectorXd q_;
  VectorXd v_;
  VectorXd a_;                 ///< Accelerations [m/s²].
  VectorXd slide_from_;        ///< dᵀ q of every contact [m].
  std::vector<double> grace_;  ///< What a branch may be short of since it began [N].
  // The step that is tried; columns are stages.
  double to_ = 0.0;
  Eigen::MatrixXd stage_q_;
  Eigen::MatrixXd stage_v_;
  Eigen::MatrixXd stage_a_;
  std::vector<double> level_;  ///< See FrictionElement::has_ended().
  std::optional<double> first_change_;
  std::size_t first_to_turn_ = 0;
  std::vector<std::size_t> to_turn_;  ///< Contacts whose branch ended first, in the last such step.

  Rods::Heat heat_;
  double smooth_until_ = 0.0;
  VectorXd z_;  ///< Displacements and forces of joints.
  VectorXd now_;
  StepStart origin_;
  Statuses statuses_;
  EnergyAccount account_;
  long factorizations_ = 0;
};

}  // namespace statejump::truss::detail
