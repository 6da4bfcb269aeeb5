# SPDX-License-Identifier: GPL-3.0-or-later
"""Joints whose first node slides along an axis fixed in space, relative to the ground or to a second node."""
from __future__ import annotations

from collections.abc import Container, Iterable, Mapping, Sequence
from typing import Any, ClassVar, Protocol, TypeVar, cast

import numpy as np

from statejump.core.errors import NotAllowed
from statejump.kinds.truss.arrays import GROUND, SAME_DIRECTION
from statejump.kinds.truss.joints.protocol import JointType, Loads
from statejump.kinds.truss.references import Around, known_nodes, vector, wrong_ends, wrong_vectors
from statejump.kinds.truss.resolved import ResolvedTruss
from statejump.schema.item_tables import ItemColumns
from statejump.schema.items import Item


class Directed(Protocol):
    """What their items have."""

    nodes: list[str]
    axis: list[float]


class Axes(Protocol):
    """What their arrays have."""

    @property
    def names(self) -> Sequence[str]:
        """Of the joints."""

    @property
    def nodes(self) -> np.ndarray:
        """Indices of nodes (s, 2); the second is GROUND, or a node that the joint couples to the first."""

    @property
    def axis(self) -> np.ndarray:
        """(s, 3) unit."""


ItemType = TypeVar("ItemType", bound=Item)
ArraysType = TypeVar("ArraysType", bound=Axes)


class AlongAxis(JointType[ItemType, ArraysType]):
    """A joint type along an axis. Across the axis, the joint couples two nodes; on ground, supports hold its node."""

    rubs_at_nodes = True
    noun: ClassVar[str]  # in sentences

    def check_vectors(self, item: ItemType, dimension: int) -> None:
        vector("axis", cast(Directed, item).axis, "-", dimension, True, **self.where(item.name))

    def check_references(self, item: ItemType, nodes: Mapping[str, Any], links: Mapping[str, Any],
                         rotating: Container[str]) -> None:
        known_nodes(cast(Directed, item).nodes, 1, nodes, self.where(item.name))

    def may_be_wrong_vectors(self, items: ItemColumns[ItemType], dimension: int) -> np.ndarray:
        return wrong_vectors(items, "axis", dimension, True)

    def may_be_wrong_references(self, items: ItemColumns[ItemType], around: Around) -> np.ndarray:
        return wrong_ends(around.nodes.of(items, "nodes"), 1)

    def check_geometry(self, truss: ResolvedTruss, joints: ArraysType, ranges_K: np.ndarray) -> None:
        nodes = truss.nodes
        on_ground = np.flatnonzero(joints.nodes[:, 1] == GROUND)
        carrier, axis = joints.nodes[on_ground, 0], joints.axis[on_ground]
        guide = nodes.guide_normal[carrier]
        # Projector on the directions in which supports hold the node; its rank is their number.
        held = nodes.fixed[carrier][:, :, None] * np.eye(3) + guide[:, :, None] * guide[:, None, :]
        along = np.einsum("ki,kij,kj->k", axis, held, axis) > SAME_DIRECTION**2
        across = np.linalg.eigvalsh(held)[:, 1] <= SAME_DIRECTION**2
        for number in np.flatnonzero(along | across)[:1]:
            joint, node = joints.names[on_ground[number]], nodes.names[carrier[number]]
            why = {"code": "held_along_axis"} if along[number] else {"code": "free_across_axis", "type": self.noun}
            raise NotAllowed("axis", [float(value) for value in axis[number, : truss.dimension]], node=node, **why,
                             nodes=(node,), **self.where(joint))

    def joined(self, joints: ArraysType) -> np.ndarray:
        return joints.nodes[joints.nodes[:, 1] != GROUND]

    def engine_arrays(self, truss: ResolvedTruss, joints: ArraysType) -> dict[str, Any]:
        return {"first_node": joints.nodes[:, 0], "second_node": joints.nodes[:, 1]}

    def place_nodes(self, truss: ResolvedTruss, joints: ArraysType) -> np.ndarray:
        return joints.nodes[:, 0]

    def places(self, truss: ResolvedTruss, joints: ArraysType) -> tuple[np.ndarray, np.ndarray]:
        """Return the positions (s, 3) of the joint symbols, and their upward directions in the drawing plane (s, 3)."""
        along = joints.axis
        return (truss.nodes.position_m[joints.nodes[:, 0]],
                np.stack((-along[:, 1], along[:, 0], np.zeros(len(along))), axis=1))

    def add_friction(self, loads: Loads, joints: ArraysType, state: Mapping[str, np.ndarray]) -> None:
        for index, (friction, (first, second), axis) in enumerate(
                zip(self.friction_N(joints, state), joints.nodes, joints.axis)):
            loads.push(index, first, -friction * axis)
            loads.push(index, second, friction * axis)

    def friction_N(self, joints: ArraysType, state: Mapping[str, np.ndarray]) -> np.ndarray:
        """Return the friction force on the first node [N] (joints,) in one state, positive against the axis."""
        raise NotImplementedError

    def covered_nodes(self, joints: ArraysType) -> np.ndarray:
        return joints.nodes[:, 0]

    def guided_nodes(self, joints: ArraysType) -> np.ndarray:
        return joints.nodes[joints.nodes[:, 1] == GROUND, 0]

    def sides(self, joints: ArraysType) -> Iterable[tuple[int, np.ndarray]]:
        for node, axis in zip(joints.nodes[:, 0], joints.axis):
            yield int(node), np.array([-axis[1], axis[0]])
