# SPDX-License-Identifier: GPL-3.0-or-later
"""What a result file says of a ``spring_slider`` case beside its histories."""
from __future__ import annotations

from typing import Any, Optional

import numpy as np

from statejump import _engine
from statejump.core import comparison as compare
from statejump.kinds.spring_slider.case import SpringSliderCase
from statejump.core.comparison import Quantity
from statejump.core.yade_process import DemRun
from statejump.core.history import History
from statejump.results import scene as drawing
from statejump.results.contents import (
    AT_STOP, CONTACT_STATES, SEPARATED, SLIP, STICK, Column, Event, ModelRun, Scalar, columns_of, history_of,
    scalars,
)
from statejump.results.events import first_event_K, from_states

CONTACTS = ("floor", "stop_minus", "stop_plus")
SLIDING_STAGES = ("S2", "S5")
# A rigid stop is touched to rounding; a sample that stands off further does not touch it.
TOUCHING = 1e-9


def names(case: SpringSliderCase) -> dict[str, list[str]]:
    """Names of the items of columns."""
    return {"links": ["bar"], "contacts": list(CONTACTS)}


def scene(case: SpringSliderCase) -> dict[str, Any]:
    """Bar, block and slot; the block's height is that of the unloaded pads."""
    link, joint = case.link, case.joint
    x = drawing.ref("history/displacement_m")
    root, radius = -link.stress_free_length_m, joint.pad_radius_m
    parts: list[dict[str, Any]] = [
        {"name": "root", "type": "frame", "points": [[root, -radius, 0.0], [root, radius, 0.0]]},
        {
            "name": "slot", "type": "slot", "centre": [0.0, 0.0, 0.0], "angle_rad": 0.0,
            "stop_minus_m": radius + joint.clearance_minus_m, "stop_plus_m": radius + joint.clearance_plus_m,
            "half_height_m": radius, "thermal_expansion_per_K": joint.slot_thermal_expansion_per_K,
        },
        {
            "name": "block", "type": "block", "centre": [x, 0.0, 0.0], "angle_rad": 0.0, "half_width_m": radius,
            "half_height_m": radius, "pad_radius_m": radius,
            "thermal_expansion_per_K": joint.pad_thermal_expansion_per_K,
        },
        drawing.link("bar", [[root, 0.0, 0.0], [x, 0.0, 0.0]], link),
    ]
    if joint.preload_stiffness_N_per_m > 0:
        parts.append({
            "name": "preload", "type": "spring", "ends": [[x, 0.0, 0.0], [-root, 0.0, 0.0]],
            "stiffness_N_per_m": joint.preload_stiffness_N_per_m,
        })
    return drawing.description(
        parts, [(name, "block", "slot") for name in CONTACTS], min(joint.clearance_minus_m, joint.clearance_plus_m)
    )


def _states(case: SpringSliderCase, history: History) -> np.ndarray:
    """States of the contacts (samples, contacts)."""
    x = history["displacement_m"]
    states = np.full((len(x), len(CONTACTS)), SEPARATED, dtype=np.uint8)
    if "slipping" in history:
        states[:, 0] = np.where(history["slipping"] > 0.5, SLIP, STICK)
        touches, push = history["stop_contact"] > 0.5, history["stop_force_N"]
        states[touches & (push > 0), 1] = AT_STOP
        states[touches & (push <= 0), 2] = AT_STOP
        return states
    states[:, 0] = np.where(np.isin(history["stage"], SLIDING_STAGES), SLIP, STICK)
    # The reduced model keeps the clearances of the reference temperature.
    for place, clearance in ((1, case.joint.clearance_minus_m), (2, case.joint.clearance_plus_m)):
        side = -1 if place == 1 else 1
        states[side * x >= clearance * (1 - TOUCHING), place] = AT_STOP
    return states


def _contacts(case: SpringSliderCase, history: History) -> dict[str, Column]:
    x, change = history["displacement_m"], history["temperature_change_K"]
    samples, radius = len(x), case.joint.pad_radius_m
    states = _states(case, history)
    reduced = "slipping" not in history
    pad = radius * (1 if reduced else 1 + case.joint.pad_thermal_expansion_per_K * change)
    normal, tangential, point = (np.zeros((samples, len(CONTACTS), 3)) for _ in range(3))
    gap = np.zeros((samples, len(CONTACTS)))
    if "floor_normal_force_N" in history:
        normal[:, 0, 1] = history["floor_normal_force_N"]
        gap[:, 0] = np.nan  # no column has the height of the block
    else:
        normal[:, 0, 1] = case.joint.normal_force_N
    tangential[:, 0, 0] = history["friction_force_N"]
    point[:, 0] = np.stack([x, np.full(samples, -radius), np.zeros(samples)], axis=1)
    for place, side in ((1, -1), (2, 1)):
        clearance = case.clearance_m(side, 0.0) if reduced else (
            case.clearance_m(side, 0.0) + (case.clearance_m(side, 1.0) - case.clearance_m(side, 0.0)) * change
        )
        gap[:, place] = clearance - side * x
        point[:, place, 0] = x + side * pad
        push = history["stop_force_N"]
        normal[:, place, 0] = np.where(side * push < 0, push, 0.0)
    return {
        "state": Column(states, items="contacts", labels=CONTACT_STATES),
        "gap_m": Column(gap, "m", "contacts", note="of the stops; NaN: the model has no such column"),
        "point_m": Column(point, "m", "contacts"),
        "normal_force_N": Column(normal, "N", "contacts", note="on the block"),
        "tangential_force_N": Column(tangential, "N", "contacts", note="on the block"),
    }


def _run(
    case: SpringSliderCase, history: History, events: Optional[list[Event]], summary: dict[str, Scalar]
) -> ModelRun:
    plain, energy = columns_of(history)
    contacts = _contacts(case, history)
    change = history["temperature_change_K"]
    links = {
        "axial_force_N": Column(history["axial_force_N"][:, None], "N", "links", note="compression positive"),
        "thermal_strain": Column(case.link.thermal_expansion_per_K * change[:, None], "-", "links"),
    }
    if events is None:
        events = from_states(history["time_s"], change, contacts["state"].values, CONTACTS)
    return ModelRun(plain, energy, links, contacts, events, summary)


def reduced_run(case: SpringSliderCase, path: _engine.SpringSliderPath, history: History) -> ModelRun:
    """The reduced model: exact events."""
    side = {1: "stop_plus", -1: "stop_minus"}
    events = []
    for event in path.events:
        joint = "floor"
        if event.kind.startswith("stop_"):
            joint = side[1 if event.displacement_m > 0 else -1]
        elif event.kind in ("cycle_end", "force_sign_change"):
            joint = ""
        events.append(Event(event.kind, event.time_s, event.temperature_change_K, joint))
    jump = {"state_jump_m": Scalar(path.state_jump_m, "m")}
    return _run(case, history, events, jump)


def dem_run(case: SpringSliderCase, done: DemRun) -> ModelRun:
    """The DEM: events between samples."""
    x = done.history["displacement_m"]
    summary = {"state_jump_m": Scalar(float(x[-1] - x[0]), "m"), **scalars(done.summary)}
    return _run(case, done.history, None, summary)


def difference_rows(case: SpringSliderCase, first: ModelRun, second: ModelRun) -> list[Quantity]:
    """Two runs of the case at the same times against its tolerances."""
    jumps = [run.summary["state_jump_m"].value for run in (first, second)]
    rows = [compare.jump_row(case, *jumps)]
    if case.friction_force_N > 0:
        for kind in compare.COMPARED_EVENTS:
            changes = [first_event_K(run, kind, case.period_s) for run in (first, second)]
            rows.append(compare.quantity(f"{kind}_temperature_change", "K", *changes, case.tolerance.event_temperature_K))
    rows.append(compare.displacement_row(case, history_of(first), history_of(second)))
    return rows
