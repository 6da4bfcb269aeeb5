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

/// One row of a contact's law as a linear equation in its speed u and impulse r:
/// by_speed u + by_beside u' + offset + compliance r + by_normal r_n = 0.
struct ContactRow {
  double offset = 0.0;      ///< [m/s]
  double compliance = 0.0;  ///< [1/kg]
  double by_speed = 1.0;
  double by_beside = 0.0;  ///< For the speed along the other tangent of a ball.
  double by_normal = 0.0;  ///< [1/kg]
};

/// The active contacts of a step and their laws.
///
/// Contact i has two rows of H, columns 2i across and 2i + 1 along its surface: u = Hᵀ v are its
/// speeds at the end of the step, r its impulses. The directions are those of the middle of the
/// step, so that the gap at the end is linear in v: g = g_middle + opened + h u_n. On its status a
/// contact has two equations (ContactRow), and inequalities that request another status. Elastic
/// laws are replaced by their tangents at an iterate.
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

  /// Speed with which a rigid contact opens after an impact, with its sign changed [m/s].
  double leaving_speed(const TimeStep& step, Index i) const;
  /// The normal law of an elastic contact as its tangent at a speed.
  struct Tangent {
    double elastic;     ///< Without the dashpot [N].
    double force;       ///< [N]
    double compliance;  ///< [m/N]
    double gap;         ///< speed h + compliance force + gap = 0 is the tangent [m].
  };
  Tangent normal_tangent(const TimeStep& step, Index i, double speed) const;
  /// Normal law of an elastic contact at the end of the step, opening at this speed.
  Contact::Across normal_law(const TimeStep& step, Index i, double speed) const;
  /// Normal force without the dashpot, at the end of the step [N].
  double elastic_normal(const TimeStep& step, Index i) const;

  ContactRow normal_row(const TimeStep& step, Index i) const;
  ContactRow stick_row(const TimeStep& step, Index i) const;
  /// Residual of a row [m/s].
  /// @param across whether it is the normal row
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

  // Contacts with partial slip, in partial_slip_contacts.cpp. An owner is the contact with the
  // normal force.
  /// Speeds of the contacts with partial slip; 0 for others [m/s].
  VectorXd partial_slip_speeds(const TimeStep& step) const;
  /// Tangent points: at the kinks of the laws; at an iterate; or (next) at an iterate, but at the
  /// kink for contacts whose slip has reversed.
  enum class TangentAt : unsigned char { kinks, iterate, next };
  /// @param speeds of the contacts [m/s]
  void place_tangents(const TimeStep& step, const VectorXd& speeds, TangentAt at);
  /// Whether impulses satisfy the partial-slip laws, not only their tangents.
  /// @param drift rounding of speeds [m/s]
  bool on_partial_slip_laws(const TimeStep& step, double drift) const;
  /// Adds the tangent to the contact problem.
  /// @param opens opening speed of the contact [m/s]
  void add_partial_slip(const TimeStep& step, Index owner, double opens,
                        complementarity::Problem& problem) const;
  /// Loads of the partial-slip law at an opening speed [m/s].
  SlipAnnuli::Pressed pressed(const TimeStep& step, Index owner, double opens) const;
  /// Components along both tangents of a contact; the second is 0 for a planar contact.
  Vector2d along(Index owner, const VectorXd& speeds) const;
  /// Part of the slide of the step that does not depend on its speed [m].
  Vector2d slid(Index owner) const;

 private:
  /// Depth of an elastic contact at the end of the step, opening at this speed [m].
  double depth(const TimeStep& step, Index i, double speed) const;
  /// The contact that provides the normal force.
  Index owner(Index i) const { return contact(i).beside ? i - 1 : i; }
  /// Tangent of the partial-slip law, for a contact or its transverse contact.
  ContactRow partial_slip_row(const TimeStep& step, Index i) const;

  double restitution_;
};

/// Status of a contact, derived from the forces in its memory.
ContactStatus status_of(const Contact& contact);

}  // namespace statejump::truss::detail
