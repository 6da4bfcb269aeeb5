# SPDX-License-Identifier: GPL-3.0-or-later
"""Cantilever that an end moment bends into a full circle: Code_Aster SSNL103."""
from __future__ import annotations

from math import sin

from manual import OTHER_CODE, Entry, Row, chain, node, section, show, truss


def entry() -> Entry:
    count, moment = 5, 12.566
    nodes = [node("N1", 0.0, 0.0, clamped=True), *(node(f"N{k + 1}", k / count, 0.0) for k in range(1, count + 1))]
    nodes[-1]["moment_N_m"] = [moment]
    beams = [{**beam, "nodes": [f"N{k + 1}", f"N{k + 2}"]} for k,
             beam in enumerate(chain(count, section(1.0, 1.0, 2.0)))]
    case = truss("ssnl103", nodes, beam=beams, reduced={"increments_per_branch": 1})
    run = case.reduced()
    moved = run["displacement_m"][0]
    return Entry(
        name="ssnl103", part="Beams and frames", title="Cantilever bent into a circle (Code_Aster SSNL103)",
        kind=OTHER_CODE,
        source="Code_Aster SSNL103A, ralic/Code_Aster 03e7b576, astest/ssnl103a.comm; J. C. Simo and L. Vu-Quoc, "
        "Comput. Methods Appl. Mech. Eng. 58 (1986) 79-116", uncertainty="Code_Aster's test allows 1e-4; its reference "
        "has two digits",
        statement="A moment of 4π N m acts at the tip of a cantilever of 1 m with E I = 2 N m². The beam closes to a "
        "circle. Five beams are used, as in Code_Aster.", case=case, tolerance=2e-4, reason="solver entries",
        model="12.566 is not quite 4π.",
        rows=[Row("displacement x of the tip", "m", -1.0, float(moved[5, 0]),
                  theory=sin(moment / 2) / (moment / 2) - 1),
              Row("rotation of the tip", "rad", moment / 2, float(run["rotation_rad"][0, 5, 2])),
              Row("gap of the circle over its circumference", "1", 0.0, float(moved[5, 1])),
              Row("rotation of the middle", "rad", moment / 2 * 0.4, float(run["rotation_rad"][0, 2, 2]))],
        verdict="The circle closes for any number of beams. Code_Aster's references for N3 and N4, -0.3 and -0.7 m, "
        "are values of its coarse mesh of chords and are not compared.")


if __name__ == "__main__":
    show(entry())
