// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <vector>

#include "statejump/linkage/model.hpp"

namespace statejump::linkage {

/// Steps and samples of a run.
struct RunOptions {
  int steps = 100000;    ///< Steps over the whole program; default from the paper. See simulate()
  int sample_every = 0;  ///< Steps between samples, >= 0; 0: only the start and the end
};

/// Work and heat since the start [J]. thermal_work equals the change of Energy plus dissipation().
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

/// First contact, located on the RK4 solution within its step.
struct FirstContact {
  double time;                ///< [s]
  double temperature_change;  ///< ΔT [K]
};

struct Run {
  std::vector<Sample> samples;  ///< The first is the start, the last the end
  std::optional<FirstContact> first_contact;
  int contacts = 0;  ///< Number of steps that end in contact after one that did not
  long steps = 0;    ///< Steps taken
  /// Error of the energy balance at the end [J]: thermal work − change of energy − dissipation; see
  /// simulate().
  double energy_residue = 0.0;
};

/// Integrates a Linkage over a thermal program by the classical Runge-Kutta method with fixed
/// steps. A step ends at every corner of the program.
///
/// Thermal work and dissipation are integrated as further components of the ODE. The thermal power
/// is ∂V/∂l_T l̇_T = −(N + N²/(2 E A)) l̇_T with N = k_T (L − l_T), minus the dashpot term c (L̇ −
/// l̇_T) l̇_T. If radii expand, F_N times the rate of −c_T and ∂V/∂R Ṙ are added.
///
/// The order of accuracy is 4 while the force is smooth, and 5 for the energy of the vibrating
/// links. Hertz's δ^1.5 has no second derivative at δ = 0, so a step in which contact begins or
/// ends has an error of order h^2.5.
///
/// For a friction law with memory, the slide ∫ v_t dt is a component of the ODE. Each stage applies
/// the law to a copy of the history at the start of the step. The accepted step updates the history
/// once. The order is 4 in stick at constant normal load. It is 1 while the normal load changes,
/// because the slide of a step uses the stiffness at its end. The friction heat is that of
/// kernel::mindlin_step(), which integrates work by the trapezoidal rule. This adds an error O(h²)
/// to the energy balance.
///
/// A contact's dissipation is scaled by the approach speed at the start of the step in which
/// contact begins. This causes an error of order h in its damping. Throws std::invalid_argument for
/// a model, program or option out of range. Throws std::domain_error with time, temperature and
/// value if a law leaves its range or the state ceases to be finite.
Run simulate(const Linkage& model, const thermal::Program& program, const State& start,
             const RunOptions& options = {});

/// Steps and samples of an adaptive run.
struct AdaptiveRunOptions {
  double relative_tolerance = 1e-10;  ///< Of lengths and speeds in a step, in [1e-14, 1e-3]
  int samples =
      0;  ///< Evenly spaced samples over the whole program besides the start, >= 0; 0: end
};

/// Integrates the ODE of simulate() by the fifth-order method of Dormand and Prince with dense
/// output (Boost.odeint). Only laws without memory are supported: friction `none` or `ambrosio`,
/// any dissipation.
///
/// The error of a step is kept below relative_tolerance times a scale: the play for positions, the
/// play times the links' angular frequency for speeds, E A times the play for energies. Starts of
/// contact are located on the dense output, of fourth order. No step is longer than half a radian
/// of the stiffer link, so that no contact is missed. Corners of the program end a step. Throws as
/// simulate(), and std::invalid_argument for a friction law with memory, because at its limit the
/// force has a corner, at which the error control fails.
Run simulate_adaptive(const Linkage& model, const thermal::Program& program, const State& start,
                      const AdaptiveRunOptions& options = {});

}  // namespace statejump::linkage
