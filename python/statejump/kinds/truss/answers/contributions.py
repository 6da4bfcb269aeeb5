# SPDX-License-Identifier: GPL-3.0-or-later
"""Contributions of the joints to the jump of a truss: the effect that their friction forces have on the truss with
frictionless joints."""
from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from statejump.core.progress import OnProgress
from statejump.kinds.truss.answers.outputs import Output
from statejump.kinds.truss.body_points import displacements_m
from statejump.kinds.truss.joints import JOINTS
from statejump.kinds.truss.joints.protocol import Loads
from statejump.kinds.truss.resolved import ResolvedTruss
from statejump.kinds.truss.solve import TrussPath, whole_path


@dataclass(frozen=True)
class Contributions:
    """Contribution of every joint to the jump of an output. ``sum_error`` is the sum of all contributions divided by
    the jump, minus 1."""

    names: tuple[str, ...]
    kinds: tuple[str, ...]
    contribution: np.ndarray
    jump: float
    reproduced: float  # jump that all friction forces together reproduce
    notes: tuple[str, ...]

    @property
    def sum_error(self) -> float:
        """Relative difference between the sum of contributions and the jump."""
        return float(abs(self.contribution.sum() - self.jump) / max(abs(self.jump), 1e-300))

    @property
    def order(self) -> np.ndarray:
        """Joints, the largest contribution first."""
        return np.argsort(-np.abs(self.contribution), kind="stable")


def friction_loads(truss: ResolvedTruss, state: Mapping[str, np.ndarray]) -> np.ndarray:
    """Return nodal forces [N] (joints, nodes, 3) that represent the friction of each joint in a state of the truss.
    Joints are sorted by type. A joint with unknown friction has zero forces."""
    place = truss.nodes.position_m + state["displacement_m"]
    found = []
    for joint in JOINTS:
        joints = truss.joints[joint.section]
        loads = Loads(truss, np.zeros((len(joints.names), *place.shape)), place)
        joint.add_friction(loads, joints, state)
        found.append(loads.force_N)
    return np.concatenate(found)


def without_friction(truss: ResolvedTruss) -> ResolvedTruss:
    """Return the truss with frictionless joints and with all temperatures held at ΔT = 0."""
    for joint in JOINTS:
        truss = joint.without_friction(truss)
    beams, bodies = truss.elements["beam"], truss.elements["body"]
    truss = truss.with_elements(
        beam=replace(beams, temperature_fraction=0 * beams.temperature_fraction,
                     gradient_per_m=0 * beams.gradient_per_m),
        body=replace(bodies, temperature_fractions=tuple(0 * one for one in bodies.temperature_fractions)))
    # No item uses the programs any more, but all programs must have one duration.
    return replace(truss, links=replace(truss.links, temperature_fraction=0 * truss.links.temperature_fraction),
                   programs=len(truss.programs) * (truss.programs[0].repeated(1),))


def turning_joint(truss: ResolvedTruss) -> tuple[str, str] | None:
    """Return the type and name of a joint whose friction is a moment on a node that rotates; None if there is none.
    Nodes carry no moments in the truss without friction."""
    if truss.bending() is None:
        return None
    return next(((joint.section, truss.joints[joint.section].names[0]) for joint in JOINTS
                 if truss.joints[joint.section].names and not joint.rubs_at_nodes), None)


def contributions(
    found: TrussPath, output: Output, on_progress: OnProgress = lambda share: None
) -> Contributions:
    """Return the contribution of each joint's friction to the jump of an output.

    At the end of the cycles, friction keeps the truss from its initial shape. The truss with frictionless joints,
    loaded by the friction forces, is in equilibrium in the same shape. Let f_j be the change of the friction force of
    joint j since the start, F0 and F1 the forces of all joints at start and end, and y the output of the truss with
    frictionless joints. The contribution of joint j is the mean of two differences: f_j added to the initial forces,
    y(F0 + f_j) - y(F0), and f_j added last, y(F1) - y(F1 - f_j). The sum of contributions equals the jump exactly if
    the truss is linear, otherwise up to an error of third order.

    :raises FailedRun: the truss with frictionless joints is a mechanism or has no equilibrium
    """
    truss, ends = found.truss, found.cycle_ends
    free = without_friction(truss)
    states = [{name: values[index] for name, values in ends.items()} for index in (0, -1)]
    start, end = (friction_loads(truss, state) for state in states)

    def value(load: np.ndarray) -> float:
        loaded = replace(free, nodes=replace(free.nodes, force_N=free.nodes.force_N + load))
        found = whole_path(loaded, increments_per_branch=1, locate_events=False)
        last = {name: values[-1:] for name, values in found.states.items()}
        return output.value(displacements_m(found.truss, last)[0])

    first, last = value(start.sum(axis=0)), value(end.sum(axis=0))
    shares = np.zeros(len(start))
    for joint, change in enumerate(end - start):
        if change.any():
            alone = value(start.sum(axis=0) + change) - first
            shares[joint] = 0.5 * (alone + last - value(end.sum(axis=0) - change))
        on_progress((joint + 1) / len(start))
    joints = [(joint, truss.joints[joint.section]) for joint in JOINTS]
    names = tuple(name for _, own in joints for name in own.names)
    kinds = tuple(joint.section for joint, own in joints for _ in own.names)
    notes = [f"{joint.section} {own.names[index]} rests at a stop: what of its force is friction is not known"
             for joint, own in joints
             for index in sorted({index for state in states for index in joint.unknown_friction(own, state)})]
    return Contributions(names, kinds, shares, output.jump(found), last - first, tuple(notes))
