# SPDX-License-Identifier: GPL-3.0-or-later
"""Outputs of a truss that are bounded: displacements of nodes along the axes."""
from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from statejump.core.errors import NotAllowed
from statejump.kinds.truss.bounds.sliding import AXES, Sliding
from statejump.kinds.truss.references import known_name
from statejump.kinds.truss.resolved import ResolvedTruss

SHOWN = 3  # nodes, if no output is chosen
DENSE = 2e7  # entries of the compliance of all dofs for which the most moved nodes are found


@dataclass(frozen=True)
class Output:
    """A displacement of a node along an axis."""

    name: str
    node: int
    axis: int

    def row(self, of: Sliding) -> np.ndarray:
        """Return c of the output c·q."""
        return np.asarray(of.of_nodes[3 * self.node + self.axis].toarray()[0])

    def value(self, displacement_m: np.ndarray) -> np.ndarray:
        """Return the output at displacements (..., nodes, 3)."""
        return np.asarray(displacement_m[..., self.node, self.axis])


def chosen(of: Sliding, names: Sequence[str]) -> list[Output]:
    """Return the outputs of given names, or those of the nodes with the largest spread.

    :raises NotAllowed: a name is not that of a node and a free direction
    """
    if not names:
        return _largest(of)
    return [output for name in names
            for output in named(of.truss, name, lambda dof: bool(abs(of.of_nodes[dof]).sum() > 0))]


def named(truss: ResolvedTruss, name: str, moves: Callable[[int], bool]) -> list[Output]:
    """Return the outputs ``node:NAME.x``, or for ``node:NAME`` those of all free directions of the node.

    :param moves: whether a dof, three per node, is free
    :raises NotAllowed: the name is not that of a node and a free direction
    """
    nodes = truss.nodes.names
    what, _, rest = name.partition(":")
    node, axes = rest, AXES[:truss.dimension]
    if rest not in nodes and rest[-2:-1] == "." and rest[-1] in AXES:
        node, axes = rest[:-2], rest[-1]
    if what != "node":
        raise NotAllowed("output", name, code="bounds_bad_output")
    known_name("output", name, node, dict.fromkeys(nodes), "node", case=truss.name)
    index = nodes.index(node)
    found = [Output(f"node:{node}.{axis}", index, AXES.index(axis)) for axis in axes
             if moves(3 * index + AXES.index(axis))]
    if not found:
        raise NotAllowed("output", name, code="bounds_bad_output")
    return found


def _largest(of: Sliding) -> list[Output]:
    nodes = of.truss.nodes.names
    if of.slides.shape[0] * of.slides.shape[1] > DENSE:
        raise NotAllowed("output", code="bounds_output_missing")
    spread = (np.abs(of.of_nodes[:3 * len(nodes)] @ of.by_friction) @ of.limit_N).reshape(-1, 3)
    axes = spread.argmax(axis=1)
    most = np.argsort(-spread.max(axis=1), kind="stable")[:SHOWN]
    return [Output(f"node:{nodes[node]}.{AXES[axes[node]]}", int(node), int(axes[node]))
            for node in most if spread[node, axes[node]] > 0]
