# SPDX-License-Identifier: GPL-3.0-or-later
"""Comparison of the DEM history with the reduced model, quantity by quantity."""
from __future__ import annotations

import csv
import json
import math
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, Optional

import numpy as np

from statejump import _engine
from statejump.kinds.spring_slider import reduced
from statejump.schema.fields import Case
from statejump.kinds.spring_slider.case import SpringSliderCase
from statejump.core.history import History
from statejump.core.output import write_atomically

COMPARED_EVENTS = ("first_slip", "stop_reached", "stop_left")


@dataclass(frozen=True)
class Quantity:
    """One compared number. ``difference`` is DEM minus reduced; None: the model has no such value."""

    name: str
    unit: str
    reduced: Optional[float]
    dem: Optional[float]
    difference: Optional[float]
    tolerance: float
    passed: bool


def quantity(name: str, unit: str, exact: Optional[float], dem: Optional[float], tolerance: float) -> Quantity:
    """Return one row; a value that one model lacks fails, one that both lack passes."""
    if exact is None or dem is None:
        return Quantity(name, unit, exact, dem, None, tolerance, passed=exact is None and dem is None)
    difference = dem - exact
    # Written so that NaN fails.
    return Quantity(name, unit, exact, dem, difference, tolerance, passed=bool(abs(difference) <= tolerance))


def dem_event_temperatures(dem: History, samples_per_cycle: int) -> dict[str, Optional[float]]:
    """Temperature changes [K] of the events of the first cycle, each half-way between two samples."""
    first = slice(0, samples_per_cycle + 1)
    change = dem["temperature_change_K"][first]

    def between(index: int) -> float:
        return float(0.5 * (change[index - 1] + change[index])) if index > 0 else float(change[0])

    def starts(column: str) -> np.ndarray:
        flags = dem[column][first] > 0.5
        return np.flatnonzero(flags & ~np.concatenate(([False], flags[:-1])))

    slips = starts("slipping")
    reached = starts("stop_contact")
    left = None
    if len(reached):  # a cycle may reach both stops: the one left is the one reached first
        push = dem["stop_force_N"][first]
        others = np.flatnonzero(push * push[reached[0]] < 0)
        end = others[0] if len(others) else len(push)
        left = np.flatnonzero(dem["stop_contact"][first][:end] > 0.5)[-1] + 1
    return {
        "first_slip": between(slips[0]) if len(slips) else None,
        "stop_reached": between(reached[0]) if len(reached) else None,
        "stop_left": between(left) if left is not None and left < len(change) else None,
    }


def energy_residual(dem: History) -> float:
    """Supplied minus stored minus dissipated energy over the whole DEM run [J]."""

    def change(name: str) -> float:
        return float(dem[name][-1] - dem[name][0]) if name in dem else 0.0

    supplied = change("thermal_work_J") + change("external_work_J")
    stored = sum(change(f"{name}_energy_J") for name in ("elastic", "preload", "contact", "kinetic"))
    dissipated = change("friction_dissipation_J") + change("damping_dissipation_J")
    return supplied - stored - dissipated


def loop_drift(dem: History, samples_per_cycle: int, cycles: int) -> float:
    """Largest distance of any later loop from the second one at the same phase [m]."""
    x = dem["displacement_m"]
    loops = [x[k * samples_per_cycle : (k + 1) * samples_per_cycle + 1] for k in range(1, cycles)]
    return float(max(np.max(np.abs(loop - loops[0])) for loop in loops))


def jump_row(case: SpringSliderCase, exact_m: float, other_m: float) -> Quantity:
    """Compare two state jumps [m]."""
    tolerance = case.tolerance
    limit = max(tolerance.state_jump_relative * abs(exact_m), tolerance.state_jump_absolute_m)
    return quantity("state_jump", "m", exact_m, other_m, limit)


def displacement_row(case: SpringSliderCase, exact: History, other: History) -> Quantity:
    """Compare two histories of displacement at the same times."""
    x, y = exact["displacement_m"], other["displacement_m"]
    largest = float(np.max(np.abs(x)))
    rms = float(np.sqrt(np.mean((y - x) ** 2)))
    return quantity("displacement_rms_over_largest", "-", 0.0, rms / largest if largest > 0 else math.nan,
                    case.tolerance.displacement_rms_relative)


def compare(case: SpringSliderCase, path: _engine.SpringSliderPath, dem: History) -> list[Quantity]:
    """Compare a DEM history with the exact path of the same case."""
    tolerance = case.tolerance
    samples = case.dem.samples_per_cycle
    exact = reduced.sample(path, dem["time_s"])
    rows = [jump_row(case, path.state_jump_m, float(dem["displacement_m"][-1] - dem["displacement_m"][0]))]

    if case.friction_force_N > 0:
        exact_events: dict[str, float] = {}
        for event in path.events:
            if event.time_s <= case.dem.period_s:
                exact_events.setdefault(event.kind, event.temperature_change_K)
        dem_events = dem_event_temperatures(dem, samples)
        rows += [
            quantity(f"{kind}_temperature_change", "K", exact_events.get(kind), dem_events[kind],
                      tolerance.event_temperature_K)
            for kind in COMPARED_EVENTS
        ]

    rows.append(displacement_row(case, exact, dem))

    reference = float(dem["friction_dissipation_J"][-1] - dem["friction_dissipation_J"][0])
    name = "energy_residual_over_friction_work"
    if not reference > 0:  # without friction the stored energy is the scale
        reference = float(np.max(dem["elastic_energy_J"] + dem["contact_energy_J"]))
        name = "energy_residual_over_largest_stored"
    rows.append(quantity(name, "-", 0.0, energy_residual(dem) / reference if reference > 0 else math.nan,
                          tolerance.energy_balance_relative))
    if case.thermal.cycles > 2:
        largest = float(np.max(np.abs(exact["displacement_m"])))
        drift = loop_drift(dem, samples, case.thermal.cycles)
        rows.append(quantity("loop_drift_over_largest_displacement", "-", 0.0, drift / largest,
                              tolerance.drift_relative))
    return rows


def _entries(rows: list[Quantity]) -> list[dict[str, Any]]:
    entries = []
    for row in rows:
        entry = asdict(row)
        entry["pass"] = entry.pop("passed")
        entries.append({k: None if isinstance(v, float) and math.isnan(v) else v for k, v in entry.items()})
    return entries


def write_comparison_csv(rows: list[Quantity], path: Path) -> None:
    """Write the rows of a comparison as CSV; there must be one."""
    entries = _entries(rows)
    with write_atomically(path) as stream:
        writer = csv.DictWriter(stream, fieldnames=list(entries[0]))
        writer.writeheader()
        writer.writerows(entries)


def write_comparison(case: Case, rows: list[Quantity], folder: Path) -> None:
    """Write ``comparison.json`` and ``comparison.csv``."""
    document = {"case": case.name, "pass": all(row.passed for row in rows), "quantities": _entries(rows)}
    with write_atomically(folder / "comparison.json") as stream:
        stream.write(json.dumps(document, indent=2) + "\n")
    write_comparison_csv(rows, folder / "comparison.csv")
