# SPDX-License-Identifier: GPL-3.0-or-later
"""Means: a reference node follows the weighted mean displacement and the best-fit rotation of other nodes.

With the weights w, the vectors r from the weighted centre to the nodes, W = Σ w and J = Σ w (r² I - r rᵀ), the mean
rotation is J⁻¹ Σ w r × u. The rotation of the reference equals it. The displacement of the reference is the mean
Σ w u/W plus that of its arm from the centre under the mean rotation. Loads of the reference act on the nodes.
"""
from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from statejump.core.notes import Note
from statejump.kinds.truss.arrays import names
from statejump.kinds.truss.constraints import AXES, LEAST_COEFFICIENT, TURNS, Constraints
from statejump.schema.fields import definition, numbers, text, texts
from statejump.schema.item_tables import ItemIndex
from statejump.schema.items import Item

ALL = (*AXES, *TURNS)
PLANAR = ("x", "y", "Rz")  # directions in a planar truss
# Sine of the angle below which nodes are on one line: coordinates have at least six digits.
ONE_LINE = 1e-6
# Error of the reference over its largest displacement, from which on a run notes that a mean is linear.
NOTABLE = 0.01


@definition
class Mean(Item):
    """A reference node that follows the weighted mean of the displacements of other nodes and their best-fit rotation,
    and that distributes its loads over them. The same as ``RBE3`` of Nastran and ``*DISTRIBUTING`` of Abaqus. It is
    linear, so rotations must be small."""

    reference: str = text(..., "the node that follows")
    nodes: list[str] = texts(..., "the nodes whose mean it follows")
    weights: list[float] | None = numbers(None, "-", 0, 1e12, "of each node, above 0; equal")
    directions: list[str] = texts(list(ALL), "displacements and rotations of the reference that follow", ALL)

    def follows(self, dimension: int) -> list[str]:
        """Return the directions that exist in a truss."""
        return [one for one in (PLANAR if dimension == 2 else ALL) if one in self.directions]

    def turns(self, dimension: int) -> list[str]:
        """Return the axes about which the reference follows."""
        return [one[-1] for one in self.follows(dimension) if one in TURNS]


@dataclass(frozen=True)
class Cloud:
    """The nodes of a mean."""

    reference: int
    nodes: np.ndarray  # (k,) int
    fractions: np.ndarray  # (k,) weights over their sum
    arms_m: np.ndarray  # (k, 3) from the centre to the nodes
    lever_m: np.ndarray  # (3,) from the centre to the reference

    @property
    def inertia_m2(self) -> np.ndarray:
        """The matrix J over the sum of weights (3, 3)."""
        squares = np.einsum("i,ij,ij->", self.fractions, self.arms_m, self.arms_m)
        return np.asarray(squares * np.eye(3) - np.einsum("i,ij,ik->jk", self.fractions, self.arms_m, self.arms_m))

    @property
    def flexibility_per_m2(self) -> np.ndarray:
        """The inverse of J on the rotations that the nodes determine (3, 3)."""
        return np.linalg.pinv(self.inertia_m2, rcond=ONE_LINE**2, hermitian=True)

    @property
    def size_m(self) -> float:
        """Largest distance of a node or the reference from the centre."""
        return float(np.linalg.norm(np.vstack((self.arms_m, self.lever_m)), axis=1).max())

    def undetermined(self, direction: str) -> bool:
        """Return whether the nodes do not determine a displacement or rotation of the reference."""
        axis = np.eye(3)["xyz".index(direction[-1])]
        moment = axis if direction in TURNS else np.cross(self.lever_m, axis)
        limit = ONE_LINE * (1.0 if direction in TURNS else self.size_m)
        return bool(np.linalg.norm(moment - self.inertia_m2 @ (self.flexibility_per_m2 @ moment)) > limit)

    def shares(self, direction: str) -> np.ndarray:
        """Return the coefficients (k, 3) of the displacements of the nodes, whose sum is that of the reference. A unit
        load of the reference causes these forces on the nodes."""
        axis = np.eye(3)["xyz".index(direction[-1])]
        force, moment = (np.zeros(3), axis) if direction in TURNS else (axis, np.cross(self.lever_m, axis))
        turned = self.flexibility_per_m2 @ moment
        return np.asarray(self.fractions[:, None] * (force + np.cross(turned, self.arms_m)))

    def rotation_rad(self, displacement_m: np.ndarray) -> np.ndarray:
        """Return the mean rotation (states, 3) at displacements (states, nodes, 3)."""
        moments = np.einsum("i,sij->sj", self.fractions, np.cross(self.arms_m, displacement_m[:, self.nodes]))
        return np.asarray(moments @ self.flexibility_per_m2)


@dataclass(frozen=True)
class Means:
    """Means as arrays."""

    names: Sequence[str]
    clouds: Sequence[Cloud]
    turning: Sequence[str]  # names of those whose references rotate with them
    constraints: Constraints
    of_constraint: Mapping[str, str]  # mean by constraint


def resolve_means(items: Sequence[Mean], nodes: ItemIndex, position_m: np.ndarray, dimension: int) -> Means:
    """Return the means as arrays."""
    clouds = [_cloud(item, nodes, position_m) for item in items]
    of = {f"{item.name}/{direction}": item.name for item in items for direction in item.follows(dimension)}
    found = [_terms(cloud, direction) for item, cloud in zip(items, clouds) for direction in item.follows(dimension)]
    made = Constraints(tuple(of), tuple(one[0] for one in found), tuple(one[1] for one in found),
                       tuple(one[2] for one in found))
    return Means(names(items), clouds, [item.name for item in items if item.turns(dimension)], made, of)


def _cloud(item: Mean, nodes: ItemIndex, position_m: np.ndarray) -> Cloud:
    places = nodes.called(item.nodes).astype(np.int32)
    reference = int(nodes.called([item.reference])[0])
    weights = np.array(item.weights if item.weights is not None else [1.0] * len(places))
    fractions = weights / weights.sum()
    centre = fractions @ position_m[places]
    return Cloud(reference, places, fractions, position_m[places] - centre, position_m[reference] - centre)


def _terms(cloud: Cloud, direction: str) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return nodes, turns and coefficients of the constraint of one displacement or rotation of a reference."""
    shares = cloud.shares(direction)
    size = np.linalg.norm(shares, axis=1)
    kept = size > LEAST_COEFFICIENT * size.max()
    nodes = np.append(cloud.nodes[kept], cloud.reference).astype(np.int32)
    turns = np.zeros(len(nodes), dtype=bool)
    turns[-1] = direction in TURNS
    coefficients = np.vstack((-shares[kept], np.eye(3)["xyz".index(direction[-1])]))
    return nodes, turns, coefficients


def run_notes(means: Means, displacement_m: np.ndarray) -> tuple[str, ...]:
    """Return a sentence for each mean whose rotation is so large that its linear equations matter.

    :param displacement_m: displacements (states, nodes, 3)
    """
    found = []
    for name, cloud in zip(means.names, means.clouds):
        angle = float(np.linalg.norm(cloud.rotation_rad(displacement_m), axis=1).max(initial=0.0))
        moved = displacement_m[:, np.append(cloud.nodes, cloud.reference)]
        largest = float(np.linalg.norm(moved, axis=2).max(initial=0.0))
        error = angle**2 / 2 * cloud.size_m
        if error > NOTABLE * largest:
            found.append(Note("mean_rotates", mean=name, angle_rad=angle, error_m=error, share=error / largest))
    return tuple(found)
