# SPDX-License-Identifier: GPL-3.0-or-later
"""DEM runs of an ``umbrella`` case in YADE: input of the script, and single runs with an offset."""
from __future__ import annotations

from typing import Any

import numpy as np

from statejump.core import yade_process
from statejump.core.yade_process import Samples, common_values
from statejump.kinds import of
from statejump.kinds.umbrella import reduced
from statejump.kinds.umbrella.case import UmbrellaCase


def number_of_steps(case: UmbrellaCase) -> int:
    """Return the steps of the whole run."""
    return case.dem_settings.steps_per_cycle * case.thermal.cycles


def dem_input(case: UmbrellaCase, offset_m: np.ndarray | None = None) -> dict[str, Any]:
    """Return the input of the YADE script. It gives the initial state as positions and velocities of the link tips.

    :param offset_m: offset (2) [m] to add to the initial position of the journal
    """
    values = common_values(case, number_of_steps(case))
    state = reduced.start_state(case, offset_m)
    for tip in ("bearing", "journal"):
        values["start"][f"{tip}_m"] = getattr(state, f"{tip}_centre_m").tolist()
        values["start"][f"{tip}_velocity_m_per_s"] = getattr(state, f"{tip}_velocity_m_per_s").tolist()
    values["torsion_spring"]["free_angle_rad"] = case.free_flare_angle_rad
    return values


def execute(case: UmbrellaCase, offset_m: np.ndarray | None = None) -> Samples:
    """Run the case in YADE with an offset of the initial position of the journal; see :func:`dem_input`."""
    values = {"scene": of(case).scene_module(), **dem_input(case, offset_m)}
    return yade_process.execute(values, lambda share: None)
