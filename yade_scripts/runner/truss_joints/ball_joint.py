# SPDX-License-Identifier: GPL-3.0-or-later
"""Ball joints of a truss in YADE: a ball at one node, a socket at another."""
from __future__ import annotations

from typing import Any

import statejump_yade as sj
from truss_joints.parts import SEPARATED, SLIP, STICK, Row
from truss_joints.round_parts import RoundParts
from yade.minieigenHP import Vector3


class BallJoints(RoundParts):
    """Ball joints with clearance."""

    section = "ball_joint"
    columns = (("ball_eccentricity_m", True), ("ball_normal_force_N", False), ("ball_friction_force_N", True),
               ("ball_joint_state", False))
    shapes = {"socket": sj.Socket, "ball": sj.Ball}

    def read(self, joint: Row, offset: Any, touching: Any) -> tuple[Any, ...]:
        if touching is None:
            return offset, 0.0, Vector3.Zero, SEPARATED
        # Forces of a contact act on the socket.
        return (offset, touching.phys.normalForce.dot(touching.geom.normal), -touching.phys.shearForce,
                SLIP if touching.phys.slipping else STICK)
