// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <functional>
#include <string>
#include <vector>

#include "statejump/truss/model.hpp"

namespace statejump::truss {

/// What a frictional joint does. Senses are those of the slide: of a slider along its axis, of a
/// revolute the journal's surface over the bearing's, anticlockwise about the axis.
enum class JointStatus : unsigned char {
  stick,
  slip_plus,
  slip_minus,
  stop_plus,   ///< Slider only: rests against a stop.
  stop_minus,  ///< Slider only.
  open         ///< Revolute only: no contact.
};

/// "stick", "slip_plus", …: the enumerator's name.
const char* to_string(JointStatus status);

struct Options {
  /// Points of a path per monotone branch of the programs, >= 1.
  int increments_per_branch = 50;
  /// Whether every change of a joint's status is located in time, or only those that the state
  /// depends on; see solve(). Costs about ten solves a change.
  bool locate_events = true;
  /// Length of time [1/branch] within which changes are located.
  double event_tolerance = 1e-9;
  /// Keep the states at the ends of the cycles only.
  bool cycle_ends_only = false;
  /// Newton iterations after the last change of a status, and of one that goes round in circles.
  int most_iterations = 40;
  /// Called with the share of the program that is done (0 to 1); returning false ends the path
  /// there, with Path::complete false.
  std::function<bool(double)> progress;
};

/// Change of a joint's status.
struct Event {
  double time;                ///< [s] End of the interval in which it happened.
  double interval;            ///< [s] Its length.
  double temperature_change;  ///< ΔT of the first program at `time` [K].
  bool is_revolute;
  int joint;  ///< Index among sliders or revolutes.
  JointStatus before;
  JointStatus after;
};

/// Equilibrium at one time. Axial force of links: compression positive; tension of springs.
struct State {
  double time = 0.0;                ///< [s]
  double temperature_change = 0.0;  ///< ΔT of the first program [K].
  Eigen::Matrix3Xd displacement;    ///< Of each node from the drawn shape [m].
  Eigen::VectorXd axial_force;      ///< Of each link [N], compression positive.
  Eigen::VectorXd tension;          ///< Of each spring [N].
  Eigen::VectorXd slide;            ///< Of each slider from the drawn shape [m].
  Eigen::VectorXd slider_force;     ///< Friction and stop on the slider, against its axis [N].
  Eigen::Matrix3Xd eccentricity;    ///< Of each revolute, journal minus bearing centre [m].
  Eigen::VectorXd normal_force;     ///< Of each revolute [N], >= 0.
  Eigen::VectorXd friction_force;   ///< Of each revolute, on the journal against the slide [N].
  std::vector<JointStatus> slider_status;
  std::vector<JointStatus> revolute_status;
  Eigen::VectorXd slider_dissipation;    ///< Heat of friction since the start [J].
  Eigen::VectorXd revolute_dissipation;  ///< Heat of friction since the start [J].
  double elastic_energy = 0.0;           ///< Links, springs and contacts [J].
  double thermal_work = 0.0;             ///< Work of the temperature since the start [J].
  double load_potential = 0.0;           ///< −Σ load · displacement [J].
};

/// What solve() returns.
struct Path {
  std::vector<State> states;      ///< Start, points of the path, events if located.
  std::vector<State> cycle_ends;  ///< Start and end of every cycle.
  std::vector<Event> events;
  bool complete = true;  ///< False if Options::progress ended it.
  long solves = 0;       ///< Newton solves.
  long factorizations = 0;
  double largest_force_residual = 0.0;    ///< Over the largest force of its state [-].
  double largest_closure_residual = 0.0;  ///< Of sticking, stops and contacts [m].
  int unknowns = 0;
};

/// Quasi-static path of a truss through its temperature programs: exact Coulomb friction.
///
/// **Equations.** Unknown are the displacements of the nodes and, at every joint, its contact
/// forces: λ of a slider, normal force λ_n and friction λ_t of a revolute. Lengths and angles are
/// exact (no small rotations); everything expands from the total ΔT. Equilibrium of the nodes is
/// completed by one line per contact force. Slider with slide s, from s_k at the start of the step:
///
///     stick   s = s_k, |λ| <= f          slip±   λ = ±f, ±(s − s_k) >= 0
///     stop±   s = ±c±, pushed against it, or held by friction and stop together
///
/// Revolute with eccentricity d, normal n = d/|d|, surface slide of the step
/// Δσ = ∫ |d| dφ + r1 dθ_J − r2 dθ_B (φ, θ_J, θ_B the angles of d and of the links that turn
/// journal and bearing; r1, r2 the radii less and plus half the depth, so that both surfaces meet
/// in one point and the moments balance):
///
///     open    λ_n = λ_t = 0, |d| <= c    contact |d| = c + (λ_n/K)^(2/3), λ_n >= 0
///     stick   Δσ = 0, |λ_t| <= μ λ_n     slip±   λ_t = ±μ λ_n, ±Δσ >= 0
///
/// A joint that sticks therefore rolls. With a finite tangential stiffness k_t a joint that sticks
/// gives way elastically, as bodies of a DEM do: s and Δσ then are the slides less what friction
/// bends, λ/k_t and ∫ dλ_t/k_t. k_t of a revolute follows its depth (Mindlin, k_t = 8 G* √(R δ)):
/// what loads the contact keeps λ_t, what unloads it keeps λ_t/k_t; energy lost either way is heat
/// at the contact's rim. One step is the implicit Euler step of this evolution, solved by Newton's
/// method with an active set: each iteration changes the status of every joint that violates its
/// inequality, and the solve has converged when none does, forces balance to 1e-12 of the largest
/// one and closures to rounding.
///
/// **Why the increment does not matter.** With every status fixed, the state is an algebraic
/// function of temperature: stick, stops and the cone |λ_t| = μ λ_n are holonomic, so a step is
/// exact however long. (Rolling is so for rigid contacts and radii that do not expand; else its
/// increment is of third order; the k_t of a revolute that sticks is taken by the trapezoidal rule,
/// of second order.) Memory enters only where a slip ends in a stick and where an open
/// joint closes. Steps with such a change are shortened until it happens within `event_tolerance`
/// of a branch, or until what the joint may have slid by then is below that share of its clearance
/// plus rounding; and so is the first step after each corner of a program, where slips turn into
/// sticks. With `locate_events` this is done for every change of status. A step that does not
/// converge is shortened as well.
///
/// **Start.** The drawn shape need not be in equilibrium: it is first relaxed at ΔT = 0 with
/// bilateral pins in place of clearance revolutes; their pin forces say where each journal touches;
/// then the clearances open with frictionless contacts. There friction begins, without force.
///
/// Throws std::invalid_argument for a model or option out of range. Throws std::runtime_error that
/// names joint or nodes and the temperature: for a mechanism (with its free modes), also one that a
/// joint makes that opens; for an equilibrium of the start or at a corner of the programs that is
/// unstable though every joint is held (buckled, with the modes); for a revolute that carries no
/// force at the start (statics does not determine its position in the play) or jumps across its
/// play; where equilibrium is not found; and for a joint whose status changes without end.
Path solve(const Model& model, const Options& options = {});

}  // namespace statejump::truss
