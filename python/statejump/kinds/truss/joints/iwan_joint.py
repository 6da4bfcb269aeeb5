# SPDX-License-Identifier: GPL-3.0-or-later
"""Iwan joints: bolted joints that slip gradually, with Segalman's four parameters, discretised by Jenkins elements.

The engine's ``iwan_joint.hpp`` has the law and its source.
"""
from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from statejump import _engine
from statejump.core.errors import NotAllowed
from statejump.kinds.truss.arrays import none_of
from statejump.kinds.truss.joints.along_axis import AlongAxis
from statejump.kinds.truss.joints.protocol import USER, ItemColumn, Strokes, Symbol, count, scaled, spread
from statejump.kinds.truss.joints.slider import with_sliders
from statejump.kinds.truss.resolved import ResolvedTruss
from statejump.schema.fields import CHOICE, definition, numbers, parameter, texts, whole
from statejump.schema.items import Item

NUMBERS = ("tangent_stiffness_N_per_m", "slip_force_N", "exponent", "stiffness_ratio")
LONGEST = 1e12  # limit of the longest interval over the first one, which must stay above rounding
# A bolt through two plates.
BOLT: Strokes = (
    ((-0.9, -0.35), (0.9, -0.35), (0.9, 0.35), (-0.9, 0.35), (-0.9, -0.35)), ((-0.9, 0.0), (0.9, 0.0)),
    ((0.0, -0.8), (0.0, 0.8)), ((-0.35, 0.6), (0.35, 0.6)), ((-0.35, -0.6), (0.35, -0.6)),
)


@definition
class IwanJoint(Item):
    """A bolted joint after Segalman's four-parameter Iwan model. The first node moves along an axis fixed in space, on
    ground or on the second node, against springs of which more and more slip. Across the axis it is constrained as a
    slider."""

    nodes: list[str] = texts(..., "one node, on ground, or two")
    axis: list[float] = numbers(..., "-", -1e9, 1e9, "of any length")
    tangent_stiffness_N_per_m: float = parameter(..., "N/m", 0, 1e15, USER + "; K_T, of the stuck joint", above=True)
    slip_force_N: float = parameter(..., "N", 0, 1e9, USER + "; F_S, at which all of it slips", above=True)
    exponent: float = parameter(..., "-", -1, 0, USER + "; χ: heat of small cycles goes with the force to 3 + χ",
                                above=True)
    stiffness_ratio: float = parameter(..., "-", 0, 1e6, USER + "; β, of the springs that slip last over all others")
    elements: int = whole(50, 1, 10_000, CHOICE + "; Jenkins elements")
    spacing: float = parameter(1.2, "-", 1, 10, CHOICE + "; length of an interval over the one before, 1: uniform")


@dataclass(frozen=True)
class IwanJoints:
    """Iwan joints. Their slide is axis · (displacement of the first node - displacement of the second node)."""

    names: Sequence[str]
    nodes: np.ndarray  # (j, 2) int; the second is GROUND, or a node that the joint couples to the first across the axis
    axis: np.ndarray  # (j, 3) unit
    tangent_stiffness_N_per_m: np.ndarray
    slip_force_N: np.ndarray
    exponent: np.ndarray
    stiffness_ratio: np.ndarray
    elements: np.ndarray  # int
    spacing: np.ndarray


class IwanJointType(AlongAxis[IwanJoint, IwanJoints]):
    """Iwan joints, in the solver."""

    section = "iwan_joint"
    noun = "an Iwan joint"
    slips_in_part = True
    Item = IwanJoint
    Arrays = IwanJoints
    columns: ClassVar[tuple[ItemColumn, ...]] = (
        ItemColumn("iwan_slide_m", "from the drawn shape"),
        ItemColumn("iwan_force_N", "on the first node, against the axis"),
    )
    varied = NUMBERS
    not_in_dem = "is a joint that the DEM does not have"

    def check_geometry(self, truss: ResolvedTruss, joints: IwanJoints, ranges_K: np.ndarray) -> None:
        super().check_geometry(truss, joints, ranges_K)
        longest = np.log10(joints.spacing) * (joints.elements - 1)
        for index in np.flatnonzero(longest >= np.log10(LONGEST))[:1]:
            raise NotAllowed("spacing", float(joints.spacing[index]), code="iwan_spacing",
                             elements=joints.elements[index], power=longest[index], limit=LONGEST,
                             **self.where(joints.names[index]))

    def symbols(self, truss: ResolvedTruss, joints: IwanJoints) -> list[Symbol]:
        places, up = self.places(truss, joints)
        return [Symbol(places, BOLT, 1.4, 0.9, marker_in_space="P", up=up, line_in_space=joints.axis)]

    def legend(self, joints: IwanJoints) -> str:
        return (f"Iwan joint, slips at {scaled(joints.slip_force_N, 1.0, 'N')}, χ = "
                f"{scaled(joints.exponent, 1.0, '').strip()}")

    def describe(self, items: Sequence[IwanJoint]) -> str:
        slack = [_engine.iwan_slack_N(item.tangent_stiffness_N_per_m, item.slip_force_N, item.exponent,
                                      item.stiffness_ratio, item.elements, item.spacing) / item.slip_force_N
                 for item in items]
        return (
            f"{count(items, 'Iwan joint')}: stiffness "
            f"{spread((item.tangent_stiffness_N_per_m for item in items), 'N/m')}, slip at "
            f"{spread((item.slip_force_N for item in items), 'N')}, χ = "
            f"{spread(item.exponent for item in items)}, β = {spread(item.stiffness_ratio for item in items)}; "
            f"{spread((float(item.elements) for item in items))} Jenkins elements, whose force is at most "
            f"{spread((100 * share for share in slack), '-', 2)} % of the slip force above that of the model."
        )

    def friction_N(self, joints: IwanJoints, state: Mapping[str, np.ndarray]) -> np.ndarray:
        # Every spring of the joint ends in a slider, so without friction the joint carries no force.
        return state["iwan_force_N"]

    def carried_friction(self, joints: IwanJoints, at: Mapping[str, np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
        return np.abs(at["iwan_force_N"]), joints.slip_force_N

    def without_friction(self, truss: ResolvedTruss) -> ResolvedTruss:
        joints: IwanJoints = truss.joints[self.section]
        return with_sliders(truss, joints).with_joints(iwan_joint=none_of(joints))


IWAN_JOINT = IwanJointType()
