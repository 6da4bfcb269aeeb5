# SPDX-License-Identifier: GPL-3.0-or-later
"""Ball joints of a truss in YADE: a ball at one node, a socket at another."""
from __future__ import annotations

import numpy as np
import statejump_yade as sj
from truss_joints.round_parts import RoundParts


class BallJoints(RoundParts):
    """Ball joints with clearance."""

    section = "ball_joint"
    columns = (("ball_eccentricity_m", True), ("ball_normal_force_N", False), ("ball_friction_force_N", True),
               ("ball_joint_state", False))
    shapes = {"socket": sj.Socket, "ball": sj.Ball}

    def read(self, offset: np.ndarray, contacts: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        return offset, -contacts["shearForce"]  # YADE stores the forces on the socket
