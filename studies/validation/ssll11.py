# SPDX-License-Identifier: GPL-3.0-or-later
"""Plane truss of four bars: AFNOR SSLL11/89, Code_Aster SSLL11."""
from __future__ import annotations

from manual import CLOSED_FORM, Entry, Row, link, node, show, truss

YOUNG_PA, STRONG_M2, WEAK_M2 = 1.962e11, 2e-4, 1e-4
SMALL = 1e-3  # the reference is linear: loads are scaled, results are scaled back
EXPECTED = {"C": (0.26517, 0.08839), "D": (3.47902, -5.60084)}  # mm


def entry() -> Entry:
    case = truss("ssll11", [
        node("A", 0.0, 0.0, fixed="xy"), node("B", 1.0, 0.0, fixed="xy"), node("C", 0.5, 0.5),
        node("D", 2.0, 1.0, force_N=[0.0, -9810.0 * SMALL])],
        link=[link("AC", "A", "C", YOUNG_PA, STRONG_M2), link("BC", "B", "C", YOUNG_PA, STRONG_M2),
              link("CD", "C", "D", YOUNG_PA, WEAK_M2), link("BD", "B", "D", YOUNG_PA, WEAK_M2)])
    moved = 1e3 / SMALL * case.reduced()["displacement_m"][0]
    rows = [Row(f"displacement {axis} of {name}", "mm", expected, float(moved["ABCD".index(name), place]))
            for name, both in EXPECTED.items() for place, (axis, expected) in enumerate(zip("xy", both))]
    return Entry(
        name="ssll11", part="Statics and thermal bars", title="Plane truss of four bars (AFNOR SSLL11/89)",
        kind=CLOSED_FORM,
        source="AFNOR, Guide de validation des progiciels de calcul de structures, 1990, SSLL11/89, as printed in the "
        "Validation Manual of SCIA Engineer 26.0", uncertainty="six printed digits; SCIA Engineer itself differs by "
        "3e-4",
        statement="A truss of four bars carries 9.81 kN at its tip D. Find the displacements of C and D.",
        case=case, tolerance=2e-4, reason="solver entries",
        model="None: the case has a thousandth of the load, so that displacements are small.",
        rows=rows, verdict="All displacements agree with the printed digits.")


if __name__ == "__main__":
    show(entry())
