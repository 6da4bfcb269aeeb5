# SPDX-License-Identifier: GPL-3.0-or-later
"""Which joints hold the jump of a truss: the effect of their friction forces on the truss without friction."""
from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from statejump.core.progress import Tell
from statejump.kinds.truss.answers.outputs import Output
from statejump.kinds.truss.arrays import GROUND
from statejump.kinds.truss.resolved import ResolvedTruss
from statejump.kinds.truss.solve import TrussPath, whole_path

STOPS = (3, 4)  # statuses of a slider at a stop, as the engine numbers them


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
        # Nothing follows them any more, but all have to last equally long.
        programs=len(truss.programs) * (truss.programs[0].repeated(1),),
    ).with_joints(
        slider=replace(truss.sliders, friction_coefficient=0 * truss.sliders.friction_coefficient),
        revolute=replace(truss.revolutes, friction_coefficient=0 * truss.revolutes.friction_coefficient,
                         temperature_fraction=0 * truss.revolutes.temperature_fraction),
    )


def contributions(
    found: TrussPath, output: Output, tell: Tell = lambda share: None
) -> Contributions:
    """Return how much of an output's jump the friction of each joint holds.

    At the end of the cycles the truss is away from where it began because friction holds it there: it is
    in equilibrium, its joints frictionless, under the friction forces as loads. The contribution of a
    joint is the effect on the output of the change f_j of its friction force since the start, on the truss
    with frictionless joints: the mean of its effect alone, y(F0 + f_j) - y(F0), and of its effect as the
    last, y(F1) - y(F1 - f_j), with F0 and F1 the forces of all joints at start and end. Contributions
    add up to the jump exactly where the truss is linear, and with an error of third order elsewhere.

    :raises FailedRun: without friction the truss is a mechanism or has no equilibrium
    """
    truss, ends = found.truss, found.cycle_ends
    free = without_friction(truss)
    start, end = (friction_loads(truss, ends, index) for index in (0, -1))

    def value(load: np.ndarray) -> float:
        loaded = replace(free, nodes=replace(free.nodes, force_N=free.nodes.force_N + load))
        found = whole_path(loaded, increments_per_branch=1, locate_events=False)
        return output.value(found.states["displacement_m"][-1])

    first, last = value(start.sum(axis=0)), value(end.sum(axis=0))
    shares = np.zeros(len(start))
    for joint, change in enumerate(end - start):
        if change.any():
            alone = value(start.sum(axis=0) + change) - first
            shares[joint] = 0.5 * (alone + last - value(end.sum(axis=0) - change))
        tell((joint + 1) / len(start))
    names = (*truss.sliders.names, *truss.revolutes.names)
    kinds = ("slider",) * len(truss.sliders.names) + ("revolute",) * len(truss.revolutes.names)
    stopped = np.isin(ends["slider_status"][[0, -1]], STOPS).any(axis=0)
    notes = [f"slider {truss.sliders.names[index]} rests at a stop: what of its force is friction is not known"
             for index in np.flatnonzero(stopped)]
    return Contributions(names, kinds, shares, output.jump(found), last - first, tuple(notes))
