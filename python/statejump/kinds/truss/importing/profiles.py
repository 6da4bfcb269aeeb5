# SPDX-License-Identifier: GPL-3.0-or-later
"""Sections from their dimensions. Names of shapes are those in the manuals of Nastran and CalculiX.

In the figures of PBARL, y points up and z to the right. Open sections twist as their walls do, hollow ones by Bredt's
formula. A shear force is carried by the walls along it.
"""
from __future__ import annotations

from collections.abc import Callable, Sequence
from math import log1p, pi

import numpy as np

from statejump.kinds.truss.elements.beam_shapes import Rectangle, moments, solid_torsion_m4
from statejump.kinds.truss.importing.bending import Section

SOLID_SHEAR = 5 / 6
PRODUCT = 1e-12  # relative: a smaller product of inertia is rounding


def _made(parts: Sequence[Rectangle], torsion: float, shear: tuple[float, float], eccentric: bool = False) -> Section:
    """Return the section of rectangles. A rectangle with a negative side along z is a hole.

    :param shear: areas that carry forces along y and z
    """
    area, about_y, about_z, product = moments(parts)
    if abs(product) <= PRODUCT * (about_y + about_z):
        product = 0.0
    return Section(area, (about_y, about_z), torsion, (shear[0] / area, shear[1] / area), product, eccentric)


def _walls(upright: Sequence[Rectangle], level: Sequence[Rectangle], eccentric: bool = False) -> Section:
    """Return an open section of walls along y and along z."""
    torsion = sum(wall.along_y * wall.along_z**3 for wall in upright) / 3
    torsion += sum(wall.along_z * wall.along_y**3 for wall in level) / 3
    areas = sum(wall.area for wall in upright), sum(wall.area for wall in level)
    return _made([*upright, *level], torsion, areas, eccentric)


def ring(outer: float, inner: float) -> Section:
    """Return a rod or a tube by its radii. The shear factors are those of G. R. Cowper for a Poisson's ratio of 0."""
    moment, square = pi / 4 * (outer**4 - inner**4), (inner / outer) ** 2
    factor = 6 * (1 + square) ** 2 / (7 * (1 + square) ** 2 + 20 * square)
    return Section(pi * (outer**2 - inner**2), (moment, moment), 2 * moment, (factor, factor))


def ellipse(along_y: float, along_z: float) -> Section:
    """Return a solid ellipse by its two diameters."""
    area = pi / 4 * along_y * along_z
    about = area * along_z**2 / 16, area * along_y**2 / 16
    torsion = pi / 16 * (along_y * along_z) ** 3 / (along_y**2 + along_z**2)
    return Section(area, about, torsion, (6 / 7, 6 / 7))


def solid(along_y: float, along_z: float) -> Section:
    """Return a solid rectangle."""
    area = along_y * along_z
    return _made([Rectangle(along_y, along_z)], solid_torsion_m4(along_y, along_z),
                 (SOLID_SHEAR * area, SOLID_SHEAR * area))


def hollow(width: float, height: float, top: float, bottom: float, left: float, right: float) -> Section:
    """Return a box with four walls."""
    parts = [Rectangle(height, width),
             Rectangle(height - top - bottom, -(width - left - right), (bottom - top) / 2, (left - right) / 2)]
    across, up = width - (left + right) / 2, height - (top + bottom) / 2
    torsion = 4 * (across * up) ** 2 / (across / top + across / bottom + up / left + up / right)
    return _made(parts, torsion, (height * (left + right), width * (top + bottom)), top != bottom or left != right)


def flanged(height: float, low: float, high: float, web: float, low_wall: float, high_wall: float) -> Section:
    """Return a section with a web along y and two flanges."""
    flanges = [Rectangle(low_wall, low, (low_wall - height) / 2), Rectangle(high_wall, high, (height - high_wall) / 2)]
    return _walls([Rectangle(height - low_wall - high_wall, web, (low_wall - high_wall) / 2)], flanges,
                  (low, low_wall) != (high, high_wall))


def _double(inner: float, flanges: float, height: float, web: float) -> Section:
    beside = inner / 2 + flanges / 4
    return _walls([Rectangle(height, flanges / 2, 0, beside), Rectangle(height, flanges / 2, 0, -beside)],
                  [Rectangle(web, inner)])


def _tee(width: float, height: float, flange: float, web: float) -> Section:
    return _walls([Rectangle(height - flange, web)], [Rectangle(flange, width, height / 2)], True)


def _lying_tee(height: float, length: float, flange: float, web: float) -> Section:
    return _walls([Rectangle(height, flange)], [Rectangle(web, length, 0, -(flange + length) / 2)], True)


def _angle(width: float, height: float, low: float, side: float) -> Section:
    return _walls([Rectangle(height - low, side, height / 2, (side - width) / 2)], [Rectangle(low, width)], True)


def _channel(width: float, height: float, web: float, flange: float) -> Section:
    middle = (height - flange) / 2
    return _walls([Rectangle(height - 2 * flange, web, 0, (web - width) / 2)],
                  [Rectangle(flange, width, middle), Rectangle(flange, width, -middle)], True)


def _bridge(leg: float, web: float, height: float, width: float) -> Section:
    beside = (width - leg) / 2
    return _walls([Rectangle(height, leg, 0, beside), Rectangle(height, leg, 0, -beside)],
                  [Rectangle(web, width - 2 * leg, (height - web) / 2)], True)


def _zee(out: float, web: float, inner: float, height: float) -> Section:
    wall, width = (height - inner) / 2, out + web
    middle = (inner + wall) / 2
    return _walls([Rectangle(inner, web)], [Rectangle(wall, width, middle, -out / 2),
                                            Rectangle(wall, width, -middle, out / 2)])


def _cross(out: float, web: float, height: float, arm: float) -> Section:
    beside = (out / 2 + web) / 2
    return _walls([Rectangle(height, web)], [Rectangle(arm, out / 2, 0, beside), Rectangle(arm, out / 2, 0, -beside)])


def _hexagon(tip: float, width: float, height: float) -> Section:
    middle = width - 2 * tip
    area = height * (width - tip)
    about_z = middle * height**3 / 12 + tip * height**3 / 24
    about_y = height * middle**3 / 12 + height * tip**3 / 18 + height * tip * (middle / 2 + tip / 3) ** 2
    # St. Venant's approximation of solid sections without corners that point inwards.
    return Section(area, (about_y, about_z), area**4 / (40 * (about_y + about_z)), (SOLID_SHEAR, SOLID_SHEAR))


def _hat(height: float, wall: float, top: float, brim: float) -> Section:
    beside, outside = (top - wall) / 2, (top + brim) / 2
    low = (wall - height) / 2
    # The webs end below the top and stand beside the brims.
    return _walls([Rectangle(height - wall, wall, -wall / 2, side) for side in (beside, -beside)],
                  [Rectangle(wall, top, (height - wall) / 2), Rectangle(wall, brim, low, outside),
                   Rectangle(wall, brim, low, -outside)], True)


def _closed_hat(width: float, height: float, top: float, wall: float, plate: float) -> Section:
    beside, brim = (top - wall) / 2, (width - top) / 2
    outside, tall = (top + brim) / 2, height - plate - wall
    upright = [Rectangle(tall, wall, plate + tall / 2, side) for side in (beside, -beside)]
    level = [Rectangle(plate, width, plate / 2), Rectangle(wall, top, height - wall / 2)]
    level += [Rectangle(wall, brim, plate + wall / 2, side) for side in (outside, -outside)]
    across, up = top - wall, height - (plate + wall) / 2
    torsion = 4 * (across * up) ** 2 / (across / plate + across / wall + 2 * up / wall)
    areas = sum(one.area for one in upright), sum(one.area for one in level)
    return _made([*upright, *level], torsion, areas, True)


def _two_cells(width: float, height: float, first: float, left: float, mid: float, right: float, top_1: float,
               low_1: float, top_2: float, low_2: float) -> Section:
    spans = first - left - mid / 2, width - first - right - mid / 2  # clear widths of the cells
    ends = 0.0, first - mid / 2, width - right
    upright = [Rectangle(height, wall, height / 2, at + wall / 2) for wall, at in zip((left, mid, right), ends)]
    level = [Rectangle(wall, span, at, start + span / 2) for span, start, top, low in (
        (spans[0], left, top_1, low_1), (spans[1], first + mid / 2, top_2, low_2))
        for wall, at in ((top, height - top / 2), (low, low / 2))]
    # Bredt's formula of two cells: shear flows from equal twists.
    across = spans[0] + (left + mid) / 2, spans[1] + (right + mid) / 2
    ups = height - (top_1 + low_1) / 2, height - (top_2 + low_2) / 2
    shared = sum(ups) / 2 / mid
    around = (ups[0] / left + shared + across[0] / top_1 + across[0] / low_1,
              ups[1] / right + shared + across[1] / top_2 + across[1] / low_2)
    cells = np.array([across[0] * ups[0], across[1] * ups[1]])
    flows = np.linalg.solve(np.array([[around[0], -shared], [-shared, around[1]]]), 2 * cells)
    areas = sum(one.area for one in upright), sum(one.area for one in level)
    return _made([*upright, *level], float(2 * cells @ flows), areas, True)


# Number of dimensions and section by shape of PBARL and PBEAML (MSC and NX Nastran, Quick Reference Guide, PBARL).
NASTRAN: dict[str, tuple[int, Callable[..., Section]]] = {
    "ROD": (1, lambda r: ring(r, 0.0)),
    "TUBE": (2, ring),
    "TUBE2": (2, lambda outer, wall: ring(outer, outer - wall)),
    "BAR": (2, lambda width, height: solid(height, width)),
    "BOX": (4, lambda b, h, t, s: hollow(b, h, t, t, s, s)),
    "BOX1": (6, hollow),
    "I": (6, flanged),
    "I1": (4, lambda out, web, inner, h: flanged(h, out + web, out + web, web, (h - inner) / 2, (h - inner) / 2)),
    "H": (4, _double),
    "T": (4, _tee),
    "T1": (4, _lying_tee),
    "T2": (4, _tee),
    "L": (4, _angle),
    "CHAN": (4, _channel),
    "CHAN1": (4, lambda out, web, inner, h: _channel(out + web, h, web, (h - inner) / 2)),
    "CHAN2": (4, _bridge),
    "Z": (4, _zee),
    "CROSS": (4, _cross),
    "HEXA": (3, _hexagon),
    "HAT": (4, _hat),
    "HAT1": (5, _closed_hat),
    "DBOX": (10, _two_cells),
}


def _valid(found: Section) -> Section | None:
    return found if found.area > 0 and min(found.moments) > 0 and found.torsion > 0 else None


def nastran(shape: str, sizes: Sequence[float]) -> Section | None:
    """Return the section of a shape of PBARL; None: the shape is unknown, or its dimensions are invalid."""
    count, make = NASTRAN.get(shape, (0, None))
    if make is None or len(sizes) < count:
        return None
    try:
        return _valid(make(*sizes[:count]))
    except (ZeroDivisionError, np.linalg.LinAlgError):
        return None


def taper(stations: Sequence[tuple[float, float]]) -> tuple[float, float]:
    """Return the area of the uniform bar with the axial stiffness of a bar whose area is linear between stations, and
    the mean area of that bar.

    :param stations: pairs of fraction of the length, rising from 0 to 1, and area
    """
    flexibility = mean = 0.0
    for (start, first), (end, second) in zip(stations, stations[1:]):
        ratio = (second - first) / first
        flexibility += (end - start) / first * (log1p(ratio) / ratio if ratio else 1.0)  # the integral of dx / A
        mean += (end - start) * (first + second) / 2
    return 1 / flexibility, mean


def between(shape: str, first: tuple[float, float], last: tuple[float, float]) -> tuple[float, float] | None:
    """Return the area of the uniform bar with the axial stiffness of a tapered bar, whose two sizes are linear between
    its ends, and its mean area; None if the shape does not have two sizes.

    :param shape: ``RECT`` or ``CIRC``, each with two sizes
    """
    if shape not in ("RECT", "CIRC") or min(*first, *last) <= 0:
        return None
    factor = pi / 4 if shape == "CIRC" else 1.0
    (one, two), (wide, high) = first, last
    ratio = one * high / (two * wide) - 1
    # ∫ dx / A = ln(1 + ratio) / (two wide ratio)
    area = factor * two * wide * (ratio / log1p(ratio) if ratio else 1.0)
    return area, factor * (2 * one * two + one * high + wide * two + 2 * wide * high) / 6


def calculix_section(shape: str, sizes: Sequence[float]) -> Section | None:
    """Return the section of a shape of ``*BEAM SECTION``; axis y is the direction n1. None: its bending is unknown.

    In CalculiX, CIRC has the lengths of two axes; a single length is the diameter. RECT with one length is square.
    """
    found: Section | None = None
    try:
        match shape, [*sizes]:
            case "RECT", [first]:
                found = solid(first, first)
            case "RECT", [first, second, *_]:
                found = solid(first, second)
            case "CIRC", [diameter]:
                found = ring(diameter / 2, 0.0)
            case "CIRC", [first, second, *_]:
                found = ellipse(first, second) if first != second else ring(first / 2, 0.0)
            case "PIPE", [radius, wall, *_]:
                found = ring(radius, radius - wall)
            case "BOX", [width, height, right, top, left, bottom, *_]:
                found = _lying(hollow(width, height, top, bottom, left, right))
            case "I", [_, height, low, high, low_wall, high_wall, web, *_]:
                found = _lying(flanged(height, low, high, web, low_wall, high_wall))
        return None if found is None else _valid(found)
    except ZeroDivisionError:
        return None


def _lying(found: Section) -> Section:
    """Return a section whose height is along z."""
    (about_y, about_z), (along_y, along_z) = found.moments, found.shear_factors
    return Section(found.area, (about_z, about_y), found.torsion, (along_z, along_y), -found.product, found.eccentric)


def calculix(shape: str, sizes: Sequence[float]) -> float | None:
    """Return the area of ``*SOLID SECTION`` (``AREA``) or of a shape of ``*BEAM SECTION``; None: it has no area."""
    found: float | None = None
    match shape, [*sizes]:
        case "AREA", [area, *_]:
            found = area
        case "RECT", [first]:
            found = first**2
        case "RECT", [first, second, *_]:
            found = first * second
        case "CIRC", [diameter]:
            found = pi / 4 * diameter**2
        case "CIRC", [first, second, *_]:
            found = pi / 4 * first * second
        case "PIPE", [radius, wall, *_]:
            found = pi * wall * (2 * radius - wall)
        case "BOX", [width, height, right, top, left, bottom, *_]:
            found = width * height - (width - right - left) * (height - top - bottom)
        case "I", [_, height, low, high, low_wall, high_wall, web, *_]:
            found = low * low_wall + high * high_wall + (height - low_wall - high_wall) * web
        case "L", [width, height, low, side, *_]:
            found = width * low + (height - low) * side
        case "TRAPEZOID", [low, height, high, *_]:
            found = (low + high) / 2 * height
    return found if found is not None and found > 0 else None
