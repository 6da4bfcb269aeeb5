# SPDX-License-Identifier: GPL-3.0-or-later
"""DEM runs of an ``umbrella`` case in YADE: single runs and ensembles."""
from __future__ import annotations

import os
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any, Callable

import numpy as np

from statejump.core import yade_process as dem
from statejump.kinds.umbrella.case import UmbrellaCase
from statejump.kinds.umbrella import reduced as model


def number_of_steps(case: UmbrellaCase) -> int:
    """Steps of the whole run."""
    return case.dem.steps_per_cycle * case.thermal.cycles


def resolved(case: UmbrellaCase, offset_m: np.ndarray | None = None) -> dict[str, Any]:
    """Everything that the YADE script needs; the start as positions and velocities of the tips."""
    values = dem.common_values(case, number_of_steps(case))
    state = model.start_state(case, offset_m)
    for tip in ("bearing", "journal"):
        values["start"][f"{tip}_m"] = getattr(state, f"{tip}_centre_m").tolist()
        values["start"][f"{tip}_velocity_m_per_s"] = getattr(state, f"{tip}_velocity_m_per_s").tolist()
    values["torsion_spring"]["free_angle_rad"] = case.free_flare_angle_rad
    return values


def run(
    case: UmbrellaCase, folder: Path, progress: Callable[[float], None], keep: dem.Keep | None = None
) -> dem.DemRun:
    """Run the case; see :func:`statejump.core.yade_process.run_resolved`."""
    return dem.run_resolved(resolved(case), folder, progress, keep)


def execute(case: UmbrellaCase, offset_m: np.ndarray | None = None) -> dem.DemRun:
    """Run the case without writing anything."""
    return dem.execute(resolved(case, offset_m), lambda fraction: None)


def execute_all(
    cases: list[UmbrellaCase], progress: Callable[[], None] = lambda: None
) -> list[dem.DemRun]:
    """Run several cases, as many at a time as there are cores; results in the order given."""

    def one(case: UmbrellaCase) -> dem.DemRun:
        done = execute(case)
        progress()
        return done

    with ThreadPoolExecutor(os.cpu_count()) as pool:
        return list(pool.map(one, cases))


def ensemble(
    case: UmbrellaCase, runs: int | None = None, progress: Callable[[], None] = lambda: None
) -> model.EnsembleOfRuns:
    """Run the case from ``runs`` starts (default: as the case says), as many as cores at a time."""
    offsets = list(model.start_offsets(case, runs or case.ensemble.dem_runs))
    case = model.for_ensemble(case)

    def one(offset: np.ndarray) -> Any:
        done = execute(case, offset)
        progress()
        return done.history

    with ThreadPoolExecutor(os.cpu_count()) as pool:
        return model.gather(list(pool.map(one, offsets)))
