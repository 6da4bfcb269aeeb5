// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "statejump/truss/path.hpp"

namespace statejump::truss {

/// Inertia and dashpots of a truss, in addition to its Model. Each vector has one number per link
/// or joint; an empty vector means zeros.
struct Inertia {
  /// Mass of each link [kg], >= 0, attached to its two nodes. The mass matrix of a link is
  /// constant, and exact for a body of constant shape. For a straight rod it is m/6 [2 1; 1 2].
  Eigen::VectorXd link_mass;
  Eigen::VectorXd node_mass;  ///< Additional point mass of each node [kg], >= 0.
  /// Coefficient c of each link's dashpot on its strain rate, c (L' − l_T') [N s/m], >= 0.
  Eigen::VectorXd link_damping;
  /// Coefficient c_p of each link's moment −c_p θ' against rotation [N m s/rad], >= 0.
  Eigen::VectorXd pin_damping;
  Eigen::VectorXd spring_damping;  ///< c of each spring's dashpot, c L' [N s/m], >= 0.
  /// 2 ζ √m of each joint's contacts [kg^1/2], >= 0. It defines dashpots c = 2 ζ √(m k), with the
  /// tangent stiffness k, in parallel with the elastic normal and tangential laws. Rigid laws have
  /// no dashpots.
  Eigen::VectorXd joint_damping = {};
  /// Centre of mass of each link, as fractions of the vector from its first to its second node:
  /// along it, and to its left (0 in space). Empty: (1/2, 0).
  Eigen::Matrix2Xd link_centre = {};
  /// Moment of inertia of each link about its centre of mass [kg m²], >= 0. Empty: rods, m l0²/12.
  Eigen::VectorXd link_moment = {};
  Eigen::VectorXd beam_mass = {};  ///< Mass of each beam [kg], >= 0.
  /// Moments of inertia of each beam's sections, integrated over half of its length [kg m²]: ρ J_p,
  /// ρ I_y and ρ I_z times l/2, about axes x, y and z of the section. Empty: none.
  Eigen::Matrix3Xd beam_moment = {};
};

/// Number of an item in a list of Inertia.
inline double inertia_of(const Eigen::VectorXd& list, std::size_t i) {
  return list.size() == 0 ? 0.0 : list[static_cast<Eigen::Index>(i)];
}

/// A link with prescribed rotation. Its angular velocity about z is linear between rows and
/// constant outside. It starts at the angle of the reference configuration. A couple on its two
/// nodes rotates it.
struct Drive {
  std::string name;  ///< For messages.
  int link = 0;
  Eigen::VectorXd time;   ///< [s], increasing, one row or more.
  Eigen::VectorXd speed;  ///< [rad/s]

  double speed_at(double t) const;   ///< [rad/s]
  double turned_at(double t) const;  ///< Angle since t = 0 [rad].
};

/// Positions and velocities of all nodes at the start of a motion.
struct MotionStart {
  Eigen::Matrix3Xd displacement;  ///< From ΔT = 0 [m].
  Eigen::Matrix3Xd velocity;      ///< [m/s]
};

struct MotionOptions {
  long steps = 10000;     ///< Over all cycles, >= 1.
  long sample_every = 1;  ///< Steps between samples, >= 1; start and end are samples as well.
  double theta = 0.5;     ///< θ of the scheme, 0.5 to 1.
  /// Allowed error of displacements in one step [m]. 0: equal steps. Otherwise steps are as long as
  /// this error allows, up to the time between samples. The integrator is then Radau IIA if all
  /// contacts have friction in series with springs along fixed directions, and backward
  /// differentiation otherwise.
  double displacement_tolerance = 0;
  double restitution = 0;  ///< e of Newton's impact law, 0 to 1; of rigid contacts only.
  int most_iterations = 50;
  /// Start of the motion. Empty: the first equilibrium of the quasi-static path, at rest.
  std::optional<MotionStart> start = {};
  /// How the truss reaches that equilibrium.
  StartFriction start_friction = StartFriction::stuck;
  std::vector<Drive> drives = {};  ///< In planar trusses.
  /// Node whose velocity is recorded at every step; −1: none.
  int watched_node = -1;
  /// Called with the finished fraction (0 to 1). If the callback returns false, the motion ends at
  /// once and Motion::complete is false.
  std::function<bool(double)> progress = {};
};

/// Quantities of the motion at a sample, in addition to those in its State.
struct MovingState {
  Eigen::Matrix3Xd velocity;  ///< Of each node [m/s].
  double kinetic_energy = 0.0;
  double damping_dissipation = 0.0;  ///< Heat of the dashpots since the start [J].
  /// Work that contacts absorbed along their normals since the start [J].
  double impact_dissipation = 0.0;
  double drive_work = 0.0;       ///< Of all drives since the start [J].
  Eigen::VectorXd drive_moment;  ///< Of each drive on its link, mean of the last step [N m].
};

/// A step in which the laws of rigid contacts do not determine their reactions. Several reactions
/// are then possible with the same velocities, and the solver returns one of them.
struct Undetermined {
  double time;  ///< Time of the step [s].
  /// Joints whose reactions can be exchanged without changing velocities.
  std::vector<int> joints;
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
  /// Number of steps repeated because their error was too large or they had no solution.
  long rejected_steps = 0;
  /// Number of inexact steps: in runs with an error tolerance, the shortest steps whose error still
  /// exceeds it; in runs with equal steps, those computed wholly or partly by damped implicit
  /// Euler.
  long inexact_steps = 0;
  long iterations = 0;  ///< Contact problems solved.
  long factorizations = 0;
  int unknowns = 0;                    ///< Free displacements.
  double largest_contact_merit = 0.0;  ///< Of the contact problems, see complementarity::Merit.
  std::optional<Undetermined> undetermined;  ///< The first such step.
  /// The first step in which the slide of a rigid contact ends because its normal force has no
  /// solution or several (Painlevé).
  std::optional<Undetermined> jammed;
  /// Sum of the negative friction heats of single steps [J], <= 0.
  double negative_dissipation = 0.0;
};

/// Motion of a truss through its temperature programs, after Moreau and Jean [1, 2].
///
/// **Scheme.** For a step h, with the constant mass matrix M, the forces f of links, springs,
/// torsion springs, dashpots and loads, and the impulses r of the contacts in directions H,
///
///   M (v1 − v0) = h (θ f1 + (1 − θ) f0) + H r,   q1 = q0 + h (θ v1 + (1 − θ) v0)
///
/// Newton's method solves the step with M + h θ C + (h θ)² K at the middle of the step; H is
/// evaluated there too. Contacts first keep the statuses of the previous step, and change them if
/// inequalities are violated. Each change costs one sparse system; smaller systems around the
/// changing contacts predict further changes. If the statuses are not found, the step is solved as
/// a local frictional contact problem (complementarity/) with the dense matrix W = Hᵀ (M + …)⁻¹ H.
/// The scheme is second-order accurate while no contact changes, and first-order accurate across
/// changes. θ = 1/2 has no numerical damping.
///
/// **Contacts.** Contact laws use the velocities at the end of the step. Rigid contacts obey
/// Newton's u1 + e min(u0, 0) >= 0 ⟂ r >= 0 once their gap is closed at the middle of the step, and
/// Coulomb's law without regularisation. A revolute with a Hertz stiffness has the elastic law of
/// the quasi-static solver, gap + (λ/K)^(2/3) >= 0 ⟂ λ >= 0, at the end of the step. The contact is
/// thus integrated by implicit Euler. If a step is longer than the contact's period, an impact has
/// no rebound. A revolute with Mindlin's stiffness deflects tangentially as in the quasi-static
/// solver. The friction of a slider has a given limit; its stops are rigid contacts. Dashpots act
/// in parallel with the elastic laws: λ = K δ^1.5 − c u >= 0 along the normal, and c_t u along the
/// surface while the spring sticks. The sum of spring and dashpot force is within Coulomb's limit
/// for λ.
///
/// **Energies.** The work of impulses uses the mean velocity of the step. Therefore thermal_work +
/// work of loads − changes of kinetic and elastic energy − dissipation equals the quadrature error
/// of the scheme for the forces f. The dissipation of a contact is the work done on it minus the
/// energy that it stores. If a slide reverses in a step, the friction heat may be negative by
/// O(h²); `negative_dissipation` sums these negative values and those of rigid impacts. Along its
/// normal an elastic contact is conservative; a dissipation in that direction, of either sign, is
/// an error of the scheme.
///
/// **Drives.** The angular velocity of a driven link at the end of the step is prescribed by its
/// program. Angles are second-order accurate.
///
/// Trusses are planar or spatial. Three-dimensional joints slide as in the quasi-static solver. The
/// friction of a ball acts along its direction at the end of the step, so the step is solved
/// repeatedly until this direction converges. Otherwise the failure `not_converged` names the
/// joint.
///
/// If one of equal steps has no solution, it is repeated by implicit Euler, then in halves. The
/// matrix of the repeated steps omits the softening of links by compression. `inexact_steps` counts
/// these steps.
///
/// Throws std::invalid_argument for a model or option out of range; Failure for a step without
/// solution (`not_converged`, `singular`, with the joint with the largest violation), and
/// `not_finite`.
///
/// [1] M. Jean, Comput. Methods Appl. Mech. Eng. 177 (1999) 235-257.
/// [2] V. Acary, B. Brogliato, Numerical Methods for Nonsmooth Dynamical Systems, Springer 2008.
Motion simulate(const Model& model, const Inertia& inertia, const MotionOptions& options = {});

/// Computes the motion of the same truss as an ordinary differential equation, with steps as short
/// as those of a DEM. Contacts follow the laws of the kernel: Hertz's law across the surface, a
/// friction law by name along it, and dashpots as in kernel::contact_step(). All steps have the
/// same length and use the fourth-order Runge–Kutta method. The slide of a whole step updates the
/// memory of a contact at its end. The slide is integrated together with the positions. If the
/// stiffness of a contact changes within a step, or a contact begins or ends in it, the step is
/// first-order accurate.
///
/// The method is explicit: a step longer than 2 √2 over the largest angular frequency is unstable.
/// `Motion::inexact_steps` counts steps in which only contacts exceed that limit. Supported joints
/// are elastic revolutes and balls, and sliders on the ground that stick elastically and have no
/// rigid stops. Masses are lumped. Only simulate() uses `theta`, `displacement_tolerance`,
/// `restitution` and drives.
///
/// @param friction_law one of kernel::laws::law_names<FrictionLaw>()
/// @throws as simulate(); std::invalid_argument for an unknown law or an unsupported joint
Motion simulate_regularised(const Model& model, const Inertia& inertia,
                            const std::string& friction_law, const MotionOptions& options = {});

}  // namespace statejump::truss
