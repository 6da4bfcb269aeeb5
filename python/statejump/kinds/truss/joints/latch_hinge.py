# SPDX-License-Identifier: GPL-3.0-or-later
"""Latch hinges: rotation with free play, with a stiffness beyond the play, friction and a preload moment."""
from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import pi
from typing import Any, ClassVar

import numpy as np

from statejump.kinds.truss.arrays import GROUND
from statejump.kinds.truss.joints.hinge_law import MOMENT, HingeLaw
from statejump.kinds.truss.joints.protocol import USER, BetweenLinks, ItemColumn, Loads, Symbol, Torsion
from statejump.kinds.truss.references import turned_links
from statejump.kinds.truss.resolved import Course, ResolvedTruss
from statejump.schema.fields import definition, numbers, parameter, texts
from statejump.schema.items import Item


@definition
class LatchHinge(Item):
    """A hinge with a latch: the second link rotates against the first, or one link against the ground. The rotation is
    free within a play and meets a stiffness beyond it, against dry friction.

    Angles are those of torsion springs. The moment against a rotation from the reference configuration is preload +
    stiffness (rotation beyond the play) ± friction.
    """

    links: list[str] = texts(..., "two links that share a place, or one")
    deadband_rad: float = parameter(..., "rad", 0, pi, USER + "; free play to either side")
    stiffness_N_m_per_rad: float = parameter(..., "N m/rad", 0, 1e12, USER + "; beyond the play", above=True)
    friction_moment_N_m: float = parameter(0.0, "N m", 0, 1e9, "no friction")
    friction_stiffness_N_m_per_rad: float | None = parameter(
        None, "N m/rad", 0, 1e12, "of friction that sticks; as beyond the play; DEM and elastic sticking only",
        above=True)
    preload_moment_N_m: float = parameter(0.0, "N m", -1e9, 1e9, "against the rotation; none")
    axis: list[float] | None = numbers(None, "-", -1e9, 1e9, "fixed in space; needed in three dimensions")


@dataclass(frozen=True)
class LatchHinges:
    """Hinges with rotational play, stiffness beyond it, and friction. Their angle is that of torsion springs."""

    names: Sequence[str]
    links: np.ndarray  # (h, 2) int; (link, GROUND): the angle from the ground to one link
    deadband_rad: np.ndarray
    stiffness_N_m_per_rad: np.ndarray
    friction_moment_N_m: np.ndarray
    friction_stiffness_N_m_per_rad: np.ndarray
    preload_moment_N_m: np.ndarray
    axis: np.ndarray  # (h, 3) unit; z in planar trusses


class LatchHingeType(BetweenLinks[LatchHinge, LatchHinges], HingeLaw[LatchHinge, LatchHinges]):
    """Latch hinges, supported by the solver and the DEM."""

    section = "latch_hinge"
    noun = "latch hinge"
    Item = LatchHinge
    Arrays = LatchHinges
    columns: ClassVar[tuple[ItemColumn, ...]] = (
        ItemColumn("hinge_rotation_rad", "from the drawn shape"),
        ItemColumn("hinge_moment_N_m", MOMENT),
    )

    def check_geometry(self, truss: ResolvedTruss, joints: LatchHinges, ranges_K: np.ndarray) -> None:
        turned_links(truss, self.section, joints)

    def engine_arrays(self, truss: ResolvedTruss, joints: LatchHinges) -> dict[str, Any]:
        return super().engine_arrays(truss, joints) | {
            "first_link": joints.links[:, 0], "second_link": joints.links[:, 1],
        }

    def place_nodes(self, truss: ResolvedTruss, joints: LatchHinges) -> np.ndarray:
        return truss.turning_nodes(joints.links)

    def symbols(self, truss: ResolvedTruss, joints: LatchHinges) -> list[Symbol]:
        return [Symbol(truss.turning_places(joints.links), "D", 0.9, 0.7, order=4.6)]

    def add_friction(self, loads: Loads, joints: LatchHinges, state: Mapping[str, np.ndarray]) -> None:
        for index, (moment, (first, second)) in enumerate(zip(self.friction_N_m(joints, state), joints.links)):
            against = moment * joints.axis[index]
            # Against the ground, the angle of the hinge is the rotation of the first link.
            loads.turn(index, first, -against if second == GROUND else against)
            loads.turn(index, second, -against)

    def torsion(self, joints: LatchHinges) -> Torsion:
        sticking = np.where(joints.friction_moment_N_m > 0, joints.friction_stiffness_N_m_per_rad, 0.0)
        return Torsion(joints.names, joints.links, joints.axis, joints.stiffness_N_m_per_rad + sticking)

    def largest_turn_rad(self, path: Course, joints: LatchHinges) -> np.ndarray:
        return np.asarray(np.abs(path.states["hinge_rotation_rad"]).max(axis=0))

    def scene(self, path: Course, joints: LatchHinges) -> dict[str, Any]:
        start = {key: path.states[key][0] for key in ("hinge_rotation_rad", "hinge_moment_N_m")}
        return {"start_rotation_rad": start["hinge_rotation_rad"],
                "start_friction_N_m": self.friction_N_m(joints, start)}


LATCH_HINGE = LatchHingeType()
