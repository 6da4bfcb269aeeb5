# SPDX-License-Identifier: GPL-3.0-or-later
"""How the DEM approaches the reduced model: slower cycles, shorter time steps."""
from __future__ import annotations

import csv
import math
import shutil
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from . import compare, dem, reduced, stable_step
from .case import Case
from .history import History
from .output import write_atomically

PERIOD_FACTORS = (1 / 64, 1 / 16, 1 / 4, 1, 4)
STEP_FACTORS = (4, 2, 1, 1 / 2)

EXPLANATION = """\
The time step is given as a fraction of the stable one. The jump and the displacement outside of the
stop converge to the reduced model as the cycle becomes slower (inertia and damping, forces that fall
with the duration). What stays is elasticity that the reduced model does not have: the tangential
stiffness k_t of the floor contact delays the first slip by f/k_t of thermal displacement, and the
Hertz stiffness of the stop lets the slider sink in, which is the whole remaining RMS difference. The
time step hardly matters: leapfrog is of second order and the quasi-static path is slow against it;
its error shows in the energy account.
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


def _with_dem(case: Case, **changes: Any) -> Case:
    return case.copy(update={"dem": case.dem.copy(update=changes)})


def variants(case: Case) -> list[Case]:
    """Cases to run: each period at the case's own step, then each step at the case's period."""
    period, fraction = case.dem.period_s, case.dem.time_step_fraction
    periods = [_with_dem(case, period_s=period * factor, time_step_s=None) for factor in PERIOD_FACTORS]
    steps = [
        _with_dem(case, time_step_s=None, time_step_fraction=fraction * factor)
        for factor in STEP_FACTORS
        if fraction * factor < 1 and factor != 1
    ]
    return periods + steps


def row(case: Case, history: History) -> Row:
    """Errors of one run."""
    rows = {entry.name: entry for entry in compare.compare(case, reduced.solve(case), history)}

    def difference(name: str) -> float:
        entry = rows.get(name)
        return math.nan if entry is None or entry.difference is None else entry.difference

    jump = rows["state_jump"]
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


def write(case: Case, rows: list[Row], folder: Path) -> None:
    """Write ``convergence.csv`` and ``convergence.md`` and remove the scratch folder."""
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
        *("| " + " | ".join(f"{entry[name]:.4g}" for name in names) + " |" for entry in entries),
        "",
        EXPLANATION,
    ]
    with write_atomically(folder / "convergence.md") as stream:
        stream.write("\n".join(lines))
    shutil.rmtree(folder / ".convergence.partial", ignore_errors=True)
