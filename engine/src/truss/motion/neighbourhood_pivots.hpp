// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "step_matrix.hpp"
#include "truss/active_set.hpp"

namespace statejump::truss::detail {

/// Pivots in the neighbourhood of contacts whose inequalities are violated.
///
/// Where slip spreads from one joint to the next, a step in which it passes many would be as many
/// systems of the whole truss: every one shows the next joint only. Impulses act as far as sound
/// travels in a step. So these systems have only the bodies and contacts within some layers around
/// a contact, and grow while a correction reaches their edge. The statuses found here are a guess:
/// the whole truss is then solved on them, and its inequalities are checked.
class NeighbourhoodPivots {
 public:
  using Index = Eigen::Index;

  /// @param statuses those on which the step is solved, and then those that are found
  NeighbourhoodPivots(const StepForces& forces, StepMatrix& matrix, TimeStep& step,
                      StepContacts& contacts, ContactStatuses& statuses);

  /// Unknowns of the neighbourhoods of all these contacts, as they are at first.
  Index reach_of(const std::vector<std::size_t>& contacts);
  /// Pivots around a contact until none that they reach is violated. False if that is not
  /// found, or if is_spent().
  bool settle(std::size_t contact);
  /// Violated contacts of all neighbourhoods so far.
  std::vector<std::size_t> reached_violations() const;
  /// Whether it has cost as much as a system of the whole truss.
  bool is_spent() const { return left_ <= 0; }

  // For find_active_set().
  using Changes = std::vector<std::pair<std::size_t, ContactStatus>>;
  std::size_t key() const { return fingerprint_; }
  Changes violated() const;
  bool change(const Changes& changes, const PivotSearch<std::size_t>& search);
  bool solve();

 private:
  ContactStatus requested(std::size_t contact) const {
    return contacts_.requested(step_, static_cast<Index>(contact), statuses_[contact]);
  }
  void begin(std::size_t contact);
  /// Takes in so many layers around bodies, with all contacts that touch a body inside.
  void grow(std::vector<int> from, int layers);
  void take_in(int unknown, std::vector<int>& fresh);
  template <class Visit>
  void each_body_beside(int unknown, Visit&& visit) const;
  /// Bodies with which one shares a link, a constraint or a contact, and itself.
  template <class Visit>
  void each_neighbour(int body, Visit&& visit) const;
  /// Whether the last move reached the edge, which then has become a wider one.
  bool grow_where_felt();
  /// Right side of a row of a contact.
  double right_side(Index i, bool across) const;
  /// Goes to the solution of the neighbourhood on the present statuses.
  bool move();

  StepMatrix& step_matrix_;
  TimeStep& step_;
  StepContacts& contacts_;
  ContactStatuses& statuses_;
  const Eigen::SparseMatrix<double>& matrix_;
  const Index bodies_;         ///< Unknowns that are not the contacts': velocities and constraints.
  const Index velocities_;     ///< Those of them that are velocities.
  std::vector<int> position_;  ///< Of an unknown in the neighbourhood, or −1.
  std::vector<int> inside_;    ///< Its unknowns.
  std::vector<std::size_t> inside_contacts_;
  std::vector<std::size_t> reached_;  ///< Contacts of all neighbourhoods so far.
  std::vector<bool> is_reached_;
  int layers_ = 0;
  VectorXd residual_;  ///< Right sides of all rows that are not contacts'.
  VectorXd moved_;     ///< By the last move.
  std::optional<linear::SparseFactor> factor_;
  std::size_t fingerprint_ = 0;  ///< Of the statuses.
  Index left_;  ///< Unknowns to be solved for until it costs as much as the whole truss.
};

}  // namespace statejump::truss::detail
