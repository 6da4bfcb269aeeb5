# SPDX-License-Identifier: GPL-3.0-or-later
"""Quarter circle under forces and a moment at its tip: AFNOR SSLL06/89."""
from __future__ import annotations

from math import cos, pi, sin

from manual import CLOSED_FORM, Entry, Row, chain, node, show, truss

import numpy as np

import statejump as sj

RADIUS_M, YOUNG_PA, SMALL = 3.0, 2e11, 1e-3
TUBE = {"young_modulus_Pa": YOUNG_PA, "cross_section_area_m2": 1.131e-4, "second_moments_of_area_m4": [4.637e-9] * 2}


def bent(beams: int) -> sj.Case:
    """Return the quarter circle as straight beams, clamped at (0, R), loaded at (R, 0)."""
    angle = pi / 2 * (1 - np.arange(beams + 1) / beams)
    nodes = [node(f"N{k}", RADIUS_M * cos(a), RADIUS_M * sin(a), clamped=k == 0) for k, a in enumerate(angle)]
    nodes[-1] |= {"force_N": [10.0 * SMALL, 5.0 * SMALL], "moment_N_m": [8.0 * SMALL]}
    return truss("ssll06", nodes, beam=chain(beams, TUBE))


def tip(beams: int) -> np.ndarray:
    """Return displacements [mm] and rotation [mrad] of the tip."""
    run = bent(beams).reduced()
    return 1e3 / SMALL * np.array([*run["displacement_m"][0, -1, :2], run["rotation_rad"][0, -1, 2]])


def entry() -> Entry:
    coarse, fine = tip(10), tip(20)
    better = fine + (fine - coarse) / 3
    expected = (379.1, 241.7, 165.4)
    return Entry(
        name="ssll06", part="Beams and frames", title="Quarter circle in its plane (AFNOR SSLL06/89)", kind=CLOSED_FORM,
        source="AFNOR, Guide de validation des progiciels de calcul de structures, 1990, SSLL06/89, as printed in the "
        "Validation Manual of SCIA Engineer 26.0", uncertainty="four printed digits: 2e-4; the loads are printed with "
        "one digit as 0.01 kN, the results need 10 N, 5 N, 8 N m",
        statement="A tube bent to a quarter circle of 3 m is clamped at one end. Forces of 10 N along x and 5 N along "
        "y and a moment of 8 N m act at the other. Find its displacements and rotation.", case=bent(20), tolerance=4e-4,
        reason="the printed digits; our value is extrapolated from 10 and 20 beams",
        rows=[Row(what, unit, expected[k], float(better[k])) for k, (what, unit) in enumerate(
            (("displacement x", "mm"), ("displacement y", "mm"), ("rotation", "mrad")))]
        + [Row("displacement x, 20 beams", "mm", 379.1, float(fine[0]), refined=float(better[0]), tolerance=2e-3)],
        verdict="Straight beams on the arc converge to the reference as the square of their length.")


if __name__ == "__main__":
    show(entry())
