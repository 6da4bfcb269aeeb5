# SPDX-License-Identifier: GPL-3.0-or-later
"""Tangential loading of a Hertz contact: slide and energy loss of Mindlin and Deresiewicz."""
from __future__ import annotations

from manual import CLOSED_FORM, Curve, Entry, Picture, Row, show

import numpy as np

import statejump as sj

PAIR = {"effective_young_modulus_Pa": 38.5e9, "effective_shear_modulus_Pa": 7.9e9, "effective_radius_m": 0.01,
        "friction_coefficient": 0.3}
NORMAL_N = 10.0
LIMIT_N = PAIR["friction_coefficient"] * NORMAL_N
RADIUS_M = (0.75 * NORMAL_N * PAIR["effective_radius_m"] / PAIR["effective_young_modulus_Pa"]) ** (1 / 3)
STIFFNESS = 8 * PAIR["effective_shear_modulus_Pa"] * RADIUS_M  # of the sticking contact [N/m]


def slide(force: float) -> float:
    """Return the slide under first loading [m]."""
    return 1.5 * LIMIT_N / STIFFNESS * (1 - (1 - force / LIMIT_N) ** (2 / 3))


def loss(fraction: float) -> float:
    """Return the energy loss of a cycle between ±fraction of the friction limit [J]."""
    left = 1 - fraction
    return (9 * LIMIT_N**2 / (10 * PAIR["effective_shear_modulus_Pa"] * RADIUS_M)
            * (1 - left ** (5 / 3) - 5 * fraction / 6 * (1 + left ** (2 / 3))))


def loop(fraction: float) -> dict[str, np.ndarray]:
    """Return the response to two cycles of tangential force."""
    force = fraction * LIMIT_N * np.interp(np.linspace(0, 8, 4001), np.arange(9), [0, 1, 0, -1, 0, 1, 0, -1, 0])
    return sj.laws.drive("mindlin_deresiewicz", {"normal_force_N": np.full_like(force, NORMAL_N),
                                                 "tangential_force_N": force}, **PAIR)


def entry() -> Entry:
    rows = []
    for fraction in (0.2, 0.5, 0.9):
        found = loop(fraction)
        rows.append(Row(f"slide at {fraction:g} of the limit", "nm", 1e9 * slide(fraction * LIMIT_N),
                        1e9 * float(found["slide_m"].max())))
        heat = found["friction_dissipation_J"]
        rows.append(Row(f"loss of a cycle at {fraction:g} of the limit", "nJ", 1e9 * loss(fraction),
                        1e9 * float(heat[3500] - heat[1500])))
    found = loop(0.9)
    path = np.linspace(0, 0.9 * LIMIT_N, 40)
    return Entry(
        name="mindlin_loop", part="Contact and laws", title="Tangential loop of a Hertz contact (Mindlin and "
        "Deresiewicz)",
        kind=CLOSED_FORM, source="R. D. Mindlin and H. Deresiewicz, J. Appl. Mech. 20 (1953) 327-344: slide under "
        "constant normal force, energy loss of a cycle", uncertainty="exact",
        statement="A sphere is pressed by 10 N on a wall; friction 0.3. A tangential force cycles. Find the slide and "
        "the energy loss of a cycle.", tolerance=2e-4, reason="steps of the driven contact", rows=rows,
        picture=Picture("slide [nm]", "tangential force [N]", [
            Curve("law", 1e9 * found["slide_m"], 0.9 * LIMIT_N * np.interp(
                np.linspace(0, 8, 4001), np.arange(9), [0, 1, 0, -1, 0, 1, 0, -1, 0])),
            Curve("closed form, first loading", [1e9 * slide(float(at)) for at in path], path, ours=False)]),
        verdict="Slides and losses are those of Mindlin and Deresiewicz.")


if __name__ == "__main__":
    show(entry())
