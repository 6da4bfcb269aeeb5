# SPDX-License-Identifier: GPL-3.0-or-later
"""Natural frequencies of a Timoshenko cantilever."""
from __future__ import annotations

from math import pi

from manual import CLOSED_FORM, Entry, Row, chain, node, show, truss

import numpy as np
from scipy.linalg import expm
from scipy.optimize import brentq

import statejump as sj

YOUNG_PA, POISSON, DENSITY, HEIGHT_M, WIDTH_M, LENGTH_M, SHEAR = 70e9, 0.33, 2700.0, 0.05, 0.02, 1.0, 5 / 6
AREA_M2, MOMENT_M4 = HEIGHT_M * WIDTH_M, WIDTH_M * HEIGHT_M**3 / 12
STIFF_N = SHEAR * YOUNG_PA / (2 * (1 + POISSON)) * AREA_M2
BEAM = {"young_modulus_Pa": YOUNG_PA, "poisson_ratio": POISSON, "density_kg_per_m3": DENSITY, "shape": "rectangle",
        "dimensions_m": [HEIGHT_M, WIDTH_M], "shear_factors": [SHEAR, SHEAR]}


def determinant(frequency_Hz: float) -> float:
    """Return the determinant of the free end's conditions: zero at a natural frequency.

    The state is (deflection, rotation, moment, shear force); its derivative along the beam is linear.
    """
    square = (2 * pi * frequency_Hz) ** 2
    rate = np.array([[0, 1, 0, 1 / STIFF_N], [0, 0, 1 / (YOUNG_PA * MOMENT_M4), 0],
                     [0, -DENSITY * MOMENT_M4 * square, 0, -1], [-DENSITY * AREA_M2 * square, 0, 0, 0]])
    return float(np.linalg.det(expm(rate * LENGTH_M)[2:, 2:]))


def clamped(beams: int) -> sj.Case:
    """Return the cantilever."""
    nodes = [node("N0", 0.0, 0.0, clamped=True), *(node(f"N{k}", k / beams, 0.0) for k in range(1, beams + 1))]
    return truss("cantilever_modes", nodes, 1.0, beam=chain(beams, BEAM))


def entry() -> Entry:
    exact = [float(brentq(determinant, low, high)) for low, high in ((35, 45), (240, 270), (650, 740))]
    found = [sj.modes(clamped(beams), 3).frequency_Hz for beams in (16, 32, 64)]
    once = [(4 * found[k + 1] - found[k]) / 3 for k in range(2)]
    better = (16 * once[1] - once[0]) / 15
    return Entry(
        name="cantilever_modes", part="Beams and frames", title="Natural frequencies of a Timoshenko cantilever",
        kind=CLOSED_FORM, source="S. Timoshenko, Phil. Mag. 41 (1921) 744-746; the script solves the frequency "
        "equation",
        uncertainty="exact",
        statement="An aluminium cantilever of 1 m, 20 mm wide and 50 mm high, with shear deformation and rotary "
        "inertia. Find its first three bending frequencies.", case=clamped(16), tolerance=2e-4,
        reason="solver entries; our value is extrapolated from 16, 32 and 64 beams",
        rows=[Row(f"frequency {k + 1}", "Hz", exact[k], float(better[k])) for k in range(3)]
        + [Row(f"frequency {k + 1}, 64 beams", "Hz", exact[k], float(found[2][k]), refined=float(better[k]),
               tolerance=2e-3)
           for k in range(3)],
        verdict="The extrapolated frequencies agree; 64 beams with linear masses are 1e-3 off.")


if __name__ == "__main__":
    show(entry())
