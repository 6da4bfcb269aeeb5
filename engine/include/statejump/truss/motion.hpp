// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "statejump/truss/path.hpp"

namespace statejump::truss {

/// What a truss needs beside its Model to move. A vector has one number for each item; an empty one
/// stands for zeros.
struct Inertia {
  /// Of each link [kg], >= 0: a body that is carried by its two nodes. Its mass matrix is constant
  /// and exact for a body that stays as it is; that of a straight rod is m/6 [2 1; 1 2].
  Eigen::VectorXd link_mass;
  Eigen::VectorXd node_mass;  ///< Of each node besides, a point [kg], >= 0.
  /// c of each link's dashpot on its strain rate, c (L' − l_T') [N s/m], >= 0.
  Eigen::VectorXd link_damping;
  /// c_p of each link's moment −c_p θ' against turning [N m s/rad], >= 0.
  Eigen::VectorXd pin_damping;
  Eigen::VectorXd spring_damping;  ///< c of each spring's dashpot, c L' [N s/m], >= 0.
  /// 2 ζ √m of each joint's contacts [kg^1/2], >= 0: dashpots c = 2 ζ √(m k) beside the elastic
  /// laws across and along the surface, k the tangent stiffness. Rigid laws have none.
  Eigen::VectorXd joint_damping = {};
  /// Of each link, where its centre of mass is: shares of the way from its first to its second node
  /// along it, and to the left of it (in the plane; in space it is on the way). Empty: (1/2, 0).
  Eigen::Matrix2Xd link_centre = {};
  /// Moment of inertia of each link about its centre of mass [kg m²], >= 0. Empty: rods, m l0²/12.
  Eigen::VectorXd link_moment = {};
};

/// Number of an item in a list of Inertia.
inline double inertia_of(const Eigen::VectorXd& list, std::size_t i) {
  return list.size() == 0 ? 0.0 : list[static_cast<Eigen::Index>(i)];
}

/// A link whose turning is prescribed: its angular velocity about z, linear between rows, the first
/// and last row beyond them. It begins at the drawn angle; a couple on its two nodes turns it.
struct Drive {
  std::string name;  ///< For messages.
  int link = 0;
  Eigen::VectorXd time;   ///< [s], increasing, one row or more.
  Eigen::VectorXd speed;  ///< [rad/s]

  double speed_at(double t) const;   ///< [rad/s]
  double turned_at(double t) const;  ///< Angle since t = 0 [rad].
};

/// Places and velocities of all nodes from which a motion begins.
struct MotionStart {
  Eigen::Matrix3Xd displacement;  ///< From the drawn shape [m].
  Eigen::Matrix3Xd velocity;      ///< [m/s]
};

struct MotionOptions {
  long steps = 10000;     ///< Over all cycles, >= 1.
  long sample_every = 1;  ///< Steps between samples, >= 1; start and end are samples as well.
  double theta = 0.5;     ///< θ of the scheme, 0.5 to 1.
  /// What displacements may be off by in one step [m]; 0: equal steps. Above it steps are as long
  /// as that allows, up to the time between samples: of backward differentiation, or, where joints
  /// rub behind springs along fixed directions, of Radau IIA between changes of branches that are
  /// sought.
  double displacement_tolerance = 0;
  double restitution = 0;  ///< e of Newton's impact law, 0 to 1; of rigid contacts only.
  int most_iterations = 50;
  /// Without: the equilibrium in which the quasi-static path begins, at rest.
  std::optional<MotionStart> start = {};
  /// How the truss gets to that equilibrium.
  StartFriction start_friction = StartFriction::stuck;
  std::vector<Drive> drives = {};  ///< In planar trusses.
  /// Node whose velocity is kept at every step; −1: none.
  int watched_node = -1;
  /// Called with the share that is done (0 to 1); returning false ends the motion there, with
  /// Motion::complete false.
  std::function<bool(double)> progress = {};
};

/// What moves, beside the State of the same sample.
struct MovingState {
  Eigen::Matrix3Xd velocity;  ///< Of each node [m/s].
  double kinetic_energy = 0.0;
  double damping_dissipation = 0.0;  ///< Heat of the dashpots since the start [J].
  double impact_dissipation = 0.0;   ///< What contacts took across their surfaces since then [J].
  double drive_work = 0.0;           ///< Of all drives since the start [J].
  Eigen::VectorXd drive_moment;      ///< Of each drive on its link, mean of the last step [N m].
};

/// A step in which the laws of rigid contacts leave their reactions open: one of several is given,
/// velocities are the same for all.
struct Undetermined {
  double time;              ///< [s]
  std::vector<int> joints;  ///< Whose reactions may be traded for each other.
};

/// What simulate() returns.
struct Motion {
  std::vector<State> states;
  std::vector<MovingState> moving;    ///< Of the same samples.
  std::vector<Event> events;          ///< Interval: the step.
  std::vector<double> event_heat;     ///< Heat of all joints in the step of each event [J].
  Eigen::Matrix3Xd watched_velocity;  ///< Of the watched node at every step, the start first.
  bool complete = true;               ///< False if MotionOptions::progress ended it.
  double time_step = 0.0;             ///< [s]; the shortest one.
  long steps = 0;
  long rejected_steps = 0;  ///< Tried, and longer than the tolerance allows or without solution.
  /// Off by more than the tolerance at the shortest length there is; of equal steps those, or their
  /// parts, that were damped.
  long inexact_steps = 0;
  long iterations = 0;  ///< Contact problems solved.
  long factorizations = 0;
  int unknowns = 0;                    ///< Free displacements.
  double largest_contact_merit = 0.0;  ///< Of the contact problems, see complementarity::Merit.
  std::optional<Undetermined> undetermined;  ///< The first such step.
  /// The first step in which a slide of a rigid contact ends that could not go on: its force had
  /// no solution or was one of several (Painlevé).
  std::optional<Undetermined> jammed;
  double negative_dissipation = 0.0;  ///< Sum of what steps gave below zero [J], <= 0.
};

/// Motion of a truss through its temperature programs, after Moreau and Jean [1, 2].
///
/// **Scheme.** Of a step h, with M the constant mass matrix, f the forces of links, springs,
/// torsion springs, dashpots and loads, and r the impulses of the contacts in directions H,
///
///     M (v1 − v0) = h (θ f1 + (1 − θ) f0) + H r,   q1 = q0 + h (θ v1 + (1 − θ) v0)
///
/// solved by Newton's method with M + h θ C + (h θ)² K at the middle of the step; H is taken there
/// too. Contacts are first taken on the branches of the step before and pivoted: one sparse system
/// a try, and small ones around the contacts that change between. What that does not settle is a
/// local frictional contact problem (complementarity/) with W = Hᵀ (M + …)⁻¹ H, dense. Second order
/// where no contact changes, first order over changes; θ = 1/2 has no numerical damping.
///
/// **Contacts.** Velocities are those at the end of the step. Rigid contacts obey Newton's
/// u1 + e min(u0, 0) >= 0 ⟂ r >= 0 once their gap is closed at the middle of the step, and
/// Coulomb's law as a set. A revolute with a Hertz stiffness keeps the truss' elastic law,
/// gap + (λ/K)^(2/3) >= 0 ⟂ λ >= 0 at the end of the step (implicit Euler in the contact, so steps
/// may be longer than its period; then its impact is without rebound), one with Mindlin's stiffness
/// gives way tangentially by the truss' rule. A slider's friction has a given bound; its stops are
/// rigid contacts. Dashpots stand beside the elastic laws: λ = K δ^1.5 − c u >= 0 across, and along
/// the surface c_t u as long as the spring sticks, together within Coulomb's bound of the whole λ.
///
/// **Energies.** Impulses work by the mean velocity of the step, so thermal_work + work of loads −
/// changes of kinetic and elastic energy − dissipation closes to the error of the scheme in the
/// forces f. A contact's own dissipation is what it took less what it stores; in a step in which a
/// slide reverses friction's may come out below zero by O(h²), which `negative_dissipation` adds up
/// with that of rigid impacts. Across its surface an elastic contact is conservative: what it took
/// there is the scheme's, of either sign in a step.
///
/// **Drives.** The angular velocity of a driven link at the end of the step is prescribed, where
/// its program puts it; angles follow to second order.
///
/// Planar and spatial trusses; three-dimensional joints slide as the quasi-static ones do. Friction
/// of a ball has the direction that it has at the end of the step: a step is solved again until it
/// is found, `not_converged` names the joint where it is not.
///
/// An equal step without solution is taken by implicit Euler, and then by halves, with a matrix
/// that leaves out what compression takes from the stiffness of links; `inexact_steps` counts them.
///
/// Throws std::invalid_argument for a model or option out of range; Failure for a step without
/// solution (`not_converged`, `singular`, with the joint whose law is violated most), and
/// `not_finite`.
///
/// [1] M. Jean, Comput. Methods Appl. Mech. Eng. 177 (1999) 235-257.
/// [2] V. Acary, B. Brogliato, Numerical Methods for Nonsmooth Dynamical Systems, Springer 2008.
Motion simulate(const Model& model, const Inertia& inertia, const MotionOptions& options = {});

/// The same truss as an ordinary differential equation at the scale of a DEM: contacts are the
/// kernel's, Hertz's across and along the surface a law of friction by its name, with dashpots as
/// in kernel::contact_step(). Steps are Runge and Kutta's of fourth order, all of one length. What
/// a contact remembers changes at the end of a step only, by the slide of the whole step, which is
/// integrated along the way with the places; where the stiffness of a contact changes within a
/// step, or a contact begins or ends in it, that is of first order.
///
/// Explicit: a step of more than 2 √2 over the largest angular frequency grows what swings. Steps
/// in which a contact alone is beyond that are counted, `Motion::inexact_steps`. Elastic revolutes
/// and balls, and sliders on the ground without stops that stick elastically; masses are lumped.
/// `theta`, `displacement_tolerance`, `restitution` and drives are of simulate() alone.
///
/// @param friction_law one of kernel::laws::law_names<FrictionLaw>()
/// @throws as simulate(); std::invalid_argument for a law that is not known or a joint that has no
/// such contact
Motion simulate_regularised(const Model& model, const Inertia& inertia,
                            const std::string& friction_law, const MotionOptions& options = {});

}  // namespace statejump::truss
