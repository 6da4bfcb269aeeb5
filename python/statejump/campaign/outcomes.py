# SPDX-License-Identifier: GPL-3.0-or-later
"""What a campaign records of one sample, for every kind of case and for either model.

NaN: it did not happen, for instance a stop that was not reached.
"""
from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Callable, Optional

import numpy as np

from statejump.core import comparison as compare, yade_process as dem
from statejump.kinds.spring_slider import reduced
from statejump.kinds.registry import Case, SpringSliderCase, TrussCase, UmbrellaCase
from statejump.core.history import History
from statejump.kinds.truss.outcomes import UNITS as TRUSS_UNITS
from statejump.kinds.truss.outcomes import outcomes as truss_outcomes
from statejump.kinds.umbrella import compare as umbrella_compare
from statejump.kinds.umbrella import dem as umbrella_dem
from statejump.kinds.umbrella import reduced as umbrella

MODELS = ("reduced", "dem")


@dataclass(frozen=True)
class KindOutcomes:
    """How one kind of case is measured. A kind registers itself in ``KINDS``."""

    units: dict[str, str]  # unit of each column, in the order of the table
    reduced: Callable[[Any], dict[str, float]]
    resolved: Optional[Callable[[Any], dict[str, Any]]] = None  # what the YADE script needs
    of_dem_run: Optional[Callable[[Any, dem.DemRun], dict[str, float]]] = None  # None: no DEM in campaigns


def _or_nan(value: Optional[float]) -> float:
    return float("nan") if value is None else float(value)


SPRING_SLIDER_UNITS = {
    "state_jump_m": "m",
    "first_slip_temperature_change_K": "K",
    "stop_reached_temperature_change_K": "K",
    "stop_left_temperature_change_K": "K",
    "friction_dissipation_J": "J",
    "largest_axial_force_N": "N",
}


def _spring_slider_reduced(case: SpringSliderCase) -> dict[str, float]:
    path = reduced.solve(case)
    # Within a segment the force is monotonic, so its ends have the largest.
    ends = path.sample(np.array([0.0, *(segment.end_time_s for segment in path.segments)]))
    events: dict[str, float] = {}
    for event in path.events:
        if event.time_s <= case.dem.period_s:
            events.setdefault(event.kind, event.temperature_change_K)
    return {
        "state_jump_m": path.state_jump_m,
        **{f"{kind}_temperature_change_K": _or_nan(events.get(kind)) for kind in compare.COMPARED_EVENTS},
        "friction_dissipation_J": float(ends["friction_dissipation_J"][-1]),
        "largest_axial_force_N": float(np.max(np.abs(ends["axial_force_N"]))),
    }


def _spring_slider_dem(case: SpringSliderCase, run: dem.DemRun) -> dict[str, float]:
    history = run.history
    events = compare.dem_event_temperatures(history, case.samples_per_cycle)
    return {
        "state_jump_m": _change(history, "displacement_m"),
        **{f"{kind}_temperature_change_K": _or_nan(events[kind]) for kind in compare.COMPARED_EVENTS},
        "friction_dissipation_J": _change(history, "friction_dissipation_J"),
        "largest_axial_force_N": float(np.max(np.abs(history["axial_force_N"]))),
    }


def _change(history: History, column: str) -> float:
    return float(history[column][-1] - history[column][0])


UMBRELLA_UNITS = {
    "theta2_jump_rad": "rad",
    "theta4_jump_rad": "rad",
    "theta2_range_rad": "rad",
    "theta4_range_rad": "rad",
    "first_contact_temperature_change_K": "K",
    "contacts": "-",
    "energy_residue_J": "J",
}


def _umbrella_values(
    history: History, first_contact: Optional[float], contacts: int, residue: float
) -> dict[str, float]:
    angles = ("theta2", "theta4")
    return {
        **{f"{angle}_jump_rad": _change(history, f"{angle}_rad") for angle in angles},
        **{f"{angle}_range_rad": float(np.ptp(history[f"{angle}_rad"])) for angle in angles},
        "first_contact_temperature_change_K": _or_nan(first_contact),
        "contacts": float(contacts),
        "energy_residue_J": float(residue),
    }


def _umbrella_reduced(case: UmbrellaCase) -> dict[str, float]:
    run = umbrella.run(case)
    return _umbrella_values(
        run.history, run.first_contact_temperature_change_K, run.contacts, run.energy_residue_J
    )


def _umbrella_dem(case: UmbrellaCase, run: dem.DemRun) -> dict[str, float]:
    return _umbrella_values(
        run.history, run.summary["first_contact_temperature_change_K"], run.summary["contacts"],
        umbrella_compare.energy_residual(run.history),
    )


KINDS: dict[str, KindOutcomes] = {
    SpringSliderCase.KIND: KindOutcomes(
        SPRING_SLIDER_UNITS, _spring_slider_reduced, dem.resolved, _spring_slider_dem
    ),
    UmbrellaCase.KIND: KindOutcomes(
        UMBRELLA_UNITS, _umbrella_reduced, umbrella_dem.resolved, _umbrella_dem
    ),
    TrussCase.KIND: KindOutcomes(TRUSS_UNITS, truss_outcomes),
}


def outcome(case: Case, model: str) -> dict[str, float]:
    """Run one sampled case and return its outcomes, in the order of the table.

    :raises StatejumpError: the run failed
    """
    kind = KINDS[case.kind]
    if model == "reduced":
        return kind.reduced(case)
    assert kind.resolved is not None and kind.of_dem_run is not None  # the campaign file was checked
    run = dem.execute(kind.resolved(case), lambda fraction: None)
    return kind.of_dem_run(case, run)
