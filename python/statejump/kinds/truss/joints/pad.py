# SPDX-License-Identifier: GPL-3.0-or-later
"""Pads: nodes on planes, with a normal stiffness, a clearance and friction in both directions of the plane."""
from __future__ import annotations

from collections.abc import Container, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, ClassVar

import numpy as np

from statejump.core import physics
from statejump.kinds.truss.arrays import GROUND, References, column, given_or, unit, vectors
from statejump.kinds.truss.joints.protocol import (
    USER, ItemColumn, JointType, Loads, Strokes, Symbol, count, scaled, spread,
)
from statejump.kinds.truss.references import Around, known_nodes, vector, wrong_ends, wrong_vectors
from statejump.kinds.truss.resolved import ResolvedTruss
from statejump.schema.fields import definition, numbers, parameter, texts
from statejump.schema.item_tables import ItemColumns
from statejump.schema.items import Item

POISSON_RATIO = 0.3  # of the default tangential stiffness
FOOT: Strokes = (((-0.5, 0.0), (0.5, 0.0), (0.5, -0.5), (-0.5, -0.5), (-0.5, 0.0)), ((-0.9, -0.55), (0.9, -0.55)))


@definition
class Pad(Item):
    """A node that rests on a plane: it may lift off, and slides against dry friction in both directions of the plane.
    The plane is fixed, or moves with the second node without rotation."""

    nodes: list[str] = texts(..., "the node and, unless the plane is fixed, the node that carries the plane")
    normal: list[float] = numbers(..., "-", -1e9, 1e9, "from the plane to the node; of any length")
    normal_stiffness_N_per_m: float = parameter(..., "N/m", 0, 1e15, USER, above=True)
    tangential_stiffness_N_per_m: float | None = parameter(
        None, "N/m", 0, 1e15, "of a pad that sticks; Mindlin's 0.82 of the normal one, ν = 0.3", above=True)
    friction_coefficient: float = parameter(..., "-", 0, 10, USER)
    clearance_m: float = parameter(0.0, "m", 0, 1e2, "between the node as drawn and the plane; none")


@dataclass(frozen=True)
class Pads:
    """Pads, p of them."""

    names: Sequence[str]
    nodes: np.ndarray  # (p, 2) int; the second is GROUND, or the node that carries the plane
    normal: np.ndarray  # (p, 3) unit, from the plane to the node
    normal_stiffness_N_per_m: np.ndarray
    tangential_stiffness_N_per_m: np.ndarray
    friction_coefficient: np.ndarray
    clearance_m: np.ndarray


class PadType(JointType[Pad, Pads]):
    """Pads, supported by the quasi-static solver and in motion."""

    section = "pad"
    rubs_at_nodes = True
    bounds_code = "bounds_of_pad"
    Item = Pad
    Arrays = Pads
    columns: ClassVar[tuple[ItemColumn, ...]] = (
        ItemColumn("pad_offset_m", "displacement of the node relative to the plane", vector=True),
        ItemColumn("pad_normal_force_N"),
        ItemColumn("pad_friction_N", "on the node", vector=True),
    )
    varied = ("friction_coefficient", "clearance_m", "normal_stiffness_N_per_m", "tangential_stiffness_N_per_m")
    not_in_dem = "is a pad, the DEM has sliders only"

    def check_vectors(self, item: Pad, dimension: int) -> None:
        vector("normal", item.normal, "-", dimension, True, **self.where(item.name))

    def may_be_wrong_vectors(self, items: ItemColumns[Pad], dimension: int) -> np.ndarray:
        return wrong_vectors(items, "normal", dimension, True)

    def check_references(self, item: Pad, nodes: Mapping[str, Any], links: Mapping[str, Any],
                         rotating: Container[str]) -> None:
        known_nodes(item.nodes, 1, nodes, self.where(item.name))

    def may_be_wrong_references(self, items: ItemColumns[Pad], around: Around) -> np.ndarray:
        return wrong_ends(around.nodes.of(items, "nodes"), 1)

    def derived(self, items: Sequence[Pad], known: References) -> dict[str, Any]:
        ratio = float(physics.shear_over_normal_stiffness(np.array(POISSON_RATIO)))
        stiffness = ratio * column(items, "normal_stiffness_N_per_m")
        return {
            "normal": unit(vectors(items, "normal", known.dimension)),
            "tangential_stiffness_N_per_m": given_or(column(items, "tangential_stiffness_N_per_m"), stiffness),
        }

    def joined(self, joints: Pads) -> np.ndarray:
        return joints.nodes[joints.nodes[:, 1] != GROUND]

    def resting_nodes(self, joints: Pads) -> np.ndarray:
        return np.asarray(joints.nodes[joints.nodes[:, 1] == GROUND, 0])

    def place_nodes(self, truss: ResolvedTruss, joints: Pads) -> np.ndarray:
        return np.asarray(joints.nodes[:, 0])

    def symbols(self, truss: ResolvedTruss, joints: Pads) -> list[Symbol]:
        return [Symbol(truss.nodes.position_m[joints.nodes[:, 0]], FOOT, 1.2, 0.7, marker_in_space="s",
                       up=joints.normal[:, :2])]

    def legend(self, joints: Pads) -> str:
        return f"pad, μ = {scaled(joints.friction_coefficient, 1.0, '').strip()}"

    def describe(self, items: Sequence[Pad]) -> str:
        return (f"{count(items, 'pad')} on planes, with a friction coefficient of "
                f"{spread(item.friction_coefficient for item in items)}.")

    def add_friction(self, loads: Loads, joints: Pads, state: Mapping[str, np.ndarray]) -> None:
        for index, (node, plane) in enumerate(joints.nodes):
            loads.push(index, int(node), state["pad_friction_N"][index])
            loads.push(index, int(plane), -state["pad_friction_N"][index])

    def without_friction(self, truss: ResolvedTruss) -> ResolvedTruss:
        pads = truss.joints[self.section]
        return truss.with_joints(pad=replace(pads, friction_coefficient=0 * pads.friction_coefficient))

    def carried_friction(self, joints: Pads, at: Mapping[str, np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
        return (np.linalg.norm(at["pad_friction_N"], axis=-1),
                joints.friction_coefficient * np.maximum(at["pad_normal_force_N"], 0.0))


PAD = PadType()
