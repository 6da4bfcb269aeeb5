# SPDX-License-Identifier: GPL-3.0-or-later
"""Bimetallic strip: Timoshenko's formula; the verification example of Dlubal and Hyfeast."""
from __future__ import annotations

from bimaterial import Strip
from manual import CLOSED_FORM, Entry, Row, show


def entry() -> Entry:
    strip = Strip("bimetal", 3.0, 0.15, 0.1, (2e11, 5e-6), (2e11, 10e-6), 50.0)
    unequal = Strip("bimetal", 0.2, 1e-3, 0.01, (140e9, 1.2e-6), (117e9, 17e-6), 100.0)
    return Entry(
        name="bimetal", part="Beams and frames", title="Bimetallic strip (Timoshenko)", kind=CLOSED_FORM,
        source="S. Timoshenko, J. Opt. Soc. Am. 11 (1925) 233-255; numbers of example E.15 of Hyfeast "
        "(jrcho.github.io/Hyfeast): 3 L² Δα ΔT/(4 h) = 5.625 mm, its solid elements give 5.6755 mm",
        uncertainty="exact in linear theory; 0.9 % for the solid elements",
        statement="Two bonded layers with different thermal expansion are heated. Find the deflection of the free end: "
        "a strip of 3 m with layers of 150 mm and equal moduli, and a strip of invar and copper of 200 mm with layers "
        "of 1 mm. Each layer is a row of beams with offsets from common nodes.", case=unequal.case(), tolerance=2e-4,
        reason="solver entries",
        model="The free strip is an arc, not a parabola, and its interface expands.",
        rows=[Row("equal moduli, 3 m", "mm", 5.625, 1e3 * strip.deflection_m(), theory=1e3 * strip.arc_m()),
              Row("equal moduli, 3 m, solid elements of Hyfeast", "mm", 5.67551, 1e3 * strip.deflection_m(),
                  tolerance=0.01),
              Row("invar and copper, 200 mm", "mm", 500 * unequal.curvature_per_m * unequal.length_m**2,
                  1e3 * unequal.deflection_m(),
                  theory=1e3 * unequal.arc_m())],
        verdict="Beams with offsets give Timoshenko's curvature. The solid elements differ by the clamp, which also "
        "holds the strip's width and height.")


if __name__ == "__main__":
    show(entry())
