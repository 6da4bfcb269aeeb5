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
  /// How the truss reaches its first equilibrium.
  StartFriction start_friction = StartFriction::stuck;
  /// Increments per monotone branch of the programs, >= 1.
  int increments_per_branch = 50;
  /// Whether every change of a joint's status is located in time. If false, a change is located
  /// only if its time affects the state; see solve(). Locating a change takes about ten solves.
  bool locate_events = true;
  /// Interval [1/branch] within which changes are located.
  double event_tolerance = 1e-9;
  /// Allowed error of the energy balance if events are located, as a fraction of the largest
  /// possible thermal work (at the largest rate all the time). An increment with a larger error is
  /// divided into at most 64 steps. Laws with gradual slip consist of chords; their increments are
  /// not divided.
  double energy_tolerance = 2.5e-11;
  /// Store only the states at the ends of the cycles.
  bool cycle_ends_only = false;
  /// Times, in ascending order, at which the frictional contact problem is stored [s]. It is that
  /// of the first step that ends then or later.
  std::vector<double> problem_times;
  /// Largest number of Newton iterations after the last change of a status. The limit also ends an
  /// iteration whose statuses cycle.
  int most_iterations = 40;
  /// Largest number of steps in an increment without a change of status, >= 1. One step per
  /// increment is usually enough; locating a change takes about ten. If the limit is reached, the
  /// path does not progress.
  int most_steps = 10000;
  /// Called with the finished fraction of the program (0 to 1). If the callback returns false, the
  /// path ends at once and Path::complete is false.
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
  Eigen::Matrix3Xd displacement;    ///< Of each node [m].
  Eigen::Matrix3Xd rotation;        ///< Rotation vector of each node [rad]; empty without beams.
  Eigen::VectorXd element_output;   ///< Outputs of all elements; see element_output().
  Eigen::VectorXd joint_output;     ///< Outputs of all joints; see output().
  std::vector<JointStatus> joint_status;
  Eigen::VectorXd joint_dissipation;  ///< Heat of friction of each joint since the start [J].
  double elastic_energy = 0.0;        ///< Links, springs and contacts [J].
  double thermal_work = 0.0;          ///< Work of the temperature since the start [J].
  double load_potential = 0.0;        ///< −Σ load · displacement [J].
};

/// Warnings about a result that is not a failure.
enum class NoteKind : unsigned char {
  large_start,  ///< The first equilibrium is far from the reference configuration: `value` [m].
  slack,  ///< Joints without contact: statics does not determine the position of their elements.
  not_unique,   ///< Sticking joints constrain a displacement more than once: reactions are not
                ///< unique.
  snap,         ///< Unstable slip within the play of joints moved the truss by `value` [m] at once.
  not_located,  ///< So many joints are open that the times of their changes are not located. With
                ///< joints: these changed within a step, because locating their changes failed.
  free_spin     ///< Beams are free to spin about their own axis; see SpinSpring.
};

/// "large_start", …: the enumerator's name.
const char* to_string(NoteKind kind);

struct Note {
  NoteKind kind;
  double time;                       ///< [s]
  double temperature_change;         ///< ΔT of the first program [K].
  std::vector<FailureJoint> joints;  ///< Joints, or beams, to which the note applies.
  double value = 0.0;                ///< See NoteKind.
};

/// Outputs of all elements of one type at a state: one row per output in outputs(), one column per
/// element.
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

/// Value of a joint's output at a state: one number or three. `key` is its name in outputs().
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
  double largest_closure_residual = 0.0;  ///< Of sticking joints, stops and contacts [m].
  int unknowns = 0;
};

/// Quasi-static path of a truss through its temperature programs, with exact Coulomb friction.
///
/// **Equations.** The unknowns are the displacements of the nodes and the forces of every joint: λ
/// of a slider, normal force λ_n and friction λ_t of a revolute. Lengths and angles are exact (no
/// small rotations). Every part expands by its total ΔT. The equations are the equilibrium of the
/// nodes, and for each joint force one row that depends on the joint's status. The solver
/// determines these statuses: stick, slip, stop and open. The types in joints/ document the laws.
/// One step is an implicit Euler step of this evolution. Newton's method with block pivoting
/// between the statuses solves it (truss/newton.hpp). It has converged if every joint satisfies the
/// inequalities of its status, and if residuals are within these bounds: forces balance to 1e-12 of
/// the largest force, closures in metres to 1e-13 of System::reach() (the largest displacement,
/// within bounds), and forces at their limits to rounding. If rounding exceeds these bounds, it has
/// converged when its steps vanish and forces balance to 1e-9.
///
/// **Why the result does not depend on the increment.** With fixed statuses the state is an
/// algebraic function of temperature: stick, stops and the cone |λ_t| = μ λ_n are holonomic. A step
/// of any length is therefore exact. Rolling is exact for rigid contacts and radii that do not
/// expand. Otherwise rolling is an integral along the path, and so is the deflection of a contact
/// with tangential stiffness k_t. The trapezoidal rule computes these integrals, and each step
/// corrects the error of the previous step. The remaining error is of fourth order in the increment
/// for a revolute, of third order for a ball that sticks, and of second order for a ball that slips
/// and for partial slip.
///
/// The path depends on the time of a change of status only where a slip ends in a stick, and where
/// an open joint closes. Steps with such a change are shortened until one of these conditions
/// holds:
///
/// - the step is at most `event_tolerance` times the length of a branch of the programs,
/// - the slide up to the change, extrapolated with the rate at the start of the step, is below
///   `event_tolerance` times the joint's clearance, plus rounding.
///
/// The first step after each corner of a program is short too, because there slipping joints start
/// to stick. With `locate_events` every change of status is located. Steps that do not converge are
/// also shortened.
///
/// **Reversals within a step.** The tangent of the last solve gives the rates of all unknowns at
/// both ends of a step. States and rates define a cubic interpolation. A joint reverses within the
/// step if on the cubic it slips backwards for a while, or leaves its status and returns. The step
/// then ends at the reversal. The work of the temperature is integrated along the same cubic. Its
/// error is of fourth order in the increment while no status changes.
///
/// **Where a path ends.** If a status changes within the shortest step, the rates of all joints at
/// a limit are decided together (truss/rate_problem.hpp). If no slow continuation exists, slip is
/// unstable. If several continuations exist, statics does not determine the motion. After every
/// step the solver evaluates the index of the equations and checks whether the rates at both ends
/// explain the displacements. Without `locate_events` an increment may step over a limit point.
///
/// **Start.** The reference configuration need not be in equilibrium. It is first relaxed at ΔT = 0
/// with bilateral pins in place of clearance joints. The pin forces determine where each journal
/// touches. Then the clearances are opened with frictionless contacts, so that friction starts at
/// zero. If this fails, they are opened with contacts that hold by friction. A journal without pin
/// force, or whose contact force vanishes meanwhile, starts open. Springs, loads and bars then
/// determine its position, or its elements are slack.
///
/// If the solve under the full load fails, moves the truss far, or ends unstable, the load is
/// increased from zero in small steps (truss/loading.cpp). If the start moves the truss by more
/// than a twentieth of its size, a note reports this.
///
/// **Slack elements.** An element that can move freely within the play of its joints has no force,
/// and statics does not determine its position. In each step it moves to the admissible position
/// nearest to its previous one, as if vanishing dashpots acted in its pins (truss/system.hpp),
/// until its clearance closes.
///
/// **Friction at the start.** With StartFriction::stuck, joints without clearance stick in the
/// reference configuration within their friction limits. With StartFriction::frictionless, the path
/// starts from the equilibrium without friction. Slides are counted from there, so friction starts
/// at zero.
///
/// Throws std::invalid_argument for a model or option out of range. Throws std::runtime_error whose
/// message names the joint or the nodes and the temperature. Reasons:
///
/// - a mechanism, with its free modes,
/// - loads that at the start need more friction than a joint can supply,
/// - an equilibrium at the start or at a corner of the programs that is unstable although every
///   closed joint is held (buckled), with the modes,
/// - a revolute that jumps across its play,
/// - unstable slip, or several continuations,
/// - no equilibrium found,
/// - a joint whose status changes without end.
Path solve(const Model& model, const Options& options = {});

}  // namespace statejump::truss
