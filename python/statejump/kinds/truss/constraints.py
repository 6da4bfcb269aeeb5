# SPDX-License-Identifier: GPL-3.0-or-later
"""Linear constraints between displacements and rotations of nodes: multi-point constraints."""
from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from statejump.kinds.truss.arrays import names
from statejump.schema.fields import definition, numbers, texts
from statejump.schema.item_tables import ItemIndex
from statejump.schema.items import Item

AXES = ("x", "y", "z")
TURNS = ("Rx", "Ry", "Rz")  # rotations about them
# The solver cannot distinguish a coefficient below this fraction of the largest one of its constraint from rounding: a
# sum of two coefficients that cancel to 1e-12 counts as zero.
LEAST_COEFFICIENT = 1e-9


@definition
class Constraint(Item):
    """A sum of displacements [m] and rotations [rad] that is always zero: for each term a coefficient times the
    displacement of a node along an axis, or its rotation about an axis. The same as ``MPC`` of Nastran and
    ``*EQUATION`` of CalculiX."""

    nodes: list[str] = texts(..., "the node of each term")
    directions: list[str] = texts(
        ..., "the direction of each term; Rx, Ry, Rz: rotation, where beams, bodies or hinges rotate the node",
        (*AXES, *TURNS))
    coefficients: list[float] = numbers(
        ..., "-", -1e12, 1e12, "the coefficient of each term, not 0; m beside rotations if others are displacements")


@dataclass(frozen=True)
class Constraints:
    """Constraints as arrays."""

    names: Sequence[str]
    nodes: tuple[np.ndarray, ...]  # (terms,) int of each
    turns: tuple[np.ndarray, ...]  # (terms,) bool for each constraint: whether a term is that of a rotation
    coefficients: tuple[np.ndarray, ...]  # (terms, 3) for each constraint: coefficients along x, y and z

    def __add__(self, others: Constraints) -> Constraints:
        """Return all constraints of both."""
        return Constraints((*self.names, *others.names), (*self.nodes, *others.nodes), (*self.turns, *others.turns),
                           (*self.coefficients, *others.coefficients))

    def sites(self, count: int) -> list[np.ndarray]:
        """Return the engine's numbers of the terms: nodes, and behind all of them their rotations.

        :param count: number of nodes
        """
        return [nodes + count * turns.astype(np.int32) for nodes, turns in zip(self.nodes, self.turns)]

    def pairs(self) -> np.ndarray:
        """Return pairs of nodes (k, 2) that link all nodes of each constraint, as edges of a graph. Equal rotations do
        not hold displacements."""
        found = [np.stack((one, np.roll(one, 1)), axis=1) for one, turns in zip(self.nodes, self.turns)
                 if not turns.all()]
        return np.concatenate(found) if found else np.zeros((0, 2), dtype=np.int32)

    def grounded(self) -> np.ndarray:
        """Return the nodes of constraints that a rigid translation of the truss violates; such constraints are
        supports."""
        found = [nodes[~turns] for nodes, turns, of in zip(self.nodes, self.turns, self.coefficients)
                 if np.linalg.norm(of[~turns].sum(axis=0)) > LEAST_COEFFICIENT * np.abs(of[~turns]).max(initial=0.0)]
        return np.concatenate(found) if found else np.zeros(0, dtype=np.int32)


def resolve_constraints(items: Sequence[Constraint], nodes: ItemIndex) -> Constraints:
    """Return the constraints as arrays."""
    axes = np.eye(3)
    return Constraints(
        names(items), tuple(nodes.called(item.nodes).astype(np.int32) for item in items),
        tuple(np.array([direction in TURNS for direction in item.directions]) for item in items),
        tuple(np.array(item.coefficients)[:, None] * axes[["xyz".index(direction[-1]) for direction in item.directions]]
              for item in items))
