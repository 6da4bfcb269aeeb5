# SPDX-License-Identifier: GPL-3.0-or-later
"""Tables of the errors of a surface in one state, and a reader for tables of nodes."""
from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from statejump.core.errors import MissingKey, StatejumpError
from statejump.core.table_files import read_known
from statejump.surface.design import DEFINITIONS, Design
from statejump.surface.motion import pointing_rad
from statejump.surface.zernike import noll

DRAWN = ("x_m", "y_m", "z_m")
MOVED = ("displacement_x_m", "displacement_y_m", "displacement_z_m")
COLUMNS = ("node", *DRAWN, *MOVED)
HEADER = ("quantity", "unit", "value")
Row = tuple[str, str, float]


def read_nodes(file: Path) -> tuple[np.ndarray, np.ndarray]:
    """Return the positions and displacements (nodes, 3) [m] in a table file.

    :raises StatejumpError: the file does not exist, a column is missing or unknown, or a cell is not a finite number
    """
    columns = read_known(file, COLUMNS, texts=("node",))
    for name in (*DRAWN, *MOVED):
        if name not in columns:
            raise MissingKey(name, code="node_column_missing", section=f"column {name}", file=file)
    drawn, moved = (np.stack([columns[name] for name in names], axis=1) for names in (DRAWN, MOVED))
    return drawn, moved


def design_rows(design: Design) -> list[Row]:
    """Return what the drawn surface is."""
    shape = "parabola" if design.profile else "paraboloid"
    if design.focal_length_m is None:
        shape = "line" if design.profile else "plane"
    focal = [] if design.focal_length_m is None else [("focal length", "m", design.focal_length_m)]
    return [*focal, ("profile, width" if design.profile else "aperture, diameter", "m", 2 * design.aperture_m[1]),
            (f"drawn nodes against the {shape}, RMS", "m", design.design_rms_m)]


def state_rows(
    design: Design, displacement_m: np.ndarray, measure: str, direction: Sequence[float] | None
) -> list[Row]:
    """Return the errors of the surface as rows of a table, for given displacements of its nodes."""
    found = design.errors(displacement_m, measure)
    rows = [(f"RMS, {text}" if name == "design" else f"RMS without {text}", "m", found.rms_m[name])
            for name, text in DEFINITIONS.items()]
    for place, tilt in enumerate(found.tilt_rad):
        rows.append((f"tilt of the axis towards {_named(design.frame[place])}", "rad", float(tilt)))
    if design.focal_length_m is not None:
        for place, shift in enumerate(found.vertex_shift_m[:-1].tolist()):
            rows.append((f"vertex moves along {_named(design.frame[place])}", "m", shift))
    rows.append(("vertex moves along the axis", "m", float(found.vertex_shift_m[-1])))
    if found.focal_change_m is not None:
        rows.append(("focal length grows by", "m", found.focal_change_m))
    way = design.frame[-1] if direction is None else np.asarray(direction, dtype=float)
    try:
        rows.append((f"pointing error of {_named(way)}", "rad", pointing_rad(design.position_m, displacement_m,
                                                                             way.tolist())))
    except StatejumpError:
        if direction is not None:
            raise
    return rows


def zernike_rows(design: Design, displacement_m: np.ndarray, terms: int | None) -> list[Row]:
    """Return Zernike coefficients of the error along the axis; none for a profile, or an error if requested."""
    if design.profile and terms is None:
        return []
    rows = []
    for term, value in enumerate(design.zernike_m(displacement_m, terms), start=1):
        degree, order = noll(term)
        way = "" if order == 0 else f" {'cos' if order > 0 else 'sin'} {abs(order)}θ"
        rows.append((f"Zernike {term} (Noll), degree {degree}{way}", "m", float(value)))
    return rows


def _named(way: np.ndarray) -> str:
    """Return a direction as text: the name of the axis of space that it is parallel to, otherwise its components."""
    unit = np.asarray(way) / np.linalg.norm(way)
    for place, name in enumerate("xyz"):
        if abs(abs(unit[place]) - 1) < 1e-12:
            return ("-" if unit[place] < 0 else "") + name
    return "(" + ", ".join(f"{part:.4g}" for part in unit) + ")"
