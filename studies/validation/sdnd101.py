# SPDX-License-Identifier: GPL-3.0-or-later
"""Mass that knocks on an elastic wall: Code_Aster SDND101."""
from __future__ import annotations

from math import pi, sqrt

from manual import OTHER_CODE, Entry, Row, node, show, truss

import numpy as np

import statejump as sj

MASS_KG, SPRING_N_PER_M, WALL_N_PER_M, SPEED = 100.0, 1e4, 1e6, 1.0
ENERGY_J = MASS_KG * SPEED**2 / 2


def case() -> sj.Case:
    """Return the mass; a start at a distance replaces the initial speed of the reference.

    From rest at SPEED/ω from the wall the spring gives the same speed where the wall begins.
    """
    start = SPEED * sqrt(MASS_KG / SPRING_N_PER_M)
    return truss(
        "sdnd101", [node("A", -1.0, 0.0, fixed="xy"), node("M", start, 0.0, fixed="y", mass_kg=MASS_KG)], 1e-6,
        spring=[{"name": "K", "nodes": ["A", "M"], "stiffness_N_per_m": SPRING_N_PER_M, "free_length_m": 1.0}],
        slider=[{"name": "wall", "nodes": ["M"], "axis": [1.0, 0.0], "friction_coefficient": 0.0, "normal_force_N": 0.0,
                 "clearance_minus_m": start, "stop_stiffness_N_per_m": WALL_N_PER_M}],
        thermal={"period_s": 0.4}, motion={"start": "drawn", "steps_per_cycle": 40000},
        output={"samples_per_cycle": 8000},
        dem={"link_damping_ratio": 0.0})


def entry() -> Entry:
    one = case()
    run = one.reduced(dynamic=True)
    times = np.asarray(run["time_s"])
    place = np.asarray(run["displacement_m"])[:, 1, 0] + SPEED * sqrt(MASS_KG / SPRING_N_PER_M)
    inside = place < 0
    first = int(np.argmax(inside))
    begins, ends = times[first], times[first + int(np.argmin(inside[first:]))]
    joined = sqrt((WALL_N_PER_M + SPRING_N_PER_M) / MASS_KG)
    deepest = -float(place.min())
    return Entry(
        name="sdnd101", part="Dynamics with friction", title="Mass that knocks on an elastic wall (Code_Aster SDND101)",
        kind=OTHER_CODE, source="Code_Aster SDND101A, ralic/Code_Aster 135093b0, astest/sdnd101a.comm: largest force "
        "9950 N, duration 0.0315 s (reference 0.03126 s), impulse 198.05 N s", uncertainty="1e-3 to 1e-2: steps of 0.5 "
        "ms; closed form exact",
        statement="A mass of 100 kg on a spring of 10 kN/m meets a wall of 1 MN/m at 1 m/s. Find the largest force of "
        "the wall and the duration of the contact.", case=one, tolerance=1e-2, reason="that of Code_Aster's test",
        rows=[Row("largest force of the wall", "N", 9950.0, WALL_N_PER_M * deepest),
              Row("duration of the contact", "ms", 31.26, 1e3 * float(ends - begins)),
              Row("largest force, closed form", "N", WALL_N_PER_M * SPEED / joined, WALL_N_PER_M * deepest,
                  tolerance=1e-3),
              Row("duration, closed form", "ms", 1e3 * pi / joined, 1e3 * float(ends - begins), tolerance=2e-3)],
        verdict="The mass meets the elastic stop as in Code_Aster. The closed form contains the spring, which acts "
        "with the wall.")


if __name__ == "__main__":
    show(entry())
