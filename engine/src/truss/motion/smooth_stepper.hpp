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

/// Integrates the motion of a truss in which friction acts in series with springs. Between changes
/// of status its equations M v' = f(q, v, t), q' = v are smooth, and steps use Radau IIA. A step is
/// attempted with the statuses at its start. If a status ends within the step, the caller repeats
/// the step up to that time. The order of accuracy is thus preserved across changes.
class SmoothStepper {
 public:
  /// Creates a stepper. Returns null unless the truss consists of links, all contacts can be
  /// represented by FrictionElement, and all dofs have mass.
  /// @pre The arguments must outlive the stepper.
  /// @param stages odd number of stages of Radau IIA
  static std::unique_ptr<SmoothStepper> of(const System& system, const Bodies& bodies,
                                           const Inertia& inertia, const MotionOptions& options,
                                           int stages = 5);

  /// Sets positions and velocities. If a quasi-static state is given, it also sets the contact
  /// forces.
  void begin(const VectorXd& q, const VectorXd& v, const State* equilibrium);

  /// The next corner of a program [s].
  double smooth_until() const { return smooth_until_; }
  /// Attempts a step with the present statuses, at most up to smooth_until(). Returns the error of
  /// the displacements [m]; empty if the iteration does not converge.
  std::optional<double> attempt(double to);
  /// The error that attempt() returns is proportional to this power of the step length.
  double error_power() const { return static_cast<double>(radau_.c.size()) + 1.0; }
  /// Time at which a status first ends in the attempted step [s]; empty if no status ends.
  std::optional<double> first_change() const { return first_change_; }
  /// Commits the last attempted step.
  void accept();
  /// Changes all statuses that end at the present time. Returns the number of changes.
  int turn();
  /// Joint of the contact whose status ended first in the attempted step; used in messages.
  int turning_joint() const { return friction_elements_[first_to_turn_].joint; }

  double time() const { return time_; }
  const VectorXd& velocity() const { return v_; }
  const Statuses& statuses() const { return statuses_; }
  const EnergyAccount& account() const { return account_; }
  double kinetic_energy() const { return 0.5 * v_.dot(bodies_->mass() * v_); }
  /// Describes the present state and updates the memory of the joints.
  void describe(State& state);
  long factorizations() const { return factorizations_; }

 private:
  using Complex = std::complex<double>;

  SmoothStepper(const System& system, const Bodies& bodies, const Inertia& inertia,
                const MotionOptions& options, std::vector<FrictionElement> elements, int stages);

  // The iteration matrix.
  void make_pattern(const Eigen::SparseMatrix<double>& damping);
  void renew_tangents();
  /// Adds springs and dashpots of sticking contacts to K and C.
  void add_contacts();
  /// Factors the matrices M + g C + g² K for all g = h/λ. Returns false if one of them is singular.
  bool factorize(double h);

  /// Solves the stages by Newton's method. Returns false if it does not converge.
  bool solve_stages();
  /// Solves for a correction and adds it to the velocities of the stages. Returns its largest
  /// component [m/s].
  double correct(const Eigen::MatrixXd& residual);
  /// Error of the displacements from the embedded method [m].
  double error();
  /// f of links, loads, dashpots and contacts on their statuses [N].
  void force(const Rods::ConstColumn& q, const Rods::ConstColumn& v, double time, VectorXd& to);
  void find_change();
  double time_of(Eigen::Index stage) const {
    return stage + 1 == radau_.c.size() ? to_ : time_ + radau_.c[stage] * (to_ - time_);
  }
  /// Slide of a contact from the start of the step to the positions q [m].
  double slide(std::size_t contact, const Rods::ConstColumn& q) const {
    return friction_elements_[contact].seen(q) - slide_from_[static_cast<Eigen::Index>(contact)];
  }
  /// Prepares the next step.
  /// @param anew true if forces or rates have jumped at the start of the step
  void start_from_here(bool anew);
  const Rods::Heat& heat_at(double time);
  void book();
  /// Writes the present joint forces and statuses.
  void write();

  const System* system_;
  const Bodies* bodies_;
  const MotionOptions* options_;
  const Radau radau_;
  Contacts contacts_;
  std::vector<FrictionElement> friction_elements_;
  std::vector<double> corners_;  ///< Of all programs [s].
  Assembly bars_;                ///< Elements, for their stiffness.
  Rods rods_;
  VectorXd loads_;  ///< On the free displacements [N].
  linear::SparseFactor mass_factor_;

  Eigen::SparseMatrix<double> stiffness_;  ///< Its pattern is that of all matrices.
  VectorXd mass_entries_;                  ///< Entries of M, C and K in this pattern.
  VectorXd damping_entries_;
  VectorXd stiffness_entries_;
  VectorXd sticking_damping_;  ///< C with sticking contacts; `stiffness_` is K with them.
  std::vector<Eigen::Index> damping_places_;
  std::vector<Eigen::Index> stiffness_places_;
  /// Positions of d dᵀ of all contacts, one after the other.
  std::vector<Eigen::Index> contact_places_;
  linear::SparseFactor factor_;
  std::vector<linear::ComplexFactor> pair_factors_;
  double factor_h_ = 0.0;          ///< Step length of the factors [s]; 0: none.
  bool tangents_are_new_ = false;  ///< Whether tangents belong to the start of this step.
  double contraction_ = 1.0;       ///< Last measured convergence rate of the corrections.
  int trusted_ = 0;                ///< Steps since that measurement.

  // State at the start of the next step.
  double time_ = 0.0;
  VectorXd q_;
  VectorXd v_;
  VectorXd a_;                 ///< Accelerations [m/s²].
  VectorXd slide_from_;        ///< dᵀ q of every contact [m].
  std::vector<double> grace_;  ///< Tolerated deficit of a status since its start [N].
  // The attempted step; columns are stages.
  double to_ = 0.0;
  Eigen::MatrixXd stage_q_;
  Eigen::MatrixXd stage_v_;
  Eigen::MatrixXd stage_a_;
  std::vector<double> level_;  ///< See FrictionElement::has_ended().
  std::optional<double> first_change_;
  std::size_t first_to_turn_ = 0;
  std::vector<std::size_t> to_turn_;  ///< Contacts whose status ended first, in the last such step.

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
