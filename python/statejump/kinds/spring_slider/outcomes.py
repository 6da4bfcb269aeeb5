# SPDX-License-Identifier: GPL-3.0-or-later
"""Outcomes of a ``spring_slider`` case for campaigns."""
from __future__ import annotations

import numpy as np

from statejump.core.run import Run
from statejump.kinds.spring_slider.case import SpringSliderCase
from statejump.kinds.spring_slider.compare import COMPARED_EVENTS, dem_event_temperatures, first_cycle_events


def outcomes(case: SpringSliderCase, run: Run) -> dict[str, float]:
    """Return jump, event temperatures, work of friction and largest axial force; NaN: it did not happen."""
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
