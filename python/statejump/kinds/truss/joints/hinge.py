# SPDX-License-Identifier: GPL-3.0-or-later
"""Hinges between beams or rigid bodies: rotation about an axis with play, stiffness, friction and a preload moment."""
from __future__ import annotations

from collections.abc import Container, Mapping, Sequence
from dataclasses import dataclass
from math import pi
from typing import Any, ClassVar

import numpy as np

from statejump.core.errors import MissingKey, NotAllowed, StatejumpError
from statejump.kinds.truss.arrays import References, distances
from statejump.kinds.truss.joints import moment_table
from statejump.kinds.truss.joints.hinge_law import MOMENT, HingeLaw
from statejump.kinds.truss.joints.protocol import USER, AboutAxis, ItemColumn, Loads, Symbol, count
from statejump.kinds.truss.references import Around, known_nodes, wrong_ends
from statejump.kinds.truss.resolved import ResolvedTruss
from statejump.schema.fields import definition, numbers, parameter, texts
from statejump.schema.item_tables import ItemColumns
from statejump.schema.items import Item


@definition
class Hinge(Item):
    """A hinge between two nodes at one position, where beams or rigid bodies end. Its axis rotates with the first node.

    The moment against the rotation of the second node relative to the first is preload + stiffness (rotation beyond
    the play) + moment of the table ± friction. The rotation is zero in the reference configuration. Between the points
    of the table the moment is a monotone cubic, so its peaks are points of the table."""

    nodes: list[str] = texts(..., "its two nodes, at one position")
    deadband_rad: float = parameter(0.0, "rad", 0, pi, "none; free play to either side")
    stiffness_N_m_per_rad: float = parameter(0.0, "N m/rad", 0, 1e12, "none; beyond the play")
    friction_moment_N_m: float = parameter(0.0, "N m", 0, 1e9, "no friction")
    friction_stiffness_N_m_per_rad: float | None = parameter(
        None, "N m/rad", 0, 1e12, "of friction that sticks; as beyond the play; elastic sticking only", above=True)
    preload_moment_N_m: float = parameter(0.0, "N m", -1e9, 1e9, "against the rotation; none")
    table_angle_rad: list[float] | None = numbers(
        None, "rad", -2 * pi, 2 * pi, "increasing rotations of a measured moment curve, around 0; none")
    table_moment_N_m: list[float] | None = numbers(
        None, "N m", -1e9, 1e9, "elastic moments at these rotations, for example of a tape spring")
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
    # Of every hinge the points of its moment curve; empty: none.
    table_angle_rad: Sequence[np.ndarray]
    table_moment_N_m: Sequence[np.ndarray]


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

    def check_vectors(self, item: Hinge, dimension: int) -> None:
        super().check_vectors(item, dimension)
        moment_table.check(item.table_angle_rad, item.table_moment_N_m, self.where(item.name))

    def may_be_wrong_vectors(self, items: ItemColumns[Hinge], dimension: int) -> np.ndarray:
        return super().may_be_wrong_vectors(items, dimension) | moment_table.given(items)

    def derived(self, items: Sequence[Hinge], known: References) -> dict[str, Any]:
        return {**super().derived(items, known), **moment_table.derived(items)}

    def engine_arrays(self, truss: ResolvedTruss, joints: Hinges) -> dict[str, Any]:
        angles, moments = joints.table_angle_rad, joints.table_moment_N_m
        return {**super().engine_arrays(truss, joints),
                "table_angle_rad": list(angles), "table_moment_N_m": list(moments),
                "table_slope_N_m_per_rad": [moment_table.slopes(*curve) for curve in zip(angles, moments)]}

    def check_states(self, truss: ResolvedTruss, joints: Hinges, states: Mapping[str, np.ndarray]) -> None:
        """Refuse states in which a hinge has left its moment curve."""
        for index, angle in enumerate(joints.table_angle_rad):
            if not len(angle) or not states:
                continue
            rotation = states["beam_hinge_rotation_rad"][:, index]
            for at in np.flatnonzero((rotation < angle[0]) | (rotation > angle[-1]))[:1]:
                raise StatejumpError(
                    code="hinge_left_table", case=truss.name, hinge=joints.names[index],
                    rotation_rad=float(rotation[at]),
                    at_s=float(states["time_s"][at]), first_rad=float(angle[0]), last_rad=float(angle[-1]))

    def friction_N_m(self, joints: Hinges, state: Mapping[str, np.ndarray]) -> np.ndarray:
        found = super().friction_N_m(joints, state)
        rotation = state["beam_hinge_rotation_rad"]
        for index, curve in enumerate(zip(joints.table_angle_rad, joints.table_moment_N_m)):
            if len(curve[0]):
                found[..., index] -= moment_table.moment_N_m(*curve, rotation[..., index])
        return found

    def describe(self, items: Sequence[Hinge]) -> str:
        curves = sum(item.table_angle_rad is not None for item in items)
        also = f" {count(curves * [None], 'moment curve')}." if curves else ""
        return super().describe(items) + also

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
