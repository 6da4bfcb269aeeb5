// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <functional>
#include <string_view>
#include <vector>

#include "statejump/failure.hpp"
#include "statejump/start_friction.hpp"
#include "statejump/truss/local_problem.hpp"
#include "statejump/truss/model.hpp"
#include "statejump/truss/trace.hpp"

namespace statejump::truss {

struct Options {
  /// How the truss gets to its first equilibrium.
  StartFriction start_friction = StartFriction::stuck;
  /// Points of a path per monotone branch of the programs, >= 1.
  int increments_per_branch = 50;
  /// Whether every change of a joint's status is located in time, or only those that the state
  /// depends on; see solve(). Costs about ten solves a change.
  bool locate_events = true;
  /// Length of time [1/branch] within which changes are located.
  double event_tolerance = 1e-9;
  /// Share of the temperature's work (of a program that works all the time as it does where it
  /// works most) by which energies may fail to balance, where events are located: increments that
  /// lose more are cut, into 64 steps at most. Laws that slip smoothly are not: they have chords.
  double energy_tolerance = 2.5e-11;
  /// Keep the states at the ends of the cycles only.
  bool cycle_ends_only = false;
  /// When the frictional contact problem of a step is told, in order [s]: of the first step that
  /// ends there or later.
  std::vector<double> problem_times;
  /// Newton iterations after the last change of a status, and of one that goes round in circles.
  int most_iterations = 40;
  /// Steps that may be tried in an increment without a change of a joint's status, >= 1. One is the
  /// rule, and a change is located in some ten; a path that takes as many as this is lost.
  int most_steps = 10000;
  /// Called with the share of the program that is done (0 to 1); returning false ends the path
  /// there, with Path::complete false.
  std::function<bool(double)> progress;
  /// Called with every iteration of Newton's method; empty: no trace.
  TraceSink trace;
};

/// Change of a joint's status.
struct Event {
  double time;                ///< [s] End of the interval in which it happened.
  double interval;            ///< [s] Its length.
  double temperature_change;  ///< ΔT of the first program at `time` [K].
  int joint;                  ///< Index among the model's joints.
  JointStatus before;
  JointStatus after;
};

/// Equilibrium at one time.
struct State {
  double time = 0.0;                ///< [s]
  double temperature_change = 0.0;  ///< ΔT of the first program [K].
  Eigen::Matrix3Xd displacement;    ///< Of each node from the drawn shape [m].
  Eigen::VectorXd element_output;   ///< Outputs of all elements; see element_output().
  Eigen::VectorXd joint_output;     ///< What the types of joints have at every state; see output().
  std::vector<JointStatus> joint_status;
  Eigen::VectorXd joint_dissipation;  ///< Heat of friction of each joint since the start [J].
  double elastic_energy = 0.0;        ///< Links, springs and contacts [J].
  double thermal_work = 0.0;          ///< Work of the temperature since the start [J].
  double load_potential = 0.0;        ///< −Σ load · displacement [J].
};

/// What a path found that a user has to know and that is no failure.
enum class NoteKind : unsigned char {
  large_start,  ///< The first equilibrium is far from the reference configuration: `value` [m].
  slack,       ///< Joints without contact: where their elements hang in the play is not determined.
  not_unique,  ///< Joints that stick constrain a displacement more than once: one of many
               ///< reactions.
  snap  ///< Slip ran away within the play of joints, and the truss moved by `value` [m] at once.
};

/// "large_start", …: the enumerator's name.
const char* to_string(NoteKind kind);

struct Note {
  NoteKind kind;
  double time;                       ///< [s]
  double temperature_change;         ///< ΔT of the first program [K].
  std::vector<FailureJoint> joints;  ///< Those that it is about.
  double value = 0.0;                ///< See NoteKind.
};

/// Outputs of the elements of a type at a state, in the order of outputs(), a column for each.
template <Element Type>
Eigen::Map<const Eigen::MatrixXd> element_output(const Model& model, const State& state) {
  const double* begin = state.element_output.data();
  std::size_t count = 0;
  for_each_element_type([&]<std::size_t k>(std::integral_constant<std::size_t, k>) {
    const std::size_t size = std::get<k>(model.lists()).size();
    if constexpr (k < element_type_index<Type>()) begin += size * output_width<ElementType<k>>();
    if constexpr (k == element_type_index<Type>()) count = size;
  });
  return {begin, static_cast<Eigen::Index>(output_width<Type>()), static_cast<Eigen::Index>(count)};
}

/// What a type of joint has at a state, by the key that its outputs() give it: one number or three.
/// @throws std::out_of_range if the joint has no such output
Eigen::VectorXd output(const Model& model, const State& state, int joint, std::string_view key);

/// What solve() returns.
struct Path {
  std::vector<State> states;      ///< Start, points of the path, events if located.
  std::vector<State> cycle_ends;  ///< Start and end of every cycle.
  std::vector<Event> events;
  std::vector<LocalProblem> problems;  ///< At Options::problem_times.
  std::vector<Note> notes;             ///< Each joint is named once for each kind.
  bool complete = true;                ///< False if Options::progress ended it.
  long solves = 0;                     ///< Newton solves.
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
/// completed by one line per contact force, the branch of the joint's law that is active: stick,
/// slip, stop and open are found, not given. What the laws are, the types in joints/ say. One step
/// is the implicit Euler step of this evolution, solved by Newton's method with block pivoting
/// between the branches (truss/newton.hpp); it has converged when every joint is on its branch,
/// forces balance to 1e-12 of the largest one, closures in metres to 1e-13 of the largest
/// displacement and forces at their bounds to rounding.
///
/// **Why the increment does not matter.** With every status fixed, the state is an algebraic
/// function of temperature: stick, stops and the cone |λ_t| = μ λ_n are holonomic, so a step is
/// exact however long. (Rolling is so for rigid contacts and radii that do not expand; else it is
/// an integral along the way, as is the bend of a contact with k_t: taken by the trapezoidal rule,
/// and what a step is off by is made up for in the next one. That leaves an error of fourth order
/// in the increment of a revolute, of third order of a ball that sticks, of second order of one
/// that slips and with partial slip.) Memory enters only where a slip ends in a stick and where an
/// open joint closes. Steps with such a change are shortened until it happens within
/// `event_tolerance` of a branch, or until what the joint may have slid by then, at the rate with
/// which it begins the step, is below that share of its clearance plus rounding; and so is the
/// first step after each corner of a program, where slips turn into sticks. With `locate_events`
/// this is done for every change of status. A step that does not converge is shortened as well.
///
/// **What turns within a step.** The rates of all unknowns, from the tangent of the last solve, are
/// known at both ends of a step; with the states they make a cubic. A joint that slips backwards
/// somewhere on it, or that leaves its branch on the way and is back at the end, turned round
/// within the step, which is then shortened to that place. The temperature's work is integrated
/// along the same cubic, with an error of fourth order in the increment where no status changes.
///
/// **Where a path ends.** A step as short as they get, within which something changes, is decided
/// by the rates of all joints at a bound together (truss/rate_problem.hpp). Where no slow
/// continuation is left, slip runs away; where more than one is, statics does not choose. After
/// every step the index of the equations is asked, and whether the rates at both ends explain the
/// step. Without `locate_events` an increment may step over a limit point.
///
/// **Start.** The drawn shape need not be in equilibrium: it is first relaxed at ΔT = 0 with
/// bilateral pins in place of clearance revolutes; their pin forces say where each journal touches;
/// then the clearances open with frictionless contacts, where friction begins without force; where
/// that leads nowhere, with contacts that hold by friction. A journal that no pin force pushes, or
/// whose contact force vanishes on the way, starts open: springs, loads and bars determine its
/// position, or it is slack.
///
/// Where the whole load leads nowhere near in one step, or to an unstable equilibrium, it is
/// followed from none in steps that stay near (truss/loading.cpp). A start that moves the truss by
/// more than a twentieth of its size is noted.
///
/// **Slack elements.** An element that hangs in the play of its joints carries nothing, and nothing
/// depends on where it is. It stays at the admissible position nearest to its last one, as with
/// vanishing dashpots in its pins (truss/system.hpp), until its clearance closes.
///
/// With StartFriction::stuck other joints hold by friction in the drawn shape as far as their
/// limits allow. With StartFriction::frictionless the start is found of the truss whose joints have
/// no friction; their slides are counted from there, so that friction begins without force.
///
/// Throws std::invalid_argument for a model or option out of range. Throws std::runtime_error that
/// names joint or nodes and the temperature: for a mechanism (with its free modes); for loads that
/// need more friction at the start than a joint has; for an equilibrium of the start or at a
/// corner of the programs that is unstable though every closed joint is held (buckled, with the
/// modes); for a revolute that jumps across its play; where slip runs away or the path parts; where
/// equilibrium is not found; and for a joint whose status changes without end.
Path solve(const Model& model, const Options& options = {});

}  // namespace statejump::truss
