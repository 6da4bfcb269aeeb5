# SPDX-License-Identifier: GPL-3.0-or-later
"""Clearance revolutes of a truss in YADE: a journal at one node, a bearing at another."""
from __future__ import annotations

from typing import Any

import statejump_yade as sj
from truss_joints.parts import SEPARATED, SLIP, STICK, Row
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

    def read(self, joint: Row, offset: Any, touching: Any) -> tuple[Any, ...]:
        axis = Vector3(joint["axis"])
        offset -= offset.dot(axis) * axis
        if touching is None:
            return offset, 0.0, 0.0, SEPARATED
        normal = touching.geom.normal
        # On the journal against the positive slide, which is anticlockwise: shearForce acts on the bearing.
        friction = touching.phys.shearForce.dot(axis.cross(normal))
        return offset, touching.phys.normalForce.dot(normal), friction, SLIP if touching.phys.slipping else STICK
