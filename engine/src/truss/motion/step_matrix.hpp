// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <vector>

#include "linear/sparse_factor.hpp"
#include "refilled_matrix.hpp"
#include "step_contacts.hpp"
#include "velocity_constraints.hpp"

namespace statejump::truss::detail {

/// Factors of the equations of a step for given statuses of the active contacts. They stem from
/// this or an earlier step of the same length.
struct StatusFactors {
  double h = 0.0;
  std::vector<int> active;  ///< Numbers of the active contacts.
  ContactStatuses statuses;
  double scale = 1.0;    ///< Scale of the velocity constraints.
  bool outdated = true;  ///< Not computed yet, or to be renewed because of slow convergence.
  linear::SparseFactor factor;
};

/// The linear system of a step, and its factors.
///
/// A correction of v changes f by its derivatives, and q by h θ times the correction. The bodies'
/// matrix is therefore M + h θ C + (h θ)² K at the middle of the step, bordered by the velocity
/// constraints B. Every active contact adds two rows. Depending on its status, a row is its
/// ContactRow, r = 0 or r_t = ∓ μ r_n. The impulses of a contact are unknowns for every status, so
/// the pattern does not depend on statuses. Entries that do not depend on contacts are filled once
/// per step.
///
/// If the statuses are not found, the matrix of the bodies alone is factored, to compute the
/// Delassus matrix of the contact problem.
class StepMatrix {
 public:
  /// @pre The arguments outlive this object.
  StepMatrix(StepForces& forces, const std::vector<Drive>& drives);

  /// Returns factors for a step length and statuses. Stored factors are returned if they exist.
  StatusFactors& factors_for(double h, const StepContacts& contacts,
                             const ContactStatuses& statuses);
  /// Factors the matrix at an iterate. False: singular.
  bool factorize(StatusFactors& of, const TimeStep& step, const StepContacts& contacts);
  /// Fills the matrix of a step at an iterate, for given statuses of the contacts.
  void assemble(const ContactStatuses& statuses, const TimeStep& step,
                const StepContacts& contacts);
  /// Replaces the entries of one contact by those for another status, evaluated at an iterate.
  void update_entries(ContactStatus status, const TimeStep& step, const StepContacts& contacts,
                      Eigen::Index i);
  /// The matrix of the last assemble(). Its rows are momentum, velocity constraints, and then two
  /// rows for each active contact.
  const Eigen::SparseMatrix<double>& matrix() const { return matrix_.matrix(); }
  double scale() const { return scale_; }  ///< Scale of the rows of constraints and contacts.

  /// Factors the matrix of the bodies alone, for solve_bodies(), and returns the Delassus matrix.
  /// @throws Failure if that matrix is singular, or if an impulse could accelerate a contact
  /// opposite to the impulse
  Delassus delassus(const TimeStep& step, const StepContacts& contacts);
  VectorXd solve_bodies(const VectorXd& right) { return bodies_factor_.solve(right); }

  const VelocityConstraints& constraints() const { return constraints_; }
  VelocityConstraints& constraints() { return constraints_; }
  /// Scales the constraints as in stored factors.
  void scale_constraints(const TimeStep& step, double scale) { constraints_.set(step, scale); }
  long factorizations() const { return factorizations_; }

 private:
  /// Updates the velocity constraints, and fills them and M + h θ C + (h θ)² K into a matrix.
  void fill_bodies(const TimeStep& step, RefilledMatrix& to);
  /// Calls `visit(row, column, value)` for each matrix entry of a contact. The positions and their
  /// order are the same for all statuses.
  template <class Visit>
  void each_contact_entry(ContactStatus status, const TimeStep& step, const StepContacts& contacts,
                          Eigen::Index i, Visit&& visit) const;

  StepForces& forces_;
  VelocityConstraints constraints_;
  RefilledMatrix matrix_;
  long step_number_ = -1;  ///< TimeStep::number of its entries for bodies.
  double scale_ = 1.0;
  std::vector<std::size_t> contact_entries_;          ///< First entry of every active contact.
  std::vector<std::unique_ptr<StatusFactors>> kept_;  ///< Most recently used first.
  RefilledMatrix bodies_matrix_;
  linear::SparseFactor bodies_factor_;
  long factorizations_ = 0;
};

}  // namespace statejump::truss::detail
