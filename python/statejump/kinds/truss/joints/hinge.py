# SPDX-License-Identifier: GPL-3.0-or-later
"""Hinges between beams or rigid bodies: rotation about an axis with play, stiffness, friction and a preload moment."""
from __future__ import annotations

from collections.abc import Container, Mapping, Sequence
from dataclasses import dataclass
from math import pi
from typing import Any, ClassVar

import numpy as np

from statejump.core.errors import MissingKey, NotAllowed
from statejump.kinds.truss.arrays import distances
from statejump.kinds.truss.joints.hinge_law import MOMENT, HingeLaw
from statejump.kinds.truss.joints.protocol import USER, AboutAxis, ItemColumn, Loads, Symbol
from statejump.kinds.truss.references import Around, known_nodes, wrong_ends
from statejump.kinds.truss.resolved import ResolvedTruss
from statejump.schema.fields import definition, numbers, parameter, texts
from statejump.schema.item_tables import ItemColumns
from statejump.schema.items import Item


@definition
class Hinge(Item):
    """A hinge between two nodes at one position, where beams or rigid bodies end. Its axis rotates with the first node.

    The moment against the rotation of the second node relative to the first is preload + stiffness (rotation beyond
    the play) ± friction. The rotation is zero in the reference configuration."""

    nodes: list[str] = texts(..., "its two nodes, at one position")
    deadband_rad: float = parameter(0.0, "rad", 0, pi, "none; free play to either side")
    stiffness_N_m_per_rad: float = parameter(0.0, "N m/rad", 0, 1e12, "none; beyond the play")
    friction_moment_N_m: float = parameter(0.0, "N m", 0, 1e9, "no friction")
    friction_stiffness_N_m_per_rad: float | None = parameter(
        None, "N m/rad", 0, 1e12, "of friction that sticks; as beyond the play; elastic sticking only", above=True)
    preload_moment_N_m: float = parameter(0.0, "N m", -1e9, 1e9, "against the rotation; none")
    axis: list[float] | None = numbers(None, "-", -1e9, 1e9, USER + ", as drawn; needed in three dimensions")


@dataclass(frozen=True)
class Hinges:
    """Hinges of beams. Their angle is that of the second node relative to the first."""

    names: Sequence[str]
    nodes: np.ndarray  # (h, 2) int
    deadband_rad: np.ndarray
    stiffness_N_m_per_rad: np.ndarray
    friction_moment_N_m: np.ndarray
    friction_stiffness_N_m_per_rad: np.ndarray  # inf: neither given nor stiff beyond the play
    preload_moment_N_m: np.ndarray
    axis: np.ndarray  # (h, 3) unit; z in planar trusses


class HingeType(AboutAxis[Hinge, Hinges], HingeLaw[Hinge, Hinges]):
    """Hinges of beams, supported by the quasi-static solver and in motion."""

    section = "hinge"
    noun = "hinge"
    bends = True
    Item = Hinge
    Arrays = Hinges
    columns: ClassVar[tuple[ItemColumn, ...]] = (
        ItemColumn("beam_hinge_rotation_rad", "of the second node against the first"),
        ItemColumn("beam_hinge_moment_N_m", MOMENT),
    )
    not_in_dem = "rotates its nodes, the DEM has no rotations of nodes yet"

    def check_references(self, item: Hinge, nodes: Mapping[str, Any], links: Mapping[str, Any],
                         rotating: Container[str]) -> None:
        known_nodes(item.nodes, 2, nodes, self.where(item.name))

    def may_be_wrong_references(self, items: ItemColumns[Hinge], around: Around) -> np.ndarray:
        return wrong_ends(around.nodes.of(items, "nodes"), 2)

    def check_geometry(self, truss: ResolvedTruss, joints: Hinges, ranges_K: np.ndarray) -> None:
        apart = distances(truss.nodes.position_m, joints.nodes)
        for index in np.flatnonzero(apart > 0)[:1]:
            raise NotAllowed("nodes", [truss.nodes.names[node] for node in joints.nodes[index]], code="hinge_apart",
                             apart_m=float(apart[index]), **self.where(joints.names[index]))
        if truss.sticking == "rigid":
            return
        soft = (joints.friction_moment_N_m > 0) & np.isinf(joints.friction_stiffness_N_m_per_rad)
        for index in np.flatnonzero(soft)[:1]:
            raise MissingKey("friction_stiffness_N_m_per_rad", code="hinge_sticking_missing", sticking=truss.sticking,
                             **self.where(joints.names[index]))

    def joined(self, joints: Hinges) -> np.ndarray:
        return joints.nodes

    def place_nodes(self, truss: ResolvedTruss, joints: Hinges) -> np.ndarray:
        return np.asarray(joints.nodes[:, 0])

    def symbols(self, truss: ResolvedTruss, joints: Hinges) -> list[Symbol]:
        return [Symbol(truss.nodes.position_m[joints.nodes[:, 0]], "o", 0.9, 0.7, order=4.6)]

    def add_friction(self, loads: Loads, joints: Hinges, state: Mapping[str, np.ndarray]) -> None:
        """Add nothing: the friction is a moment on nodes, and the answers rank no joints then."""


HINGE = HingeType()
