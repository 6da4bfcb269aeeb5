# SPDX-License-Identifier: GPL-3.0-or-later
"""Measurements of a bore as a table, for the terminal, a notebook or a file."""
from __future__ import annotations

from html import escape
from pathlib import Path

import numpy as np

from statejump.bores.measure import HARMONICS, Bore
from statejump.core.html import table as html_table
from statejump.core.tables import Shown, write_csv

HEADINGS = ("quantity", "value", "unit")


def rows(bore: Bore) -> list[tuple[str, str, str]]:
    """Return quantity, value and unit of every measurement of a bore."""
    mesh, middle = bore.mesh, bore.middle
    axis = ", ".join(f"{round(value, 6) + 0.0:.6f}" for value in mesh.axis)
    centre = ", ".join(f"{value:.6g}" for value in mesh.centre_m)
    dominating = bore.dominating_harmonic
    table = [
        ("faces", f"{mesh.face_count}", ""),
        ("faces of the wall", f"{mesh.wall_face_count}", ""),
        ("vertices", f"{mesh.vertex_count}", ""),
        ("body", "closed ring" if mesh.closed else "open tube", ""),
        ("mean radius (least squares)", f"{mesh.mean_radius_m:.9g}", "m"),
        ("length of the wall", f"{mesh.length_m:.6g}", "m"),
        ("axis", axis, ""),
        ("middle of the axis", centre, "m"),
        ("smallest curvature (concave negative)", f"{mesh.smallest_curvature_per_m:.6g}", "1/m"),
        ("largest curvature", f"{mesh.largest_curvature_per_m:.6g}", "1/m"),
        ("estimated error of the smooth wall", f"{mesh.reconstruction_error_m:.3g}", "m"),
        ("cylindricity, peak to valley", f"{bore.cylindricity_m:.6g}", "m"),
        ("lobes that dominate", "none" if dominating is None else f"{dominating}", "per turn"),
    ]
    if mesh.removed_face_count:
        table.insert(1, ("faces left out, which have no area", f"{mesh.removed_face_count}", ""))
    for each in bore.sections:
        table.append((f"roundness at z = {each.z_m:.4g} m, peak to valley", f"{each.roundness_error_m:.6g}", "m"))
    for order, amplitude, phase in zip(HARMONICS, middle.amplitude_m, middle.phase_rad):
        table.append((f"harmonic {order}, middle section: amplitude", f"{amplitude:.6g}", "m"))
        table.append((f"harmonic {order}, middle section: phase", f"{np.degrees(phase):.3f}", "deg"))
    if bore.journal_radius_m is not None:
        table.append(("journal radius", f"{bore.journal_radius_m:.9g}", "m"))
        table.append(("radial clearance, least squares",
                      f"{bore.clearance_m:.6g}", "m"))
        table.append(("radial clearance, smallest, journal on the axis",
                      f"{bore.smallest_clearance_m:.6g}", "m"))
    return table


def summary_lines(bore: Bore) -> list[Shown | str]:
    """Return what the command prints."""
    return [Shown(f"bore {bore.name}", HEADINGS, rows(bore), left=("quantity", "unit"))]


def write(bore: Bore, folder: Path) -> Path:
    """Write ``bore.csv``: quantity, value, unit; return its path."""
    return write_csv(folder / "bore.csv", HEADINGS, rows(bore))


def html(bore: Bore) -> str:
    """Return the table for a notebook."""
    return f"<h4>bore {escape(bore.name)}</h4>{html_table(HEADINGS, rows(bore))}"
