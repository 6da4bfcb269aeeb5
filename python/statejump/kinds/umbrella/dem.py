# SPDX-License-Identifier: GPL-3.0-or-later
"""DEM runs of an ``umbrella`` case in YADE: input of the script, several runs at a time, ensembles."""
from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import numpy as np

from statejump.core import yade_process
from statejump.core.run import Columns, Run
from statejump.core.yade_process import Samples, common_values
from statejump.kinds import of
from statejump.kinds.umbrella import reduced, result
from statejump.kinds.umbrella.case import UmbrellaCase


def number_of_steps(case: UmbrellaCase) -> int:
    """Return the steps of the whole run."""
    return case.dem_settings.steps_per_cycle * case.thermal.cycles


def dem_input(case: UmbrellaCase, offset_m: np.ndarray | None = None) -> dict[str, Any]:
    """Return the input of the YADE script, with the start as positions and velocities of the tips.

    :param offset_m: added to the journal's position in the clearance (2) [m]
    """
    values = common_values(case, number_of_steps(case))
    state = reduced.start_state(case, offset_m)
    for tip in ("bearing", "journal"):
        values["start"][f"{tip}_m"] = getattr(state, f"{tip}_centre_m").tolist()
        values["start"][f"{tip}_velocity_m_per_s"] = getattr(state, f"{tip}_velocity_m_per_s").tolist()
    values["torsion_spring"]["free_angle_rad"] = case.free_flare_angle_rad
    return values


def execute(case: UmbrellaCase, offset_m: np.ndarray | None = None) -> Samples:
    """Run the case in YADE, from another start; see :func:`dem_input`."""
    values = {"scene": of(case).scene_module(), **dem_input(case, offset_m)}
    return yade_process.execute(values, lambda share: None)


def execute_all(cases: Sequence[UmbrellaCase], progress: Callable[[], None] = lambda: None) -> list[Run]:
    """Run several cases, as many at a time as there are cores; results in the given order."""

    def one(case: UmbrellaCase) -> Run:
        done = execute(case)
        progress()
        return result.dem_run(case, done.columns, done.about)

    with ThreadPoolExecutor(os.cpu_count()) as pool:
        return list(pool.map(one, cases))


def ensemble(
    case: UmbrellaCase, runs: int | None = None, progress: Callable[[], None] = lambda: None
) -> reduced.EnsembleOfRuns:
    """Run the case from ``runs`` starts (default: the number in the case), as many at a time as there are cores."""
    offsets = list(reduced.start_offsets(case, runs or case.ensemble.dem_runs))
    case = reduced.for_ensemble(case)

    def one(offset: np.ndarray) -> Columns:
        done = execute(case, offset)
        progress()
        return done.columns

    with ThreadPoolExecutor(os.cpu_count()) as pool:
        return reduced.gather(list(pool.map(one, offsets)))
