# SPDX-License-Identifier: GPL-3.0-or-later
"""Half circle on a pin and a roller: AFNOR SSLL08/89."""
from __future__ import annotations

from math import cos, pi, sin

from manual import CLOSED_FORM, Entry, Row, chain, node, show, truss

import numpy as np

import statejump as sj

YOUNG_PA, SMALL = 2e11, 1e-3
TUBE = {"young_modulus_Pa": YOUNG_PA, "cross_section_area_m2": 1.131e-4, "second_moments_of_area_m4": [4.637e-9] * 2}


def arch(beams: int) -> sj.Case:
    """Return the half circle as straight beams under a force at its crown."""
    angle = pi * (1 - np.arange(beams + 1) / beams)
    nodes = [node(f"N{k}", cos(a), sin(a), fixed={0: "xy", beams: "y"}.get(k, "")) for k, a in enumerate(angle)]
    nodes[beams // 2]["force_N"] = [0.0, -100.0 * SMALL]
    return truss("ssll08", nodes, beam=chain(beams, TUBE))


def moved(beams: int) -> np.ndarray:
    """Return displacements of roller and crown [mm] and the rotation at the pin [mrad]."""
    run = arch(beams).reduced()
    shift, turned = run["displacement_m"][0], run["rotation_rad"][0]
    return 1e3 / SMALL * np.array([shift[-1, 0], shift[beams // 2, 1], turned[0, 2]])


def entry() -> Entry:
    coarse, fine = moved(12), moved(24)
    better = fine + (fine - coarse) / 3
    expected = (53.912, -19.206, -30.774)
    names = (("displacement x of the roller", "mm"), ("displacement y of the crown", "mm"),
             ("rotation at the pin", "mrad"))
    return Entry(
        name="ssll08", part="Beams and frames", title="Half circle on a pin and a roller (AFNOR SSLL08/89)",
        kind=CLOSED_FORM,
        source="AFNOR, Guide de validation des progiciels de calcul de structures, 1990, SSLL08/89, as printed in the "
        "Validation Manual of SCIA Engineer 26.0", uncertainty="the reference is for beams that do not stretch: 4e-4",
        statement="A tube bent to a half circle of 1 m stands on a pin and a roller. A force of 100 N presses its "
        "crown. Find the displacements.", case=arch(24), tolerance=5e-4, reason="beams of the reference do not stretch",
        rows=[Row(what, unit, expected[k], float(better[k])) for k, (what, unit) in enumerate(names)],
        verdict="Straight beams on the arc converge to the reference as the square of their length.")


if __name__ == "__main__":
    show(entry())
