# SPDX-License-Identifier: GPL-3.0-or-later
"""What the YADE script needs of a ``spring_slider`` case."""
from __future__ import annotations

import math
from typing import Any

from statejump.core.yade_process import common_values
from statejump.kinds.spring_slider import stable_step
from statejump.kinds.spring_slider.case import SpringSliderCase


def number_of_steps(case: SpringSliderCase) -> int:
    """Return the steps of the whole run: a multiple of the samples, so that the last sample is the end."""
    wanted = case.dem.time_step_s
    if wanted is None:
        wanted = case.dem.time_step_fraction * stable_step.stable_time_step(case)
    samples = case.dem.samples_per_cycle
    return math.ceil(case.period_s / wanted / samples) * samples * case.thermal.cycles


def time_step(case: SpringSliderCase) -> float:
    """Return the time step [s]: the wanted one or a little less, so that steps fill the program exactly."""
    return case.duration_s / number_of_steps(case)


def dem_input(case: SpringSliderCase) -> dict[str, Any]:
    """Return everything that the YADE script needs, as plain values."""
    values = common_values(case, number_of_steps(case))
    values["dem"].update(tip_mass_kg=stable_step.tip_mass(case))
    return values
