# SPDX-License-Identifier: GPL-3.0-or-later
"""Nodal forces that represent the friction of a joint. Their resultant is zero. A moment on a link becomes a pair of
forces on its ends, across it. The component that twists a link about its axis is omitted, because links of the solver
do not twist."""
from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from statejump.kinds.truss.arrays import GROUND
from statejump.kinds.truss.resolved import ResolvedTruss


@dataclass(frozen=True)
class Loads:
    """Nodal forces of all joints, joint by joint.

    :param force_N: (joints, nodes, 3), incremented by the methods
    :param place_m: (nodes, 3), positions of nodes in the state
    """

    truss: ResolvedTruss
    force_N: np.ndarray
    place_m: np.ndarray

    def push(self, joint: int, node: int, force_N: np.ndarray) -> None:
        """Add a force on a node; GROUND is ignored."""
        if node != GROUND:
            self.force_N[joint, node] += force_N

    def turn(self, joint: int, link: int, moment_N_m: np.ndarray) -> None:
        """Add a moment on a link; GROUND is ignored."""
        if link == GROUND:
            return
        one, two = self.truss.links.nodes[link]
        along = self.place_m[two] - self.place_m[one]
        pair = np.cross(moment_N_m, along) / (along @ along)
        self.force_N[joint, two] += pair
        self.force_N[joint, one] -= pair

    def rub(self, joint: int, nodes: tuple[int, int], links: tuple[int, int], friction_N: np.ndarray,
            offset_m: np.ndarray, arm_m: float) -> None:
        """Add the friction between a round part and a hollow one, with the moments on both about their nodes.

        :param nodes: nodes of the hollow part and of the round one; ``links`` likewise
        :param friction_N: friction on the round part
        :param offset_m: vector from the centre of the hollow part to that of the round one
        :param arm_m: distance from the centre of the round part to the contact point
        """
        distance = float(np.linalg.norm(offset_m))
        if distance == 0 or not friction_N.any():
            return
        for node, link, force, arm in ((nodes[0], links[0], -friction_N, arm_m + distance),
                                       (nodes[1], links[1], friction_N, arm_m)):
            self.push(joint, node, force)
            self.turn(joint, link, np.cross(offset_m / distance * arm, force))
