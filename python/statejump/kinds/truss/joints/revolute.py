# SPDX-License-Identifier: GPL-3.0-or-later
"""Clearance revolutes: a journal with clearance and Coulomb friction in a bearing."""
from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import inf
from typing import Any, ClassVar

import numpy as np

from statejump.core.errors import NotAllowed
from statejump.kinds.truss.arrays import unit
from statejump.kinds.truss.joints.protocol import (
    ALUMINIUM, BLACK, USER, AboutAxis, Contacts, ItemColumn, Sampled, Symbol, scaled,
)
from statejump.kinds.truss.joints.round_parts import RoundArrays, RoundParts
from statejump.kinds.truss.resolved import Course, ResolvedTruss
from statejump.schema.fields import CHOICE, choice, definition, numbers, parameter, text
from statejump.schema.items import Item


@definition
class Revolute(Item):
    """A clearance revolute joint with Coulomb friction: the journal, at one node, moves in the bearing, at another. A
    link carries and rotates each part; without a link, a part rotates with its node where beams, rigid bodies or hinges
    rotate that, and does not rotate elsewhere."""

    bearing_node: str = text(..., "where the bearing's centre is")
    journal_node: str = text(..., "where the journal's centre is")
    bearing_link: str | None = text(None, "whose end carries the bearing; none: it turns with its node where beams end")
    journal_link: str | None = text(None, "whose end carries the journal; none: it turns with its node where beams end")
    journal_radius_m: float = parameter(..., "m", 0, 1e2, USER, above=True)
    radial_clearance_m: float = parameter(..., "m", 0, 1e2, USER + "; at ΔT = 0", above=True)
    friction_coefficient: float = parameter(..., "-", 0, 10, USER)
    axis: list[float] | None = numbers(None, "-", -1e9, 1e9, "fixed in space; needed in three dimensions")
    journal_thermal_expansion_per_K: float = parameter(0.0, "1/K", -1e-3, 1e-3, CHOICE + ": constant radii")
    bearing_thermal_expansion_per_K: float = parameter(0.0, "1/K", -1e-3, 1e-3, CHOICE + ": constant radii")
    temperature_fraction: float = parameter(1.0, "-", -10, 10, "of its program's ΔT; fully sunlit")
    program: str | None = text(None, "name of a [[program]]; the common [thermal]")
    young_modulus_Pa: float = parameter(70e9, "Pa", 0, 1e13, ALUMINIUM, above=True)
    poisson_ratio: float = parameter(0.3, "-", -0.99, 0.49, ALUMINIUM)
    contact: str = choice("hertz", ("hertz", "rigid"), CHOICE + "; of the reduced model, DEM is always elastic")


@dataclass(frozen=True)
class Revolutes(RoundArrays):
    """Clearance revolute joints."""

    bearing_node: np.ndarray  # int
    journal_node: np.ndarray  # int
    bearing_link: np.ndarray  # int, GROUND: its node rotates the bearing, or nothing does
    journal_link: np.ndarray  # int, GROUND: likewise
    axis: np.ndarray  # (r, 3) unit; z in planar trusses
    journal_radius_m: np.ndarray
    journal_thermal_expansion_per_K: np.ndarray
    bearing_thermal_expansion_per_K: np.ndarray


class RevoluteType(AboutAxis[Revolute, Revolutes], RoundParts[Revolute, Revolutes]):
    """Clearance revolutes, in all models."""

    section = "revolute"
    Item = Revolute
    Arrays = Revolutes
    columns: ClassVar[tuple[ItemColumn, ...]] = (
        ItemColumn("eccentricity_m", "journal minus bearing centre", vector=True),
        ItemColumn("normal_force_N"),
        ItemColumn("friction_force_N", "on the journal, clockwise about the axis"),
    )
    varied = ("friction_coefficient", "radial_clearance_m", "journal_radius_m")
    noun = "revolute joint"
    inner, outer = "journal", "bearing"
    eccentricity, normal_force, friction_force = "eccentricity_m", "normal_force_N", "friction_force_N"

    def check_geometry(self, truss: ResolvedTruss, joints: Revolutes, ranges_K: np.ndarray) -> None:
        slips = (truss.sticking == "partial_slip") & (joints.friction_coefficient > 0)
        for index in np.flatnonzero(joints.rigid & slips)[:1]:
            raise NotAllowed("contact", "rigid", code="partial_slip_rigid", **self.where(joints.names[index]))
        offset = self.offset_m(truss, joints)
        along = (offset * joints.axis).sum(axis=1, keepdims=True) * joints.axis
        self.check_parts(truss, joints, ranges_K, np.linalg.norm(offset - along, axis=1))

    def engine_arrays(self, truss: ResolvedTruss, joints: Revolutes) -> dict[str, Any]:
        sticks = {} if truss.sticking != "rigid" else {"mindlin_stiffness_N_per_m15": np.full(len(joints.names), inf)}
        return {**super().engine_arrays(truss, joints), **sticks}

    def contacts(self, run: Sampled, joints: Revolutes) -> Contacts:
        normal = self.normals(run)
        across = np.cross(joints.axis, normal) if len(joints.names) else normal
        return self.touching(run, joints, -run.columns["friction_force_N"][:, :, None] * across)

    def friction_on_inner_N(self, joints: Revolutes, state: Mapping[str, np.ndarray]) -> np.ndarray:
        return np.asarray(-state["friction_force_N"][:, None] * np.cross(joints.axis, unit(state["eccentricity_m"])))

    def symbols(self, truss: ResolvedTruss, joints: Revolutes) -> list[Symbol]:
        centres = truss.nodes.position_m[joints.bearing_node]
        return [Symbol(centres, "o", 0.8, 0.7, order=5), Symbol(centres, "o", 0.42, 0.35, order=6, face=BLACK)]

    def legend(self, joints: Revolutes) -> str:
        return (f"clearance joint, c = {scaled(joints.radial_clearance_m, 1e3, 'mm')}, "
                f"μ = {scaled(joints.friction_coefficient, 1.0, '').strip()}")

    def parameters(self, joints: Revolutes) -> list[tuple[str, np.ndarray]]:
        elastic = np.where(joints.rigid, 0.0, joints.young_modulus_Pa)
        return [*super().parameters(joints), *([("young_modulus_Pa", elastic)] if elastic.any() else [])]

    def reach_m(self, path: Course, joints: Revolutes) -> np.ndarray:
        return np.sqrt(2) * self.radius_m(joints, "bearing")


REVOLUTE = RevoluteType()
