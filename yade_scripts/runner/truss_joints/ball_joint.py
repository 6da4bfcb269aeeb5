# SPDX-License-Identifier: GPL-3.0-or-later
"""Ball joints of a truss in YADE: a ball at one node, a socket at another."""
from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import statejump_yade as sj
from failures import Names, pair
from scene import O
from truss_joints.parts import GROUND, SEPARATED, SLIP, STICK, Joints, Row, contact, give, material
from yade import wrapper
from yade.minieigenHP import Vector3


class BallJoints(Joints):
    """Ball joints with clearance."""

    section = "ball_joint"
    columns = (("ball_eccentricity_m", True), ("ball_normal_force_N", False), ("ball_friction_force_N", True),
               ("ball_joint_state", False))

    def furnish(self, bodies: list[wrapper.Body], turn: Callable[[int, int], None],
                expand: Callable[[int, Row], None]) -> None:
        for joint in self.rows:
            for part, shape in (("socket", sj.Socket), ("ball", sj.Ball)):
                node, expansion = joint[f"{part}_node"], joint[f"{part}_thermal_expansion_per_K"]
                give(bodies[node], shape(radius=joint[f"{part}_radius_m"]), material(joint, expansion), joint["group"])
                if expansion:
                    expand(node, joint)
                if joint[f"{part}_link"] != GROUND:
                    turn(joint[f"{part}_link"], node)

    def append(self, ids: list[int]) -> Iterator[tuple[int, int]]:
        self.ids = ids
        for joint in self.rows:
            yield ids[joint["ball_node"]], ids[joint["socket_node"]]

    def radii(self) -> list[float]:
        return [joint["ball_radius_m"] for joint in self.rows]

    def states(self) -> list[tuple[Any, ...]]:
        return [self._state(self.ids[joint["ball_node"]], self.ids[joint["socket_node"]]) for joint in self.rows]

    @staticmethod
    def _state(ball: int, socket: int) -> tuple[Any, ...]:
        offset = O.bodies[ball].state.pos - O.bodies[socket].state.pos
        touching = contact(ball, socket)
        if touching is None or touching.geom.penetrationDepth <= 0:
            return offset, 0.0, Vector3.Zero, SEPARATED
        # Forces of a contact act on the socket.
        return (offset, touching.phys.normalForce.dot(touching.geom.normal), -touching.phys.shearForce,
                SLIP if touching.phys.slipping else STICK)

    def name(self, found: Names) -> None:
        for joint in self.rows:
            bodies = pair(self.ids[joint["ball_node"]], self.ids[joint["socket_node"]])
            found.joints[bodies] = (joint["names"], f"ball_joint {joint['names']!r}")
