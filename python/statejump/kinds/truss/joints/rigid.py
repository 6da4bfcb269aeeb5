# SPDX-License-Identifier: GPL-3.0-or-later
"""Rigid bodies of nodes: a master carries other nodes on rigid arms."""
from __future__ import annotations

from collections.abc import Container, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from statejump.core.errors import NotAllowed
from statejump.kinds.truss.arrays import References
from statejump.kinds.truss.joints.protocol import ItemColumn, JointType, Loads, Symbol, count
from statejump.kinds.truss.references import known_name
from statejump.kinds.truss.resolved import ResolvedTruss
from statejump.schema.fields import definition, text, texts
from statejump.schema.items import Item

AXES = ("x", "y", "z")


@definition
class Rigid(Item):
    """A rigid body: the master node carries other nodes on rigid arms, which rotate with it. The same as ``RBE2`` of
    Nastran, ``*RIGID BODY`` and ``*KINEMATIC COUPLING`` of CalculiX, for rotations of any size."""

    master: str = text(..., "its master node, which it rotates")
    nodes: list[str] = texts(..., "the nodes on its arms")
    directions: list[str] = texts(list(AXES), "held displacements of these nodes", AXES)
    rotations: list[str] = texts(
        list(AXES), "held rotations of these nodes: all or none; matters where beams end", AXES)


@dataclass(frozen=True)
class Rigids:
    """Arms of rigid bodies, one for each node except the masters."""

    names: Sequence[str]  # "BODY/NODE"
    master: np.ndarray  # (k,) int
    node: np.ndarray  # (k,) int
    holds: np.ndarray  # (k, 6) bool: displacements, then rotations


class RigidType(JointType[Rigid, Rigids]):
    """Rigid bodies, supported by the quasi-static solver and in motion."""

    section = "rigid"
    rubs_at_nodes = True
    bends = True
    Item = Rigid
    Arrays = Rigids
    columns: ClassVar[tuple[ItemColumn, ...]] = (
        ItemColumn("rigid_force_N", "force of the arm on its node", True),
    )
    not_in_dem = "rotates its nodes, the DEM has no rotations of nodes yet"

    def check_vectors(self, item: Rigid, dimension: int) -> None:
        where = self.where(item.name)
        allowed = AXES[:2] if dimension == 2 else AXES
        if not set(item.directions) & set(allowed):
            raise NotAllowed("directions", item.directions, code="rigid_without_direction", **where)
        if item.rotations and not set("z" if dimension == 2 else AXES) <= set(item.rotations):
            raise NotAllowed("rotations", item.rotations, code="rigid_rotations", **where)

    def check_references(self, item: Rigid, nodes: Mapping[str, Any], links: Mapping[str, Any],
                         rotating: Container[str]) -> None:
        where = self.where(item.name)
        known_name("master", item.master, item.master, nodes, "node", **where)
        if not item.nodes:
            raise NotAllowed("nodes", item.nodes, code="rigid_without_node", **where)
        for name in item.nodes:
            known_name("nodes", item.nodes, name, nodes, "node", **where)
        if item.master in item.nodes or len(set(item.nodes)) < len(item.nodes):
            raise NotAllowed("nodes", item.nodes, code="rigid_node_repeated", **where)

    def resolve(self, items: Sequence[Rigid], known: References) -> Rigids:
        arms = [(f"{item.name}/{node}", item.master, node, item) for item in items for node in item.nodes]
        holds = [[axis in given for given in (item.directions, item.rotations) for axis in AXES]
                 for *_, item in arms]
        return Rigids(
            tuple(name for name, *_ in arms), _numbers([master for _, master, *_ in arms], known),
            _numbers([node for *_, node, _ in arms], known), np.array(holds, dtype=bool).reshape(len(arms), 6))

    def check_geometry(self, truss: ResolvedTruss, joints: Rigids, ranges_K: np.ndarray) -> None:
        """Refuse nodes on two arms, and rings of arms: their forces would not be unique."""
        carrier: dict[int, int] = {}
        for index, (master, node) in enumerate(zip(joints.master.tolist(), joints.node.tolist())):
            body = joints.names[index].rpartition("/")[0]
            if node in carrier:
                raise NotAllowed("nodes", truss.nodes.names[node], code="rigid_node_twice", **self.where(body))
            carrier[node] = master
            at = master
            while at in carrier:
                at = carrier[at]
                if at == node:
                    raise NotAllowed("master", truss.nodes.names[master], code="rigid_ring", **self.where(body))
            arm = truss.nodes.position_m[node] - truss.nodes.position_m[master]
            free = ~truss.nodes.fixed[[node, master]].all(axis=0) & joints.holds[index, :3]
            rotates = not truss.nodes.fixed_rotations[master].all() and arm.any()
            if not free.any() and not rotates:
                raise NotAllowed("nodes", truss.nodes.names[node], code="rigid_node_fixed", **self.where(body))

    def joined(self, joints: Rigids) -> np.ndarray:
        return np.stack((joints.node, joints.master), axis=1)

    def place_nodes(self, truss: ResolvedTruss, joints: Rigids) -> np.ndarray:
        return joints.node

    def symbols(self, truss: ResolvedTruss, joints: Rigids) -> list[Symbol]:
        return [Symbol(truss.nodes.position_m[joints.node], "s", 0.5, 0.4, order=4.6)]

    def legend(self, joints: Rigids) -> str:
        return "node of a rigid body"

    def describe(self, items: Sequence[Rigid]) -> str:
        arms = sum(len(item.nodes) for item in items)
        return f"{count(items, 'rigid body').replace('bodys', 'bodies')} with {arms} arm{'' if arms == 1 else 's'}."

    def add_friction(self, loads: Loads, joints: Rigids, state: Mapping[str, np.ndarray]) -> None:
        """Add nothing: rigid bodies have no friction."""

    def without_friction(self, truss: ResolvedTruss) -> ResolvedTruss:
        return truss

    def carried_friction(self, joints: Rigids, at: Mapping[str, np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
        return np.zeros(len(joints.names)), np.zeros(len(joints.names))


def _numbers(names: list[str], known: References) -> np.ndarray:
    """Return the indices of nodes."""
    return known.node.called(names).astype(np.int32)


RIGID = RigidType()
