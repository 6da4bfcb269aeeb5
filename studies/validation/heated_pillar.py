# SPDX-License-Identifier: GPL-3.0-or-later
"""Measured deflection of a concrete pillar that is heated on one side: Močnik, Koler, Zupan, Ambrožič."""
from __future__ import annotations

from manual import MEASUREMENT, Entry, Row, hottest, node, section, show, truss

import numpy as np

import statejump as sj

HEIGHT_M, DIAMETER_M, DIFFERENCE_K = 1.5, 0.217, 16.2
YOUNG_PA = 31e9  # concrete C25/30; no effect on the free deflection
EXPANSION, LOWEST, HIGHEST = 10e-6, 9e-6, 12e-6


def pillar(expansion: float) -> sj.Case:
    """Return the pillar: clamped below, temperature linear over its diameter."""
    area, second = np.pi * DIAMETER_M**2 / 4, np.pi * DIAMETER_M**4 / 64
    return truss("heated_pillar", [node("foot", 0.0, 0.0, clamped=True), node("screw", 0.0, HEIGHT_M)], DIFFERENCE_K,
                 beam=[{"name": "P", "nodes": ["foot", "screw"], **section(
                     YOUNG_PA, float(area), float(second), thermal_expansion_per_K=expansion, temperature_fraction=0.5,
                     gradient_per_m=[1 / DIAMETER_M, 0.0])}])


def deflection_mm(expansion: float) -> float:
    """Return the displacement of the screw [mm]."""
    return 1e3 * abs(float(hottest(pillar(expansion).reduced(), "displacement_m")[1, 0]))


def entry() -> Entry:
    low, ours, high = (deflection_mm(expansion) for expansion in (LOWEST, EXPANSION, HIGHEST))
    # The reading "about 1 mm" has one digit; the interval is the reading with the spread of the expansivity.
    return Entry(
        name="heated_pillar", part="Whole structures", title="Concrete pillar heated on one side (measured)",
        kind=MEASUREMENT, source="R. Močnik, B. Koler, D. Zupan, T. Ambrožič, Sensors 19 (2019) 3489 (CC BY); section "
        "in R. Močnik and others, Appl. Sci. 10 (2020) 8319: concrete C25/30 in a tube of 217 mm inner diameter",
        uncertainty=f"about 1 mm measured; expansivity of concrete 9e-6 to 12e-6 1/K gives {low:.2f} to {high:.2f} mm; "
        "temperatures within 0.3 K, their course through the pillar is taken as linear",
        statement="A pillar of 1.5 m is heated on one side, until the sides differ by 16.2 K. Find the displacement of "
        "the screw on its top.", case=pillar(EXPANSION), tolerance=0.25,
        reason="interval: rounding of the reading (0.05 mm) and spread of the expansivity (-10 to +20 %)",
        rows=[Row("displacement of the screw", "mm", 1.0, ours, low=(1.0 - 0.05) * EXPANSION / HIGHEST,
                  high=(1.0 + 0.05) * EXPANSION / LOWEST)],
        verdict="The linear temperature course gives the measured displacement within the spread of the expansivity of "
        "concrete.")


if __name__ == "__main__":
    show(entry())
