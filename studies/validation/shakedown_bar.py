# SPDX-License-Identifier: GPL-3.0-or-later
"""Bar between a wall and a rubbing block under cyclic heat: when it shakes down."""
from __future__ import annotations

from manual import CLOSED_FORM, Curve, Entry, Picture, Row, link, node, show, truss

import numpy as np

import statejump as sj

YOUNG_PA, AREA_M2, LENGTH_M, ALPHA, FRICTION_N = 70e9, 9e-6, 0.5, 23.4e-6, 30.0
LIMIT_K = 2 * FRICTION_N / (YOUNG_PA * AREA_M2 * ALPHA)


def cycled(change_K: float) -> sj.Case:
    """Return the bar under five cycles."""
    return truss("shakedown_bar", [node("A", 0.0, 0.0, fixed="xy"), node("B", LENGTH_M, 0.0, fixed="y")], change_K,
                 link=[link("bar", "A", "B", YOUNG_PA, AREA_M2, ALPHA)],
                 slider=[{"name": "S", "nodes": ["B"], "axis": [1.0, 0.0], "friction_coefficient": 0.3,
                          "normal_force_N": FRICTION_N / 0.3}], thermal={"cycles": 5})


def heat(change_K: float) -> float:
    """Return the heat of the last cycle [J]."""
    run = cycled(change_K).reduced().at([4.0, 5.0])
    lost = run["friction_dissipation_J"]
    return float(lost[1] - lost[0])


def formula(change_K: float) -> float:
    """Return the heat of a steady cycle: twice the friction times the path beyond the limit."""
    return max(0.0, 2 * FRICTION_N * ALPHA * LENGTH_M * (change_K - LIMIT_K))


def entry() -> Entry:
    fractions = (0.6, 0.99, 1.2, 2.0)
    found = {fraction: heat(fraction * LIMIT_K) for fraction in fractions}
    scale = formula(2.0 * LIMIT_K)
    grid = np.linspace(0, 2.1, 40)
    return Entry(
        name="shakedown_bar", part="Frictional shakedown", title="Shakedown of a bar with a rubbing block",
        kind=CLOSED_FORM,
        source="Melan's theorem for friction with given normal forces: A. Klarbring, M. Ciavarella, J. R. Barber, Int. "
        "J. Solids Struct. 44 (2007) 8355-8365; the script evaluates the limit E A α ΔT = 2 f and the heat of a steady "
        "cycle",
        uncertainty="exact for small strain",
        statement="A bar pushes a block with friction f while its temperature cycles between 0 and ΔT. Up to a limit "
        "the block moves once and then rests for ever. Beyond the limit it slides to and fro in every cycle. Find the "
        "heat of the fifth cycle.", case=cycled(1.2 * LIMIT_K), tolerance=2e-4, reason="solver entries, over the heat "
        "at twice the limit",
        rows=[Row(f"heat at {fraction:g} of the limit", "µJ", 1e6 * formula(fraction * LIMIT_K), 1e6 * value,
                  scale=1e6 * scale)
              for fraction, value in found.items()],
        picture=Picture("temperature change over the limit", "heat of a cycle [µJ]", [
            Curve("closed form", grid, [1e6 * formula(float(at) * LIMIT_K) for at in grid]),
            Curve("ours", fractions, [1e6 * value for value in found.values()], ours=False)]),
        verdict="The block shakes down up to the limit, whatever its start.")


if __name__ == "__main__":
    show(entry())
