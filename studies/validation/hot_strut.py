# SPDX-License-Identifier: GPL-3.0-or-later
"""Temperature at which a heated strut buckles."""
from __future__ import annotations

from math import pi

from manual import CLOSED_FORM, Entry, Row, chain, node, section, show, truss

import statejump as sj

YOUNG_PA, AREA_M2, MOMENT_M4, LENGTH_M, ALPHA, BEAMS = 210e9, 4e-4, 4e-8 / 3, 2.0, 1.2e-5, 8
LINEAR_K = pi**2 * MOMENT_M4 / (AREA_M2 * LENGTH_M**2) / ALPHA


def strut(change_K: float, beams: int) -> sj.Case:
    """Return the strut between two pins."""
    nodes = [node(f"N{k}", k * LENGTH_M / beams, 0.0, fixed="xy" if k in (0, beams) else "") for k in range(beams + 1)]
    return truss("hot_strut", nodes, change_K,
                 beam=chain(beams, section(YOUNG_PA, AREA_M2, MOMENT_M4, thermal_expansion_per_K=ALPHA)))


def critical_K(beams: int) -> float:
    """Return the temperature change up to which our strut stays straight, by bisection."""
    low, high = 0.8 * LINEAR_K, 1.2 * LINEAR_K
    while high - low > 1e-6 * LINEAR_K:
        middle = (low + high) / 2
        try:
            strut(middle, beams).reduced()
            low = middle
        except sj.StatejumpError:
            high = middle
    return low


def entry() -> Entry:
    coarse, fine = critical_K(4), critical_K(BEAMS)
    better = fine + (fine - coarse) / 15
    return Entry(
        name="hot_strut", part="Beams and frames", title="Heated strut that buckles", kind=CLOSED_FORM,
        source="L. Euler; S. Timoshenko and J. M. Gere, Theory of Elastic Stability: α ΔT = π² I/(A l²); the script "
        "evaluates it",
        uncertainty=f"linear theory: its error is of the order α ΔT = {LINEAR_K * ALPHA:.0e}",
        statement="A strut of 2 m and 20 x 20 mm between two fixed pins is heated. Find the temperature change at "
        "which it buckles.",
        case=strut(0.9 * LINEAR_K, BEAMS), tolerance=2e-4, reason="solver entries; ours is extrapolated from 4 and 8 "
        "beams",
        rows=[Row("temperature change at buckling", "K", LINEAR_K, better),
              Row("temperature change, 8 beams", "K", LINEAR_K, fine, refined=better, tolerance=1e-3)],
        verdict="The solver refuses the straight path where Euler's load is reached.")


if __name__ == "__main__":
    show(entry())
