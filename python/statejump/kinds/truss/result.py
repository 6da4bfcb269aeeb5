# SPDX-License-Identifier: GPL-3.0-or-later
"""What a result file says of a ``truss`` case: both models have the same columns, by item."""
from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from statejump.core.run import (
    AT_STOP, CONTACT_STATES, SEPARATED, SLIP, STICK, Column, Columns, Event, Events, Run, columns_of, numbers_of,
)
from statejump.core.units import unit_of
from statejump.kinds.truss import compare
from statejump.kinds.truss.case import TrussCase
from statejump.kinds.truss.dem import pressing_directions
from statejump.kinds.truss.motion import TrussMotion
from statejump.kinds.truss.resolved import GROUND, ResolvedTruss
from statejump.kinds.truss.solve import TrussPath, engine_program, heat_of_joints_J
from statejump.results import scene as drawing
from statejump.results.events import from_states, kind_of

# Of the engine's statuses stick, slip_plus, slip_minus, stop_plus, stop_minus, open.
STATES = np.array([STICK, SLIP, SLIP, AT_STOP, AT_STOP, SEPARATED], dtype=np.uint8)
STATE_OF = {"stick": STICK, "slip_plus": SLIP, "slip_minus": SLIP, "stop_plus": AT_STOP, "stop_minus": AT_STOP,
            "open": SEPARATED}
# Columns by item: what it is of, whether it is a vector. Names and order are those of the DEM's samples.
ITEMS = {
    "displacement_m": ("nodes", True), "axial_force_N": ("links", False), "tension_N": ("springs", False),
    "slide_m": ("sliders", False), "slider_force_N": ("sliders", False), "slider_state": ("sliders", False),
    "eccentricity_m": ("revolutes", True), "normal_force_N": ("revolutes", False),
    "friction_force_N": ("revolutes", False), "revolute_state": ("revolutes", False),
    "hinge_rotation_rad": ("latch_hinges", False), "hinge_moment_N_m": ("latch_hinges", False),
}
LOCATED = 1e-6  # of a cycle: an event within less has no uncertainty worth telling
NOTES = {
    "displacement_m": "from the drawn shape", "axial_force_N": "compression positive",
    "slider_force_N": "friction and stop on the slider, against its axis",
    "hinge_rotation_rad": "from the drawn shape",
    "hinge_moment_N_m": "against the rotation: preload, stiffness beyond the play, friction",
    "eccentricity_m": "journal minus bearing centre", "friction_force_N": "on the journal, clockwise about the axis",
}


def _joints(truss: ResolvedTruss) -> list[str]:
    """Names of all contacts, sliders first."""
    return list(joint_names(truss).values())


def joint_names(truss: ResolvedTruss) -> dict[tuple[str, str], str]:
    """Name of every contact by kind and name of its joint; with the kind where a slider and a revolute share one."""
    sliders, revolutes = truss.sliders.names, truss.revolutes.names
    shared = bool(set(sliders) & set(revolutes))
    return {
        (kind, name): f"{kind} {name}" if shared else name
        for kind, found in (("slider", sliders), ("revolute", revolutes)) for name in found
    }


def names(case: TrussCase) -> dict[str, list[str]]:
    """Names of the items of columns."""
    truss = case.resolve()
    of = {key: list(getattr(truss, key).names) for key in ("nodes", "links", "springs", "sliders", "revolutes")}
    if truss.latch_hinges.names:
        of["latch_hinges"] = list(truss.latch_hinges.names)
    return {**of, "contacts": _joints(truss)}


def scene(case: TrussCase) -> dict[str, Any]:
    """Links and springs between the nodes; blocks of sliders; journals and bearings."""
    truss = case.resolve()
    nodes = [drawing.ref("history/position_m", name) for name in truss.nodes.names]
    parts: list[dict[str, Any]] = [
        drawing.link(link.name, [nodes[end] for end in ends], _Section(truss, place))
        for place, (link, ends) in enumerate(zip(case.link, truss.links.nodes))
    ]
    for name, ends, stiffness in zip(truss.springs.names, truss.springs.nodes, truss.springs.stiffness_N_per_m):
        parts.append({"name": f"spring {name}", "type": "spring", "ends": [nodes[end] for end in ends],
                      "stiffness_N_per_m": float(stiffness)})
    contacts = []
    joints = _joints(truss)
    for place, (ends, axis, radius) in enumerate(
        zip(truss.sliders.nodes, truss.sliders.axis, truss.sliders.pad_radius_m)
    ):
        block = f"block {joints[place]}"
        parts.append({
            "name": block, "type": "block", "centre": nodes[ends[0]], "angle_rad": float(np.arctan2(axis[1], axis[0])),
            "half_width_m": float(radius), "half_height_m": float(radius), "pad_radius_m": float(radius),
        })
        held = truss.nodes.position_m[ends[0]]
        floor = f"floor {joints[place]}"
        parts.append({"name": floor, "type": "frame", "points": [(held - radius * axis).tolist(),
                                                                 (held + radius * axis).tolist()]})
        contacts.append((joints[place], block, floor))
    revolutes = truss.revolutes
    drawn: set[str] = set()
    for place in range(len(revolutes.names)):
        name = joints[len(truss.sliders.names) + place]
        pair = []
        for part in ("journal", "bearing"):
            node, link = (int(getattr(revolutes, f"{part}_{what}")[place]) for what in ("node", "link"))
            label = f"{part} {truss.nodes.names[node]}"
            pair.append(label)
            if label in drawn:
                continue
            drawn.add(label)
            # About an axis in space a link's view along z has no angle of its own to tell.
            turns = link != GROUND and truss.dimension == 2
            angle = drawing.ref("links/angle_rad", truss.links.names[link]) if turns else 0.0
            axis = {} if truss.dimension == 2 else {"axis": revolutes.axis[place].tolist()}
            parts.append({
                "name": label, "type": part, "centre": nodes[node], "angle_rad": angle,
                "radius_m": float(getattr(revolutes, f"{part}_radius_m")[place]),
                "thermal_expansion_per_K": float(getattr(revolutes, f"{part}_thermal_expansion_per_K")[place]), **axis,
            })
        contacts.append((name, pair[0], pair[1]))
    clearances = [*revolutes.radial_clearance_m, *truss.sliders.clearance_minus_m, *truss.sliders.clearance_plus_m]
    smallest = min((float(value) for value in clearances if np.isfinite(value)), default=0.0)
    return {**drawing.description(parts, contacts, smallest), "plane": "xy" if truss.dimension == 2 else "xyz"}


class _Section:
    """Section of a link as the drawing wants it."""

    def __init__(self, truss: ResolvedTruss, place: int) -> None:
        for key in ("cross_section_area_m2", "stress_free_length_m", "young_modulus_Pa", "thermal_expansion_per_K"):
            setattr(self, key, float(getattr(truss.links, key)[place]))


def _changes(truss: ResolvedTruss, time_s: np.ndarray, part: Any) -> np.ndarray:
    """Temperature change [K] of every item (samples, items)."""
    programs = [engine_program(program) for program in truss.programs]
    used = [int(number) for number in np.unique(part.program)]
    found = {number: programs[number].temperature_change(time_s) for number in used}
    if not len(part.names):
        return np.zeros((len(time_s), 0))
    return np.stack([found[number] for number in part.program], axis=1) * part.temperature_fraction


def _run(
    case: TrussCase, model: str, plain: dict[str, Column], energy: dict[str, Column], items: dict[str, np.ndarray],
    events: list[Event] | None, summary: Mapping[str, float], **more: Any,
) -> Run:
    truss, time = case.resolve(), plain["time_s"].values
    history = dict(plain)
    for key, (of, _) in ITEMS.items():
        if key not in ("slider_state", "revolute_state", "axial_force_N") and items[key].shape[1]:
            history[key] = Column(items[key], unit_of(key), of, note=NOTES.get(key, ""))
    position = truss.nodes.position_m + items["displacement_m"]
    history["position_m"] = Column(position, "m", "nodes")

    expansion = truss.links.thermal_expansion_per_K * _changes(truss, time, truss.links)
    along = position[:, truss.links.nodes[:, 1]] - position[:, truss.links.nodes[:, 0]]
    links = {
        "axial_force_N": Column(items["axial_force_N"], "N", "links", note=NOTES["axial_force_N"]),
        "thermal_strain": Column(expansion, "-", "links"),
        "angle_rad": Column(np.arctan2(along[:, :, 1], along[:, :, 0]), "rad", "links", note="of its view along z"),
    }
    contacts = _contacts(truss, time, position, items)
    change = plain["temperature_change_K"].values
    if events is None:
        events = from_states(time, change, contacts["state"].values, _joints(truss)) if len(time) else []
    jumps = np.linalg.norm(items["displacement_m"][-1] - items["displacement_m"][0], axis=1)
    return Run(model, history, energy, links, contacts, Events(events),
               {"largest_jump_m": float(jumps.max()), **summary}, names(case), lambda: case, **more)


def _contacts(
    truss: ResolvedTruss, time: np.ndarray, position: np.ndarray, items: dict[str, np.ndarray]
) -> dict[str, Column]:
    sliders, revolutes = truss.sliders, truss.revolutes
    samples = len(time)
    state = np.concatenate((items["slider_state"], items["revolute_state"]), axis=1).astype(np.uint8)
    slide = items["slide_m"]
    stops = np.minimum(slide + sliders.clearance_minus_m, sliders.clearance_plus_m - slide)
    offset = items["eccentricity_m"]
    distance = np.linalg.norm(offset, axis=2)
    clearance = revolutes.clearance_m(_changes(truss, time, revolutes))
    gap = np.concatenate((np.where(np.isfinite(stops), stops, np.nan), clearance - distance), axis=1)
    normal = np.divide(offset, distance[:, :, None], out=np.zeros_like(offset), where=distance[:, :, None] > 0)
    floor = pressing_directions(truss)
    pads = position[:, sliders.nodes[:, 0]] + sliders.pad_radius_m[:, None] * floor
    bearings = position[:, revolutes.bearing_node] + revolutes.bearing_radius_m[:, None] * normal
    push = np.tile(-sliders.normal_force_N[:, None] * floor, (samples, 1, 1))
    friction = -items["slider_force_N"][:, :, None] * sliders.axis
    across = np.cross(revolutes.axis, normal) if len(revolutes.names) else normal
    return {
        "state": Column(state, items="contacts", labels=CONTACT_STATES),
        "gap_m": Column(gap, "m", "contacts", note="of sliders: to the nearer stop; NaN: there is none"),
        "point_m": Column(np.concatenate((pads, bearings), axis=1), "m", "contacts"),
        "normal_force_N": Column(np.concatenate((push, -items["normal_force_N"][:, :, None] * normal), axis=1), "N",
                                 "contacts", note="on pad or journal"),
        "tangential_force_N": Column(
            np.concatenate((friction, -items["friction_force_N"][:, :, None] * across), axis=1), "N", "contacts",
            note="on pad (with the stops' force) or journal"),
    }


def sample_times(case: TrussCase) -> np.ndarray:
    """Return the times of the DEM's samples [s]."""
    cycles = case.thermal.cycles
    return np.linspace(0, case.period_s * cycles, case.samples_per_cycle * cycles + 1)


def reduced_run(case: TrussCase, path: TrussPath, times_s: np.ndarray) -> Run:
    """Return the quasi-static path at these times [s], linear between its states; :meth:`Run.at` gives it at
    others."""
    states = path.states
    at = states["time_s"]
    times_s = np.asarray(times_s, dtype=float)

    def sampled(values: np.ndarray) -> np.ndarray:
        place = np.clip(np.searchsorted(at, times_s, side="right") - 1, 0, max(len(at) - 2, 0))
        length = np.diff(at)[place]
        share = np.clip(np.divide(times_s - at[place], length, out=np.zeros_like(times_s), where=length > 0), 0, 1)
        share = share.reshape(-1, *(1,) * (values.ndim - 1))
        return (1 - share) * values[place] + share * values[place + 1]

    # The status of a state is that of the increment which ends there.
    ending = np.clip(np.searchsorted(at, times_s, side="left"), 0, len(at) - 1)
    items = {key: sampled(states[key]) for key in ITEMS if not key.endswith("_state")}
    for kind in ("slider", "revolute"):
        items[f"{kind}_state"] = STATES[states[f"{kind}_status"].astype(int)][ending]
    heat = heat_of_joints_J(states).sum(axis=1)
    plain, energy = columns_of({
        "time_s": times_s,
        "temperature_change_K": sampled(states["temperature_change_K"]),
        "elastic_energy_J": sampled(states["elastic_energy_J"]),
        "friction_dissipation_J": sampled(heat),
        "thermal_work_J": sampled(states["thermal_work_J"]),
        "external_work_J": sampled(states["load_potential_J"][0] - states["load_potential_J"]),
    })
    summary = {"energy_residue_J": path.energy_residue_J, "solves": float(path.solves),
               "unknowns": float(path.unknowns)}
    run = _run(case, "reduced", plain, energy, items, _events(case, path), summary, native=path,
               sampler=lambda times: reduced_run(case, path, times))
    of_joints = np.concatenate((states["slider_dissipation_J"], states["revolute_dissipation_J"]), axis=1)
    heat_of_joints = Column(sampled(of_joints), "J", "contacts", note="heat of friction since the start")
    return replace(run, contacts={**run.contacts, "dissipation_J": heat_of_joints})


def motion_run(case: TrussCase, motion: TrussMotion) -> Run:
    """Return the motion of a case as a run of the reduced model; its samples are those of the DEM."""
    states = motion.states
    items = {key: states[key] for key in ITEMS if not key.endswith("_state")}
    for kind in ("slider", "revolute"):
        items[f"{kind}_state"] = STATES[states[f"{kind}_status"].astype(int)]
    of_joints = np.concatenate((states["slider_dissipation_J"], states["revolute_dissipation_J"]), axis=1)
    plain, energy = columns_of({
        **{key: states[key] for key in (
            "time_s", "temperature_change_K", "elastic_energy_J", "kinetic_energy_J", "damping_dissipation_J",
            "impact_dissipation_J", "thermal_work_J")},
        "friction_dissipation_J": of_joints.sum(axis=1),
        "external_work_J": states["load_potential_J"][0] - states["load_potential_J"],
    })
    summary = {
        "energy_residue_J": compare.energy_residual(energy), "time_step_s": motion.time_step_s,
        "contact_problems": float(motion.iterations), "negative_dissipation_J": motion.negative_dissipation_J,
        "unknowns": float(motion.unknowns),
    }
    run = _run(case, "reduced", plain, energy, items, _events(case, motion), summary, native=motion,
               warnings=motion.warnings)
    velocity = Column(states["velocity_m_per_s"], "m/s", "nodes")
    heat = Column(of_joints, "J", "contacts", note="heat of friction since the start")
    return replace(run, history={**run.history, "velocity_m_per_s": velocity},
                   contacts={**run.contacts, "dissipation_J": heat})


def _events(case: TrussCase, path: TrussPath | TrussMotion) -> list[Event]:
    truss, at = path.truss, path.states["time_s"]
    joints, slipped, events = joint_names(truss), set(), []
    taken = set(joints.values())
    joints |= {("latch_hinge", name): f"latch_hinge {name}" if name in taken else name
               for name in truss.latch_hinges.names}
    for event in path.events:
        name = joints[event.joint_kind, event.name]
        before, after = STATE_OF[event.before], STATE_OF[event.after]
        # A path that does not locate all events has some of them somewhere within an increment.
        half = event.interval_s / 2 if event.interval_s > LOCATED * case.period_s else 0.0
        if before != after:
            change = float(np.interp(event.time_s - half, at, path.states["temperature_change_K"])) if half else (
                event.temperature_change_K)
            events.append(Event(kind_of(before, after, name in slipped), event.time_s - half, change, name, half))
        if after == SLIP:
            slipped.add(name)
    return events


def dem_run(case: TrussCase, columns: Columns, about: Mapping[str, Any]) -> Run:
    """Return a DEM run: events between samples."""
    truss, samples = case.resolve(), len(columns["time_s"])
    items = {}
    for key, (of, vector) in ITEMS.items():
        ends = (".x", ".y", ".z") if vector else ("",)
        found = [columns[f"{key}[{name}]{end}"] for name in getattr(truss, of).names for end in ends]
        values = np.stack(found, axis=1) if found else np.zeros((samples, 0))
        items[key] = values.reshape(samples, -1, 3) if vector else values
    plain, energy = columns_of({name: values for name, values in columns.items() if "[" not in name})
    summary = {**numbers_of(about), "energy_residue_J": compare.energy_residual(energy)}
    return _run(case, "dem", plain, energy, items, None, summary, about=about)
