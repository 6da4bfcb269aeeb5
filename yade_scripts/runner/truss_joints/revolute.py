# SPDX-License-Identifier: GPL-3.0-or-later
"""Clearance revolutes of a truss in YADE: a journal at one node, a bearing at another."""
from __future__ import annotations

import numpy as np
import statejump_yade as sj
from states import dot
from truss_joints.parts import Row
from truss_joints.round_parts import RoundParts
from yade import wrapper
from yade.minieigenHP import Quaternion, Vector3


class Revolutes(RoundParts):
    """Clearance revolutes."""

    section = "revolute"
    columns = (("eccentricity_m", True), ("normal_force_N", False), ("friction_force_N", False),
               ("revolute_state", False))
    shapes = {"bearing": sj.Bearing, "journal": sj.Journal}

    def orient(self, body: wrapper.Body, joint: Row) -> None:
        turned = Quaternion()
        turned.setFromTwoVectors(Vector3(0, 0, 1), Vector3(joint["axis"]))
        body.state.ori = turned

    def read(self, offset: np.ndarray, contacts: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        axes = np.array([joint["axis"] for joint in self.rows])
        # Friction on the journal, opposite to the positive slide (anticlockwise); shearForce acts on the bearing.
        friction = dot(contacts["shearForce"], np.cross(axes, contacts["normal"]))
        return offset - dot(offset, axes)[..., None] * axes, friction
