// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "bodies.hpp"
#include "contacts.hpp"
#include "statejump/failure.hpp"
#include "truss/system.hpp"

namespace statejump::truss::detail {

/// Status of a contact in a step: open, closed and sticking, or closed and sliding.
enum class ContactStatus : unsigned char { open, stick, slip_plus, slip_minus };
using ContactStatuses = std::vector<ContactStatus>;

/// State of a truss between two steps. Each Contact stores its own memory.
struct MotionState {
  double time = 0.0;         ///< [s]
  VectorXd q;                ///< Free displacements [m].
  VectorXd v;                ///< Their velocities [m/s].
  VectorXd z;                ///< q and the forces of the joints.
  StepStart origin;          ///< Statuses and history of the joints.
  VectorXd force;            ///< Forces without dashpots and contacts at (q, time) [N].
  VectorXd held;             ///< Forces of Contacts::turning_holds() in the last step [N].
  ContactStatuses contacts;  ///< Statuses of all contacts in the last step.
};

/// A step in progress. Its equations are M (v − v_from) = h (θ f + (1 − θ) f0) + H r, q = q_from +
/// h (θ v + (1 − θ) v0). A Moreau–Jean step starts from the end of the last step. A step of
/// backward differentiation has θ = 1; its starting values v_from and q_from follow from the last
/// two steps, and h is a fraction of its length.
struct TimeStep {
  long number = 0;
  double h = 0.0;       ///< [s]; impulses are h times the forces at the end.
  double to = 0.0;      ///< Time at its end [s].
  double length = 0.0;  ///< [s]
  double theta = 1.0;
  bool differentiates = false;  ///< Whether the last two steps determine its starting values.
  /// Whether the matrix omits the softening by compression. At the start of a step, a slack element
  /// seems compressed by its expansion. At the end its force vanishes, and only its mass resists
  /// rotation.
  bool is_definite = false;
  Bodies::Step span = {};
  VectorXd q_from;
  VectorXd v_from;
  VectorXd q_middle;
  VectorXd force_before;  ///< f0 [N]
  VectorXd q;
  VectorXd v;
  VectorXd held = {};  ///< Impulses of the velocity constraints, for their scaled columns.

  /// Mean force, which determines the work in a step. In backward differentiation it is the mean of
  /// both ends, unless the contact slides with friction at its limit.
  double mean(double before, double after, bool slides) const {
    return differentiates && !slides ? 0.5 * (before + after) : after;
  }
};

/// Tolerance of the law of an elastic contact, as a fraction of its force. The contact problem is
/// solved to 1e-10 of its largest velocity. In a stiff contact, the relative error of the force is
/// much larger.
constexpr double on_law = 1e-6;

/// Allowed violation of an inequality, as a fraction of the contact's own force or of the largest
/// speed. It equals the tolerance of the contact problem.
constexpr double allowance = 1e-10;

/// Throws Failure for a step without a solution.
/// @param contact the contact that caused it, or null
[[noreturn]] void fail_step(const System& system, FailureKind kind, double time,
                            const Contact* contact);

}  // namespace statejump::truss::detail
