# SPDX-License-Identifier: GPL-3.0-or-later
"""Limit load of the two-bar truss of von Mises."""
from __future__ import annotations

from math import hypot, sqrt

from manual import CLOSED_FORM, Curve, Entry, Picture, Row, link, node, show, truss

import statejump as sj

HALF_M, RISE_M, RIGIDITY_N = 5.0, 1.0, 1280e6
LENGTH_M = hypot(HALF_M, RISE_M)


def load_N(deflection_m: float) -> float:
    """Return the load of the exact path."""
    height = RISE_M - deflection_m
    length = hypot(HALF_M, height)
    return 2 * RIGIDITY_N * (LENGTH_M - length) / LENGTH_M * height / length


def limit() -> tuple[float, float]:
    """Return deflection [m] and load [N] of the limit point: l^3 = L a^2."""
    length = (LENGTH_M * HALF_M**2) ** (1 / 3)
    deflection = RISE_M - sqrt(length**2 - HALF_M**2)
    return deflection, load_N(deflection)


def loaded(force_N: float) -> sj.Case:
    """Return the truss under a load at its apex."""
    return truss("von_mises", [
        node("A", -HALF_M, 0.0, fixed="xy"), node("B", HALF_M, 0.0, fixed="xy"),
        node("C", 0.0, RISE_M, fixed="x", force_N=[0.0, -force_N])],
        link=[link("AC", "A", "C", RIGIDITY_N / 1e-2, 1e-2), link("CB", "C", "B", RIGIDITY_N / 1e-2, 1e-2)],
        reduced={"increments_per_branch": 1})


def deflection_m(force_N: float) -> float | None:
    """Return our deflection; None if the truss has no equilibrium beside the unloaded one."""
    try:
        moved = -float(loaded(force_N).reduced()["displacement_m"][0, 2, 1])
    except sj.StatejumpError:
        return None
    return moved if moved < RISE_M else None


def entry() -> Entry:
    at, most = limit()
    low, high = 0.9 * most, 1.1 * most
    while high - low > 1e-7 * most:
        middle = (low + high) / 2
        low, high = (middle, high) if deflection_m(middle) is not None else (low, middle)
    loads = [fraction * most for fraction in (0.1, 0.3, 0.5, 0.7, 0.85, 0.95, 0.99, 0.999)]
    ours = [deflection_m(load) or 0.0 for load in loads]
    path = [at * k / 60 for k in range(61)]
    half = ours[loads.index(0.5 * most)]
    return Entry(
        name="von_mises", part="Statics and thermal bars", title="Limit load of the von Mises truss", kind=CLOSED_FORM,
        source="R. von Mises, Z. angew. Math. Mech. 3 (1923) 406-422; the script evaluates the closed form",
        uncertainty="exact",
        statement="Two bars of axial rigidity 1280 MN meet at the apex of an arch of half span 5 m and rise 1 m. A "
        "vertical load presses the apex. Find the load at which the arch snaps through.",
        case=loaded(0.5 * most), tolerance=1e-6, reason="bisection to 1e-7 of the load",
        rows=[Row("limit load", "kN", most / 1e3, low / 1e3),
              Row("load at our deflection, half of the limit load", "kN", load_N(half) / 1e3, 0.5 * most / 1e3,
                  tolerance=1e-9)],
        picture=Picture("deflection [m]", "load [kN]", [
            Curve("ours", ours, [load / 1e3 for load in loads], ours=False),
            Curve("closed form", path, [load_N(value) / 1e3 for value in path])]),
        verdict="The solver follows the arch to its limit load and refuses larger loads.")


if __name__ == "__main__":
    show(entry())
