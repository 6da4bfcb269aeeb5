# SPDX-License-Identifier: GPL-3.0-or-later
"""What makes a mechanism of a truss in motion: bodies that are no rods, their weight, links that are driven."""
from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from statejump.core.errors import MissingKey, NotAllowed
from statejump.kinds.truss.arrays import References, column, given_or, indices, names, said, vectors
from statejump.kinds.truss.joints.ball_joint import BALL_JOINT
from statejump.kinds.truss.references import known_name, vector
from statejump.schema.fields import definition, numbers, parameter, text
from statejump.schema.item_tables import ItemColumns, once, where_wrong
from statejump.schema.items import Item

if TYPE_CHECKING:
    from statejump.kinds.truss.case import Link, TrussCase
    from statejump.kinds.truss.resolved import ResolvedTruss


@definition
class Drive(Item):
    """A link of a planar truss in motion whose turning is prescribed, anticlockwise: at a constant angular velocity
    after a ramp, or by a table, straight between its rows. A couple on the link's two nodes turns it."""

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
    """Shapes of links, in shares of the way from the first to the second node and of its left normal."""

    centre: np.ndarray  # (m, 2) of mass
    moment_kg_m2: np.ndarray  # (m,) of inertia about it
    own: np.ndarray  # (m,) bool: not that of a rod


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


def resolve_bodies(links: Sequence[Link], length_m: np.ndarray, mass_kg: np.ndarray) -> Bodies:
    """Return the shapes of links; those of which nothing is said are rods."""
    moment = column(links, "moment_of_inertia_kg_m2")
    own_centre = said(links, "centre_of_mass_m")
    middle = np.stack((length_m / 2, np.zeros(len(links))), axis=1)
    given = vectors(links, "centre_of_mass_m", 2)[:, :2]
    length = np.where(length_m > 0, length_m, np.nan)  # a link without one is refused where geometry is checked
    return Bodies(
        once(np.where(own_centre[:, None], given, middle) / length[:, None]),
        given_or(moment, mass_kg * length_m**2 / 12), own_centre | ~np.isnan(moment),
    )


def weights_N(gravity_m_per_s2: np.ndarray, link_nodes: np.ndarray, mass_kg: np.ndarray, bodies: Bodies,
              node_mass_kg: np.ndarray) -> np.ndarray:
    """Return the weights of all bodies on the nodes (n, 3) [N], which are dead: where a body's centre of mass is
    depends linearly on its nodes, also when it turns in the plane."""
    found = node_mass_kg[:, None] * gravity_m_per_s2
    along, left = bodies.centre.T
    x, y, z = gravity_m_per_s2
    to_second = np.stack((along * x + left * y, along * y - left * x, along * z), axis=1) * mass_kg[:, None]
    np.add.at(found, link_nodes[:, 1], to_second)
    np.add.at(found, link_nodes[:, 0], mass_kg[:, None] * gravity_m_per_s2 - to_second)
    return found


def check(case: TrussCase, links: Mapping[str, Any]) -> None:
    """Raise StatejumpError for gravity, bodies and drives that do not fit."""
    dimension = case.truss.dimension
    vector("truss.gravity_m_per_s2", case.truss.gravity_m_per_s2, "m/s2", dimension, False)
    heavy, lumped = any(case.truss.gravity_m_per_s2 or ()), case.motion.masses == "lumped"

    def wrong(links: ItemColumns[Link]) -> np.ndarray:
        mass, centre = said(links, "mass_kg"), said(links, "centre_of_mass_m")
        body = centre | said(links, "moment_of_inertia_kg_m2")
        off_line = centre & (dimension == 3)
        if off_line.any():
            off_line &= vectors(links, "centre_of_mass_m", 2)[:, 1] != 0
        return np.asarray((body & (~mass | lumped)) | off_line | (heavy & ~mass & ~said(links, "density_kg_per_m3")))

    for link in where_wrong(case.link, wrong):
        where = {"item": f"link {link.name!r}"}
        weighed = link.mass_kg is not None or link.density_kg_per_m3 is not None
        if not weighed and any(case.truss.gravity_m_per_s2 or ()):
            raise MissingKey("mass_kg", "what has weight has one of them", section="density_kg_per_m3 or mass_kg",
                             **where)
        for key in ("centre_of_mass_m", "moment_of_inertia_kg_m2"):
            if getattr(link, key) is None:
                continue
            if link.mass_kg is None:
                raise MissingKey("mass_kg", f"{key} is of a body of that mass", **where)
            if case.motion.masses == "lumped":
                raise NotAllowed("motion.masses", "lumped", f"link {link.name!r} has {key}, which masses at nodes have "
                                 "not; must be 'consistent'")
        if link.centre_of_mass_m is not None and dimension == 3 and link.centre_of_mass_m[1]:
            raise NotAllowed("centre_of_mass_m", link.centre_of_mass_m, "in a spatial truss it is on the line of its "
                             "nodes: [distance, 0]", **where)
    driven: dict[str, str] = {}
    for drive in case.drive:
        where = {"item": f"drive {drive.name!r}"}
        if dimension == 3:
            raise NotAllowed("link", drive.link, "drives are of planar trusses", **where)
        known_name("link", drive.link, drive.link, links, "link", **where)
        if drive.link in driven:
            raise NotAllowed("link", drive.link, f"drive {driven[drive.link]!r} turns it already", **where)
        driven[drive.link] = drive.name
        _check_program(drive, where)


def _check_program(drive: Drive, where: Mapping[str, Any]) -> None:
    times, speeds = drive.table_time_s, drive.table_angular_velocity_rad_per_s
    if (times is None) != (speeds is None):
        missing = "table_time_s" if times is None else "table_angular_velocity_rad_per_s"
        raise MissingKey(missing, "a table has both times and angular velocities", **where)
    if times is None or speeds is None:
        if drive.angular_velocity_rad_per_s is None:
            raise MissingKey("angular_velocity_rad_per_s", "a number [rad/s], or a table, is needed", **where)
        return
    if drive.angular_velocity_rad_per_s is not None or drive.ramp_s:
        key = "ramp_s" if drive.ramp_s else "angular_velocity_rad_per_s"
        raise NotAllowed(key, getattr(drive, key), "only without a table", **where)
    if len(times) != len(speeds) or not times:
        raise NotAllowed("table_angular_velocity_rad_per_s", speeds, f"must be as many numbers as table_time_s has, "
                         f"which are {len(times)}, one or more", **where)
    for before, after in zip(times, times[1:]):
        if not after > before:
            raise NotAllowed("table_time_s", times, f"must increase, {after:g} follows {before:g} [s]", **where)


def refused_at_rest(truss: ResolvedTruss) -> str | None:
    """Return why a truss has no path without inertia."""
    for name in truss.drives.names[:1]:
        return f"drive {name!r} turns a link, which is motion: 'statejump reduced --dynamic' runs the case"
    for name in BALL_JOINT.rigid_ones(truss.joints[BALL_JOINT.section])[:1]:
        return (f"{BALL_JOINT.section} {name!r} has contact = 'rigid', of which a path does not say how it begins to "
                "slide: 'statejump reduced --dynamic' runs the case with motion.start = 'drawn'")
    return None
