# SPDX-License-Identifier: GPL-3.0-or-later
"""Block on an incline at the limit of friction: ANSYS VM29."""
from __future__ import annotations

from math import cos, radians, sin

from manual import CLOSED_FORM, Entry, Row, link, node, show, truss

import statejump as sj

SLOPE, FRICTION, POUND = radians(20), 0.3, 4.4482216152605
WEIGHT_N = 100 * POUND
NORMAL_N = WEIGHT_N * cos(SLOPE)


def case(push_N: float) -> sj.Case:
    """Return the block, pushed along the slope."""
    return truss("vm29", [node("A", 0.0, 0.0, fixed="xy"), node("B", 0.0, 1.0, fixed="xy"),
                          node("M", 1.0, 0.0, fixed="y", force_N=[push_N, 0.0])],
                 link=[link("L", "A", "B", 1e9, 1e-4)],
                 slider=[{"name": "S", "nodes": ["M"], "axis": [1.0, 0.0], "friction_coefficient": FRICTION,
                          "normal_force_N": NORMAL_N}])


def holds(push_N: float) -> bool:
    """Return whether friction holds the block."""
    try:
        return abs(float(case(push_N).reduced()["displacement_m"][-1, 2, 0])) < 1e-12
    except sj.StatejumpError:
        return False


def limit_N(low: float, high: float) -> float:
    """Return the push at which the block begins to slide, by bisection from a push that holds."""
    while abs(high - low) > 1e-7 * NORMAL_N:
        middle = (low + high) / 2
        low, high = (middle, high) if holds(middle) else (low, middle)
    return low


def entry() -> Entry:
    drive = WEIGHT_N * sin(SLOPE)
    up, down = limit_N(0.0, NORMAL_N), limit_N(0.0, -NORMAL_N)
    return Entry(
        name="vm29", part="Statics and thermal bars", title="Block at the limit of friction (ANSYS VM29)",
        kind=CLOSED_FORM,
        source="F. P. Beer and E. R. Johnston, Vector Mechanics for Engineers, p. 283 (ANSYS VM29: friction on a "
        "support block); the script evaluates μ W cos θ", uncertainty="exact",
        statement="A block of 100 lb rests on a slope of 20°; the friction coefficient is 0.3. Find the forces along "
        "the slope between which it does not move, its weight included.", case=case(0.999 * FRICTION * NORMAL_N),
        tolerance=2e-4,
        reason="bisection to 1e-7 of the normal force",
        rows=[Row("largest push up the slope, less its weight", "lb", (drive + FRICTION * NORMAL_N) / POUND,
                  (drive + up) / POUND),
              Row("smallest push that holds it", "lb", (drive - FRICTION * NORMAL_N) / POUND, (drive + down) / POUND)],
        verdict="The solver holds the block up to the limit of friction and refuses larger pushes, because nothing "
        "holds it then.")


if __name__ == "__main__":
    show(entry())
