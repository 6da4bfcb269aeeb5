# SPDX-License-Identifier: GPL-3.0-or-later
"""Portal frame with one heated column."""
from __future__ import annotations

from manual import CLOSED_FORM, Entry, Row, hottest, node, section, show, truss

import numpy as np

SPAN_M, HEIGHT_M, YOUNG_PA, AREA_M2, MOMENT_M4, ALPHA, CHANGE_K = 6.0, 4.0, 210e9, 5e-3, 8e-5, 1.2e-5, 60.0
SMALL = 1e-3  # the reference is linear
PLACES = np.array([(0.0, 0.0), (0.0, HEIGHT_M), (SPAN_M, HEIGHT_M), (SPAN_M, 0.0)])


def linear() -> tuple[float, float]:
    """Return shear force [N] and foot moment [N m] of linear beam theory, by stiffness matrices of three members."""
    stiffness, load = np.zeros((12, 12)), np.zeros(12)
    bent = YOUNG_PA * MOMENT_M4
    for member in range(3):
        axis = PLACES[member + 1] - PLACES[member]
        length = float(np.hypot(*axis))
        cosine, sine = axis / length
        turn = np.kron(np.eye(2), np.array([[cosine, sine, 0], [-sine, cosine, 0], [0, 0, 1.0]]))
        a, b, c, d = YOUNG_PA * AREA_M2 / length, 12 * bent / length**3, 6 * bent / length**2, 2 * bent / length
        own = np.array([[a, 0, 0, -a, 0, 0], [0, b, c, 0, -b, c], [0, c, 2 * d, 0, -c, d], [-a, 0, 0, a, 0, 0],
                        [0, -b, -c, 0, b, -c], [0, c, d, 0, -c, 2 * d]])
        at = slice(3 * member, 3 * member + 6)
        stiffness[at, at] += turn.T @ own @ turn
        if member == 0:
            heat = YOUNG_PA * AREA_M2 * ALPHA * CHANGE_K
            load[at] += turn.T @ np.array([-heat, 0, 0, heat, 0, 0])
    moved = np.zeros(12)
    moved[3:9] = np.linalg.solve(stiffness[3:9, 3:9], load[3:9])
    reaction = stiffness @ moved - load
    return abs(float(reaction[1])), abs(float(reaction[2]))


def entry() -> Entry:
    cold = section(YOUNG_PA, AREA_M2, MOMENT_M4, thermal_expansion_per_K=ALPHA)
    case = truss("heated_portal", [
        node("A", 0.0, 0.0, clamped=True), node("B", 0.0, HEIGHT_M), node("C", SPAN_M, HEIGHT_M),
        node("D", SPAN_M, 0.0, clamped=True)], CHANGE_K * SMALL,
        beam=[{"name": "left column", "nodes": ["A", "B"], **cold},
              {"name": "girder", "nodes": ["B", "C"], **cold, "temperature_fraction": 0.0},
              {"name": "right column", "nodes": ["C", "D"], **cold, "temperature_fraction": 0.0}])
    run = case.reduced()
    axial = abs(float(hottest(run, "beam_force_first_N")[0, 0])) / SMALL
    moment = abs(float(hottest(run, "beam_moment_first_N_m")[0, 2])) / SMALL
    reference = linear()
    return Entry(
        name="heated_portal", part="Beams and frames", title="Portal frame with one heated column", kind=CLOSED_FORM,
        source="linear slope-deflection theory with axial strain; the script solves its six equations",
        uncertainty="exact in linear theory",
        statement="A clamped portal of 6 m span and 4 m height; its left column is heated by 60 K. Find the vertical "
        "reaction and the foot moment. One beam per member.", case=case, tolerance=2e-4, reason="solver entries",
        model="None: the case has a thousandth of the heat, so that displacements are small.",
        rows=[Row("vertical reaction", "N", reference[0], axial),
              Row("moment at the left foot", "N m", reference[1], moment)],
        verdict="One beam per member gives the forces of linear theory.")


if __name__ == "__main__":
    show(entry())
