# SPDX-License-Identifier: GPL-3.0-or-later
"""Results of a ``truss`` case. Both models return the same columns, with one value per item."""
from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from math import nan
from typing import Any

import numpy as np

from statejump.core import plausibility
from statejump.core.notes import Note
from statejump.core.run import (
    AT_STOP, CONTACT_STATES, SEPARATED, SLIP, STICK, Column, Columns, Event, Events, Run, columns_of, numbers_of,
)
from statejump.core.start import carried
from statejump.core.units import unit_of
from statejump.kinds.truss import compare, means, notes
from statejump.kinds.truss.body_modes import without_modes
from statejump.kinds.truss.body_points import displacements_m, point_names, positions_m
from statejump.kinds.truss.case import TrussCase
from statejump.kinds.truss.elements import ELEMENTS
from statejump.kinds.truss.elements.protocol import ElementType
from statejump.kinds.truss.joints import JOINTS
from statejump.kinds.truss.joints.protocol import Contacts, JointType, Sampled
from statejump.kinds.truss.motion import TrussMotion
from statejump.kinds.truss.resolved import ResolvedTruss
from statejump.kinds.truss.solve import TrussPath, engine_programs, heat_of_joints_J
from statejump.results import scene as drawing
from statejump.results.events import from_states, kind_of

# Contact state for each engine status: stick, slip_plus, slip_minus, stop_plus, stop_minus, open.
STATES = np.array([STICK, SLIP, SLIP, AT_STOP, AT_STOP, SEPARATED], dtype=np.uint8)
STATE_OF = {"stick": STICK, "slip_plus": SLIP, "slip_minus": SLIP, "stop_plus": AT_STOP, "stop_minus": AT_STOP,
            "open": SEPARATED}
TYPES: tuple[ElementType[Any, Any] | JointType[Any, Any], ...] = (*ELEMENTS, *JOINTS)
# Columns by item: list of the items, and whether values are vectors. Names and order are those of the DEM's samples.
ITEMS = {"displacement_m": ("nodes", True), "axial_force_N": ("links", False)} | {
    column.name: (kind.items, column.vector) for kind in TYPES for column in kind.columns}
ROTATIONS = ("rotation_rad",)  # columns of cases with nodes that rotate
TOUCHING = [joint for joint in JOINTS if joint.has_contacts]
# Types whose states the DEM samples. Types with contacts have states in the contacts of a result.
STICKING = [joint for joint in JOINTS if joint.has_contacts or not joint.not_in_dem]
# Displacement at the end of a program that does not return to the reference temperature.
AT_END = "largest_displacement_at_program_end_m"
HEAT = "heat of friction since the start"
LOCATED = 1e-6  # fraction of a cycle below which the uncertainty of an event is not reported
NOTES = {"displacement_m": "from the drawn shape", "axial_force_N": "compression positive"} | {
    column.name: column.note for kind in TYPES for column in kind.columns}


def _joints(truss: ResolvedTruss) -> list[str]:
    """Names of all contacts, type by type."""
    return list(joint_names(truss).values())


def joint_names(truss: ResolvedTruss) -> dict[tuple[str, str], str]:
    """Return for each contact the name of its joint, with the kind of joint if joints of two types share a name."""
    listed = [(joint.section, name) for joint in TOUCHING for name in truss.joints[joint.section].names]
    shared = len({name for _, name in listed}) < len(listed)
    return {(kind, name): f"{kind} {name}" if shared else name for kind, name in listed}


def every_joint_name(truss: ResolvedTruss) -> dict[tuple[str, str], str]:
    """Return the name of every joint; contacts keep theirs. It includes the kind if an earlier joint has this name."""
    found = joint_names(truss)
    taken = set(found.values())
    for joint in JOINTS:
        own = () if joint.has_contacts else truss.joints[joint.section].names
        found |= {(joint.section, name): f"{joint.section} {name}" if name in taken else name for name in own}
        taken |= set(own)
    return found


def names(case: TrussCase) -> dict[str, list[str]]:
    """Names of the items of columns."""
    truss = case.resolve()
    of = {key: list(getattr(truss, key).names) for key in ("nodes", "links")}
    of |= {element.items: list(truss.elements[element.section].names) for element in ELEMENTS
           if element.columns and (element.listed_if_none or truss.elements[element.section].names)}
    of |= {joint.items: list(truss.joints[joint.section].names) for joint in JOINTS
           if joint.has_contacts or truss.joints[joint.section].names}
    of |= {"drives": list(truss.drives.names)} if truss.drives.names else {}
    of |= {"points": point_names(truss)} if point_names(truss) else {}
    return {**of, "contacts": _joints(truss)}


def scene(case: TrussCase) -> dict[str, Any]:
    """Return the scene for drawings: links and elements between nodes, blocks of sliders, journals and bearings."""
    truss = case.resolve()
    nodes = [drawing.ref("history/position_m", name) for name in truss.nodes.names]
    parts: list[dict[str, Any]] = [
        drawing.link(link.name, [nodes[end] for end in ends], _Section(truss.links, place))
        for place, (link, ends) in enumerate(zip(case.link, truss.links.nodes))
    ]
    for element in ELEMENTS:
        elements = truss.elements[element.section]
        if element.has_section:
            # Their columns are not those of links.
            parts += [{**drawing.link(f"{element.section} {name}", [nodes[end] for end in ends],
                                      _Section(elements, place)), "values": {}}
                      for place, (name, ends) in enumerate(zip(elements.names, element.ends(elements)))]
            continue
        seen: dict[str, int] = {}
        for name, ends, stiffness in zip(element.names_of_ends(elements), element.ends(elements),
                                         element.stiffness_N_per_m(elements)):
            seen[name] = seen.get(name, 0) + 1
            number = f" {seen[name]}" if seen[name] > 1 else ""
            parts.append({"name": f"{element.section} {name}{number}", "type": "spring",
                          "ends": [nodes[end] for end in ends], "stiffness_N_per_m": float(stiffness)})
    labels, taken = joint_names(truss), {part["name"] for part in parts}
    contacts, clearances = [], [np.zeros(0)]
    for joint in JOINTS:
        joints = truss.joints[joint.section]
        own = joint.drawn(truss, joints, [labels.get((joint.section, name), name) for name in joints.names], taken)
        parts += own.parts
        contacts += own.contacts
        clearances.append(own.clearances_m)
    every = np.concatenate(clearances)
    smallest = float(every[np.isfinite(every)].min(initial=np.inf)) if np.isfinite(every).any() else 0.0
    return {**drawing.description(parts, contacts, smallest), "plane": "xy" if truss.dimension == 2 else "xyz"}


class _Section:
    """Section of a link or a beam for the drawing."""

    def __init__(self, parts: Any, place: int) -> None:
        for key in ("cross_section_area_m2", "stress_free_length_m", "young_modulus_Pa", "thermal_expansion_per_K"):
            setattr(self, key, float(getattr(parts, key)[place]))


def _changes(truss: ResolvedTruss, time_s: np.ndarray, part: Any) -> np.ndarray:
    """Return the temperature change [K] of every item (samples, items)."""
    programs = engine_programs(truss)
    used = [int(number) for number in np.unique(part.program)]
    found = {number: programs[number].temperature_change(time_s) for number in used}
    if not len(part.names):
        return np.zeros((len(time_s), 0))
    return np.stack([found[number] for number in part.program], axis=1) * part.temperature_fraction


def _run(
    case: TrussCase, model: str, plain: dict[str, Column], energy: dict[str, Column], items: dict[str, np.ndarray],
    events: Callable[[], list[Event]], summary: Mapping[str, float], warnings: tuple[str, ...] = (),
    dense: tuple[np.ndarray, np.ndarray] | None = None, **more: Any,
) -> Run:
    """Make a run. ``dense`` has times and displacements at smaller intervals than the samples, if there are any."""
    truss, time = case.resolve(), plain["time_s"].values
    history = dict(plain)
    for key, (of, _) in ITEMS.items():
        if key != "axial_force_N" and items[key].shape[1]:
            history[key] = Column(items[key], unit_of(key), of, note=NOTES.get(key, ""))
    position = truss.nodes.position_m + items["displacement_m"]
    history["position_m"] = Column(position, "m", "nodes")
    if point_names(truss):
        points = slice(len(truss.nodes.names), None)
        moved = displacements_m(truss, {**items, "time_s": time})[:, points]
        history["point_displacement_m"] = Column(moved, "m", "points", note="from the drawn shape")
        history["point_position_m"] = Column(positions_m(truss)[points] + moved, "m", "points")

    expansion = truss.links.thermal_expansion_per_K * _changes(truss, time, truss.links)
    along = position[:, truss.links.nodes[:, 1]] - position[:, truss.links.nodes[:, 0]]
    links = {
        "axial_force_N": Column(items["axial_force_N"], "N", "links", note=NOTES["axial_force_N"]),
        "thermal_strain": Column(expansion, "-", "links"),
        "angle_rad": Column(np.arctan2(along[:, :, 1], along[:, :, 0]), "rad", "links", note="of its view along z"),
    }
    contacts = _contacts(truss, time, position, items)
    change = plain["temperature_change_K"].values

    def happened() -> list[Event]:
        return sorted([*events(), *_switches(truss, time, change, items)], key=lambda event: event.time_s)

    return Run(model, history, energy, links, contacts, Events(happened),
               {**_jumps(case, *(dense or (time, items["displacement_m"]))), **summary}, names(case), lambda: case,
               warnings=(*case.thermal_notes, *case.implausible, *plausibility.axial_strains(
                   truss.links.names, items["axial_force_N"], truss.links.axial_stiffness_N),
                   *_of_elements(truss, items),
                   *means.run_notes(truss.means, items["displacement_m"]), *warnings), **more)


def _of_elements(truss: ResolvedTruss, items: Mapping[str, np.ndarray]) -> tuple[str, ...]:
    """Return what the element types note about a run."""
    return tuple(note for element in ELEMENTS if truss.elements[element.section].names
                 for note in element.run_notes(truss, truss.elements[element.section], items))


def _jumps(case: TrussCase, time_s: np.ndarray, displacement_m: np.ndarray) -> dict[str, float]:
    """Return the largest jump of a node, and the largest displacement at the end of the program. The jump is NaN if the
    program does not return to ΔT = 0."""
    moved = displacement_m - displacement_m[0]
    largest = float(np.linalg.norm(moved[-1], axis=1).max())
    found = {"largest_jump_m": largest if case.has_jump else nan}
    if case.ending is not None:
        after = min(int(np.searchsorted(time_s, case.ending.time_s)), len(time_s) - 1)
        before = max(after - 1, 0)
        share = float(np.interp(case.ending.time_s, time_s[[before, after]], [0.0, 1.0])) if after > before else 0.0
        there = (1 - share) * moved[before] + share * moved[after]
        found[AT_END] = float(np.linalg.norm(there, axis=1).max())
    return found


def _start_friction(truss: ResolvedTruss, items: Mapping[str, np.ndarray]) -> dict[str, float]:
    """Return the friction forces, and the friction moments of hinges, in the first state, for the summary."""
    forces: list[tuple[np.ndarray, np.ndarray]] = [(np.zeros(0), np.zeros(0))]
    moments: list[tuple[np.ndarray, np.ndarray]] = []
    for joint in JOINTS:
        joints = truss.joints[joint.section]
        if len(joints.names):
            own = joint.carried_friction(joints, {column.name: items[column.name][0] for column in joint.columns})
            (moments if joint.turns else forces).append(own)
    found = carried(*map(np.concatenate, zip(*forces)))
    if moments:
        of_hinges = carried(*map(np.concatenate, zip(*moments)))
        found["start_friction_over_limit"] = max(one["start_friction_over_limit"] for one in (found, of_hinges))
        found["start_friction_N_m"] = of_hinges["start_friction_N"]
    return found


def _switches(truss: ResolvedTruss, time: np.ndarray, change: np.ndarray, items: Mapping[str, np.ndarray]
              ) -> list[Event]:
    """Return the events at which elements switch on or off. The time of an event is the mean of two samples."""
    others = set(every_joint_name(truss).values())
    found = []
    for element in ELEMENTS:
        elements = truss.elements[element.section]
        for one in element.switches(elements, {column.name: items[column.name] for column in element.columns}):
            name = elements.names[one.element]
            for after in np.flatnonzero(one.is_on[1:] != one.is_on[:-1]) + 1:
                between = slice(after - 1, after + 1)
                found.append(Event(one.on if one.is_on[after] else one.off, float(time[between].mean()),
                                   float(change[between].mean()),
                                   f"{element.section} {name}" if name in others else name,
                                   float(np.ptp(time[between]) / 2)))
    return found


def _contacts(
    truss: ResolvedTruss, time: np.ndarray, position: np.ndarray, items: dict[str, np.ndarray]
) -> dict[str, Column]:
    found: list[Contacts] = []
    for joint in TOUCHING:
        joints = truss.joints[joint.section]
        changes = _changes(truss, time, joints) if joint.has_temperature else np.zeros((len(time), 0))
        own = {column.name: items[column.name] for column in joint.columns}
        found.append(joint.contacts(Sampled(truss, position, own, changes), joints))
    state = np.concatenate([items[joint.state_column] for joint in TOUCHING], axis=1).astype(np.uint8)

    def together(key: str) -> np.ndarray:
        return np.concatenate([getattr(one, key) for one in found], axis=1)

    return {
        "state": Column(state, items="contacts", labels=CONTACT_STATES),
        "gap_m": Column(together("gap_m"), "m", "contacts", note="of sliders: to the nearer stop; NaN: there is none"),
        "point_m": Column(together("point_m"), "m", "contacts"),
        "normal_force_N": Column(together("normal_force_N"), "N", "contacts", note="on pad or journal"),
        "tangential_force_N": Column(together("tangential_force_N"), "N", "contacts",
                                     note="on pad (with the stops' force) or journal"),
    }


def _states(states: Mapping[str, np.ndarray]) -> dict[str, np.ndarray]:
    """Return the states of contacts by column name, converted from the statuses of the engine."""
    return {joint.state_column: STATES[states[f"{joint.section}_status"].astype(int)] for joint in TOUCHING}


def _heat(states: Mapping[str, np.ndarray]) -> np.ndarray:
    """Return the frictional heat since the start [J] (states, contacts)."""
    return np.concatenate([states[f"{joint.section}_dissipation_J"] for joint in TOUCHING], axis=1)


def _heat_without_contact(states: Mapping[str, np.ndarray]) -> dict[str, np.ndarray]:
    """Return the frictional heat since the start [J] (states, joints) of joint types without contacts."""
    heats = {f"{joint.section}_dissipation_J": joint for joint in JOINTS if not joint.has_contacts}
    return {key: states[key] for key in heats if states[key].shape[1]}


def _heat_columns(heats: Mapping[str, np.ndarray]) -> dict[str, Column]:
    items = {f"{joint.section}_dissipation_J": joint.items for joint in JOINTS}
    return {key: Column(values, "J", items[key], note=HEAT) for key, values in heats.items()}


def sample_times(case: TrussCase) -> np.ndarray:
    """Return the times of the DEM's samples [s]."""
    cycles = case.thermal.cycles
    return np.linspace(0, case.period_s * cycles, case.samples_per_cycle * cycles + 1)


def reduced_run(case: TrussCase, path: TrussPath, times_s: np.ndarray) -> Run:
    """Return the quasi-static path at given times [s], interpolated linearly between its states."""
    states = path.states
    at = states["time_s"]
    times_s = np.asarray(times_s, dtype=float)

    def sampled(values: np.ndarray) -> np.ndarray:
        place = np.clip(np.searchsorted(at, times_s, side="right") - 1, 0, max(len(at) - 2, 0))
        length = np.diff(at)[place]
        share = np.clip(np.divide(times_s - at[place], length, out=np.zeros_like(times_s), where=length > 0), 0, 1)
        share = share.reshape(-1, *(1,) * (values.ndim - 1))
        return (1 - share) * values[place] + share * values[place + 1]

    # The status of a state is that of the increment ending there.
    ending = np.clip(np.searchsorted(at, times_s, side="left"), 0, len(at) - 1)
    items = {key: sampled(states[key]) for key in ITEMS}
    items |= {key: values[ending] for key, values in _states(states).items()}
    items |= {key: sampled(states[key]) for key in ROTATIONS if key in states}
    heat = heat_of_joints_J(states).sum(axis=1)
    plain, energy = columns_of({
        "time_s": times_s,
        "temperature_change_K": sampled(states["temperature_change_K"]),
        "elastic_energy_J": sampled(states["elastic_energy_J"]),
        "friction_dissipation_J": sampled(heat),
        "thermal_work_J": sampled(states["thermal_work_J"]),
        "external_work_J": sampled(states["load_potential_J"][0] - states["load_potential_J"]),
    })
    summary = {**_start_friction(path.truss, states), "energy_residue_J": path.energy_residue_J,
               "solves": float(path.solves), "unknowns": float(path.unknowns)}
    beyond = notes.warnings(path.truss.links, at, states["temperature_change_K"], states["axial_force_N"])
    if len(at) == len(path.cycle_ends["time_s"]):
        beyond = (*beyond, "of this long path the ends of cycles are kept: loads of links between them are not checked")
    beyond = (*beyond, *_taken_together(case, path), *notes.sentences(path.truss, path.notes))
    run = _run(case, "reduced", plain, energy, items, lambda: _events(case, path), summary, native=path,
               warnings=beyond, dense=(at, states["displacement_m"]),
               sampler=lambda times: reduced_run(case, path, times))
    others = _heat_columns({key: sampled(values) for key, values in _heat_without_contact(states).items()})
    heat_of_joints = Column(sampled(_heat(states)), "J", "contacts", note=HEAT)
    if "rotation_rad" in states:
        others["rotation_rad"] = Column(sampled(states["rotation_rad"]), "rad", "nodes", note="rotation vector")
    return replace(run, history={**run.history, **others}, contacts={**run.contacts, "dissipation_J": heat_of_joints})


def _taken_together(case: TrussCase, path: TrussPath) -> tuple[str, ...]:
    """Return warnings about a path whose events are not located. If two joints change within one increment, their order
    is unknown, and a third joint may have slipped back and forth without a trace. If events are located, the solver
    itself notes those that it passes."""
    if case.reduced_settings.locate_events:
        return ()
    # Changes that affect the state are located even then, within 1.5 tolerances of a branch.
    located = 2 * case.reduced_settings.event_tolerance * float(path.states["time_s"][-1])
    found = path.events
    within = found.interval_s > located
    changed = np.unique(np.stack([part[within] for part in (found.time_s, found.kind, found.joint)]), axis=1)
    together = np.count_nonzero(np.unique(changed[0], return_counts=True)[1] > 1)
    if not together:
        return ()
    increments = "1 increment" if together == 1 else f"{together} increments"
    return (Note("changes_together", increments=increments, number=int(together)),)


def motion_run(case: TrussCase, motion: TrussMotion) -> Run:
    """Return the motion of a case as a run of the reduced model, at the times of the DEM's samples."""
    states = motion.states
    items = {key: states[key] for key in (*ITEMS, *ROTATIONS) if key in states} | _states(states)
    of_joints = _heat(states)
    plain, energy = columns_of({
        **{key: states[key] for key in (
            "time_s", "temperature_change_K", "elastic_energy_J", "kinetic_energy_J", "damping_dissipation_J",
            "impact_dissipation_J", "thermal_work_J")},
        "friction_dissipation_J": heat_of_joints_J(states).sum(axis=1),
        "external_work_J": states["load_potential_J"][0] - states["load_potential_J"] + states["drive_work_J"],
    })
    summary = {
        **_start_friction(motion.truss, states),
        "energy_residue_J": compare.energy_residual(energy), "time_step_s": motion.time_step_s,
        "contact_problems": float(motion.iterations), "negative_dissipation_J": motion.negative_dissipation_J,
        "unknowns": float(motion.unknowns), "steps": float(motion.steps),
        "rejected_steps": float(motion.rejected_steps),
    }
    run = _run(case, "reduced", plain, energy, items, lambda: _events(case, motion), summary, native=motion,
               warnings=(*motion.warnings, *without_modes(case.resolve()), *_beyond(case, plain, items)))
    velocity = Column(states["velocity_m_per_s"], "m/s", "nodes")
    heat = Column(of_joints, "J", "contacts", note=HEAT)
    moments = {} if not case.drive else {
        "drive_moment_N_m": Column(states["drive_moment_N_m"], "N m", "drives", note="on the link, anticlockwise")}
    others = _heat_columns(_heat_without_contact(states))
    return replace(run, history={**run.history, **others, "velocity_m_per_s": velocity, **moments},
                   contacts={**run.contacts, "dissipation_J": heat})


def _events(case: TrussCase, path: TrussPath | TrussMotion) -> list[Event]:
    truss, at = path.truss, path.states["time_s"]
    joints, slipped, events = every_joint_name(truss), set(), []
    for event in path.events:
        name = joints[event.joint_kind, event.name]
        before, after = STATE_OF[event.before], STATE_OF[event.after]
        # A path without located events knows the time of some events only to an increment.
        half = event.interval_s / 2 if event.interval_s > LOCATED * case.period_s else 0.0
        if before != after:
            change = float(np.interp(event.time_s - half, at, path.states["temperature_change_K"])) if half else (
                event.temperature_change_K)
            events.append(Event(kind_of(before, after, name in slipped), event.time_s - half, change, name, half))
        if after == SLIP:
            slipped.add(name)
    return events


def dem_run(case: TrussCase, columns: Columns, about: Mapping[str, Any]) -> Run:
    """Return a DEM run; its events are between samples."""
    samples = len(columns["time_s"])
    items, listed = {}, names(case)
    states = {joint.state_column: (joint.items, False) for joint in STICKING}
    for key, (of, vector) in {**ITEMS, **states}.items():
        ends = (".x", ".y", ".z") if vector else ("",)
        found = [columns[f"{key}[{name}]{end}"] for name in listed.get(of, ()) for end in ends]
        values = np.stack(found, axis=1) if found else np.zeros((samples, 0))
        items[key] = values.reshape(samples, -1, 3) if vector else values
    turned = {key: np.stack([columns[f"{key}[{name}]{end}"] for name in listed["nodes"] for end in (".x", ".y", ".z")],
                            axis=1).reshape(samples, -1, 3)
              for key in ROTATIONS if f"{key}[{listed['nodes'][0]}].x" in columns}
    items |= turned
    plain, energy = columns_of({name: values for name, values in columns.items() if "[" not in name})
    summary = {**_start_friction(case.resolve(), items), **numbers_of(about),
               "energy_residue_J": compare.energy_residual(energy)}

    def happened() -> list[Event]:
        truss = case.resolve()
        called = every_joint_name(truss)
        found = np.concatenate([items[joint.state_column] for joint in STICKING], axis=1)
        return from_states(plain["time_s"].values, plain["temperature_change_K"].values, found,
                           [called[joint.section, name] for joint in STICKING
                            for name in truss.joints[joint.section].names])

    run = _run(case, "dem", plain, energy, items, happened, summary, about=about, warnings=_beyond(case, plain, items))
    return replace(run, history={**run.history, **{key: Column(values, "rad", "nodes", note="rotation vector")
                                                   for key, values in turned.items()}})


def _beyond(case: TrussCase, plain: Mapping[str, Column], items: Mapping[str, np.ndarray]) -> tuple[str, ...]:
    """Return warnings about links that could not carry their forces at some samples."""
    return notes.warnings(case.resolve().links, plain["time_s"].values, plain["temperature_change_K"].values,
                          items["axial_force_N"])
