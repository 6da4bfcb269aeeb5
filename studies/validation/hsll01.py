# SPDX-License-Identifier: GPL-3.0-or-later
"""Two-hinged circular arch under heat and a gradient: AFNOR HSLL01/89."""
from __future__ import annotations

from math import cos, pi, sin

from manual import OTHER_CODE, Entry, Row, chain, hottest, node, section, show, truss

import numpy as np

import statejump as sj

RADIUS_M, SIDE_M, YOUNG_PA, ALPHA, MEAN_K, ACROSS_K = 10.0, 0.12, 2e11, 1.1e-5, 100.0, 120.0
SMALL = 1e-3  # the reference is linear
MOMENT_M4 = SIDE_M**4 / 12


def arch(beams: int) -> sj.Case:
    """Return the half circle as straight beams; the outer fibre is warmer."""
    angle = pi * np.arange(beams + 1) / beams
    nodes = [node(f"N{k}", float(RADIUS_M - RADIUS_M * cos(a)), float(RADIUS_M * sin(a)),
                  fixed="xy" if k in (0, beams) else "") for k, a in enumerate(angle)]
    keys = section(YOUNG_PA, SIDE_M**2, MOMENT_M4, thermal_expansion_per_K=ALPHA,
                   gradient_per_m=[ACROSS_K / MEAN_K / SIDE_M, 0.0])
    return truss("hsll01", nodes, MEAN_K * SMALL, beam=chain(beams, keys))


def thrust(beams: int) -> tuple[float, float]:
    """Return the horizontal thrust [N] and the moment at the crown [N m]."""
    run = arch(beams).reduced()
    return (float(np.linalg.norm(hottest(run, "beam_force_first_N")[0])) / SMALL,
            abs(float(hottest(run, "beam_moment_second_N_m")[beams // 2 - 1, 2])) / SMALL)


def entry() -> Entry:
    coarse, fine = thrust(32), thrust(64)
    better = [value + (value - rough) / 3 for value, rough in zip(fine, coarse)]
    bent = YOUNG_PA * MOMENT_M4
    # Statically indeterminate thrust: free closing 2R² α ΔT/h - 2R α T, compliance π R³/(2 E I) + π R/(2 E A).
    closing = 2 * RADIUS_M**2 * ALPHA * ACROSS_K / SIDE_M - 2 * RADIUS_M * ALPHA * MEAN_K
    exact = closing / (pi * RADIUS_M**3 / (2 * bent) + pi * RADIUS_M / (2 * YOUNG_PA * SIDE_M**2))
    return Entry(
        name="hsll01", part="Beams and frames", title="Two-hinged arch under a thermal gradient (AFNOR HSLL01/89)",
        kind=OTHER_CODE, source="AFNOR, Guide de validation des progiciels de calcul de structures, 1990, HSLL01/89, "
        "as printed in the Validation Manual of SCIA Engineer 26.0", uncertainty="four printed digits: 1e-4; the "
        "thermal expansion is printed with one digit, the results need 1.1e-5/K",
        statement="A half circle of 10 m radius and 120 x 120 mm stands on two pins. Its outer fibre is heated by 160 "
        "K, its inner fibre by 40 K. Find the thrust and the moment at the crown.",
        case=arch(64), tolerance=2e-4, reason="solver entries; ours is extrapolated from 32 and 64 beams",
        model="None: the case has a thousandth of the heat, so that displacements are small.",
        rows=[Row("thrust", "N", 4792.0, better[0]), Row("moment at the crown", "N m", 47918.0, better[1]),
              Row("thrust, formula with axial strain", "N", exact, better[0], tolerance=2e-4),
              Row("thrust, 64 beams", "N", 4792.0, fine[0], refined=better[0], tolerance=2e-3)],
        verdict="Straight beams on the arc converge to the reference as the square of their length.")


if __name__ == "__main__":
    show(entry())
