# SPDX-License-Identifier: GPL-3.0-or-later
"""Rectangular, cylindrical and spherical coordinate systems."""
from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import cos, radians, sin

import numpy as np

KINDS = ("R", "C", "S")
# Points or directions nearer than this fraction of their distance span no plane; input has at least four digits.
PARALLEL = 1e-6


@dataclass(frozen=True)
class Frame:
    """A coordinate system.

    :param kind: ``R`` (x, y, z), ``C`` (radius, angle [°], height) or ``S`` (radius, angle from z, angle about z)
    :param axes: matrix whose rows are the axes x, y, z of the system, in the basic system
    """

    kind: str
    origin: np.ndarray
    axes: np.ndarray

    def point(self, given: Sequence[float]) -> np.ndarray:
        """Return a point in the basic system."""
        return np.asarray(self.origin + self._rectangular(given) @ self.axes)

    def _rectangular(self, given: Sequence[float]) -> np.ndarray:
        first, second, third = given
        if self.kind == "C":
            return np.array([first * cos(radians(second)), first * sin(radians(second)), third])
        if self.kind == "S":
            across = first * sin(radians(second))
            return np.array([across * cos(radians(third)), across * sin(radians(third)), first * cos(radians(second))])
        return np.array([first, second, third], dtype=float)

    def directions(self, at: Sequence[float]) -> np.ndarray:
        """Return the three coordinate directions at a point, as rows in the basic system; on the axis x, y, z."""
        if self.kind == "R":
            return self.axes
        x, y, z = self.axes @ (np.asarray(at, dtype=float) - self.origin)
        across = np.hypot(x, y)
        if across <= PARALLEL * np.hypot(across, z):
            return self.axes
        radial = np.array([x, y, 0.0]) / across
        around = np.array([-radial[1], radial[0], 0.0])
        if self.kind == "C":
            return np.asarray(np.array([radial, around, [0.0, 0.0, 1.0]]) @ self.axes)
        out = np.array([x, y, z]) / np.hypot(across, z)
        return np.asarray(np.array([out, np.cross(around, out), around]) @ self.axes)


BASIC = Frame("R", np.zeros(3), np.eye(3))


def by_points(kind: str, origin: np.ndarray, on_z: np.ndarray, in_xz: np.ndarray) -> Frame | None:
    """Return the system of Nastran from a point on its z axis and one in its xz plane; None: they span no plane."""
    z, across = on_z - origin, in_xz - origin
    length, size = np.linalg.norm(z), np.linalg.norm(across)
    if length == 0 or size == 0:
        return None
    z = z / length
    y = np.cross(z, across)
    height = np.linalg.norm(y)
    if height <= PARALLEL * size:
        return None
    y = y / height
    return Frame(kind, origin, np.array([np.cross(y, z), y, z]))


def by_axis(kind: str, origin: np.ndarray, on_x: np.ndarray, in_xy: np.ndarray) -> Frame | None:
    """Return the system of Abaqus from a point on its x axis and one in its xy plane; None: they span no plane."""
    found = by_points(kind, origin, on_x, in_xy)
    if found is None:
        return None
    # by_points gets x as its z axis, and its x axis, in the plane of the third point, becomes y.
    y, _, x = found.axes
    return Frame(kind, origin, np.array([x, y, np.cross(x, y)]))


def about_axis(first: np.ndarray, second: np.ndarray) -> Frame | None:
    """Return the cylindrical system whose axis passes through two points; None if the points coincide.

    The zero of its angle is arbitrary, so the system is used only for directions.
    """
    z = second - first
    aside = np.eye(3)[int(np.argmin(np.abs(z)))]
    return by_points("C", first, second, first + aside * max(float(np.linalg.norm(z)), 1.0))


def rotated(point: np.ndarray, first: np.ndarray, second: np.ndarray, degrees: float) -> np.ndarray:
    """Return a point after a rotation about the axis through two other points."""
    axis = (second - first) / np.linalg.norm(second - first)
    way, angle = point - first, radians(degrees)
    return np.asarray(first + way * cos(angle) + np.cross(axis, way) * sin(angle)
                      + axis * (axis @ way) * (1 - cos(angle)))
