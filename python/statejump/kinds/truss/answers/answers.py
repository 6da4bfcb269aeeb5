# SPDX-License-Identifier: GPL-3.0-or-later
"""What a designer asks of a truss: jumps after each cycle, whether they settle, which joints cause them.

Displacements are those of the quasi-static path; a jump is the displacement at the end of a cycle less
that at the start.
"""
from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, Callable, Optional

import numpy as np

from statejump.core import units
from statejump.core.errors import StatejumpError
from statejump.kinds.truss.answers import reflector
from statejump.kinds.truss.resolved import GROUND, ResolvedTruss
from statejump.kinds.truss.solve import TrussPath, path

STOPS = (3, 4)  # statuses of a slider at a stop, as the engine numbers them
# A jump of a cycle below this share of the largest has settled: events are located to 1e-9 of a branch.
SETTLED = 1e-6
STEADY = 0.01  # two jumps that differ by less are the same growth


@dataclass(frozen=True)
class Output:
    """One number of the truss' shape whose jump is traced to the joints."""

    name: str
    text: str
    unit: str
    value: Callable[[np.ndarray], float]  # of displacements (nodes, 3)

    def jump(self, found: TrussPath) -> float:
        """Return its jump over all cycles."""
        ends = found.cycle_ends["displacement_m"]
        return self.value(ends[-1]) - self.value(ends[0])


@dataclass(frozen=True)
class Verdict:
    """Whether jumps settle over the cycles."""

    word: str  # "no jump", "one cycle", "shakedown", "ratcheting", "not settled"
    text: str
    cycle_jump_m: np.ndarray  # (cycles,) largest motion of a node over each cycle
    dissipation_J: np.ndarray  # (cycles,)


@dataclass(frozen=True)
class Contributions:
    """Share of every joint in the jump of an output. ``sum_error``: sum over the jump, less one."""

    names: tuple[str, ...]
    kinds: tuple[str, ...]
    contribution: np.ndarray
    jump: float
    reproduced: float  # jump that all friction forces together give back
    notes: tuple[str, ...]

    @property
    def sum_error(self) -> float:
        """Relative difference of the sum from the jump."""
        return float(abs(self.contribution.sum() - self.jump) / max(abs(self.jump), 1e-300))

    @property
    def order(self) -> np.ndarray:
        """Joints, the largest contribution first."""
        return np.argsort(-np.abs(self.contribution), kind="stable")


def quick_path(truss: ResolvedTruss, increments_per_branch: int = 50, **more: Any) -> TrussPath:
    """Return the path with only those events located on which the state depends: the same cycle ends."""
    return path(truss, increments_per_branch=increments_per_branch, locate_events=False, **more)


def node_jumps(found: TrussPath) -> np.ndarray:
    """Return the jump [m] (cycles, nodes, 3) of every node after each cycle, against the start."""
    ends = found.cycle_ends["displacement_m"]
    return ends[1:] - ends[0]


def most_moved(found: TrussPath) -> int:
    """Return the node with the largest jump at the end."""
    return int(np.argmax(np.linalg.norm(node_jumps(found)[-1], axis=1)))


def _cycle_jumps(found: TrussPath) -> np.ndarray:
    return np.linalg.norm(np.diff(found.cycle_ends["displacement_m"], axis=0), axis=2).max(axis=1)


def resolution_m(found: TrussPath, finer: TrussPath) -> float:
    """Return by how much [m] the jumps of cycles after the first depend on the increments, against a path of
    more of them. 0 for one cycle."""
    return float(np.abs(_cycle_jumps(found) - _cycle_jumps(finer))[1:].max(initial=0.0))


def verdict(found: TrussPath, resolution: float = 0.0) -> Verdict:
    """Return whether the jumps of later cycles vanish, go on, or shrink.

    :param resolution: jumps [m] below twice this are numerical, see :func:`resolution_m`
    """
    ends = found.cycle_ends
    each = _cycle_jumps(found)
    heat = np.diff(ends["slider_dissipation_J"].sum(axis=1) + ends["revolute_dissipation_J"].sum(axis=1))
    largest = float(np.abs(found.states["displacement_m"]).max())
    floor = 1e-12 * max(largest, 1e-300)

    def made(word: str, text: str) -> Verdict:
        return Verdict(word, text, each, heat)

    if each.max() <= floor:
        return made("no jump", "no node jumps: the truss returns after every cycle")
    if len(each) == 1:
        return made("one cycle", "one cycle: whether the jump settles needs more, see --cycles")
    first, last, before = each[0], each[-1], each[-2]
    least = max(SETTLED * each.max(), floor, 2 * resolution)
    if last <= least:
        settled = int(np.flatnonzero(each > min(least, 0.5 * each.max()))[-1]) + 1
        slip = heat[-1] > SETTLED * heat.max() if heat.max() > 0 else False
        return made("shakedown", f"the jump settles after cycle {settled}; " + (
            f"joints still slip there and back, {units.plain(heat[-1], 'J', 4)} per cycle" if slip else "then no joint slips"))
    if len(each) > 2 and abs(last - before) <= STEADY * last:
        return made("ratcheting", f"the jump grows by {units.plain(last, 'm', 4)} per cycle (cycle {len(each)}; first cycle "
                    f"{units.plain(first, 'm', 4)})")
    return made("not settled", f"the jump of cycle {len(each)} is {100 * last / first:.3g} % of the first cycle's: "
                "neither settled nor steady, more cycles are needed")


def node_output(found: TrussPath, name: Optional[str] = None) -> Output:
    """Return the displacement [m] of a node along its jump; the most moved node without a name.

    :raises StatejumpError: there is no such node
    """
    names = found.truss.nodes.names
    if name is not None and name not in names:
        raise StatejumpError(f"{found.truss.name}: node {name!r} is unknown")
    index = most_moved(found) if name is None else names.index(name)
    jump = node_jumps(found)[-1, index]
    size = float(np.linalg.norm(jump))
    way = jump / size if size > 0 else np.array([1.0, 0.0, 0.0])
    which = "most moved node" if name is None else "node"
    return Output(f"node:{names[index]}", f"displacement of the {which} {names[index]} along its jump", "m",
                  lambda moved: float(moved[index] @ way))


def rms_output(found: TrussPath, surface: reflector.Surface) -> Output:
    """Return the RMS [m] over the surface of what the jump changes in the residuals of the best fit."""
    ends = found.cycle_ends["displacement_m"]
    start = surface.fit(ends[0]).residual_m
    change = surface.fit(ends[-1]).residual_m - start
    size = float(np.linalg.norm(change))
    way = change / (size * np.sqrt(len(change))) if size > 0 else 0 * change
    return Output("rms", "RMS of the surface's change against its best fit", "m",
                  lambda moved: float((surface.fit(moved).residual_m - start) @ way))


def tilt_output(found: TrussPath, surface: reflector.Surface) -> Output:
    """Return the tilt [rad] of the surface along its jump."""
    ends = found.cycle_ends["displacement_m"]
    change = surface.fit(ends[-1]).tilt_rad - surface.fit(ends[0]).tilt_rad
    size = float(np.linalg.norm(change))
    way = change / size if size > 0 else 0 * change
    return Output("tilt", "tilt of the surface along its jump", "rad", lambda moved: float(surface.fit(moved).tilt_rad @ way))


def chosen_output(found: TrussPath, name: str) -> Output:
    """Return the output of a name: ``node`` (most moved), ``node:NAME``, ``rms``, ``tilt``.

    :raises StatejumpError: there is none
    """
    if name == "node" or name.startswith("node:"):
        return node_output(found, name[5:] or None if name != "node" else None)
    if name not in ("rms", "tilt"):
        raise StatejumpError(f"--output = {name!r} is not allowed: must be 'node', 'node:NAME', 'rms' or 'tilt'")
    surface = reflector.surface(found.truss)
    if surface is None:
        raise StatejumpError(f"--output = {name!r} is not allowed: the truss has no [reflector] whose nodes determine a fit")
    return rms_output(found, surface) if name == "rms" else tilt_output(found, surface)


def _turning(force: np.ndarray, truss: ResolvedTruss, places: np.ndarray, link: int, moment: np.ndarray) -> None:
    """Add a moment on a link as a pair of forces on its nodes."""
    if link == GROUND:
        return
    one, two = truss.links.nodes[link]
    along = places[two] - places[one]
    pair = np.cross(moment, along) / (along @ along)
    force[two] += pair
    force[one] -= pair


def friction_loads(truss: ResolvedTruss, state: dict[str, np.ndarray], index: int) -> np.ndarray:
    """Return the nodal forces [N] (joints, nodes, 3) that stand for the friction of each joint in a state:
    sliders, then revolutes; a revolute's with the moments on its links. A slider at a stop has none: what
    of its force is friction is not known."""
    sliders, revolutes = truss.sliders, truss.revolutes
    places = truss.nodes.position_m + state["displacement_m"][index]
    loads = np.zeros((len(sliders.names) + len(revolutes.names), len(truss.nodes.names), 3))
    for joint, ((one, two), axis) in enumerate(zip(sliders.nodes, sliders.axis)):
        if state["slider_status"][index, joint] in STOPS:
            continue
        along = state["slider_force_N"][index, joint] * axis
        loads[joint, one] -= along
        if two != GROUND:
            loads[joint, two] += along
    # The radii meet in the middle of the depth; at the ends of cycles ΔT = 0.
    for joint in range(len(revolutes.names)):
        load = loads[len(sliders.names) + joint]
        centre = state["eccentricity_m"][index, joint]
        distance = float(np.linalg.norm(centre))
        friction = state["friction_force_N"][index, joint]
        if friction == 0 or distance == 0:
            continue
        normal, axis = centre / distance, revolutes.axis[joint]
        tangent = np.cross(axis, normal)
        depth = max(distance - revolutes.radial_clearance_m[joint], 0.0)
        radius = revolutes.journal_radius_m[joint] - depth / 2
        load[revolutes.journal_node[joint]] -= friction * tangent
        load[revolutes.bearing_node[joint]] += friction * tangent
        _turning(load, truss, places, revolutes.journal_link[joint], -friction * radius * axis)
        _turning(load, truss, places, revolutes.bearing_link[joint], friction * (radius + distance) * axis)
    return loads


def without_friction(truss: ResolvedTruss) -> ResolvedTruss:
    """Return the truss with frictionless joints that stays at ΔT = 0."""
    return replace(
        truss,
        links=replace(truss.links, temperature_fraction=0 * truss.links.temperature_fraction),
        sliders=replace(truss.sliders, friction_coefficient=0 * truss.sliders.friction_coefficient),
        revolutes=replace(truss.revolutes, friction_coefficient=0 * truss.revolutes.friction_coefficient,
                          temperature_fraction=0 * truss.revolutes.temperature_fraction),
        programs=tuple(program.copy(update={"cycles": 1}) for program in truss.programs),
    )


def contributions(
    found: TrussPath, output: Output, progress: Callable[[float], Any] = lambda fraction: None
) -> Contributions:
    """Return how much of an output's jump the friction of each joint holds.

    At the end of the cycles the truss is away from where it began because friction holds it there: it is
    in equilibrium, its joints frictionless, under the friction forces as loads. The contribution of a
    joint is the effect on the output of the change f_j of its friction force since the start, on the truss
    with frictionless joints: the mean of its effect alone, y(F0 + f_j) - y(F0), and of its effect as the
    last, y(F1) - y(F1 - f_j), with F0 and F1 the forces of all joints at start and end. Contributions
    add up to the jump exactly where the truss is linear, and with an error of third order elsewhere.

    :raises StatejumpError: without friction the truss is a mechanism or has no equilibrium
    """
    truss, ends = found.truss, found.cycle_ends
    free = without_friction(truss)
    start, end = (friction_loads(truss, ends, index) for index in (0, -1))

    def value(load: np.ndarray) -> float:
        loaded = replace(free, nodes=replace(free.nodes, force_N=free.nodes.force_N + load))
        return output.value(path(loaded, increments_per_branch=1, locate_events=False).states["displacement_m"][-1])

    first, last = value(start.sum(axis=0)), value(end.sum(axis=0))
    shares = np.zeros(len(start))
    for joint, change in enumerate(end - start):
        if change.any():
            alone = value(start.sum(axis=0) + change) - first
            shares[joint] = 0.5 * (alone + last - value(end.sum(axis=0) - change))
        progress((joint + 1) / len(start))
    names = (*truss.sliders.names, *truss.revolutes.names)
    kinds = ("slider",) * len(truss.sliders.names) + ("revolute",) * len(truss.revolutes.names)
    stopped = np.isin(ends["slider_status"][[0, -1]], STOPS).any(axis=0)
    notes = [f"slider {truss.sliders.names[index]} rests at a stop: what of its force is friction is not known"
             for index in np.flatnonzero(stopped)]
    return Contributions(names, kinds, shares, output.jump(found), last - first, tuple(notes))
