# SPDX-License-Identifier: GPL-3.0-or-later
"""Named sections of beams: area, second moments of area, torsion constant and shear factors from dimensions.

Axes y and z are the principal axes through the centroid. Torsion is St. Venant's, without warping. A shear force is
carried by the walls parallel to it; solid sections and tubes have the factors of the literature.
"""
from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import pi

import numpy as np

Dimensions = Sequence[float]


@dataclass(frozen=True)
class Properties:
    """Properties of a section."""

    cross_section_area_m2: float
    second_moments_of_area_m4: tuple[float, float]  # about y and z
    torsion_constant_m4: float
    shear_factors: tuple[float, float]  # of shear forces along y and z


@dataclass(frozen=True)
class Shape:
    """A named section: the names of its dimensions, the rule between them, its properties."""

    dimensions: tuple[str, ...]
    rule: str  # in words; empty: only that all are positive
    fits: Callable[..., bool]
    properties: Callable[..., Properties]


@dataclass(frozen=True)
class Rectangle:
    """A rectangle of a section: its sides along y and z, and its centre."""

    along_y: float
    along_z: float
    y: float = 0.0
    z: float = 0.0

    @property
    def area(self) -> float:
        return self.along_y * self.along_z


def moments(parts: Sequence[Rectangle]) -> tuple[float, float, float, float]:
    """Return area, second moments about y and z, and product moment of rectangles, about their centroid. A rectangle
    with a negative side along z is a hole."""
    area = sum(part.area for part in parts)
    centre_y = sum(part.area * part.y for part in parts) / area
    centre_z = sum(part.area * part.z for part in parts) / area
    about_y = sum(part.area * (part.along_z**2 / 12 + (part.z - centre_z) ** 2) for part in parts)
    about_z = sum(part.area * (part.along_y**2 / 12 + (part.y - centre_y) ** 2) for part in parts)
    product = sum(part.area * (part.y - centre_y) * (part.z - centre_z) for part in parts)
    return area, about_y, about_z, product


def solid_torsion_m4(one: float, other: float) -> float:
    """Return the torsion constant of a rectangle, by the series of St. Venant."""
    long, short = max(one, other), min(one, other)
    odd = np.arange(1, 1000, 2)
    series = float((np.tanh(odd * pi * long / (2 * short)) / odd**5).sum())
    return long * short**3 / 3 * (1 - 192 / pi**5 * short / long * series)


def _rod(diameter: float) -> Properties:
    return _tube(diameter, diameter / 2)


def _tube(diameter: float, wall: float) -> Properties:
    inner = diameter - 2 * wall
    area, second = pi / 4 * (diameter**2 - inner**2), pi / 64 * (diameter**4 - inner**4)
    # G. R. Cowper, J. Appl. Mech. 33 (1966) 335-340, with Poisson's ratio 0.3.
    ratio = (1 + (inner / diameter) ** 2) ** 2
    factor = 7.8 * ratio / (8.8 * ratio + 23.6 * (inner / diameter) ** 2)
    return Properties(area, (second, second), 2 * second, (factor, factor))


def _rectangle(height: float, width: float) -> Properties:
    area, about_y, about_z, _ = moments([Rectangle(height, width)])
    return Properties(area, (about_y, about_z), solid_torsion_m4(height, width), (5 / 6, 5 / 6))


def _box(height: float, width: float, wall: float) -> Properties:
    inner = height - 2 * wall, width - 2 * wall
    area, about_y, about_z, _ = moments([Rectangle(height, width), Rectangle(inner[0], -inner[1])])
    # The hole has a negative area; its second moment about y has the sign of its area.
    enclosed, around = (height - wall) * (width - wall), 2 * (height + width - 2 * wall)
    return Properties(area, (about_y, about_z), 4 * enclosed**2 * wall / around,
                      (2 * height * wall / area, 2 * width * wall / area))


def _open(parts: Sequence[Rectangle], along_y: float, along_z: float) -> Properties:
    """Return the properties of an open section of thin walls, with its walls' areas along y and z."""
    area, about_y, about_z, _ = moments(parts)
    torsion = sum(max(part.along_y, part.along_z) * min(part.along_y, part.along_z) ** 3 for part in parts) / 3
    return Properties(area, (about_y, about_z), torsion, (along_y / area, along_z / area))


def _i(height: float, width: float, web: float, flange: float) -> Properties:
    middle = (height - flange) / 2
    parts = [Rectangle(height - 2 * flange, web), Rectangle(flange, width, middle), Rectangle(flange, width, -middle)]
    return _open(parts, height * web, 2 * width * flange)


def _channel(height: float, width: float, web: float, flange: float) -> Properties:
    middle, beside = (height - flange) / 2, (width - web) / 2
    parts = [Rectangle(height - 2 * flange, web), Rectangle(flange, width, middle, beside),
             Rectangle(flange, width, -middle, beside)]
    return _open(parts, height * web, 2 * width * flange)


def _t(height: float, width: float, web: float, flange: float) -> Properties:
    parts = [Rectangle(height - flange, web), Rectangle(flange, width, height / 2)]
    return _open(parts, height * web, width * flange)


def _angle(leg: float, wall: float) -> Properties:
    parts = [Rectangle(wall, leg, wall / 2, leg / 2), Rectangle(leg - wall, wall, (leg + wall) / 2, wall / 2)]
    area, about_one, _, product = moments(parts)
    # The principal axes are at 45° to the legs; y is the axis of symmetry, about which the moment is larger.
    torsion = (2 * leg - wall) * wall**3 / 3
    return Properties(area, (about_one + abs(product), about_one - abs(product)), torsion,
                      (leg * wall / area, leg * wall / area))


def _flanged_fits(height: float, width: float, web: float, flange: float) -> bool:
    return 2 * flange < height and web <= width


_FLANGED = ("height along y", "width along z", "web thickness", "flange thickness")
SHAPES: dict[str, Shape] = {
    "rod": Shape(("diameter",), "", lambda diameter: True, _rod),
    "tube": Shape(("outer diameter", "wall thickness"), "the walls must leave a hole",
                  lambda diameter, wall: 2 * wall < diameter, _tube),
    "rectangle": Shape(("height along y", "width along z"), "", lambda height, width: True, _rectangle),
    "box": Shape(("height along y", "width along z", "wall thickness"), "the walls must leave a hole",
                 lambda height, width, wall: 2 * wall < min(height, width), _box),
    "i": Shape(_FLANGED, "flanges and web must fit into height and width", _flanged_fits, _i),
    "channel": Shape(_FLANGED, "flanges and web must fit into height and width", _flanged_fits, _channel),
    "t": Shape(_FLANGED, "flange and web must fit into height and width",
               lambda height, width, web, flange: flange < height and web <= width, _t),
    "angle": Shape(("leg length", "wall thickness"), "the wall must be thinner than the leg is long",
                   lambda leg, wall: wall < leg, _angle),
}
# Sections whose shear centre is not their centroid: twist by shear forces is neglected.
ECCENTRIC = ("channel", "t", "angle")
