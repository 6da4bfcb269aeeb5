# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks of bodies, weights and drives of a truss, and rejection of trusses without a quasi-static path."""
from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from statejump.core.errors import MissingKey, NotAllowed, StatejumpError
from statejump.kinds.truss.arrays import said, vectors
from statejump.kinds.truss.joints import JOINTS
from statejump.kinds.truss.mechanism import Drive
from statejump.kinds.truss.references import known_name, vector
from statejump.kinds.truss.resolved import ResolvedTruss
from statejump.kinds.truss.sections import Link, TrussSections
from statejump.schema.item_tables import ItemColumns, where_wrong


def check(case: TrussSections, links: Mapping[str, Any]) -> None:
    """Raise StatejumpError for invalid gravity, bodies or drives."""
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
            raise MissingKey("mass_kg", code="mass_missing", section="density_kg_per_m3 or mass_kg", **where)
        for key in ("centre_of_mass_m", "moment_of_inertia_kg_m2"):
            if getattr(link, key) is None:
                continue
            if link.mass_kg is None:
                raise MissingKey("mass_kg", code="mass_of_body_missing", of=key, **where)
            if case.motion.masses == "lumped":
                raise NotAllowed("motion.masses", "lumped", code="lumped_mass_of_body", link=link.name, of=key)
        if link.centre_of_mass_m is not None and dimension == 3 and link.centre_of_mass_m[1]:
            raise NotAllowed("centre_of_mass_m", link.centre_of_mass_m, code="centre_not_on_line", **where)
    for beam in case.beam if heavy else ():
        if beam.density_kg_per_m3 is None:
            raise MissingKey("density_kg_per_m3", code="mass_missing", item=f"beam {beam.name!r}")
        for key in ("offset_first_m", "offset_second_m"):
            if any(getattr(beam, key) or ()):
                raise NotAllowed(key, getattr(beam, key), code="offset_with_gravity", item=f"beam {beam.name!r}")
    driven: dict[str, str] = {}
    for drive in case.drive:
        where = {"item": f"drive {drive.name!r}"}
        if dimension == 3:
            raise NotAllowed("link", drive.link, code="drive_not_planar", **where)
        known_name("link", drive.link, drive.link, links, "link", **where)
        if drive.link in driven:
            raise NotAllowed("link", drive.link, code="link_driven_already", drive=driven[drive.link], **where)
        driven[drive.link] = drive.name
        _check_program(drive, where)


def _check_program(drive: Drive, where: Mapping[str, Any]) -> None:
    times, speeds = drive.table_time_s, drive.table_angular_velocity_rad_per_s
    if (times is None) != (speeds is None):
        missing = "table_time_s" if times is None else "table_angular_velocity_rad_per_s"
        raise MissingKey(missing, code="drive_table_incomplete", **where)
    if times is None or speeds is None:
        if drive.angular_velocity_rad_per_s is None:
            raise MissingKey("angular_velocity_rad_per_s", code="drive_without_speed", **where)
        return
    if drive.angular_velocity_rad_per_s is not None or drive.ramp_s:
        key = "ramp_s" if drive.ramp_s else "angular_velocity_rad_per_s"
        raise NotAllowed(key, getattr(drive, key), code="conflicting_key", other="a table", **where)
    if len(times) != len(speeds) or not times:
        raise NotAllowed("table_angular_velocity_rad_per_s", speeds, code="drive_table_length", times=len(times),
                         **where)
    for before, after in zip(times, times[1:]):
        if not after > before:
            raise NotAllowed("table_time_s", times, code="drive_times_not_increasing", after=after,
                             before=before, **where)


def refuse_beams(truss: ResolvedTruss, what: str) -> None:
    """Raise StatejumpError for a truss with beams in a model that has no rotations of nodes.

    :param what: the model, for example "the motion of a truss"
    """
    found = truss.bending()
    if found is not None:
        section, name = found
        raise StatejumpError(code="beams_not_supported", case=truss.name, part=f"{section} {name!r}", model=what)


def check_at_rest(truss: ResolvedTruss) -> None:
    """Raise StatejumpError for a truss without a quasi-static path."""
    if truss.free:
        raise StatejumpError(code="free_truss", case=truss.name)
    for name in truss.drives.names[:1]:
        raise StatejumpError(code="driven_truss", case=truss.name, drive=name)
    for joint in JOINTS:
        unable = joint.path_refuses(truss.joints[joint.section])
        if unable is not None:
            name, code = unable
            raise StatejumpError(code=code, case=truss.name, joint=name, part=f"{joint.section} {name!r}")
