# SPDX-License-Identifier: GPL-3.0-or-later
"""Mass on a spring with Coulomb friction: ANSYS VM73."""
from __future__ import annotations

from math import cos, pi, sqrt

from manual import CLOSED_FORM, Curve, Entry, Picture, Row, link, node, show, truss

import numpy as np

INCH, POUND = 0.0254, 4.4482216152605
WEIGHT_N, STIFFNESS_N_PER_M, START_M = 10 * POUND, 30 * POUND / INCH, 1 * INCH
MASS_KG, FRICTION_N = WEIGHT_N / (386 * INCH), 1.875 * POUND
STUCK_M = FRICTION_N / STIFFNESS_N_PER_M


def exact(time_s: float) -> float:
    """Return the displacement: half cosines about the friction offset, whose amplitudes fall by twice the offset."""
    rate = sqrt(STIFFNESS_N_PER_M / MASS_KG)
    half, sign, start = pi / rate, 1.0, START_M
    while True:
        if abs(start) <= STUCK_M:
            return start
        if time_s <= half:
            return sign * STUCK_M + (start - sign * STUCK_M) * cos(rate * time_s)
        time_s, start, sign = time_s - half, 2 * sign * STUCK_M - start, -sign


def entry() -> Entry:
    young, length = 1e9, 1.0
    case = truss(
        "vm73", [node("A", 0.0, 0.0, fixed="xy"), node("M", length, 0.0, fixed="y", mass_kg=MASS_KG)], 1e-6,
        link=[link("K", "A", "M", young, STIFFNESS_N_PER_M * (length + START_M) / young,
                   stress_free_length_m=length + START_M, mass_kg=1e-9)],
        slider=[{"name": "S", "nodes": ["M"], "axis": [1.0, 0.0], "friction_coefficient": 0.1,
                 "normal_force_N": FRICTION_N / 0.1}],
        thermal={"period_s": 1.2}, motion={"start": "drawn", "steps_per_cycle": 96000},
        output={"samples_per_cycle": 1200},
        dem={"link_damping_ratio": 0.0})
    run = case.reduced(dynamic=True)
    # The spring is relaxed at +1 in: our displacement from there is the mirrored one of the reference.
    moved = START_M - np.asarray(run["displacement_m"])[:, 1, 0]
    times = np.asarray(run["time_s"])
    reference = np.array([exact(float(at)) for at in times])
    at = {label: int(abs(times - value).argmin()) for label,
          value in (("0.09 s", 0.09), ("0.102 s", 0.102), ("0.183 s", 0.183))}
    rows = [Row(f"displacement at {label}", "in", exact(float(times[k])) / INCH, float(moved[k]) / INCH, scale=1.0)
            for label, k in at.items()]
    rows += [Row("rest position", "in", float(reference[-1]) / INCH, float(moved[-1]) / INCH, scale=1.0),
             Row("largest difference of the whole motion", "in", 0.0, float(abs(moved - reference).max()) / INCH,
                 scale=1.0)]
    return Entry(
        name="vm73", part="Dynamics with friction", title="Free vibration with Coulomb damping (ANSYS VM73)",
        kind=CLOSED_FORM,
        source="F. S. Tse, I. E. Morse, R. T. Hinkle, Mechanical Vibrations, 1963, p. 175, case 1 (ANSYS VM73); the "
        "script evaluates the half cosines", uncertainty="exact",
        statement="A weight of 10 lb on a spring of 30 lb/in is released at 1 in. Dry friction of 1.875 lb acts. Find "
        "the motion and where it stops.", case=case, tolerance=2e-4, reason="solver entries", rows=rows,
        picture=Picture("time [s]", "displacement [in]", [
            Curve("ours", times, moved / INCH), Curve("closed form", times[::30], reference[::30] / INCH, ours=False)]),
        verdict="The motion follows the half cosines and stops where friction holds the spring.")


if __name__ == "__main__":
    show(entry())
