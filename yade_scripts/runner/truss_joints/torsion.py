# SPDX-License-Identifier: GPL-3.0-or-later
"""Torsion springs of a truss in YADE: those of the case, and those that represent joints."""
from __future__ import annotations

from math import atan2, cos, pi, sin
from typing import Any

import statejump_yade as sj
from scene import fixed_point
from truss_joints.parts import GROUND, Row
from yade.minieigenHP import Vector3


def torsion_spring(row: Row, bias_rad: float, nodes: list[Row], links: list[Row], ids: list[int],
                   **more: Any) -> sj.TorsionSpring:
    """Return a torsion spring on its own pair of links, whose directions keep the angle away from the jump at ±π. A
    link between two fixed points represents the ground.

    :param row: links, stiffness, axis and bias; the free angle is the angle of the reference configuration plus the
        bias
    """
    first, second = row["links"]
    axis = Vector3(row["axis"])

    def direction(link: int) -> Vector3:
        start, end = (Vector3(nodes[node]["position_m"]) for node in links[link]["nodes"])
        return end - start

    one = direction(first)
    if second == GROUND:
        ends = [fixed_point((0, 0, 0)), fixed_point(one)]
        pair = [(*ends, one), (*[ids[node] for node in links[first]["nodes"]], one)]
    else:
        pair = [(*[ids[node] for node in links[link]["nodes"]], direction(link)) for link in (first, second)]
    angle = _angle(pair[0][2], pair[1][2], axis)
    if abs(angle) > pi / 2:
        pair[1] = (pair[1][1], pair[1][0], -pair[1][2])
        angle = _angle(pair[0][2], pair[1][2], axis)
    # These links carry no force and are not in the engine of links.
    carried = [sj.ThermalLink(id1=root, id2=tip, stressFreeLength=1) for root, tip, _ in pair]
    free = angle + bias_rad
    return sj.TorsionSpring(
        link1=carried[0], link2=carried[1], stiffness=row["stiffness_N_m_per_rad"],
        freeAngle=atan2(sin(free), cos(free)), axis=axis, **more,
    )


def _angle(one: Vector3, other: Vector3, axis: Vector3) -> float:
    return atan2(one.cross(other).dot(axis), one.dot(other))
