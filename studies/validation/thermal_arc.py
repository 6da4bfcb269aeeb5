# SPDX-License-Identifier: GPL-3.0-or-later
"""Free cantilever that a temperature gradient bends into an arc."""
from __future__ import annotations

from math import cos, hypot, log2, sin

from manual import CLOSED_FORM, Entry, Row, chain, hottest, node, section, show, truss

import statejump as sj

ALPHA, GRADIENT_PER_M = 1.2e-5, 250.0
BEAM = section(210e9, 2e-2, 6e7 / 210e9, thermal_expansion_per_K=ALPHA, temperature_fraction=0.0,
               gradient_per_m=[GRADIENT_PER_M, 0.0])


def heated(beams: int) -> sj.Case:
    """Return the cantilever whose free curvature is 1/m."""
    nodes = [node("N0", 0.0, 0.0, clamped=True), *(node(f"N{k}", k / beams, 0.0) for k in range(1, beams + 1))]
    return truss("thermal_arc", nodes, 1 / (ALPHA * GRADIENT_PER_M), beam=chain(beams, BEAM))


def tip(beams: int) -> tuple[float, float]:
    """Return the position of the tip [m]."""
    moved = hottest(heated(beams).reduced(), "displacement_m")[-1]
    return 1 + float(moved[0]), -float(moved[1])


def entry() -> Entry:
    exact = sin(1.0), 1 - cos(1.0)
    coarse, fine = tip(4), tip(8)
    errors = [hypot(at[0] - exact[0], at[1] - exact[1]) for at in (coarse, fine)]
    return Entry(
        name="thermal_arc", part="Beams and frames", title="Free thermal arc", kind=CLOSED_FORM,
        source="a free beam of constant thermal curvature κ is an arc of radius 1/κ (Timoshenko 1925)",
        uncertainty="exact",
        statement="A cantilever of 1 m bends by a temperature gradient with the curvature 1/m. Find its tip: (sin 1, 1 "
        "- cos 1).",
        case=heated(8), tolerance=2e-4, reason="solver entries",
        rows=[Row("tip x", "m", exact[0], fine[0], refined=fine[0] + (fine[0] - coarse[0]) / 15),
              Row("tip y", "m", exact[1], fine[1], refined=fine[1] + (fine[1] - coarse[1]) / 15),
              Row("order of convergence", "1", 4.0, log2(errors[0] / errors[1]), tolerance=0.02)],
        verdict="Eight beams are within 1e-6; the error falls as the fourth power of the beam length.")


if __name__ == "__main__":
    show(entry())
