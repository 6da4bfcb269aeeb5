# SPDX-License-Identifier: GPL-3.0-or-later
"""Beam on an elastic foundation: AFNOR SSLL15/89."""
from __future__ import annotations

from math import pi, sqrt

from manual import CLOSED_FORM, Entry, Row, chain, node, section, show, truss

import numpy as np

import statejump as sj

YOUNG_PA, MOMENT_M4, LENGTH_M, LOAD_N = 2.1e11, 1e-4, pi * sqrt(10) / 2, 10e3
SMALL, GROUND_M = 1e-3, 1.0
# The length is π/(2 β); β = (k/(4 E I))^(1/4) = 1/sqrt(10 m²) gives k = 840 kN/m².
FOUNDATION_PA = 4 * YOUNG_PA * MOMENT_M4 / 100


def beam(count: int) -> sj.Case:
    """Return the beam on springs at its nodes; a spring at an end carries half of a beam."""
    pitch = LENGTH_M / count
    nodes = [node(f"N{k}", k * pitch, 0.0, fixed="x" if k == 0 else "",
                  force_N=[0.0, -LOAD_N * SMALL if k in (0, count // 2, count) else 0.0]) for k in range(count + 1)]
    nodes += [node(f"G{k}", k * pitch, -GROUND_M, fixed="xy") for k in range(count + 1)]
    springs = [{"name": f"S{k}", "nodes": [f"G{k}", f"N{k}"], "free_length_m": GROUND_M,
                "stiffness_N_per_m": FOUNDATION_PA * pitch * (0.5 if k in (0, count) else 1.0)}
               for k in range(count + 1)]
    return truss("ssll15", nodes, beam=chain(count, section(YOUNG_PA, 3.4641e-2, MOMENT_M4)), spring=springs)


def found(count: int) -> np.ndarray:
    """Return middle and end deflection [mm], rotation at the end [mrad], moment in the middle [kN m]."""
    run = beam(count).reduced()
    moved, turned = run["displacement_m"][0], run["rotation_rad"][0]
    moment = run["beam_moment_first_N_m"][0, count // 2, 2]
    return np.array([1e3 * moved[count // 2, 1], 1e3 * moved[0, 1], 1e3 * turned[0, 2], moment / 1e3]) / SMALL


def entry() -> Entry:
    coarse, fine = found(20), found(40)
    better = np.abs(fine + (fine - coarse) / 3)
    names = (("deflection of the middle", "mm", 6.844), ("deflection of the end", "mm", 7.854),
             ("rotation of the end", "mrad", 0.706),
             ("moment in the middle", "kN m", 5.759))
    return Entry(
        name="ssll15", part="Beams and frames", title="Beam on an elastic foundation (AFNOR SSLL15/89)",
        kind=CLOSED_FORM,
        source="AFNOR, Guide de validation des progiciels de calcul de structures, 1990, SSLL15/89, as printed in the "
        "Validation Manual of SCIA Engineer 26.0", uncertainty="three to four printed digits: 7e-4",
        statement="A free beam of 4.967 m lies on an elastic foundation. Forces of 10 kN act at its ends and in its "
        "middle. Find deflections, rotation and moment. Springs at the nodes are the foundation.", case=beam(20),
        tolerance=1e-3,
        reason="the printed digits; ours is extrapolated from 20 and 40 beams. The foundation of the reference is not "
        "printed: it follows from the length, π/(2 β)",
        rows=[Row(what, unit, value, float(better[k])) for k, (what, unit, value) in enumerate(names)],
        verdict="Deflections and moment agree with the printed digits.")


if __name__ == "__main__":
    show(entry())
