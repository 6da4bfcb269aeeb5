# SPDX-License-Identifier: GPL-3.0-or-later
"""Measured strip of aluminium and polycarbonate in liquid nitrogen: DoITPoMS."""
from __future__ import annotations

from bimaterial import Strip
from manual import MEASUREMENT, Entry, Row, show

PLACE_M, LENGTH_M, LAYER_M, ALUMINIUM = 0.189, 0.21, 1e-3, (70e9, 23e-6)
ROOM, FITTED = (5.5e9, 67e-6), (5.5e9, 45e-6)
COLD_K = 213.0


def deflection_m(polymer: tuple[float, float]) -> float:
    """Return our deflection [m]."""
    return abs(Strip("cold_polymer_strip", LENGTH_M, LAYER_M, 0.02, ALUMINIUM, polymer, -COLD_K).deflection_m(PLACE_M))


def entry() -> Entry:
    strip = Strip("cold_polymer_strip", LENGTH_M, LAYER_M, 0.02, ALUMINIUM, ROOM, -COLD_K)
    return Entry(
        name="cold_polymer_strip", part="Whole structures", title="Aluminium-polycarbonate strip in liquid nitrogen "
        "(measured)",
        kind=MEASUREMENT, source="DoITPoMS, University of Cambridge, Thermal expansion and the bi-material strip, "
        "results3.php: deflection 40 mm at 189 mm, layers of 1 mm, 70 and 5.5 GPa, 213 K, mean expansivity of the "
        "polymer 45e-6 1/K",
        uncertainty="reading 0.5 mm",
        statement="A strip of aluminium and polycarbonate is immersed in liquid nitrogen. Find its deflection at 189 "
        "mm, first with the room-temperature expansivity of polycarbonate (67e-6 1/K, a common table value), then with "
        "the mean one that the authors derive from the curvature.", case=strip.case(), tolerance=0.25,
        reason="as for the steel strip",
        rows=[Row("deflection, room-temperature expansivity", "mm", 40.0, 1e3 * deflection_m(ROOM), low=30.0,
                  high=50.0),
              Row("deflection, mean expansivity of the authors", "mm", 40.0, 1e3 * deflection_m(FITTED), low=38.0,
                  high=42.0)],
        verdict="The prediction with the room-temperature expansivity is far too large. Cases have constant "
        "properties, or expansivities that follow the temperature; the modulus of a polymer also changes by a factor "
        "in the cold. With the mean expansivity of the authors the deflection agrees, so the mechanics of the strip is "
        "not the cause.")


if __name__ == "__main__":
    show(entry())
