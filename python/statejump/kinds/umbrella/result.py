# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs of an ``umbrella`` case from the columns of either model, and its scene for drawings."""
from __future__ import annotations

from collections.abc import Mapping
from math import isnan, nan
from typing import Any

import numpy as np

from statejump import _engine
from statejump.core.run import (
    CONTACT_STATES, SEPARATED, SLIP, STICK, Column, Columns, Event, Events, Run, columns_of, numbers_of,
)
from statejump.core.start import carried
from statejump.kinds.umbrella.case import UmbrellaCase
from statejump.results import scene as drawing
from statejump.results.events import from_states

CONTACTS = ("joint_b",)
LINKS = ("link_ab", "link_bc")
ANGLES = ("theta2", "theta4")
# Change of an angle from the start to the last row of a program that does not end at the reference temperature.
AT_END = "_change_at_program_end_rad"
CHAOS = (
    "without damping of links and pins the motion after contact is chaotic: one run's jump is one of many, see "
    "'statejump figures'"
)


def names(case: UmbrellaCase) -> dict[str, list[str]]:
    """Names of the items of columns."""
    return {"links": list(LINKS), "contacts": list(CONTACTS)}


def scene(case: UmbrellaCase) -> dict[str, Any]:
    """Return the scene for drawings: frame, two links, and the journal of BC in the bearing of AB. Journal and bearing
    rotate with their links."""
    joint, frame = case.joint, case.frame.length_m
    pins: dict[str, drawing.Point] = {"link_ab": [0.0, 0.0, 0.0], "link_bc": [frame, 0.0, 0.0]}
    tips: dict[str, drawing.Point] = {
        part: [drawing.ref(f"history/{part}_x_m"), drawing.ref(f"history/{part}_y_m"), 0.0]
        for part in ("bearing", "journal")
    }
    parts: list[dict[str, Any]] = [
        {"name": "frame", "type": "frame", "points": [pins["link_ab"], pins["link_bc"]]},
        drawing.link("link_ab", [pins["link_ab"], tips["bearing"]], case.link_ab),
        drawing.link("link_bc", [pins["link_bc"], tips["journal"]], case.link_bc),
        {
            "name": "bearing", "type": "bearing", "centre": tips["bearing"],
            "angle_rad": drawing.ref("history/theta2_rad"), "radius_m": case.bearing_radius_m,
            "thermal_expansion_per_K": joint.bearing_thermal_expansion_per_K,
        },
        {
            "name": "journal", "type": "journal", "centre": tips["journal"],
            "angle_rad": drawing.ref("history/theta4_rad"), "radius_m": joint.journal_radius_m,
            "thermal_expansion_per_K": joint.journal_thermal_expansion_per_K,
        },
    ]
    if case.torsion_spring.stiffness_N_m_per_rad > 0:
        parts.append({
            "name": "torsion_spring", "type": "spring", "ends": [tips["bearing"], tips["journal"]],
            "stiffness_N_m_per_rad": case.torsion_spring.stiffness_N_m_per_rad,
            "free_angle_rad": case.free_flare_angle_rad,
        })
    return drawing.description(parts, [("joint_b", "journal", "bearing")], joint.radial_clearance_m)


def _contacts(case: UmbrellaCase, history: Columns) -> dict[str, Column]:
    """Return force, state and position of the contact. The unit vector n points from the centre of the bearing to that
    of the journal. The bearing pushes the journal along -n; friction acts along n rotated by +90 degrees."""
    change = history["temperature_change_K"]
    offset = np.stack([history["eccentricity_x_m"], history["eccentricity_y_m"], np.zeros(len(change))], axis=1)
    distance = np.linalg.norm(offset, axis=1, keepdims=True)
    normal = np.divide(offset, distance, out=np.zeros_like(offset), where=distance > 0)
    along = np.stack([-normal[:, 1], normal[:, 0], np.zeros(len(change))], axis=1)
    centre = np.stack([history["bearing_x_m"], history["bearing_y_m"], np.zeros(len(change))], axis=1)
    radius = case.bearing_radius_m * (1 + case.joint.bearing_thermal_expansion_per_K * change)
    depth = history["penetration_depth_m"]
    state = np.where(depth < 0, SEPARATED, np.where(history["slipping"] > 0.5, SLIP, STICK)).astype(np.uint8)
    return {
        "state": Column(state[:, None], items="contacts", labels=CONTACT_STATES),
        "gap_m": Column(-depth[:, None], "m", "contacts"),
        "point_m": Column((centre + radius[:, None] * normal)[:, None, :], "m", "contacts",
                          note="on the bearing's surface, where the gap is smallest"),
        "normal_force_N": Column((-history["normal_force_N"][:, None] * normal)[:, None, :], "N", "contacts",
                                 note="on the journal"),
        "tangential_force_N": Column((history["tangential_force_N"][:, None] * along)[:, None, :], "N",
                                     "contacts", note="on the journal"),
    }


def _links(case: UmbrellaCase, history: Columns) -> dict[str, Column]:
    change = history["temperature_change_K"]
    forces, strains = [], []
    for name in LINKS:
        link = getattr(case, name)
        strain = link.thermal_expansion_per_K * change
        free = link.stress_free_length_m * (1 + strain)
        rigidity = link.young_modulus_Pa * link.cross_section_area_m2
        forces.append(rigidity * (free - history[f"length_{name[-2:]}_m"]) / free)
        strains.append(strain)
    return {
        "axial_force_N": Column(np.stack(forces, axis=1), "N", "links",
                                note="compression positive; of the spring E A/l, from the length, without the dashpot"),
        "thermal_strain": Column(np.stack(strains, axis=1), "-", "links"),
    }


def _run(
    case: UmbrellaCase, model: str, columns: Columns, summary: Mapping[str, float], **more: Any
) -> Run:
    plain, energy = columns_of(columns)
    contacts = _contacts(case, columns)
    change = columns["temperature_change_K"]
    events = from_states(columns["time_s"], change, contacts["state"].values, CONTACTS)
    first_time, first_change = (summary.get(f"first_contact_{key}", nan) for key in ("time_s", "temperature_change_K"))
    if not isnan(first_time):
        # Both models locate this event more accurately than samples do, even if it lies between samples.
        seen = next((event for event in events if event.kind == "contact"), None)
        if seen is not None and abs(seen.time_s - first_time) <= 2 * seen.time_uncertainty_s:
            events.remove(seen)
        events.append(Event("first_contact", first_time, first_change, CONTACTS[0]))
        events.sort(key=lambda event: event.time_s)
    jumps = {}
    for angle in ANGLES:
        turned = columns[f"{angle}_rad"] - columns[f"{angle}_rad"][0]
        jumps[f"{angle}_jump_rad"] = float(turned[-1]) if case.has_jump else nan
        if case.ending is not None:
            jumps[f"{angle}{AT_END}"] = float(np.interp(case.ending.time_s, columns["time_s"], turned))
    warnings = (*case.thermal_notes, *case.implausible, *(() if case.is_reproducible else (CHAOS,)))
    start = carried(columns["tangential_force_N"][0], case.joint.friction_coefficient * columns["normal_force_N"][0])
    return Run(model, plain, energy, _links(case, columns), contacts, Events(events), {**jumps, **start, **summary},
               names(case), lambda: case, warnings=warnings, **more)


def reduced_run(case: UmbrellaCase, done: _engine.LinkageRun) -> Run:
    """Return a run of the reduced model."""
    keys = ("first_contact_time_s", "first_contact_temperature_change_K", "contacts", "steps", "energy_residue_J")
    summary = numbers_of({key: getattr(done, key) for key in keys})
    return _run(case, "reduced", done.columns(), summary, native=done)


def dem_run(case: UmbrellaCase, columns: Columns, about: Mapping[str, Any]) -> Run:
    """Return a DEM run."""
    return _run(case, "dem", columns, numbers_of(about), about=about)
