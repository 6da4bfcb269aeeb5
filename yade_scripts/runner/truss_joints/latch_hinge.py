# SPDX-License-Identifier: GPL-3.0-or-later
"""Latch hinges of a truss in YADE: torsion springs with free play and friction."""
from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import statejump_yade as sj
from failures import Names
from states import States
from truss_joints.parts import SLIP, STICK, Joints, Row, rows
from truss_joints.torsion import torsion_spring
from yade import wrapper


class LatchHinges(Joints):
    """Latch hinges have no contacts: the engine of torsion springs applies their moments."""

    section = "latch_hinge"
    columns = (("hinge_rotation_rad", False), ("hinge_moment_N_m", False), ("latch_hinge_state", False))

    def __init__(self, case: dict[str, Any]) -> None:
        super().__init__(case)
        self._links = rows(case["link"])
        self._springs: list[sj.TorsionSpring] = []

    def furnish(self, bodies: list[wrapper.Body], turn: Callable[[int, int], None],
                expand: Callable[[int, Row], None]) -> None:
        """Nodes need no part for them."""

    def append(self, ids: list[int]) -> Iterator[tuple[int, int]]:
        self.ids = ids
        for hinge in self.rows:
            friction = hinge["friction_stiffness_N_m_per_rad"]
            self._springs.append(torsion_spring(
                hinge, 0.0, self.nodes, self._links, ids, deadband=hinge["deadband_rad"],
                preload=hinge["preload_moment_N_m"], frictionLimit=hinge["friction_moment_N_m"],
                frictionStiffness=friction, frictionMoment=hinge["start_friction_N_m"],
                slipAngle=hinge["start_rotation_rad"] - hinge["start_friction_N_m"] / friction,
            ))
        yield from ()

    def radii(self) -> list[float]:
        return []

    def torsion_springs(self) -> list[sj.TorsionSpring]:
        return self._springs

    def states(self, states: States) -> list[np.ndarray]:
        found = states.springs(self._springs)
        free, limit = (np.array([getattr(spring, name) for spring in self._springs])
                       for name in ("freeAngle", "frictionLimit"))
        return [found["angle"] - free, found["moment"],
                np.where(np.abs(found["frictionMoment"]) >= limit, SLIP, STICK)]

    def name(self, found: Names) -> None:
        for hinge, spring in zip(self.rows, self._springs):
            found.add_torsion_spring(spring, f"latch_hinge {hinge['names']!r}", hinge["names"])
