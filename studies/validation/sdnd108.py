# SPDX-License-Identifier: GPL-3.0-or-later
"""Mass that falls on an elastic stop: Code_Aster SDND108."""
from __future__ import annotations

from math import atan2, pi, sqrt

from manual import CLOSED_FORM, Entry, Row, node, show, truss

import numpy as np

import statejump as sj

MASS_KG, GRAVITY, SPEED, GAP_M, STOP_N_PER_M = 1.0, 10.0, 1.0, 2.0, 100.0
RISE_M = SPEED**2 / (2 * GRAVITY)  # a fall from here gives the speed of the reference


def case() -> sj.Case:
    """Return the mass at rest, above its place in the reference by the height that gives the initial speed."""
    return truss(
        "sdnd108", [node("A", -1.0, 0.0, fixed="xy"),
                    node("M", 0.0, 0.0, fixed="y", mass_kg=MASS_KG, force_N=[-MASS_KG * GRAVITY, 0.0])], 1e-6,
        spring=[{"name": "K", "nodes": ["A", "M"], "stiffness_N_per_m": 1e-9, "free_length_m": 1.0}],
        slider=[{"name": "stop", "nodes": ["M"], "axis": [1.0, 0.0], "friction_coefficient": 0.0, "normal_force_N": 0.0,
                 "clearance_minus_m": GAP_M + RISE_M, "stop_stiffness_N_per_m": STOP_N_PER_M}],
        thermal={"period_s": 2.0}, motion={"start": "drawn", "steps_per_cycle": 40000},
        output={"samples_per_cycle": 8000}, dem={"link_damping_ratio": 0.0})


def entry() -> Entry:
    one = case()
    run = one.reduced(dynamic=True)
    times = np.asarray(run["time_s"])
    height = np.asarray(run["displacement_m"])[:, 1, 0] + GAP_M + RISE_M
    inside = height < 0
    first = int(np.argmax(inside))
    last = first + int(np.argmin(inside[first:]))
    rate = sqrt(STOP_N_PER_M / MASS_KG)
    meets, sinks = sqrt(2 * GRAVITY * (GAP_M + RISE_M)), GRAVITY / rate**2
    deepest = sinks + sqrt(sinks**2 + (meets / rate)**2)
    stays = 2 * (pi - atan2(meets / rate, sinks)) / rate
    return Entry(
        name="sdnd108", part="Dynamics with friction", title="Mass that falls on an elastic stop (Code_Aster SDND108)",
        kind=CLOSED_FORM, source="data of Code_Aster SDND108: 1 kg, 10 m/s², 1 m/s downwards, gap 2 m, 100 N/m; the "
        "script evaluates the closed form", uncertainty="exact",
        statement="A mass of 1 kg falls with 1 m/s at the start from 2 m above a stop of 100 N/m. Find the time of the "
        "impact, the largest force of the stop and the duration of the contact. The case starts at rest 0.05 m higher.",
        case=one, tolerance=2e-4, reason="solver entries; times 1e-3: samples of 0.25 ms",
        rows=[Row("time from the start of the fall to the impact", "s", sqrt(2 * (GAP_M + RISE_M) / GRAVITY),
                  float(times[first]), tolerance=1e-3),
              Row("largest force of the stop", "N", STOP_N_PER_M * deepest, -STOP_N_PER_M * float(height.min())),
              Row("duration of the contact", "s", stays, float(times[last] - times[first]), tolerance=2e-3),
              Row("energy after the impact over that before", "1", 1.0,
                  float(height[last:].max()) / (GAP_M + RISE_M))],
        verdict="The mass meets the elastic stop and leaves it as in the closed form, without loss.")


if __name__ == "__main__":
    show(entry())
