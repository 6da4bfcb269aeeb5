// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "linear/sparse_factor.hpp"
#include "statejump/complementarity/problem.hpp"
#include "time_step.hpp"

namespace statejump::truss::detail {

/// Responses of velocities to impulses of contacts.
struct Delassus {
  Eigen::MatrixXd responses;  ///< Of velocities and constraint impulses: A⁻¹ H.
  Eigen::MatrixXd matrix;     ///< W = Hᵀ A⁻¹ H; empty: not computed.
};

/// One row of a contact's law, linear in its speed u, the speed u' along the other tangent, its
/// impulse r and the normal impulse r_n: by_speed u + by_beside u' + offset + compliance r +
/// by_normal r_n = 0.
struct ContactRow {
  double offset = 0.0;      ///< [m/s]
  double compliance = 0.0;  ///< [1/kg]
  double by_speed = 1.0;
  double by_beside = 0.0;  ///< For the speed along the other tangent of a ball.
  double by_normal = 0.0;  ///< [1/kg]
};

/// The active contacts of a step and their laws.
///
/// Contact i has two columns of H: column 2i along its normal, and column 2i + 1 along its surface.
/// u = Hᵀ v are the speeds at the end of the step, r the impulses. H is evaluated at the middle of
/// the step, so that the gap at the end is linear in v: g = g_middle + opened + h u_n. For its
/// status a contact has two equations (ContactRow), and inequalities that request another status if
/// they are violated. Tangents at an iterate replace elastic laws.
class StepContacts {
 public:
  using Index = Eigen::Index;

  /// @param jacobian of the joints at the middle of the step
  StepContacts(Contacts& all, const linear::SparseView& jacobian, const MotionState& state,
               const TimeStep& step, double restitution);

  std::vector<Contact*> contacts;
  std::vector<int> numbers;                ///< Numbers of these contacts among all contacts.
  Eigen::SparseMatrix<double> directions;  ///< H
  VectorXd before;                         ///< Speeds at the start of the step.
  VectorXd impulses;                       ///< r [N s]
  Delassus delassus;                       ///< Computed for the contact problem only.

  Index count() const { return static_cast<Index>(contacts.size()); }
  Contact& contact(Index i) const { return *contacts[static_cast<std::size_t>(i)]; }
  double speed(const TimeStep& step, Index row) const { return directions.col(row).dot(step.v); }

  /// Negative of the speed at which a rigid contact opens after an impact [m/s].
  double leaving_speed(const TimeStep& step, Index i) const;
  /// Tangent of an elastic contact's normal law at a speed.
  struct Tangent {
    double elastic;     ///< Without the dashpot [N].
    double force;       ///< [N]
    double compliance;  ///< [m/N]
    double gap;         ///< speed h + compliance force + gap = 0 is the tangent [m].
  };
  Tangent normal_tangent(const TimeStep& step, Index i, double speed) const;
  /// Normal law of an elastic contact at the end of the step, if it opens at the given speed [m/s].
  Contact::Across normal_law(const TimeStep& step, Index i, double speed) const;
  /// Normal force of a contact at the end of the step, without the dashpot [N].
  double elastic_normal(const TimeStep& step, Index i) const;

  ContactRow normal_row(const TimeStep& step, Index i) const;
  ContactRow stick_row(const TimeStep& step, Index i) const;
  /// Residual of a row [m/s].
  /// @param across true for the normal row, false for the tangential row
  double residual(const ContactRow& row, const TimeStep& step, Index i, bool across) const;
  /// Tangential over normal impulse of a contact that slides.
  static double friction_ratio(const Contact& contact, ContactStatus status);
  /// The status that the inequalities of a contact request, given the status whose equations hold.
  ContactStatus requested(const TimeStep& step, Index i, ContactStatus status) const;
  /// Statuses at the end of a step, derived from the impulses.
  ContactStatuses statuses() const;
  /// Whether a rigid contact closes in the step, so that velocities jump.
  bool closes() const;

  /// The other tangent of a ball with partial slip; −1: none.
  Index partner(Index i) const {
    return !contact(i).slips_in_part || contact(i).ball < 0 ? -1
           : contact(i).beside                              ? i - 1
                                                            : i + 1;
  }

  // Contacts with partial slip, in partial_slip_contacts.cpp. The owner of a transverse contact has
  // the normal force.
  /// Speeds of the contacts with partial slip [m/s]; 0 for all other contacts.
  VectorXd partial_slip_speeds(const TimeStep& step) const;
  /// Points of the tangents: the kinks of the laws; an iterate; or (`next`) an iterate, but the
  /// kink for contacts whose slip has reversed.
  enum class TangentAt : unsigned char { kinks, iterate, next };
  /// @param speeds of the contacts [m/s]
  void place_tangents(const TimeStep& step, const VectorXd& speeds, TangentAt at);
  /// Whether the impulses satisfy the partial-slip laws themselves, not only the tangents.
  /// @param drift rounding error of speeds [m/s]
  bool on_partial_slip_laws(const TimeStep& step, double drift) const;
  /// Adds the tangent of the partial-slip law to the contact problem.
  /// @param opens opening speed at which the contact's law is evaluated [m/s]
  void add_partial_slip(const TimeStep& step, Index owner, double opens,
                        complementarity::Problem& problem) const;
  /// Loads of the partial-slip law at an opening speed [m/s].
  SlipAnnuli::Pressed pressed(const TimeStep& step, Index owner, double opens) const;
  /// Components of `speeds` along both tangents of a contact. For a planar contact the second
  /// component is 0.
  Vector2d along(Index owner, const VectorXd& speeds) const;
  /// Part of a contact's slide in the step that does not depend on the speed at its end [m].
  Vector2d slid(Index owner) const;

 private:
  /// Depth [m] of an elastic contact at the end of the step, if it opens at the given speed [m/s].
  double depth(const TimeStep& step, Index i, double speed) const;
  /// The contact that provides the normal force.
  Index owner(Index i) const { return contact(i).beside ? i - 1 : i; }
  /// Tangent of the partial-slip law, as the row of a contact or of its transverse contact.
  ContactRow partial_slip_row(const TimeStep& step, Index i) const;

  double restitution_;
};

/// Status of a contact, derived from the forces in its memory.
ContactStatus status_of(const Contact& contact);

}  // namespace statejump::truss::detail
