# SPDX-License-Identifier: GPL-3.0-or-later
"""Ball joints with clearance: a ball in a socket, with a cone of Coulomb friction; spatial trusses."""
from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from statejump.core.errors import NotAllowed
from statejump.kinds.truss.joints.protocol import ALUMINIUM, BLACK, USER, Contacts, ItemColumn, Sampled, Symbol, scaled
from statejump.kinds.truss.joints.round_parts import RoundArrays, RoundParts
from statejump.kinds.truss.resolved import Course, ResolvedTruss
from statejump.schema.fields import CHOICE, choice, definition, parameter, text
from statejump.schema.item_tables import ItemColumns
from statejump.schema.items import Item


@definition
class BallJoint(Item):
    """A ball joint with clearance and Coulomb friction in a spatial truss: the ball, at one node, moves in the socket,
    at another. A link carries and rotates each part, without spin about its own axis; without a link, a part rotates
    with its node where beams, rigid bodies or hinges rotate that, and does not rotate elsewhere."""

    socket_node: str = text(..., "where the socket's centre is")
    ball_node: str = text(..., "where the ball's centre is")
    socket_link: str | None = text(None, "whose end carries the socket; none: it turns with its node where beams end")
    ball_link: str | None = text(None, "whose end carries the ball; none: it turns with its node where beams end")
    ball_radius_m: float = parameter(..., "m", 0, 1e2, USER, above=True)
    radial_clearance_m: float = parameter(..., "m", 0, 1e2, USER + "; at ΔT = 0", above=True)
    friction_coefficient: float = parameter(..., "-", 0, 10, USER)
    ball_thermal_expansion_per_K: float = parameter(0.0, "1/K", -1e-3, 1e-3, CHOICE + ": constant radii")
    socket_thermal_expansion_per_K: float = parameter(0.0, "1/K", -1e-3, 1e-3, CHOICE + ": constant radii")
    temperature_fraction: float = parameter(1.0, "-", -10, 10, "of its program's ΔT; fully sunlit")
    program: str | None = text(None, "name of a [[program]]; the common [thermal]")
    young_modulus_Pa: float = parameter(70e9, "Pa", 0, 1e13, ALUMINIUM, above=True)
    poisson_ratio: float = parameter(0.3, "-", -0.99, 0.49, ALUMINIUM)
    contact: str = choice("hertz", ("hertz", "rigid"), CHOICE + "; rigid: in motion from the drawn shape only")


@dataclass(frozen=True)
class BallJoints(RoundArrays):
    """Ball joints with clearance."""

    socket_node: np.ndarray  # int
    ball_node: np.ndarray  # int
    socket_link: np.ndarray  # int, GROUND: its node rotates the socket, or nothing does
    ball_link: np.ndarray  # int, GROUND: likewise
    ball_radius_m: np.ndarray
    ball_thermal_expansion_per_K: np.ndarray
    socket_thermal_expansion_per_K: np.ndarray


class BallJointType(RoundParts[BallJoint, BallJoints]):
    """Ball joints with clearance, supported by the solver and the DEM."""

    section = "ball_joint"
    bounds_code = "bounds_of_clearance"
    Item = BallJoint
    Arrays = BallJoints
    columns: ClassVar[tuple[ItemColumn, ...]] = (
        ItemColumn("ball_eccentricity_m", "ball minus socket centre", vector=True),
        ItemColumn("ball_normal_force_N"),
        ItemColumn("ball_friction_force_N", "on the ball", vector=True),
    )
    varied = ("friction_coefficient", "radial_clearance_m", "ball_radius_m", "young_modulus_Pa")
    noun = "ball joint"
    inner, outer = "ball", "socket"
    eccentricity, normal_force = "ball_eccentricity_m", "ball_normal_force_N"
    friction_force = "ball_friction_force_N"
    has_axis = False

    def check_vectors(self, item: BallJoint, dimension: int) -> None:
        if dimension == 2:
            raise NotAllowed("truss.dimension", 2, code="ball_joint_planar", **self.where(item.name))

    def may_be_wrong_vectors(self, items: ItemColumns[BallJoint], dimension: int) -> np.ndarray:
        return np.full(len(items), dimension == 2)

    def check_geometry(self, truss: ResolvedTruss, joints: BallJoints, ranges_K: np.ndarray) -> None:
        rubs = (joints.friction_coefficient > 0) & ~joints.rigid
        for index in np.flatnonzero((truss.sticking == "rigid") & rubs)[:1]:
            raise NotAllowed("reduced.sticking", truss.sticking, code="ball_joint_rigid",
                             **self.where(joints.names[index]))
        self.check_parts(truss, joints, ranges_K, np.linalg.norm(self.offset_m(truss, joints), axis=1))

    def path_refuses(self, joints: BallJoints) -> tuple[str, str] | None:
        for index in np.flatnonzero(joints.rigid)[:1]:
            return joints.names[index], "rigid_ball_joint_at_rest"
        return None

    def contacts(self, run: Sampled, joints: BallJoints) -> Contacts:
        return self.touching(run, joints, run.columns["ball_friction_force_N"])

    def symbols(self, truss: ResolvedTruss, joints: BallJoints) -> list[Symbol]:
        centres = truss.nodes.position_m[joints.socket_node]
        return [Symbol(centres, "o", 1.0, 1.0, order=5), Symbol(centres, "o", 0.6, 0.6, order=6, face=BLACK)]

    def legend(self, joints: BallJoints) -> str:
        return (f"ball joint, c = {scaled(joints.radial_clearance_m, 1e3, 'mm')}, "
                f"μ = {scaled(joints.friction_coefficient, 1.0, '').strip()}")

    def friction_on_inner_N(self, joints: BallJoints, state: Mapping[str, np.ndarray]) -> np.ndarray:
        return state["ball_friction_force_N"]

    def reach_m(self, path: Course, joints: BallJoints) -> np.ndarray:
        return self.radius_m(joints, "socket")


BALL_JOINT = BallJointType()
