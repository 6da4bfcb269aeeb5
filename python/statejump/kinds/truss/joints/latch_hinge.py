# SPDX-License-Identifier: GPL-3.0-or-later
"""Latch hinges: rotation with free play, with a stiffness beyond the play, friction and a preload moment."""
from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from math import inf, pi
from typing import Any, ClassVar

import numpy as np

from statejump.kinds.truss.arrays import GROUND, References, column
from statejump.kinds.truss.joints.protocol import (
    USER, BetweenLinks, ItemColumn, JointType, Loads, Symbol, Torsion, count, scaled, spread,
)
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


class LatchHingeType(BetweenLinks[LatchHinge, LatchHinges], JointType[LatchHinge, LatchHinges]):
    """Latch hinges, supported by the solver and the DEM."""

    section = "latch_hinge"
    turns = True
    Item = LatchHinge
    Arrays = LatchHinges
    columns: ClassVar[tuple[ItemColumn, ...]] = (
        ItemColumn("hinge_rotation_rad", "from the drawn shape"),
        ItemColumn("hinge_moment_N_m", "against the rotation: preload, stiffness beyond the play, friction"),
    )
    varied = ("deadband_rad", "stiffness_N_m_per_rad", "friction_moment_N_m", "preload_moment_N_m")

    def derived(self, items: Sequence[LatchHinge], known: References) -> dict[str, Any]:
        sticking = column(items, "friction_stiffness_N_m_per_rad")
        beyond = column(items, "stiffness_N_m_per_rad")
        return {"friction_stiffness_N_m_per_rad": np.where(np.isnan(sticking), beyond, sticking)}

    def check_geometry(self, truss: ResolvedTruss, joints: LatchHinges, ranges_K: np.ndarray) -> None:
        turned_links(truss, self.section, joints)

    def engine_arrays(self, truss: ResolvedTruss, joints: LatchHinges) -> dict[str, Any]:
        elastic = truss.sticking != "rigid"
        return {
            "first_link": joints.links[:, 0], "second_link": joints.links[:, 1],
            "friction_stiffness_N_m_per_rad": joints.friction_stiffness_N_m_per_rad if elastic else (
                np.full(len(joints.names), inf)),
        }

    def place_nodes(self, truss: ResolvedTruss, joints: LatchHinges) -> np.ndarray:
        return truss.turning_nodes(joints.links)

    def symbols(self, truss: ResolvedTruss, joints: LatchHinges) -> list[Symbol]:
        return [Symbol(truss.turning_places(joints.links), "D", 0.9, 0.7, order=4.6)]

    def legend(self, joints: LatchHinges) -> str:
        return f"latch hinge, play ±{scaled(joints.deadband_rad, 1e3, 'mrad')}"

    def describe(self, items: Sequence[LatchHinge]) -> str:
        return (
            f"{count(items, 'latch hinge')} with a free play of ±"
            f"{spread((hinge.deadband_rad for hinge in items), 'rad')}, "
            f"{spread((hinge.stiffness_N_m_per_rad for hinge in items), 'N m/rad')} beyond it, friction of "
            f"{spread((hinge.friction_moment_N_m for hinge in items), 'N m')}."
        )

    def add_friction(self, loads: Loads, joints: LatchHinges, state: Mapping[str, np.ndarray]) -> None:
        for index, (moment, (first, second)) in enumerate(zip(self._friction_N_m(joints, state), joints.links)):
            against = moment * joints.axis[index]
            # Against the ground, the angle of the hinge is the rotation of the first link.
            loads.turn(index, first, -against if second == GROUND else against)
            loads.turn(index, second, -against)

    def carried_friction(self, joints: LatchHinges, at: Mapping[str, np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
        return np.abs(self._friction_N_m(joints, at)), joints.friction_moment_N_m

    def without_friction(self, truss: ResolvedTruss) -> ResolvedTruss:
        hinges: LatchHinges = truss.joints[self.section]
        return truss.with_joints(latch_hinge=replace(hinges, friction_moment_N_m=0 * hinges.friction_moment_N_m))

    @staticmethod
    def _friction_N_m(joints: LatchHinges, state: Mapping[str, np.ndarray]) -> np.ndarray:
        """Return the friction moment [N m] of each hinge in a state."""
        rotation = state["hinge_rotation_rad"]
        beyond = rotation - np.clip(rotation, -joints.deadband_rad, joints.deadband_rad)
        elastic = joints.preload_moment_N_m + joints.stiffness_N_m_per_rad * beyond
        return np.asarray(state["hinge_moment_N_m"] - elastic)

    def torsion(self, joints: LatchHinges) -> Torsion:
        sticking = np.where(joints.friction_moment_N_m > 0, joints.friction_stiffness_N_m_per_rad, 0.0)
        return Torsion(joints.names, joints.links, joints.axis, joints.stiffness_N_m_per_rad + sticking)

    def largest_turn_rad(self, path: Course, joints: LatchHinges) -> np.ndarray:
        return np.asarray(np.abs(path.states["hinge_rotation_rad"]).max(axis=0))

    def scene(self, path: Course, joints: LatchHinges) -> dict[str, Any]:
        start = {key: path.states[key][0] for key in ("hinge_rotation_rad", "hinge_moment_N_m")}
        return {"start_rotation_rad": start["hinge_rotation_rad"],
                "start_friction_N_m": self._friction_N_m(joints, start)}


LATCH_HINGE = LatchHingeType()
