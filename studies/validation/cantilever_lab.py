# SPDX-License-Identifier: GPL-3.0-or-later
"""Measured natural frequencies of a metal cantilever: a laboratory of the University of Arkansas."""
from __future__ import annotations

from loops import blind
from manual import MEASUREMENT, Entry, Row, chain, node, show, truss

import numpy as np

import statejump as sj

INCH = 0.0254
WIDTH_M, HEIGHT_M, LENGTH_M = 0.75 * INCH, 0.0625 * INCH, 107180.145**0.25 * INCH
SPEED_M_PER_S = (3.22e8 / 0.00812864) ** 0.5 * INCH  # of waves along the beam, from their modulus and density
DENSITY = 7850.0  # only the ratio of modulus and density acts on frequencies
MEASURED_HZ = (6.0, 44.0, 109.0, 212.0, 346.0)
ROOTS = (1.8751041, 4.6940911, 7.8547574, 10.9955407, 14.1371684)  # of cos x cosh x = -1
CALCULATED_HZ = (6.13793, 38.4658, 107.705, 211.059, 348.896)


def clamped(beams: int) -> sj.Case:
    """Return the cantilever."""
    nodes = [node("N0", 0.0, 0.0, clamped=True),
             *(node(f"N{k}", k * LENGTH_M / beams, 0.0) for k in range(1, beams + 1))]
    return truss("cantilever_lab", nodes, 1.0, beam=chain(beams, {
        "young_modulus_Pa": DENSITY * SPEED_M_PER_S**2, "density_kg_per_m3": DENSITY, "shape": "rectangle",
        "poisson_ratio": 0.3, "dimensions_m": [HEIGHT_M, WIDTH_M]}))


def with_shear(frequency_Hz: float, root: float) -> float:
    """Return a frequency of the formula, to first order with rotary inertia and shear of a rectangle."""
    slenderness = root / LENGTH_M * HEIGHT_M / 12**0.5
    return frequency_Hz * (1 - slenderness**2 / 2 * (1 + 2 * 1.3 * 6 / 5))


def entry() -> Entry:
    found = [np.asarray(sj.modes(clamped(beams), 5).frequency_Hz) for beams in (16, 32, 64)]
    once = [(4 * found[k + 1] - found[k]) / 3 for k in range(2)]
    better = (16 * once[1] - once[0]) / 15
    rows = [blind(f"frequency {k + 1}, measured", "Hz", measured, float(better[k]), max(0.5, 0.05 * measured))
            for k, measured in enumerate(MEASURED_HZ)]
    rows += [Row(f"frequency {k + 1}, formula of the report", "Hz", theirs, float(better[k]), tolerance=2e-4,
                 theory=with_shear(theirs, ROOTS[k])) for k, theirs in enumerate(CALCULATED_HZ)]
    return Entry(
        name="cantilever_lab", part="Whole structures", title="Frequencies of a metal strip (measured)",
        kind=MEASUREMENT, source="V. Perez, Modal analysis of a cantilever beam, laboratory report MEEG 3212, "
        "University of Arkansas (scribd.com/document/460366084): 0.046875 in², 1.5259e-5 in⁴, L⁴ = 107180 in⁴, five "
        "frequencies by stroboscope", uncertainty="whole hertz; clamp and shaker; modulus and density of the report "
        "have no unit, their ratio is that of steel or aluminium",
        statement="A metal strip of 0.75 x 0.0625 in is clamped with a free length of 18.09 in and shaken. Find its "
        "first five frequencies.", case=clamped(16), tolerance=0.05,
        reason="interval of 5 %, at least 0.5 Hz: clamp, shaker and reading; 2e-4 to the formula of the "
        "report", rows=rows,
        model="The formula of the report has neither rotary inertia nor shear; the table contains their first-order "
        "term.",
        verdict="Four of five measured frequencies agree within 2.5 %. The second one is 14 % above ours, and as far "
        "above the report's own formula and finite elements (38.47 and 40.02 Hz). Neither model nor discretisation "
        "explains it: our value is the formula to 2e-4, and the strip has no other bending frequency near 44 Hz. The "
        "cause lies in the measurement, probably the reading or the mass of the shaker's armature.")


if __name__ == "__main__":
    show(entry())
