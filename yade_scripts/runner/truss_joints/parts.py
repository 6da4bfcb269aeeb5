# SPDX-License-Identifier: GPL-3.0-or-later
"""Code shared by the joints of a truss in YADE: interface, items of a section, material of bodies."""
from __future__ import annotations

from collections.abc import Callable, Iterator
from math import atan
from typing import Any

import numpy as np
import statejump_yade as sj
from failures import Names, SceneFailure
from states import States
from yade import wrapper

GROUND = -1
STICK, SLIP, AT_STOP, SEPARATED = 1, 2, 3, 0  # as statejump.results.contents has them

Row = dict[str, Any]


def rows(section: dict[str, Any]) -> list[Row]:
    """Return a section in columns as one dict per item."""
    count = len(section["names"])
    whole = {key: values for key, values in section.items() if isinstance(values, list) and len(values) == count}
    return [{key: values[place] for key, values in whole.items()} for place in range(count)]


def material(part: Row, expansion: float = 0.0) -> sj.ThermalFrictMat:
    """Return the material of a contact part."""
    return sj.ThermalFrictMat(
        young=part["young_modulus_Pa"], poisson=part["poisson_ratio"],
        frictionAngle=atan(part["friction_coefficient"]), thermalExpansion=expansion,
    )


def give(body: wrapper.Body, shape, made, group: int) -> None:
    """Set shape and material of a body. The body interacts only with bodies of its contact group."""
    body.shape, body.material, body.bound = shape, made, wrapper.Aabb()
    body.mask = 1 << group


class Joints:
    """All joints of one type. ``ids``: numbers of the bodies of the nodes, set by :meth:`append`.

    :param case: result of ``statejump.kinds.truss.dem.resolved``
    """

    section: str  # of the case
    columns: tuple[tuple[str, bool], ...]  # columns of every joint: key, and whether it is a vector

    def __init__(self, case: dict[str, Any]) -> None:
        self.rows = rows(case[self.section])
        self.nodes: list[Row] = rows(case["node"])
        self.ids: list[int] = []

    def furnish(self, bodies: list[wrapper.Body], turn: Callable[[int, int], None],
                expand: Callable[[int, Row], None]) -> None:
        """Set contact shapes and materials of the bodies of nodes.

        :param turn: called with a link and a node whose body rotates with it
        :param expand: called with a node whose body expands, and the joint with its temperature
        """
        raise NotImplementedError

    def append(self, ids: list[int]) -> Iterator[tuple[int, int]]:
        """Append the bodies that belong to joints only; yield the pairs of bodies that may touch."""
        raise NotImplementedError

    def radii(self) -> list[float]:
        """Return the radii of the bodies for contact detection."""
        raise NotImplementedError

    def torsion_springs(self) -> list[sj.TorsionSpring]:
        """Return the torsion springs that represent joints; call it after :meth:`append`."""
        return []

    def prismatic_joints(self) -> list[sj.PrismaticJoint]:
        """Return the prismatic joints that represent joints; call it after :meth:`append`."""
        return []

    def start_slides(self) -> dict[int, tuple[float, float, float]]:
        """Return, by body, the slide [m] that loads the contact of this body with the initial friction, see
        :func:`scene.start_sticking`."""
        return {}

    def states(self, states: States) -> list[np.ndarray]:
        """Return the values of each column by sample and joint, with vectors along a third axis."""
        raise NotImplementedError

    def faults(self, states: States) -> Iterator[SceneFailure]:
        """Yield a failure for the first event that is outside the model of a joint."""
        yield from ()

    def faces(self) -> dict[int, tuple[str, str]]:
        """Return joint and position text of the bodies that belong to joints, by body."""
        return {}

    def name(self, found: Names) -> None:
        """Add the case's names of its contacts."""
        raise NotImplementedError
