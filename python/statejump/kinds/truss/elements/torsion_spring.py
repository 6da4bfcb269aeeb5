# SPDX-License-Identifier: GPL-3.0-or-later
"""Springs on the angle between two links or, in space, between one link and the ground."""
from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import pi

import numpy as np

from statejump.kinds.truss.elements.protocol import ElementType
from statejump.kinds.truss.joints.protocol import USER, BetweenLinks, Strokes, Symbol, Torsion, scaled
from statejump.kinds.truss.references import turned_links
from statejump.kinds.truss.resolved import ResolvedTruss
from statejump.schema.fields import definition, numbers, parameter, texts
from statejump.schema.items import Item

SPIRAL: Strokes = (tuple((0.28 * t * np.cos(5.2 * t), 0.28 * t * np.sin(5.2 * t)) for t in np.linspace(0.4, 3.6, 60)),)
PINK = "#CC79A7"


@definition
class TorsionSpring(Item):
    """A spring on the angle from the first link to the second, or on the angle of one link in space.

    Links point from their first to their second node, angles are anticlockwise about the axis (z in the plane). The
    moment K (angle - angle in the reference configuration - bias) rotates the links back to that angle + bias.
    """

    links: list[str] = texts(..., "two links that share a place, or one")
    stiffness_N_m_per_rad: float = parameter(..., "N m/rad", 0, 1e12, USER, above=True)
    bias_rad: float = parameter(0.0, "rad", -pi, pi, "free angle beyond the drawn one")
    axis: list[float] | None = numbers(None, "-", -1e9, 1e9, "fixed in space; needed in three dimensions")


@dataclass(frozen=True)
class TorsionSprings:
    """Springs on the anticlockwise angle about the axis from the first link to the second; a link points from its first
    to its second node. The moment is stiffness · (angle - angle in the reference configuration - bias)."""

    names: Sequence[str]
    links: np.ndarray  # (t, 2) int; (link, GROUND): the angle from the ground to one link
    stiffness_N_m_per_rad: np.ndarray
    bias_rad: np.ndarray
    axis: np.ndarray  # (t, 3) unit; z in planar trusses


class TorsionSpringType(BetweenLinks[TorsionSpring, TorsionSprings], ElementType[TorsionSpring, TorsionSprings]):
    """Torsion springs, supported by the solver and the DEM."""

    section = "torsion_spring"
    Item = TorsionSpring
    Arrays = TorsionSprings
    varied = ("stiffness_N_m_per_rad", "bias_rad")

    def check_geometry(self, truss: ResolvedTruss, elements: TorsionSprings) -> None:
        turned_links(truss, self.section, elements)

    def torsion(self, elements: TorsionSprings) -> Torsion:
        return Torsion(elements.names, elements.links, elements.axis, elements.stiffness_N_m_per_rad)

    def symbols(self, truss: ResolvedTruss, elements: TorsionSprings) -> list[Symbol]:
        # A revolute has its own symbol at the centre, so the spiral is drawn around it.
        return [Symbol(truss.turning_places(elements.links), SPIRAL, 1.6, 1.3, colour=PINK, face="none", order=4.5)]

    def legend(self, elements: TorsionSprings) -> str:
        return f"torsion spring, {scaled(elements.stiffness_N_m_per_rad, 1.0, 'N m/rad')}"

    def dem_refuses(self, elements: TorsionSprings) -> tuple[str, str, str] | None:
        for index in np.flatnonzero(np.abs(elements.bias_rad) > pi / 2)[:1]:
            return elements.names[index], "dem_large_rotation", (
                "has a bias above π/2, which the DEM cannot distinguish from its opposite")
        return None


TORSION_SPRING = TorsionSpringType()
