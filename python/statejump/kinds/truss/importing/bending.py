# SPDX-License-Identifier: GPL-3.0-or-later
"""Bending of beams of a deck: principal axes of a section, and the nodal equivalents of loads on a beam."""
from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from math import atan2, cos, sin

import numpy as np

# Sine of the angle below which a direction is along a beam; decks have at least four digits.
ALONG = 1e-4
# Product of inertia, over the larger second moment, below which the axes of a section are principal.
PRINCIPAL = 1e-9
# Stiffness of a beam that its deck gives as 0, over its largest one: cases need a positive number.
SOFT = 1e-6
GAUSS = np.polynomial.legendre.leggauss(4)  # exact for cubic shape functions times a linear load


@dataclass(frozen=True)
class Section:
    """A section of a beam, in the units of the deck. Axes y and z are those of its program.

    :param moments: second moments of area about y and z
    :param product: integral of y z over the area
    :param shear_factors: for forces along y and z; 0: rigid in shear
    :param eccentric: whether its shear centre is beside its centroid
    """

    area: float
    moments: tuple[float, float]
    torsion: float
    shear_factors: tuple[float, float] = (0.0, 0.0)
    product: float = 0.0
    eccentric: bool = False

    def turned(self) -> tuple[Section, float]:
        """Return the section in principal axes, and the angle from its axis y to the principal axis y, about x."""
        about_y, about_z = self.moments
        if abs(self.product) <= PRINCIPAL * max(about_y, about_z):
            return self, 0.0
        angle = atan2(2 * self.product, about_z - about_y) / 2
        c, s = cos(angle), sin(angle)
        large = about_z * c**2 + about_y * s**2 + 2 * self.product * s * c
        return replace(self, moments=(about_y + about_z - large, large), product=0.0), angle


@dataclass
class Bending:
    """Bending of a beam, in the units of the deck.

    :param axis_y: direction of axis y of the section, in the basic system; its part across the beam counts
    :param shear_modulus: None: the beam has no stiffness in torsion and is rigid in shear
    :param stations: sections by fraction of the length, from 0 to 1; a uniform beam has at most one
    :param gradient: temperature per length along y and z of the section
    :param released: what each end does not transmit to its node: Fx, Rx, Ry, Rz in the axes of the beam
    :param offsets: from the nodes to the ends of the beam (2, 3), in the basic system
    """

    section: Section
    axis_y: np.ndarray
    shear_modulus: float | None = None
    stations: tuple[tuple[float, Section], ...] = ()
    gradient: tuple[float, float] = (0.0, 0.0)
    released: tuple[frozenset[str], frozenset[str]] = (frozenset(), frozenset())
    offsets: np.ndarray = field(default_factory=lambda: np.zeros((2, 3)))

    @property
    def turned_ends(self) -> tuple[bool, bool]:
        """Whether the rotation of each node has an effect: its end transmits a moment or has an offset."""
        torsion = {"Rx"} & (self.released[0] | self.released[1])
        first, second = (bool({"Rx", "Ry", "Rz"} - released - torsion or offset.any())
                         for released, offset in zip(self.released, self.offsets))
        return first, second

    def principal(self, first: np.ndarray, second: np.ndarray) -> tuple[Section, float, np.ndarray | None]:
        """Return the section in principal axes, their angle from its own axes about x, and x, y, z as rows; None for
        them if y is along the beam.

        :param first: position of the first end of the beam
        """
        section, angle = self.section.turned()
        own = triad(first, second, self.axis_y)
        if own is None:
            return section, angle, None
        c, s = cos(angle), sin(angle)
        return section, angle, np.array([own[0], c * own[1] + s * own[2], c * own[2] - s * own[1]])


def across(first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """Return a direction across a beam, for sections without preferred axes."""
    return np.asarray(np.eye(3)[int(np.argmin(np.abs(second - first)))])


def triad(first: np.ndarray, second: np.ndarray, axis_y: np.ndarray) -> np.ndarray | None:
    """Return the axes x, y, z of a beam as rows; None if the direction of y is along the beam."""
    along = second - first
    length, size = float(np.linalg.norm(along)), float(np.linalg.norm(axis_y))
    if length == 0 or size == 0:
        return None
    x = along / length
    across = axis_y / size - (axis_y / size @ x) * x
    height = float(np.linalg.norm(across))
    if height <= ALONG:
        return None
    return np.array([x, across / height, np.cross(x, across / height)])


@dataclass(frozen=True)
class Load:
    """A load on a part of a beam: force per length or moment per length in the basic system, linear between two
    positions. If both positions are equal, it is a force or a moment.

    :param start: position from the first node, as a fraction of the length
    """

    start: float
    end: float
    first: np.ndarray
    last: np.ndarray
    moment: bool = False


def nodal_loads(load: Load, length: float, axes: np.ndarray, shear: tuple[float, float]) -> list[np.ndarray]:
    """Return force and moment at the first node, force and moment at the second node, in the basic system.

    These loads displace the nodes of a beam exactly as the load does.

    :param axes: of the beam, as rows
    :param shear: 12 E I / (k G A l²) of bending in the planes xy and xz
    """
    if load.end == load.start:
        found = _at(load.start, axes @ load.first, load.moment, length, shear)
    else:
        found = np.zeros((4, 3))
        middle, half = (load.start + load.end) / 2, (load.end - load.start) / 2
        for point, weight in zip(*GAUSS):
            share = (1 + point) / 2
            value = axes @ (load.first * (1 - share) + load.last * share)
            found += weight * half * length * _at(middle + half * point, value, load.moment, length, shear)
    return [part @ axes for part in found]


def _at(xi: float, value: np.ndarray, is_moment: bool, length: float, shear: tuple[float, float]) -> np.ndarray:
    """Return the nodal loads of a force or a moment at a position, in the axes of the beam: rows force, moment."""
    found = np.zeros((4, 3))
    found[[1, 3] if is_moment else [0, 2], 0] = value[0] * np.array([1 - xi, xi])
    # The plane xy bends about z. In the plane xz a rotation about y lowers the beam: its sign is reversed.
    for across, about, phi, sign in ((1, 2, shear[0], 1.0), (2, 1, shear[1], -1.0)):
        of: Callable[..., np.ndarray] = _rotations if is_moment else _deflections
        acting = value[about] * sign if is_moment else value[across]
        one, turn_one, two, turn_two = of(xi, length, phi) * acting
        found[0, across] += one
        found[1, about] += sign * turn_one
        found[2, across] += two
        found[3, about] += sign * turn_two
    return found


def _deflections(xi: float, length: float, phi: float) -> np.ndarray:
    """Return the deflection at a position for unit deflection and rotation of the first and of the second node."""
    return np.array([1 - 3 * xi**2 + 2 * xi**3 + phi * (1 - xi),
                     length * (xi - 2 * xi**2 + xi**3 + phi / 2 * (xi - xi**2)),
                     3 * xi**2 - 2 * xi**3 + phi * xi,
                     length * (xi**3 - xi**2 - phi / 2 * (xi - xi**2))]) / (1 + phi)


def _rotations(xi: float, length: float, phi: float) -> np.ndarray:
    """Return the rotation of the section at a position for the same unit displacements."""
    return np.array([6 / length * (xi**2 - xi), 1 - 4 * xi + 3 * xi**2 + phi * (1 - xi),
                     6 / length * (xi - xi**2), 3 * xi**2 - 2 * xi + phi * xi]) / (1 + phi)


def shear_parameters(bending: Bending, modulus: float, length: float) -> tuple[float, float]:
    """Return 12 E I / (k G A l²) of bending in the planes xy and xz; 0: rigid in shear."""
    section, shear = bending.section, bending.shear_modulus
    found = [12 * modulus * inertia / (factor * shear * section.area * length**2) if factor and shear else 0.0
             for factor, inertia in zip(section.shear_factors, section.moments[::-1])]
    return found[0], found[1]
