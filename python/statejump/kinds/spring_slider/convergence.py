# SPDX-License-Identifier: GPL-3.0-or-later
"""How the DEM approaches the reduced model: slower cycles, shorter time steps."""
from __future__ import annotations

import csv
import math
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from statejump.core import comparison as compare, yade_process as dem
from statejump.kinds.spring_slider import reduced, stable_step
from statejump.kinds.spring_slider.case import SpringSliderCase
from statejump.core.history import History
from statejump.core.output import write_atomically

PERIOD_FACTORS = (1 / 256, 1 / 64, 1 / 16, 1 / 4, 1, 4)
# Time steps are compared on a fast cycle, where the motion is not quasi-static and they matter; few
# samples, because the number of steps is a multiple of theirs.
STEP_PERIOD_FACTOR = 1 / 16
STEP_SAMPLES = 50
STEP_FRACTIONS = (0.8, 0.4, 0.2, 0.1, 0.05, 0.025)

EXPLANATION = """\
First the duration of the cycle, then the time step (on a fast cycle, where it matters most).

The error of the jump, the energy residue and the lag of the events fall as the cycle becomes slower:
inertia and damping forces fall with it. The last column is the RMS distance of the displacement
history from that of the finest time step: it falls in proportion to the step (slip and impact begin
at a step, dashpots see the velocity of half a step before). Against the physics it is nothing: even
at 0.8 of the stable step it is 1e-5 of the largest displacement.

What stays is elasticity and geometry that the reduced model does not have:

- the tangential stiffness k_t of the floor contact delays the first slip by f/k_t of thermal
  displacement, and events are known to half a sample;
- the Hertz stiffness of the stop lets the slider sink in: nearly the whole remaining RMS difference;
- the slider sinks into the floor by delta, so the bar is inclined by delta/l0. That takes f delta/l0
  off the normal force and delta^2/(2 l0) off the projected length, together -3.3e-6 of the jump of
  the Table 1 case (delta = 4.2 um), which is where its error settles.
"""


@dataclass(frozen=True)
class Row:
    """One DEM run against the exact path."""

    period_s: float
    time_step_s: float
    time_step_over_stable: float
    state_jump_m: float
    state_jump_error_relative: float
    first_slip_error_K: float
    stop_reached_error_K: float
    stop_left_error_K: float
    displacement_rms_over_largest: float
    energy_residual_over_friction_work: float
    displacement_rms_from_finest_step_m: float = math.nan


def _with_dem(case: SpringSliderCase, **changes: Any) -> SpringSliderCase:
    return case.copy(update={"dem": case.dem.copy(update=changes)})


def variants(case: SpringSliderCase) -> list[SpringSliderCase]:
    """Cases to run: each period at the case's own step, then each step on a fast cycle."""
    period = case.dem.period_s
    periods = [_with_dem(case, period_s=period * factor, time_step_s=None) for factor in PERIOD_FACTORS]
    fast = _with_dem(
        case, period_s=period * STEP_PERIOD_FACTOR, time_step_s=None, samples_per_cycle=STEP_SAMPLES
    )
    steps = [_with_dem(fast, time_step_fraction=fraction) for fraction in STEP_FRACTIONS]
    return periods + steps


def rows(cases: list[SpringSliderCase], histories: list[History]) -> list[Row]:
    """Errors of all runs of :func:`variants`, in its order; the last has the finest time step."""
    result = [_row(case, history) for case, history in zip(cases, histories)]
    first_step_run = len(PERIOD_FACTORS)
    finest = histories[-1]["displacement_m"]
    for i in range(first_step_run, len(cases)):
        # Events are known to half a sample, and these runs have few samples.
        result[i] = replace(
            result[i],
            first_slip_error_K=math.nan,
            stop_reached_error_K=math.nan,
            stop_left_error_K=math.nan,
        )
    for i in range(first_step_run, len(cases) - 1):
        distance = histories[i]["displacement_m"] - finest
        rms = float(np.sqrt(np.mean(distance**2)))
        result[i] = replace(result[i], displacement_rms_from_finest_step_m=rms)
    return result


def _row(case: SpringSliderCase, history: History) -> Row:
    """Errors of one run."""
    compared = {entry.name: entry for entry in compare.compare(case, reduced.solve(case), history)}

    def difference(name: str) -> float:
        entry = compared.get(name)
        return math.nan if entry is None or entry.difference is None else entry.difference

    jump = compared["state_jump"]
    step = dem.time_step(case)
    return Row(
        period_s=case.dem.period_s,
        time_step_s=step,
        time_step_over_stable=step / stable_step.stable_time_step(case),
        state_jump_m=jump.dem or 0.0,
        state_jump_error_relative=jump.difference / jump.reduced if jump.reduced else math.nan,
        first_slip_error_K=difference("first_slip_temperature_change"),
        stop_reached_error_K=difference("stop_reached_temperature_change"),
        stop_left_error_K=difference("stop_left_temperature_change"),
        displacement_rms_over_largest=difference("displacement_rms_over_largest"),
        energy_residual_over_friction_work=difference("energy_residual_over_friction_work"),
    )


def write(case: SpringSliderCase, rows: list[Row], folder: Path) -> None:
    """Write ``convergence.csv`` and ``convergence.md``."""
    entries = [asdict(entry) for entry in rows]
    names = list(entries[0])
    with write_atomically(folder / "convergence.csv") as stream:
        writer = csv.DictWriter(stream, fieldnames=names)
        writer.writeheader()
        writer.writerows(entries)
    lines = [
        f"# DEM against reduced model: {case.case.title or case.name}",
        "",
        f"Made by `statejump convergence cases/{case.name}.toml`.",
        "",
        "| " + " | ".join(names) + " |",
        "|" + "---|" * len(names),
        *("| " + " | ".join("" if math.isnan(entry[name]) else f"{entry[name]:.4g}" for name in names) + " |" for entry in entries),
        "",
        EXPLANATION,
    ]
    with write_atomically(folder / "convergence.md") as stream:
        stream.write("\n".join(lines))
