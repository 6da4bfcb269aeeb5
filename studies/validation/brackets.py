# SPDX-License-Identifier: GPL-3.0-or-later
"""Two brackets with a friction joint: condensed bodies against full meshes in CalculiX."""
from __future__ import annotations

from pathlib import Path

from manual import OTHER_CODE, Entry, Row, node, show, truss

import numpy as np

import statejump as sj

MATRICES = np.loadtxt(Path(__file__).parent / "data" / "bracket.csv", delimiter=",")
STIFFNESS, LOADS = MATRICES[:18], MATRICES[18:]  # loads per kelvin: uniform, gradient along z
PLACES = {"A": (0.2, 0.02, 0.005), "B": (0.005, 0.02, 0.12), "C": (0.01, 0.02, 0.0)}
LIMIT_N, SPRING_N_PER_M, TIE_N_PER_M, TIE_N_M = 5.0, 1e6, 1e9, 1e5
PATH_K = (0.0, 0.06, 0.0, -0.06, 0.0)
CALCULIX = (-2.069036600e-7, -6.749544e-8, 2.069036600e-7, 6.749544e-8)
SKETCH = """
   B1 o-----/\\/\\/\\-----o B2      z
      |     1 MN/m     |         |
      |                |         +-- x
   C1 #================# C2      #: held foot
              A1|A2              |: slider, 5 N
"""
TURNED = np.diag([-1.0, -1.0, 1.0])


def case() -> sj.Case:
    """Return two brackets with held feet, arm ends face to face."""
    content = sj.body.from_arrays(list(PLACES), list(PLACES.values()), STIFFNESS, loads=LOADS, source="CalculiX",
                                  pattern_names=["uniform", "gradient_z"], patch="rigid")
    second = {name: (0.4 - x, 0.04 - y, z) for name, (x, y, z) in PLACES.items()}
    nodes = [node(f"{name}{side}", *map(float, place), clamped=name == "C")
             for side, places in ((1, PLACES), (2, second)) for name, place in places.items()]
    bodies = [{"name": f"bracket {side}", "nodes": [f"A{side}", f"B{side}", f"C{side}"], "content": content,
               "patterns": ["uniform", "gradient_z"], "temperature_fractions": fractions, "axis_x": [sign, 0.0, 0.0],
               "axis_y": [0.0, sign, 0.0], "position_m": origin}
              for side, fractions, sign, origin in ((1, [1.0, 0.0], 1.0, [0.0, 0.0, 0.0]),
                                                    (2, [0.5, 1.0], -1.0, [0.4, 0.04, 0.0]))]
    ties = [{"name": f"tie {direction}", "nodes": ["A1", "A2"], "directions": [direction] * 2,
             "coefficients": [1.0, -1.0]} for direction in ("Rx", "Ry", "Rz")]
    return truss(
        "brackets", nodes, dimension=3, body=bodies, constraint=ties,
        slider=[{"name": "S", "nodes": ["A1", "A2"], "axis": [1.0, 0.0, 0.0], "friction_coefficient": 1.0,
                 "normal_force_N": LIMIT_N}],
        spring=[{"name": "K", "nodes": ["B1", "B2"], "stiffness_N_per_m": SPRING_N_PER_M, "free_length_m": 0.39}],
        thermal={"shape": "table", "table_time_s": [0.0, 1.0, 2.0, 3.0, 4.0],
                 "table_temperature_change_K": list(PATH_K)})


def closed_form(ties_N_per_m: float, ties_N_m: float) -> list[float]:
    """Return the slide at the ends of the temperature changes: two linear bodies, a friction joint, ties as springs."""
    turn = np.kron(np.eye(4), TURNED)
    stiffness = np.zeros((24, 24))
    stiffness[:12, :12], stiffness[12:, 12:] = STIFFNESS[:12, :12], turn @ STIFFNESS[:12, :12] @ turn.T
    loads = np.concatenate((LOADS[0][:12], turn @ (0.5 * LOADS[0] + LOADS[1])[:12]))
    for at, spring in ((1, ties_N_per_m), (2, ties_N_per_m), (3, ties_N_m), (4, ties_N_m), (5, ties_N_m),
                       (6, SPRING_N_PER_M)):
        pair = np.ix_((at, 12 + at), (at, 12 + at))
        stiffness[pair] += spring * np.array([[1, -1], [-1, 1]])
    slide = np.zeros(24)
    slide[[0, 12]] = -1.0, 1.0
    compliance, free = slide @ np.linalg.solve(stiffness, slide), slide @ np.linalg.solve(stiffness, loads)
    moved, found = 0.0, []
    for change in PATH_K[1:]:
        force = float(np.clip((free * change - moved) / compliance, -LIMIT_N, LIMIT_N))
        moved = float(free * change - force * compliance)
        found.append(moved)
    return found


def entry() -> Entry:
    one = case()  # its bodies are arrays, so it has no case file
    run = one.reduced()
    names = [item["name"] for item in one.to_dict()["node"]]
    times, x = np.asarray(run["time_s"]), np.asarray(run["displacement_m"])[:, :, 0]
    slide = x[:, names.index("A2")] - x[:, names.index("A1")]
    rows = []
    for at, theirs, springs, stiff in zip((1.0, 2.0, 3.0, 4.0), CALCULIX, closed_form(TIE_N_PER_M, TIE_N_M),
                                          closed_form(1e14, 1e12)):
        ours = float(slide[int(np.abs(times - at).argmin())])
        rows.append(Row(f"slide at {PATH_K[int(at)]:g} K", "nm", 1e9 * theirs, 1e9 * ours,
                        theory=1e9 * theirs * stiff / springs))
    return Entry(
        name="brackets", part="Condensed bodies", title="Two brackets with a friction joint (CalculiX, full meshes)",
        kind=OTHER_CODE, source="CalculiX 2.20: two meshes of 256 C3D20R with rigid interface patches, friction by a "
        "brick of ideally plastic metal; condensed stiffness and loads of one mesh in data/bracket.csv",
        uncertainty="seven printed digits",
        statement="Two L-shaped brackets of aluminium stand with held feet, their arm ends face to face. The ends "
        "slide along x against 5 N, their other motions are tied; a spring of 1 MN/m joins the tops. One bracket is "
        "heated uniformly, the other by half as much and by a gradient, by 0.06, 0, -0.06 and 0 K. Find the slide.",
        tolerance=2e-4, reason="solver entries", rows=rows, sketch=SKETCH,
        model="CalculiX ties the ends with springs of 1 GN/m and 100 kN m/rad, we tie them rigidly. The script "
        "evaluates a play operator on the condensed stiffness with both ties.",
        verdict="Two condensed bodies and a slider give the slide and its residual of the full meshes.")


if __name__ == "__main__":
    show(entry())
