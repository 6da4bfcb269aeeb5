# SPDX-License-Identifier: GPL-3.0-or-later
"""Possible reasons for a missed tolerance in the comparison of the models of a ``spring_slider`` case."""
from __future__ import annotations

from collections.abc import Sequence
from math import pi, sqrt

import numpy as np

from statejump.core.comparison import Quantity
from statejump.core.run import Run
from statejump.core.units import text
from statejump.core.why_missed import heated_too_fast, still_moving
from statejump.kinds.spring_slider import stable_step
from statejump.kinds.spring_slider.case import SpringSliderCase


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
    """Return reasons for a shift of events: the distance of samples and the compliance of contacts."""
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
