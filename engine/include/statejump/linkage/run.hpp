// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <vector>

#include "statejump/linkage/model.hpp"

namespace statejump::linkage {

/// How a run is stepped and recorded.
struct RunOptions {
  int steps = 100000;    ///< Steps over the whole program; the paper's number. See simulate()
  int sample_every = 0;  ///< Steps between samples, >= 0; 0: only the start and the end
};

/// Work and heat since the start [J]: thermal_work = change of Energy + dissipation().
struct Account {
  double thermal_work = 0.0;
  double axial_dissipation = 0.0;
  double pin_dissipation = 0.0;
  double friction_dissipation = 0.0;
  double impact_dissipation = 0.0;  ///< of the dissipation law of the contact
  double dissipation() const {
    return axial_dissipation + pin_dissipation + friction_dissipation + impact_dissipation;
  }
};

struct Sample {
  double time;                ///< [s]
  double temperature_change;  ///< ΔT [K]
  State state;
  Account account;
};

/// Instant at which the clearance is first used up, on the RK4 solution within its step.
struct FirstContact {
  double time;                ///< [s]
  double temperature_change;  ///< ΔT [K]
};

struct Run {
  std::vector<Sample> samples;  ///< The first is the start, the last the end
  std::optional<FirstContact> first_contact;
  int contacts = 0;  ///< Number of steps that end in contact after one that did not
  long steps = 0;    ///< Steps taken
  /// thermal work − change of energy − dissipation at the end [J]; see simulate().
  double energy_residue = 0.0;
};

/// Integrates a Linkage over a thermal program by the classical Runge-Kutta method with fixed
/// steps, corners of the program always on a step.
///
/// Thermal work and dissipation are further components of the same ODE. The thermal power is
/// ∂V/∂l_T l̇_T = −(N + N²/(2 E A)) l̇_T with N = k_T (L − l_T), less the dashpot's c (L̇ − l̇_T) l̇_T,
/// and F_N times the rate of −c_T plus ∂V/∂R Ṙ where radii expand.
///
/// Order: 4 while the force is smooth, 5 for the energy of the ringing links. Hertz's δ^1.5 has no
/// second derivative at δ = 0, so a step over the edge of contact leaves an error of order h^2.5.
/// A friction law that remembers: the slide ∫ v_t dt is a component of the ODE; a stage applies the
/// law to a copy of the history at the step's start with the slide so far, the accepted step
/// updates the history once. That is of order 4 in stick at constant normal load, of order 1 while
/// the load changes, since the step's slide is taken at the stiffness of its end. The friction heat
/// is that of kernel::mindlin_step(), whose work is the trapezium's: a further O(h²) in the
/// account. A contact's dissipation is scaled by the approach speed at the start of the step in
/// which it begins, an error of order h in its damping. Throws std::invalid_argument for a model,
/// program or option out of range, std::domain_error with time, temperature and value if a law
/// leaves its range or the state ceases to be finite.
Run simulate(const Linkage& model, const thermal::Program& program, const State& start,
             const RunOptions& options = {});

/// How an adaptive run is stepped and recorded.
struct AdaptiveRunOptions {
  double relative_tolerance = 1e-10;  ///< Of lengths and speeds in a step, in [1e-14, 1e-3]
  int samples =
      0;  ///< Evenly spaced samples over the whole program besides the start, >= 0; 0: end
};

/// The same ODE by the fifth-order method of Dormand and Prince with dense output (Boost.odeint),
/// for laws without memory: friction `none` or `ambrosio`, any dissipation.
///
/// The error of a step is held below relative_tolerance times (the play for positions, the play
/// times the links' angular frequency for speeds, E A times the play for energies). Contacts are
/// located on the dense output, of fourth order; no step is longer than half a radian of the
/// stiffer link, so that none passes over a contact. Corners of the program end a step.
/// Throws as simulate(), and std::invalid_argument for a friction law with memory: its limit is a
/// corner in the force that the error control would chase.
Run simulate_adaptive(const Linkage& model, const thermal::Program& program, const State& start,
                      const AdaptiveRunOptions& options = {});

}  // namespace statejump::linkage
