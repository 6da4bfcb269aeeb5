# SPDX-License-Identifier: GPL-3.0-or-later
"""Frame that NX Nastran condensed to four nodes: the superelement ``outboard`` of pyYeti."""
from __future__ import annotations

from manual import OTHER_CODE, Entry, Row, node, show, truss

import numpy as np

import statejump as sj

YOUNG_PA, SHEAR_PA, MM = 6.894e10, 2.62e10, 1e-3
# Area [mm²], second moment and torsion constant [mm⁴].
SECTIONS = {100: (12.566, 12.566, 25.133), 102: (201.06, 3217.0, 6434.0)}
PLACES = {1: (0, 0, 300), 2: (300, 0, 300), 3: (600, 0, 300), 9: (0, 300, 300), 10: (300, 300, 300),
          11: (600, 300, 300), 17: (0, 300, 0), 18: (300, 300, 0), 19: (600, 300, 0), 25: (0, 0, 0), 26: (300, 0, 0),
          27: (600, 0, 0), 35: (150, -30, 150), 36: (150, 330, 150)}
BARS = {100: "1-2 2-3 9-10 10-11 17-18 18-19 25-26 26-27 1-9 2-10 3-11 17-25 18-26 19-27 1-25 2-26 3-27 9-17 10-18 "
             "11-19 9-25 2-18 11-27 1-10 3-10 9-18 11-18 17-26 19-26 2-25 2-27",
        102: "17-36 18-36 10-36 9-36 25-35 26-35 2-35 1-35"}
HELD = (3, 19, 27)
LOADED = 11
# Displacements [m/N] and rotations [rad/(N m)] of node 11, from the condensed stiffness.
NASTRAN = {"x": (1.28237694e-06, 2.33977126e-08, -8.96452997e-08),
           "y": (2.33977126e-08, 2.74244376e-07, -7.05837829e-08),
           "z": (-8.96452997e-08, -7.05837829e-08, 2.70223696e-07)}
ROTATIONS = (2.63229247e-02, 2.63360229e-02, 2.90772895e-02)


def case(load: dict[str, list[float]]) -> sj.Case:
    """Return the frame, held at three of its four interface nodes and loaded at the fourth."""
    nodes = [node(str(name), *(MM * value for value in place), clamped=name in HELD, **(load if name == LOADED else {}))
             for name, place in PLACES.items()]
    beams = []
    for kind, pairs in BARS.items():
        area, second, torsion = SECTIONS[kind]
        for pair in pairs.split():
            first, last = (np.array(PLACES[int(name)]) for name in pair.split("-"))
            along = (last - first) / np.linalg.norm(last - first)
            side = np.cross(along, np.eye(3)[int(np.argmin(np.abs(along)))])
            beams.append({"name": f"B{pair}", "nodes": pair.split("-"), "young_modulus_Pa": YOUNG_PA,
                          "shear_modulus_Pa": SHEAR_PA, "cross_section_area_m2": area * MM**2,
                          "second_moments_of_area_m4": [second * MM**4] * 2, "torsion_constant_m4": torsion * MM**4,
                          "axis_y": (side / np.linalg.norm(side)).tolist(), "thermal_expansion_per_K": 0.0})
    return truss("outboard", nodes, dimension=3, beam=beams)


def moved(load: dict[str, list[float]], column: str) -> np.ndarray:
    """Return displacement or rotation of the loaded node."""
    return np.asarray(case(load).reduced()[column])[-1, list(PLACES).index(LOADED)]


def entry() -> Entry:
    rows = []
    for axis, direction in zip("xyz", np.eye(3)):
        ours = moved({"force_N": direction.tolist()}, "displacement_m")
        largest = 1e9 * max(map(abs, NASTRAN[axis]))
        rows += [Row(f"displacement along {along} under 1 N along {axis}", "nm", 1e9 * theirs, 1e9 * float(value),
                     scale=largest) for along, theirs, value in zip("xyz", NASTRAN[axis], ours)]
    for axis, direction, theirs in zip("xyz", np.eye(3), ROTATIONS):
        turned = moved({"moment_N_m": (1e-3 * direction).tolist()}, "rotation_rad")
        rows.append(Row(f"rotation about {axis} under 1 mN m about it", "µrad", 1e3 * theirs,
                        1e6 * float(turned["xyz".index(axis)])))
    return Entry(
        name="outboard", part="Condensed bodies", title="Frame condensed by NX Nastran (superelement of pyYeti)",
        kind=OTHER_CODE, source="twmacro/pyyeti, pyyeti/tests/nas2cam_extseout/outboard.blk and outboard.op4, NX "
        "Nastran 9 (BSD-3)", uncertainty="stiffness of 16 digits; areas and second moments of 5",
        statement="A frame of 39 bars is condensed to four nodes of six dofs. Its import with statejump body import "
        "gives a force of unit rigid motions of 2e-14, a mass of 1.590384 kg and 1.650001 Hz with held nodes, which NX "
        "Nastran prints as 1.650001 Hz. Three of the nodes are held. Find the motion of the fourth under unit forces "
        "and moments. Two booms of the frame are left out, because they carry no static load.",
        case=case({"force_N": [1.0, 0.0, 0.0]}), tolerance=2e-4, reason="solver entries", rows=rows,
        verdict="A frame of our beams has the stiffness that NX Nastran condensed.")


if __name__ == "__main__":
    show(entry())
