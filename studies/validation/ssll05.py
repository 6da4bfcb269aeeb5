# SPDX-License-Identifier: GPL-3.0-or-later
"""Two cantilevers that a rigid body joins: AFNOR SSLL05/89."""
from __future__ import annotations

from manual import CLOSED_FORM, Entry, Row, node, section, show, truss

SMALL = 1e-3  # the reference is linear


def entry() -> Entry:
    keys = section(2e11, 1.0, 4 / 3 * 1e-8, thermal_expansion_per_K=0.0)
    case = truss("ssll05", [
        node("N1", 0.0, 0.0, clamped=True), node("N2", 2.0, 0.0), node("N3", 0.0, -0.2, clamped=True),
        node("N4", 2.0, -0.2, force_N=[0.0, -1e3 * SMALL])],
        beam=[{"name": "B1", "nodes": ["N1", "N2"], **keys}, {"name": "B2", "nodes": ["N3", "N4"], **keys}],
        rigid=[{"name": "R", "master": "N2", "nodes": ["N4"]}])
    run = case.reduced()
    moved = run["displacement_m"][0] / SMALL
    force, moment = run["beam_force_first_N"][0] / SMALL, run["beam_moment_first_N_m"][0] / SMALL
    return Entry(
        name="ssll05", part="Beams and frames", title="Cantilevers joined by a rigid body (AFNOR SSLL05/89)",
        kind=CLOSED_FORM,
        source="AFNOR, Guide de validation des progiciels de calcul de structures, 1990, SSLL05/89, as printed in the "
        "Validation Manual of SCIA Engineer 26.0", uncertainty="exact for beams that do not stretch",
        statement="Two cantilevers of 2 m, 0.2 m apart, are joined at their tips by a rigid body. A force of 1 kN acts "
        "on one tip. Find tip displacement, shear force and moment.", case=case, tolerance=2e-4,
        reason="solver entries",
        rows=[Row("tip displacement", "mm", -125.0, 1e3 * float(moved[1, 1])),
              Row("shear force of the upper beam", "kN", 0.5, abs(float(force[0, 1])) / 1e3),
              Row("moment at the upper clamp", "kN m", 0.5, abs(float(moment[0, 2])) / 1e3)],
        verdict="The rigid body shares the force between both beams.")


if __name__ == "__main__":
    show(entry())
