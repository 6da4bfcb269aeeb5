# SPDX-License-Identifier: GPL-3.0-or-later
"""Cantilever under a large tip force: the elastica."""
from __future__ import annotations

from manual import CLOSED_FORM, Curve, Entry, Picture, Row, chain, node, section, show, truss

import numpy as np
from scipy.optimize import brentq
from scipy.special import ellipe, ellipeinc, ellipk, ellipkinc

import statejump as sj

RIGIDITY_N_M2, LENGTH_M = 10.0, 1.0
SECTION = section(1e11, 1e-2, 1e-10)  # P/(E A) is 1e-8 P L²/(E I)


def exact(load: float) -> tuple[float, float]:
    """Return tip position x/L and deflection w/L at P L²/(E I) from elliptic integrals (Bisshopp and Drucker)."""
    root = np.sqrt(load)

    def missing(modulus: float) -> float:
        start = np.arcsin(1 / (np.sqrt(2) * modulus))
        return float(ellipk(modulus**2) - ellipkinc(start, modulus**2) - root)

    modulus = float(brentq(missing, np.sqrt(0.5) + 1e-12, 1 - 1e-12, xtol=1e-15))
    start = np.arcsin(1 / (np.sqrt(2) * modulus))
    across = 1 - 2 * (ellipe(modulus**2) - ellipeinc(start, modulus**2)) / root
    along = np.sqrt(2 * (2 * modulus**2 - 1)) / root
    return float(along), float(across)


def loaded(load: float, beams: int) -> sj.Case:
    """Return the cantilever under a dead force across it."""
    nodes = [node("N0", 0.0, 0.0, clamped=True), *(node(f"N{k}", k / beams, 0.0) for k in range(1, beams + 1))]
    nodes[-1]["force_N"] = [0.0, load * RIGIDITY_N_M2]
    return truss("elastica", nodes, beam=chain(beams, SECTION), reduced={"increments_per_branch": 1})


def tip(load: float, beams: int) -> np.ndarray:
    """Return tip position x/L and deflection w/L of our beams."""
    moved = loaded(load, beams).reduced()["displacement_m"][0, -1]
    return np.array([1 + moved[0], moved[1]])


def entry() -> Entry:
    rows, points = [], []
    for load in (1.0, 5.0, 10.0):
        reference, coarse, fine = exact(load), tip(load, 8), tip(load, 16)
        better = fine + (fine - coarse) / 15  # errors fall as the fourth power
        points.append((load, fine[1]))
        rows += [Row(f"{what} at P L²/(E I) = {load:g}", "L", reference[k], float(fine[k]), refined=float(better[k]))
                 for k, what in enumerate(("tip x", "tip deflection"))]
    loads = np.linspace(0.05, 10.0, 60)
    return Entry(
        name="elastica", part="Beams and frames", title="Cantilever under a large tip force (elastica)",
        kind=CLOSED_FORM,
        source="K. E. Bisshopp and D. C. Drucker, Q. Appl. Math. 3 (1945) 272-275; the script evaluates the elliptic "
        "integrals",
        uncertainty="exact",
        statement="A cantilever carries a dead force across its drawn axis, up to ten times E I/L². Find the position "
        "of its tip.", case=loaded(10.0, 16), tolerance=2e-4, reason="solver entries",
        model="None: the beam is almost inextensible.", rows=rows,
        picture=Picture("P L²/(E I)", "tip deflection [L]", [
            Curve("closed form", loads, [exact(load)[1] for load in loads]),
            Curve("ours, 16 beams", [load for load, _ in points], [value for _, value in points], ours=False)]),
        verdict="Sixteen beams meet the elastica within 1e-5; the error falls as the fourth power of the beam length.")


if __name__ == "__main__":
    show(entry())
