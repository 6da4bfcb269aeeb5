# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs of a ``spring_slider`` case from the columns of either model, and its scene for drawings."""
from __future__ import annotations

from collections.abc import Callable, Mapping
from math import nan
from typing import Any

import numpy as np

from statejump import _engine
from statejump.core import plausibility
from statejump.core.run import (
    AT_STOP, CONTACT_STATES, SEPARATED, SLIP, STICK, Column, Columns, Event, Events, Run, columns_of, numbers_of,
)
from statejump.core.start import carried
from statejump.core.thermal import program
from statejump.kinds.spring_slider.case import SpringSliderCase
from statejump.results import scene as drawing
from statejump.results.events import from_states
from statejump.schema.fields import evolved

CONTACTS = ("floor", "stop_minus", "stop_plus")
# Displacement from the start [m] at the last row of a program that does not end at the reference temperature.
AT_END = "displacement_at_program_end_m"
SLIDING_STAGES = ("S2", "S5")
# Largest distance [m] at which a block counts as touching a rigid stop (rounding).
TOUCHING = 1e-9


def names(case: SpringSliderCase) -> dict[str, list[str]]:
    """Names of the items of columns."""
    return {"links": ["bar"], "contacts": list(CONTACTS)}


def scene(case: SpringSliderCase) -> dict[str, Any]:
    """Return bar, block and slot for drawings. The block is as high as with unloaded pads."""
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
        drawing.link("bar", [[root, 0.0, 0.0], [x, 0.0, 0.0]],
                     evolved(link, thermal_expansion_per_K=case.thermal_expansion_per_K)),
    ]
    if joint.preload_stiffness_N_per_m > 0 or joint.preload_force_N:
        parts.append({
            "name": "preload", "type": "spring", "ends": [[x, 0.0, 0.0], [-root, 0.0, 0.0]],
            "stiffness_N_per_m": joint.preload_stiffness_N_per_m,
        })
    return drawing.description(
        parts, [(name, "block", "slot") for name in CONTACTS], min(joint.clearance_minus_m, joint.clearance_plus_m)
    )


def _states(case: SpringSliderCase, history: Columns) -> np.ndarray:
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


def _contacts(case: SpringSliderCase, history: Columns) -> dict[str, Column]:
    x, change = history["displacement_m"], history["temperature_change_K"]
    samples, radius = len(x), case.joint.pad_radius_m
    states = _states(case, history)
    reduced = "slipping" not in history
    pad: float | np.ndarray = radius
    if not reduced:
        pad = radius * (1 + case.joint.pad_thermal_expansion_per_K * change)
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
        clearance: float | np.ndarray = case.clearance_m(side, 0.0)
        if not reduced:
            clearance = clearance + (case.clearance_m(side, 1.0) - clearance) * change
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
    case: SpringSliderCase, model: str, columns: Columns, events: list[Event] | None, summary: dict[str, float],
    warnings: tuple[str, ...] = (), **more: Any,
) -> Run:
    plain, energy = columns_of(columns)
    contacts = _contacts(case, columns)
    change = warmed = columns["temperature_change_K"]
    if case.expansion is not None:
        warmed = program(case.bar_program, case.period_s).temperature_change(columns["time_s"])
    links = {
        "axial_force_N": Column(columns["axial_force_N"][:, None], "N", "links", note="compression positive"),
        "thermal_strain": Column(case.thermal_expansion_per_K * warmed[:, None], "-", "links"),
    }
    if events is None:
        events = from_states(columns["time_s"], change, contacts["state"].values, CONTACTS)
    rigidity = np.array([case.link.young_modulus_Pa * case.link.cross_section_area_m2])
    warnings = (*case.thermal_notes, *case.implausible,
                *plausibility.axial_strains(["bar"], links["axial_force_N"].values, rigidity), *warnings)
    return Run(model, plain, energy, links, contacts, Events(events), summary, names(case), lambda: case,
               warnings=warnings, **more)


def _summary(case: SpringSliderCase, jump_m: float, there_m: float) -> dict[str, float]:
    """Return the state jump, and the displacement at the last row. The jump is NaN if the program does not return.

    :param jump_m: displacement at the end minus that at the start
    :param there_m: displacement at the last row of the program minus that at the start
    """
    found = {"state_jump_m": jump_m if case.has_jump else nan}
    return found if case.ending is None else {**found, AT_END: there_m}


def reduced_run(
    case: SpringSliderCase, path: _engine.SpringSliderPath, columns: Columns, warnings: tuple[str, ...],
    sampler: Callable[[np.ndarray], Run],
) -> Run:
    """Return a run of the reduced model with exact events."""
    side = {1: "stop_plus", -1: "stop_minus"}
    events = []
    for event in path.events:
        joint = "floor"
        if event.kind.startswith("stop_"):
            joint = side[1 if event.displacement_m > 0 else -1]
        elif event.kind in ("cycle_end", "force_sign_change"):
            joint = ""
        events.append(Event(event.kind, event.time_s, event.temperature_change_K, joint))
    there = nan
    if case.ending is not None:
        start, there = path.sample(np.array([0.0, case.ending.time_s]))["displacement_m"]
        there -= start
    summary = {**_summary(case, path.state_jump_m, float(there)),
               **carried(path.model.start_load_N, case.friction_force_N)}
    return _run(case, "reduced", columns, events, summary, warnings=warnings, native=path, sampler=sampler)


def dem_run(case: SpringSliderCase, columns: Columns, about: Mapping[str, Any]) -> Run:
    """Return a DEM run: events between samples."""
    x = columns["displacement_m"]
    there = nan if case.ending is None else np.interp(case.ending.time_s, columns["time_s"], x) - x[0]
    summary = {**_summary(case, float(x[-1] - x[0]), float(there)),
               **carried(columns["friction_force_N"][0], case.friction_force_N), **numbers_of(about)}
    return _run(case, "dem", columns, None, summary, about=about)
