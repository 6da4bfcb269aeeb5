# SPDX-License-Identifier: GPL-3.0-or-later
"""Beams under a temperature gradient over their section: free, clamped, propped."""
from __future__ import annotations

from math import cos

from manual import CLOSED_FORM, Entry, Row, hottest, node, section, show, truss

import statejump as sj

RIGIDITY_N_M2, LENGTH_M, ALPHA, CHANGE_K, HEIGHT_M = 6e7, 6.0, 1.2e-5, 20.0, 0.4
CURVATURE = ALPHA * CHANGE_K / HEIGHT_M
WARM = section(210e9, 2e-2, RIGIDITY_N_M2 / 210e9, thermal_expansion_per_K=ALPHA, temperature_fraction=0.0,
               gradient_per_m=[1 / HEIGHT_M, 0.0])
PINNED, ROLLER, FREE = {"fixed": "xy"}, {"fixed": "y"}, {}
CLAMPED = {"clamped": True}


def beam(first: dict[str, object], last: dict[str, object]) -> sj.Case:
    """Return the beam of 6 m with two supports; its middle is a node."""
    return truss("thermal_beams", [node("A", 0.0, 0.0, **first), node("M", 3.0, 0.0), node("C", 6.0, 0.0, **last)],
                 CHANGE_K, beam=[{"name": "AM", "nodes": ["A", "M"], **WARM},
                                 {"name": "MC", "nodes": ["M", "C"], **WARM}])


def entry() -> Entry:
    simple, cantilever = beam(PINNED, ROLLER).reduced(), beam(CLAMPED, FREE).reduced()
    clamped, propped = beam(CLAMPED, CLAMPED).reduced(), beam(CLAMPED, ROLLER).reduced()
    arc = (1 - cos(3 * CURVATURE)) / CURVATURE, (1 - cos(6 * CURVATURE)) / CURVATURE
    return Entry(
        name="thermal_beams", part="Beams and frames", title="Beams under a temperature gradient", kind=CLOSED_FORM,
        source="S. Timoshenko, Strength of Materials I, 3rd ed., chapter on thermal stresses in beams; the script "
        "evaluates the formulas κ = α ΔT/h, w = κ L²/8 and κ L²/2, M = E I κ, R = 3 E I κ/(2 L)",
        uncertainty="exact in linear theory",
        statement="A beam of 6 m with E I = 60 MN m² and height 0.4 m is 20 K warmer on one side. Find the sag between "
        "simple supports, the tip of a cantilever, the moment between clamps, and the reaction of a propped "
        "cantilever.",
        case=beam(CLAMPED, ROLLER), tolerance=2e-4, reason="solver entries",
        model="A free beam is an arc, not a parabola: terms of the order (κ L)² = 1.3e-5.",
        rows=[Row("simply supported: sag", "mm", 1e3 * CURVATURE * 36 / 8,
                  1e3 * float(hottest(simple, "displacement_m")[1, 1]), theory=1e3 * arc[0]),
              Row("cantilever: tip", "mm", 1e3 * CURVATURE * 36 / 2,
                  -1e3 * float(hottest(cantilever, "displacement_m")[2, 1]), theory=1e3 * arc[1]),
              Row("clamped: moment", "kN m", RIGIDITY_N_M2 * CURVATURE / 1e3,
                  float(hottest(clamped, "beam_moment_first_N_m")[0, 2]) / 1e3),
              Row("propped: reaction", "kN", 1.5 * RIGIDITY_N_M2 * CURVATURE / LENGTH_M / 1e3,
                  abs(float(hottest(propped, "beam_force_first_N")[0, 1])) / 1e3),
              Row("propped: moment at the clamp", "kN m", 1.5 * RIGIDITY_N_M2 * CURVATURE / 1e3,
                  abs(float(hottest(propped, "beam_moment_first_N_m")[0, 2])) / 1e3)],
        verdict="Linear theory holds to 1e-5; what remains is the square of the rotations.")


if __name__ == "__main__":
    show(entry())
