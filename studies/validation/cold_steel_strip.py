# SPDX-License-Identifier: GPL-3.0-or-later
"""Measured strip of steel and aluminium in liquid nitrogen: DoITPoMS."""
from __future__ import annotations

from bimaterial import Strip
from manual import MEASUREMENT, Entry, Row, show

PLACE_M, LENGTH_M, LAYER_M, ALUMINIUM, STEEL = 0.189, 0.2, 1e-3, (70e9, 18.45e-6), (200e9, 8.78e-6)
COLD_K = 20.0 - -196.0


def entry() -> Entry:
    strip = Strip("cold_steel_strip", LENGTH_M, LAYER_M, 0.02, STEEL, ALUMINIUM, -COLD_K)
    ours = abs(strip.deflection_m(PLACE_M))
    return Entry(
        name="cold_steel_strip", part="Whole structures", title="Steel-aluminium strip in liquid nitrogen (measured)",
        kind=MEASUREMENT, source="DoITPoMS, University of Cambridge, Thermal expansion and the bi-material strip, "
        "results2.php: deflection 21 mm at 189 mm; results3.php: layers of 1 mm. Mean expansivities from 293 to 80 K: "
        "GNIRS note SDN0013.02 (noao.edu), aluminium 6061 18.45e-6, carbon steel 8.78e-6, stainless steel 302 13.47e-6 "
        "1/K",
        uncertainty="reading 0.5 mm. The kind of steel is not stated; with stainless steel the deflection is half of "
        "that with carbon steel",
        statement="A strip of steel and aluminium is clamped and immersed in liquid nitrogen. Find its deflection at "
        "189 mm. The steel is taken as carbon steel.", case=strip.case(), tolerance=0.3, reason="kind of steel and of "
        "aluminium",
        rows=[Row("deflection at 189 mm, carbon steel", "mm", 21.0, 1e3 * ours, low=14.7, high=27.3)],
        verdict="The prediction for carbon steel is within the interval, at its upper end. The measured deflection "
        "lies between the predictions for carbon and stainless steel.")


if __name__ == "__main__":
    show(entry())
