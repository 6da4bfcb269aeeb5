# SPDX-License-Identifier: GPL-3.0-or-later
"""Release of a rubbing pad on a spring: Code_Aster SDND100."""
from __future__ import annotations

from math import pi, sqrt

from manual import CLOSED_FORM, Entry, Row, link, node, show, truss

import numpy as np

MASS_KG, STIFFNESS_N_PER_M, FRICTION_N, START_M = 1.0, 1e4, 1.0, 0.85e-3
# Printed values of the component along the diagonal; the pad moves by sqrt(2) of them.
PRINTED = (-4.5961940777125592e-4, 3.1819805153394639e-4, -1.7677669529663682e-4, 3.5355339059327316e-5)


def entry() -> Entry:
    young, length = 1e9, 1.0
    case = truss(
        "sdnd100", [node("A", 0.0, 0.0, fixed="xy"), node("M", length, 0.0, fixed="y", mass_kg=MASS_KG)], 1e-6,
        link=[link("K", "A", "M", young, STIFFNESS_N_PER_M * (length + START_M) / young,
                   stress_free_length_m=length + START_M, mass_kg=1e-9)],
        slider=[{"name": "S", "nodes": ["M"], "axis": [1.0, 0.0], "friction_coefficient": 0.1,
                 "normal_force_N": FRICTION_N / 0.1}],
        thermal={"period_s": 0.16 * pi}, motion={"start": "drawn", "steps_per_cycle": 32000},
        output={"samples_per_cycle": 1600}, dem={"link_damping_ratio": 0.0})
    run = case.reduced(dynamic=True)
    half = pi / sqrt(STIFFNESS_N_PER_M / MASS_KG)
    moved = START_M - np.asarray(run.at([half * k for k in (1, 2, 3, 4)])["displacement_m"])[:, 1, 0]
    return Entry(
        name="sdnd100", part="Dynamics with friction", title="Release of a rubbing pad (Code_Aster SDND100)",
        kind=CLOSED_FORM,
        source="Code_Aster SDND100A, ralic/Code_Aster 135093b0, astest/sdnd100a.comm: u₀ - 2 k μ m g/K after k half "
        "periods",
        uncertainty="exact; Code_Aster's test allows 1e-3 to 5e-3",
        statement="A pad of 1 kg on a spring of 10 kN/m is released at 0.85 mm; dry friction of 1 N acts. Find its "
        "position after each half period.", case=case, tolerance=2e-4, reason="solver entries, relative to the first "
        "amplitude",
        rows=[Row(f"position after {k + 1} half periods", "mm", 1e3 * sqrt(2) * printed, 1e3 * float(moved[k]),
                  scale=1e3 * START_M) for k, printed in enumerate(PRINTED)],
        verdict="Each half period loses twice the friction offset, as the closed form states.")


if __name__ == "__main__":
    show(entry())
