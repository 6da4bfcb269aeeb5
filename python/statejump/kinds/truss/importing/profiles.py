# SPDX-License-Identifier: GPL-3.0-or-later
"""Areas of cross-sections from their dimensions. Names of shapes are those in the manuals of Nastran and CalculiX."""
from __future__ import annotations

from collections.abc import Callable, Sequence
from math import log1p, pi

# Number of dimensions and area by shape of PBARL and PBEAML (MSC and NX Nastran, Quick Reference Guide, PBARL).
NASTRAN: dict[str, tuple[int, Callable[..., float]]] = {
    "ROD": (1, lambda r: pi * r**2),
    "TUBE": (2, lambda outer, inner: pi * (outer**2 - inner**2)),
    "TUBE2": (2, lambda outer, wall: pi * wall * (2 * outer - wall)),
    "BAR": (2, lambda width, height: width * height),
    "BOX": (4, lambda b, h, t, s: b * h - (b - 2 * s) * (h - 2 * t)),
    "BOX1": (6, lambda b, h, top, bottom, left, right: b * h - (b - left - right) * (h - top - bottom)),
    "I": (6, lambda h, a, b, web, ta, tb: a * ta + b * tb + (h - ta - tb) * web),
    "I1": (4, lambda out, web, inner, h: web * inner + (h - inner) * (out + web)),
    "H": (4, lambda inner, flanges, h, web: flanges * h + inner * web),
    "T": (4, lambda b, h, flange, web: b * flange + (h - flange) * web),
    "T1": (4, lambda h, length, flange, web: h * flange + length * web),
    "T2": (4, lambda b, h, flange, web: b * flange + (h - flange) * web),
    "L": (4, lambda b, h, low, side: b * low + (h - low) * side),
    "CHAN": (4, lambda b, h, web, flange: 2 * b * flange + (h - 2 * flange) * web),
    "CHAN1": (4, lambda out, web, inner, h: web * inner + (h - inner) * (out + web)),
    "CHAN2": (4, lambda leg, web, h, b: 2 * leg * h + (b - 2 * leg) * web),
    "Z": (4, lambda out, web, inner, h: web * h + out * (h - inner)),
    "CROSS": (4, lambda out, web, h, arm: web * h + out * arm),
    "HEXA": (3, lambda tip, b, h: h * (b - tip)),
    "HAT": (4, lambda h, t, top, brim: t * (top + 2 * brim + 2 * (h - t))),
    "HAT1": (5, lambda b, h, top, t, plate: b * (plate + t) + 2 * (h - plate - t) * t),
    "DBOX": (10, lambda b, h, first, left, mid, right, top1, low1, top2, low2:
             h * (left + mid + right) + (first - left - mid / 2) * (top1 + low1)
             + (b - first - right - mid / 2) * (top2 + low2)),
}


def nastran(shape: str, sizes: Sequence[float]) -> float | None:
    """Return the area of a shape of PBARL; None: the shape is unknown, or its dimensions are invalid."""
    count, area = NASTRAN.get(shape, (0, None))
    if area is None or len(sizes) < count:
        return None
    found = area(*sizes[:count])
    return found if found > 0 else None


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


def calculix(shape: str, sizes: Sequence[float]) -> float | None:
    """Return the area of ``*SOLID SECTION`` (``AREA``) or of a shape of ``*BEAM SECTION``; None: it has no area.

    In CalculiX, CIRC has the lengths of two axes; a single length is the diameter. RECT with one length is square.
    """
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
