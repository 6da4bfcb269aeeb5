# SPDX-License-Identifier: GPL-3.0-or-later
"""Two bars under a load: AFNOR SSLL09/89."""
from __future__ import annotations

from math import cos, radians, sin

from manual import CLOSED_FORM, Entry, Row, link, node, show, truss

LENGTH_M, AREA_M2, YOUNG_PA = 4.5, 3e-4, 2.1e11
SMALL = 1e-3  # the reference is linear: loads are scaled, results are scaled back


def entry() -> Entry:
    half, depth = LENGTH_M * cos(radians(30)), LENGTH_M * sin(radians(30))
    case = truss("ssll09", [
        node("N1", 0.0, 0.0, fixed="xy"), node("N2", half, -depth, force_N=[0.0, -21e3 * SMALL]),
        node("N3", 2 * half, 0.0, fixed="xy")],
        link=[link("B1", "N1", "N2", YOUNG_PA, AREA_M2), link("B2", "N3", "N2", YOUNG_PA, AREA_M2)])
    run = case.reduced()
    return Entry(
        name="ssll09", part="Statics and thermal bars", title="Plane truss with nodal load (AFNOR SSLL09/89)",
        kind=CLOSED_FORM, source="AFNOR, Guide de validation des progiciels de calcul de structures, 1990, SSLL09/89, "
        "as printed in the Validation Manual of SCIA Engineer 26.0", uncertainty="exact in linear theory",
        statement="Two steel bars of 4.5 m and 3 cm² at 30° carry 21 kN where they meet. Find displacement and stress.",
        case=case, tolerance=2e-4, reason="solver entries",
        model="None: the case has a thousandth of the load, so that displacements are small.",
        rows=[Row("displacement of the load", "mm", 3.0, -1e3 / SMALL * float(run["displacement_m"][0, 1, 1])),
              Row("stress", "MPa", 70.0, -float(run["links/axial_force_N"][0, 0]) / AREA_M2 / SMALL / 1e6)],
        verdict="Both numbers agree with linear theory.")


if __name__ == "__main__":
    show(entry())
