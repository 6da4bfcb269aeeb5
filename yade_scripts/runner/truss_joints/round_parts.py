# SPDX-License-Identifier: GPL-3.0-or-later
"""Joints with clearance of a truss in YADE: a round part at one node in the bore of another."""
from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any, ClassVar

import numpy as np
from failures import Names, pair
from states import States, dot
from truss_joints.parts import GROUND, SEPARATED, SLIP, STICK, Joints, Row, give, material
from yade import wrapper


class RoundParts(Joints):
    """Joints of a round part in a bore. Keys of the case begin with the part's name: ``journal_node``,
    ``journal_radius_m``..."""

    shapes: ClassVar[dict[str, Any]]  # shapes by part: the outer one, then the inner one

    def furnish(self, bodies: list[wrapper.Body], turn: Callable[[int, int], None],
                expand: Callable[[int, Row], None]) -> None:
        for joint in self.rows:
            for part, shape in self.shapes.items():
                node, expansion = joint[f"{part}_node"], joint[f"{part}_thermal_expansion_per_K"]
                give(bodies[node], shape(radius=joint[f"{part}_radius_m"]), material(joint, expansion), joint["group"])
                self.orient(bodies[node], joint)
                if expansion:
                    expand(node, joint)
                if joint[f"{part}_link"] != GROUND:
                    turn(joint[f"{part}_link"], node)

    def orient(self, body: wrapper.Body, joint: Row) -> None:
        """Rotate a part to the joint's axis, if it has one."""

    def bodies_of(self, joint: Row) -> tuple[int, int]:
        """Return the bodies of inner and outer part."""
        outer, inner = self.shapes
        return self.ids[joint[f"{inner}_node"]], self.ids[joint[f"{outer}_node"]]

    def append(self, ids: list[int]) -> Iterator[tuple[int, int]]:
        self.ids = ids
        for joint in self.rows:
            yield self.bodies_of(joint)

    def radii(self) -> list[float]:
        _, inner = self.shapes
        return [joint[f"{inner}_radius_m"] for joint in self.rows]

    def states(self, states: States) -> list[np.ndarray]:
        pairs = [self.bodies_of(joint) for joint in self.rows]
        inner, outer = (states.bodies([bodies[side] for bodies in pairs])["position"] for side in (0, 1))
        contacts = states.contacts(pairs)
        touches = (contacts["real"] > 0) & (contacts["penetrationDepth"] > 0)
        offset, friction = self.read(inner - outer, contacts)
        vector = friction.ndim > 2
        return [offset, np.where(touches, dot(contacts["normalForce"], contacts["normal"]), 0.0),
                np.where(touches[..., None] if vector else touches, friction, 0.0),
                np.where(touches, np.where(contacts["slipping"] > 0, SLIP, STICK), SEPARATED)]

    def read(self, offset: np.ndarray, contacts: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the values of the columns: offset of the centres, and friction force at the contact point."""
        raise NotImplementedError

    def name(self, found: Names) -> None:
        for joint in self.rows:
            found.joints[pair(*self.bodies_of(joint))] = (joint["names"], f"{self.section} {joint['names']!r}")
