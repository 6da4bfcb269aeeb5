# SPDX-License-Identifier: GPL-3.0-or-later
"""Outputs of a truss whose jump is divided among the joints: motion of a node, error and tilt of a surface."""
from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from statejump.core.errors import NotAllowed
from statejump.kinds.truss.answers import reflector
from statejump.kinds.truss.answers.jumps import most_moved, node_jumps, rounding_m
from statejump.kinds.truss.body_points import displacements_m
from statejump.kinds.truss.references import known_name
from statejump.kinds.truss.solve import TrussPath


@dataclass(frozen=True)
class Output:
    """An output of a truss whose jump is divided among the joints.

    :param short: short name of the output
    :param value: the output as a function of displacements (n, 3) of nodes and points of bodies, projected on the
        direction of the jump
    :param vector: all components of the output as a function of displacements
    """

    name: str
    text: str
    short: str
    unit: str
    value: Callable[[np.ndarray], float]
    vector: Callable[[np.ndarray], np.ndarray]

    def jump(self, found: TrussPath) -> float:
        """Return its jump over all cycles."""
        ends = cycle_ends_m(found)
        return self.value(ends[-1]) - self.value(ends[0])

    def over_cycles(self, found: TrussPath) -> np.ndarray:
        """Return the change of the vector over each cycle (cycles, components)."""
        return np.diff([self.vector(moved) for moved in cycle_ends_m(found)], axis=0)

    @staticmethod
    def sizes(motion: np.ndarray) -> np.ndarray:
        """Return the lengths of changes of the vector, see :meth:`over_cycles`."""
        return np.linalg.norm(motion, axis=1)

    def rounding(self, found: TrussPath) -> float:
        """Return the largest change that counts as rounding; for a tilt [rad] it is relative to the truss size."""
        size = float(np.ptp(found.truss.nodes.position_m, axis=0).max())
        return rounding_m(found) / size if self.unit == "rad" else rounding_m(found)


def cycle_ends_m(found: TrussPath) -> np.ndarray:
    """Return the displacements (cycles + 1, n, 3) of nodes, and of points of bodies, at the ends of the cycles [m]."""
    return displacements_m(found.truss, found.cycle_ends)


def node_output(found: TrussPath, name: str | None = None) -> Output:
    """Return the output "displacement [m] of a node along its jump"; without a name, that of the node that moves most.

    :raises NotAllowed: the node does not exist
    """
    names = found.truss.nodes.names
    if name is not None:
        known_name("output", f"node:{name}", name, dict.fromkeys(names), "node", case=found.truss.name)
    index = most_moved(found) if name is None else names.index(name)
    jump = node_jumps(found)[-1, index]
    size = float(np.linalg.norm(jump))
    way = jump / size if size > 0 else np.array([1.0, 0.0, 0.0])
    which = "most moved node" if name is None else "node"
    return Output(f"node:{names[index]}", f"displacement of the {which} {names[index]} along its jump",
                  f"node {names[index]}", "m", lambda moved: float(moved[index] @ way), lambda moved: moved[index])


def rms_output(found: TrussPath, surface: reflector.Surface) -> Output:
    """Return the output "RMS [m] over the surface of how the best-fit residuals change"."""
    ends = cycle_ends_m(found)
    start = surface.fit(ends[0]).residual_m
    change = surface.fit(ends[-1]).residual_m - start
    size = float(np.linalg.norm(change))
    nodes = np.sqrt(len(change))
    way = change / (size * nodes) if size > 0 else 0 * change
    return Output("rms", "RMS of the surface's change against its best fit", "the surface", "m",
                  lambda moved: float((surface.fit(moved).residual_m - start) @ way),
                  lambda moved: surface.fit(moved).residual_m / nodes)


def tilt_output(found: TrussPath, surface: reflector.Surface) -> Output:
    """Return the tilt [rad] of the surface along its jump."""
    ends = cycle_ends_m(found)
    change = surface.fit(ends[-1]).tilt_rad - surface.fit(ends[0]).tilt_rad
    size = float(np.linalg.norm(change))
    way = change / size if size > 0 else 0 * change
    return Output("tilt", "tilt of the surface along its jump", "the surface", "rad",
                  lambda moved: float(surface.fit(moved).tilt_rad @ way), lambda moved: surface.fit(moved).tilt_rad)


def chosen_output(found: TrussPath, name: str) -> Output:
    """Return the output with the given name: ``node`` (the node that moves most), ``node:NAME``, ``rms`` or ``tilt``.

    :raises NotAllowed: the name is not that of an output
    """
    if name == "node" or name.startswith("node:"):
        return node_output(found, name[5:] or None if name != "node" else None)
    if name not in ("rms", "tilt"):
        raise NotAllowed("output", name, code="output_unknown", allowed=("node", "node:NAME", "rms", "tilt"))
    surface = reflector.surface(found.truss)
    if surface is None:
        raise NotAllowed("output", name, code="no_fit")
    return rms_output(found, surface) if name == "rms" else tilt_output(found, surface)
