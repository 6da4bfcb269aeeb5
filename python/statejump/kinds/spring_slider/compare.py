# SPDX-License-Identifier: GPL-3.0-or-later
"""Comparison of the DEM run of a ``spring_slider`` case with the reduced model."""
from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from math import pi, sqrt

import numpy as np

from statejump.core.comparison import Comparison, Quantity, models, share
from statejump.core.run import Run, change, energy_residue_J
from statejump.core.units import text
from statejump.core.why_missed import heated_too_fast, still_moving
from statejump.kinds.spring_slider import stable_step
from statejump.kinds.spring_slider.case import SpringSliderCase
from statejump.kinds.spring_slider.result import AT_END

# Fraction of the largest stored energy. If friction does less work, the block does not slip.
NO_SLIP = 1e-6
COMPARED_EVENTS = ("first_slip", "stop_reached", "stop_left")


def dem_event_temperatures(dem: Run, samples_per_cycle: int) -> dict[str, float | None]:
    """Return the temperature changes [K] of the events in the first cycle. Each is the mean of two samples."""
    first = slice(0, samples_per_cycle + 1)
    temperature = dem["temperature_change_K"][first]

    def between(index: int) -> float:
        return float(0.5 * (temperature[index - 1] + temperature[index])) if index > 0 else float(temperature[0])

    def starts(column: str) -> np.ndarray:
        flags = dem[column][first] > 0.5
        return np.flatnonzero(flags & ~np.concatenate((np.zeros(1, dtype=bool), flags[:-1])))

    slips = starts("slipping")
    reached = starts("stop_contact")
    reached = reached[reached > 0]  # an event is a change, so sample 0 does not count
    left = None
    if len(reached):  # a cycle may reach both stops; the first one counts
        push = dem["stop_force_N"][first]
        others = reached[0] + np.flatnonzero(push[reached[0]:] * push[reached[0]] < 0)
        end = others[0] if len(others) else len(push)
        left = int(np.flatnonzero(dem["stop_contact"][first][:end] > 0.5)[-1]) + 1
    return {
        "first_slip": between(slips[0]) if len(slips) else None,
        "stop_reached": between(reached[0]) if len(reached) else None,
        "stop_left": between(left) if left is not None and left < len(temperature) else None,
    }


def energy_residual(dem: Run) -> float:
    """Return supplied minus stored minus dissipated energy [J], over the whole DEM run."""
    return energy_residue_J(
        dem.energy, ("thermal_work_J", "external_work_J"),
        ("elastic_energy_J", "preload_energy_J", "contact_energy_J", "kinetic_energy_J"),
        ("friction_dissipation_J", "damping_dissipation_J"),
    )


def loop_drift(dem: Run, samples_per_cycle: int, cycles: int) -> float:
    """Return the largest distance [m] of a later loop from the second loop, at the same phase of the cycle."""
    x = dem["displacement_m"]
    loops = [x[k * samples_per_cycle : (k + 1) * samples_per_cycle + 1] for k in range(1, cycles)]
    return float(np.max(np.abs(np.stack(loops) - loops[0])))


def first_cycle_events(case: SpringSliderCase, run: Run) -> dict[str, float | None]:
    """Return ΔT [K] of the first event of each compared kind in the first cycle; None if it did not happen."""
    found = {kind: run.events.first(kind, case.period_s) for kind in COMPARED_EVENTS}
    return {kind: None if event is None else event.temperature_change_K for kind, event in found.items()}


def _jump_row(case: SpringSliderCase, first: Run, second: Run) -> Quantity:
    """Compare the state jumps, or the displacements at the end if the program does not return to ΔT = 0."""
    tolerance = case.tolerance
    # The allowed error of a jump that is zero uses the scale of jumps, f/(k + k_p).
    stiffness = stable_step.link_stiffness(case) + case.joint.preload_stiffness_N_per_m
    name = "state_jump_m" if case.has_jump else AT_END
    exact_m, other_m = (run.summary[name] for run in (first, second))
    scale = max(abs(exact_m), case.friction_force_N / stiffness)
    limit = max(tolerance.state_jump_relative * scale, tolerance.state_jump_absolute_m)
    return models(name.removesuffix("_m"), "m", exact_m, other_m, limit)


def _displacement_row(case: SpringSliderCase, exact: Run, other: Run) -> Quantity:
    x, y = exact["displacement_m"], other["displacement_m"]
    allowed = case.tolerance.displacement_rms_relative
    # If the block hardly moves, its displacement has the absolute tolerance of the jump.
    largest = max(float(np.max(np.abs(x))), case.tolerance.state_jump_absolute_m / allowed)
    rms = float(np.sqrt(np.mean((y - x) ** 2)))
    return models("displacement_rms_over_largest", "-", 0.0, share(rms, largest), allowed)


def compare(case: SpringSliderCase, reduced: Run, dem: Run) -> Comparison:
    """Compare a DEM run with the exact path of the same case."""
    tolerance = case.tolerance
    samples = case.dem_settings.samples_per_cycle
    exact = reduced.at(dem["time_s"])
    rows = [_jump_row(case, reduced, dem)]

    if case.friction_force_N > 0:
        exact_events = first_cycle_events(case, reduced)
        dem_events = dem_event_temperatures(dem, samples)
        rows += [
            models(f"{kind}_temperature_change", "K", exact_events[kind], dem_events[kind],
                   tolerance.event_temperature_K)
            for kind in COMPARED_EVENTS
        ]

    rows.append(_displacement_row(case, exact, dem))

    reference = change(dem.energy, "friction_dissipation_J")
    name = "energy_residual_over_friction_work"
    stored = float(np.max(dem["elastic_energy_J"] + dem["contact_energy_J"]))
    if not reference > NO_SLIP * stored:  # without friction the stored energy is the scale
        reference, name = stored, "energy_residual_over_largest_stored"
    rows.append(models(name, "-", 0.0, share(energy_residual(dem), reference),
                       tolerance.energy_balance_relative))
    if case.thermal.cycles > 2:
        largest = float(np.max(np.abs(exact["displacement_m"])))
        drift = loop_drift(dem, samples, case.thermal.cycles)
        rows.append(models("loop_drift_over_largest_displacement", "-", 0.0, share(drift, largest),
                           tolerance.drift_relative))
    found = Comparison(case, {"reduced": exact, "dem": dem}, tuple(rows), warnings=reduced.warnings)
    return found if found.passed else replace(found, reasons=tuple(why_missed(case, exact, dem, rows)))


def difference(case: SpringSliderCase, first: Run, second: Run) -> list[Quantity]:
    """Compare two runs of one model at the same times."""
    rows = [_jump_row(case, first, second)]
    if case.friction_force_N > 0:
        found = [first_cycle_events(case, run) for run in (first, second)]
        rows += [
            models(f"{kind}_temperature_change", "K", found[0][kind], found[1][kind],
                   case.tolerance.event_temperature_K)
            for kind in COMPARED_EVENTS
        ]
    return [*rows, _displacement_row(case, first, second)]


def outcomes(case: SpringSliderCase, run: Run) -> dict[str, float]:
    """Return jump, event temperatures, work of friction and largest axial force; NaN if an event did not happen."""
    exact = run.native is not None
    if exact:
        columns, force = run.native.sample(np.array([case.duration_s])), run.native.largest_axial_force_N
        events = first_cycle_events(case, run)
    else:
        columns, force = run, float(np.max(np.abs(run["axial_force_N"])))
        events = dem_event_temperatures(run, case.samples_per_cycle)
    found = {f"{kind}_temperature_change_K": events[kind] for kind in COMPARED_EVENTS}
    return {
        "state_jump_m": run.summary["state_jump_m"],
        **{name: float("nan") if value is None else float(value) for name, value in found.items()},
        "friction_dissipation_J": float(columns["friction_dissipation_J"][-1]) - (
            0.0 if exact else float(columns["friction_dissipation_J"][0])),
        "largest_axial_force_N": force,
    }


def natural_period_s(case: SpringSliderCase) -> float:
    """Return the natural period of the block on its bar [s]."""
    stiffness = stable_step.link_stiffness(case) + case.joint.preload_stiffness_N_per_m
    return 2 * pi * sqrt(stable_step.tip_mass(case) / stiffness)


def why_missed(case: SpringSliderCase, exact: Run, dem: Run, rows: Sequence[Quantity]) -> list[str]:
    """Return sentences."""
    period, moved = natural_period_s(case), float(np.ptp(exact["displacement_m"]))
    allowed = max(case.tolerance.displacement_rms_relative * moved, case.tolerance.state_jump_absolute_m)
    found = heated_too_fast(period, case.thermal, case.thermal_program(), moved, allowed)
    found += still_moving(dem, stable_step.tip_mass(case), period, allowed)
    if any(row.name.endswith("_temperature_change") and not row.passed for row in rows):
        found += _events(case, dem)
    return found


def _events(case: SpringSliderCase, dem: Run) -> list[str]:
    """Return reasons why event temperatures differ: the interval of samples, and the compliance of contacts."""
    found, allowed = [], case.tolerance.event_temperature_K
    between = float(np.abs(np.diff(dem["temperature_change_K"])).max())
    if between > allowed:
        found.append(f"two samples of the DEM are up to {text(between, 'K', 2)} apart, the tolerance of events is "
                     f"{text(allowed, 'K', 2)}: raise dem.samples_per_cycle")
    _, tangential = stable_step.contact_stiffness(case, case.joint.normal_force_N)
    give = case.friction_force_N / tangential
    along = abs(case.thermal_expansion_per_K) * case.link.stress_free_length_m
    if along and give / along > 0.5 * allowed:
        found.append(f"the reduced model sticks rigidly, the floor of the DEM gives by {text(give, 'm', 2)} before the "
                     f"block slides, {text(give / along, 'K', 2)} of expansion: raise joint.young_modulus_Pa or "
                     "joint.pad_radius_m")
    return found
