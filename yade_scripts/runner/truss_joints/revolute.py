# SPDX-License-Identifier: GPL-3.0-or-later
"""Clearance revolutes of a truss in YADE: a journal at one node, a bearing at another."""
from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import statejump_yade as sj
from failures import Names, pair
from scene import O
from truss_joints.parts import GROUND, SEPARATED, SLIP, STICK, Joints, Row, contact, give, material
from yade import wrapper
from yade.minieigenHP import Quaternion, Vector3


class Revolutes(Joints):
    """Clearance revolutes."""

    section = "revolute"
    columns = (("eccentricity_m", True), ("normal_force_N", False), ("friction_force_N", False),
               ("revolute_state", False))

    def furnish(self, bodies: list[wrapper.Body], turn: Callable[[int, int], None],
                expand: Callable[[int, Row], None]) -> None:
        for joint in self.rows:
            for part in ("bearing", "journal"):
                node, expansion = joint[f"{part}_node"], joint[f"{part}_thermal_expansion_per_K"]
                shape = (sj.Bearing if part == "bearing" else sj.Journal)(radius=joint[f"{part}_radius_m"])
                give(bodies[node], shape, material(joint, expansion), joint["group"])
                turned = Quaternion()
                turned.setFromTwoVectors(Vector3(0, 0, 1), Vector3(joint["axis"]))
                bodies[node].state.ori = turned
                if expansion:
                    expand(node, joint)
                if joint[f"{part}_link"] != GROUND:
                    turn(joint[f"{part}_link"], node)

    def append(self, ids: list[int]) -> Iterator[tuple[int, int]]:
        self.ids = ids
        for joint in self.rows:
            yield ids[joint["journal_node"]], ids[joint["bearing_node"]]

    def radii(self) -> list[float]:
        return [joint["journal_radius_m"] for joint in self.rows]

    def states(self) -> list[tuple[Any, ...]]:
        return [self._state(joint, self.ids[joint["journal_node"]], self.ids[joint["bearing_node"]])
                for joint in self.rows]

    def _state(self, joint: Row, journal: int, bearing: int) -> tuple[Any, ...]:
        offset = O.bodies[journal].state.pos - O.bodies[bearing].state.pos
        axis = Vector3(joint["axis"])
        offset -= offset.dot(axis) * axis
        touching = contact(journal, bearing)
        if touching is None or touching.geom.penetrationDepth <= 0:
            return offset, 0.0, 0.0, SEPARATED
        normal = touching.geom.normal
        # On the journal against the positive slide, which is anticlockwise: shearForce acts on the bearing.
        friction = touching.phys.shearForce.dot(axis.cross(normal))
        return offset, touching.phys.normalForce.dot(normal), friction, SLIP if touching.phys.slipping else STICK

    def name(self, found: Names) -> None:
        for joint in self.rows:
            bodies = pair(self.ids[joint["journal_node"]], self.ids[joint["bearing_node"]])
            found.joints[bodies] = (joint["names"], f"revolute {joint['names']!r}")
