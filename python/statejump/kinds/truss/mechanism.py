# SPDX-License-Identifier: GPL-3.0-or-later
"""Items of a mechanism for a truss in motion: bodies of any shape, weights, driven links."""
from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from statejump.kinds.truss.arrays import References, column, given_or, indices, names, said, vectors
from statejump.schema.fields import definition, numbers, parameter, text
from statejump.schema.item_tables import once
from statejump.schema.items import Item


@definition
class Drive(Item):
    """A link of a planar truss in motion with prescribed rotation, anticlockwise: at a constant angular velocity after
    a ramp, or by a table, linear between its rows. A couple on the link's two nodes rotates it."""

    link: str = text(..., "name of the link")
    angular_velocity_rad_per_s: float | None = parameter(None, "rad/s", -1e6, 1e6, "this or a table")
    ramp_s: float = parameter(0.0, "s", 0, 1e6, "from rest to it; 0: within a step, which is an impact")
    table_time_s: list[float] | None = numbers(None, "s", 0, 1e9, "increasing; the first and the last row go on")
    table_angular_velocity_rad_per_s: list[float] | None = numbers(None, "rad/s", -1e6, 1e6, "one for each time")


@dataclass(frozen=True)
class Drives:
    """Driven links."""

    names: Sequence[str]
    link: np.ndarray  # int
    time_s: tuple[np.ndarray, ...]
    angular_velocity_rad_per_s: tuple[np.ndarray, ...]


@dataclass(frozen=True)
class Bodies:
    """Shapes of links. Lengths are fractions of the vector from the first to the second node and of its left normal."""

    centre: np.ndarray  # (m, 2) centre of mass
    moment_kg_m2: np.ndarray  # (m,) moment of inertia about it
    own: np.ndarray  # (m,) bool: whether it differs from a rod


def resolve_drives(items: list[Drive], known: References) -> Drives:
    """Return the drives as arrays."""
    tables = [_table(item) for item in items]
    return Drives(names(items), indices(items, "link", known.link), tuple(time for time, _ in tables),
                  tuple(speed for _, speed in tables))


def _table(item: Drive) -> tuple[np.ndarray, np.ndarray]:
    if item.table_time_s is not None:
        return np.array(item.table_time_s), np.array(item.table_angular_velocity_rad_per_s)
    speed = item.angular_velocity_rad_per_s
    return (np.array([0.0, item.ramp_s]), np.array([0.0, speed])) if item.ramp_s else (np.zeros(1), np.array([speed]))


def resolve_bodies(links: Sequence[Any], length_m: np.ndarray, mass_kg: np.ndarray) -> Bodies:
    """Return the shapes of links. A link without a shape is a rod."""
    moment = column(links, "moment_of_inertia_kg_m2")
    own_centre = said(links, "centre_of_mass_m")
    middle = np.stack((length_m / 2, np.zeros(len(links))), axis=1)
    given = vectors(links, "centre_of_mass_m", 2)[:, :2]
    length = np.where(length_m > 0, length_m, np.nan)  # the geometry check refuses a link without length
    return Bodies(
        once(np.where(own_centre[:, None], given, middle) / length[:, None]),
        given_or(moment, mass_kg * length_m**2 / 12), own_centre | ~np.isnan(moment),
    )


def weights_N(gravity_m_per_s2: np.ndarray, link_nodes: np.ndarray, mass_kg: np.ndarray, bodies: Bodies,
              node_mass_kg: np.ndarray) -> np.ndarray:
    """Return the weights of all bodies as loads on the nodes (n, 3) [N]. The loads are constant, because the centre of
    mass of a body is a linear function of the positions of its nodes, even if the body rotates in the plane."""
    found = node_mass_kg[:, None] * gravity_m_per_s2
    along, left = bodies.centre.T
    x, y, z = gravity_m_per_s2
    to_second = np.stack((along * x + left * y, along * y - left * x, along * z), axis=1) * mass_kg[:, None]
    np.add.at(found, link_nodes[:, 1], to_second)
    np.add.at(found, link_nodes[:, 0], mass_kg[:, None] * gravity_m_per_s2 - to_second)
    return found
