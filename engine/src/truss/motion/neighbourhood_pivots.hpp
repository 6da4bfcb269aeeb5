// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "step_matrix.hpp"
#include "truss/active_set.hpp"

namespace statejump::truss::detail {

/// Changes statuses (pivots) in the neighbourhood of contacts whose inequalities are violated.
///
/// If slip spreads from joint to joint, each solve of the whole truss reveals only the next joint.
/// Impulses act only as far as sound travels in a step. Each pivot therefore uses only the bodies
/// and contacts within some layers around a contact. This neighbourhood grows while a correction
/// reaches its edge. The resulting statuses are a guess: a solve of the whole truss then checks the
/// inequalities of all contacts.
class NeighbourhoodPivots {
 public:
  using Index = Eigen::Index;

  /// @param statuses of the present solve; out: the statuses found
  NeighbourhoodPivots(const StepForces& forces, StepMatrix& matrix, TimeStep& step,
                      StepContacts& contacts, ContactStatuses& statuses);

  /// Number of unknowns in the initial neighbourhoods of all these contacts.
  Index reach_of(const std::vector<std::size_t>& contacts);
  /// Pivots around a contact until no contact in its neighbourhood is violated. Returns false if
  /// the search fails, or if is_spent().
  bool settle(std::size_t contact);
  /// Violated contacts in all neighbourhoods so far.
  std::vector<std::size_t> reached_violations() const;
  /// Whether the pivots have cost as much as one solve of the whole truss.
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
  /// Adds layers around the bodies `from`, and all contacts of the bodies then inside.
  void grow(std::vector<int> from, int layers);
  void take_in(int unknown, std::vector<int>& fresh);
  template <class Visit>
  void each_body_beside(int unknown, Visit&& visit) const;
  /// Visits a body, and all bodies that share a link, a constraint or a contact with it.
  template <class Visit>
  void each_neighbour(int body, Visit&& visit) const;
  /// If the last correction reached the edge of the neighbourhood, enlarges the neighbourhood and
  /// returns true.
  bool grow_where_felt();
  /// Right-hand side of a row of a contact.
  double right_side(Index i, bool across) const;
  /// Solves the neighbourhood on the present statuses.
  bool move();

  StepMatrix& step_matrix_;
  TimeStep& step_;
  StepContacts& contacts_;
  ContactStatuses& statuses_;
  const Eigen::SparseMatrix<double>& matrix_;
  const Index bodies_;         ///< Number of unknowns without contacts: velocities and constraints.
  const Index velocities_;     ///< Number of velocities.
  std::vector<int> position_;  ///< Index of an unknown in inside_, or −1.
  std::vector<int> inside_;    ///< Unknowns of the neighbourhood.
  std::vector<std::size_t> inside_contacts_;
  std::vector<std::size_t> reached_;  ///< Contacts of all neighbourhoods so far.
  std::vector<bool> is_reached_;
  int layers_ = 0;
  VectorXd residual_;  ///< Right-hand sides of all rows except those of contacts.
  VectorXd moved_;     ///< Correction of the last move.
  std::optional<linear::SparseFactor> factor_;
  std::size_t fingerprint_ = 0;  ///< Hash of the statuses.
  Index left_;  ///< Unknowns that may still be solved for within the cost of the whole truss.
};

}  // namespace statejump::truss::detail
