# SPDX-License-Identifier: GPL-3.0-or-later
"""Four-parameter Iwan joint beside tmdsimpy."""
from __future__ import annotations

from manual import OTHER_CODE, Curve, Entry, Picture, Row, link, node, show, truss

import numpy as np

STIFFNESS_N_PER_M, SLIP_N, EXPONENT, RATIO = 2e6, 300.0, -0.5, 1.0
LARGEST_M = 2.25e-4  # displacement at which the whole joint slips
# Displacement over LARGEST_M, force [N] of Iwan4Force with 4000 sliders along 0, 0.6, -0.6, 1.2 LARGEST_M.
PRINTED = [(0.2, 76.58361858601444), (0.4, 142.05269475016323), (0.6, 200.2863265547509), (0.3, 82.71469892799429),
           (0.0, -20.418696441532646), (-0.3, -114.15297376850833), (-0.6, -200.2863265547509),
           (-0.3, -82.71469892799429),
           (0.0, 20.418696441532646), (0.6, 200.2863265547509), (1.2, 300.0000269303296)]


def entry() -> Entry:
    # A stiff bar that expands drives the joint along its path.
    alpha, length = 1e-5, 1.0
    path = np.array([0.0] + [at for at, _ in PRINTED])
    case = truss(
        "iwan_loop", [node("A", 0.0, 0.0, fixed="xy"), node("B", length, 0.0, fixed="y")],
        link=[link("bar", "A", "B", 1e13, 1.0, alpha)],
        iwan_joint=[{"name": "J", "nodes": ["B"], "axis": [1.0, 0.0], "tangent_stiffness_N_per_m": STIFFNESS_N_PER_M,
                     "slip_force_N": SLIP_N, "exponent": EXPONENT, "stiffness_ratio": RATIO, "elements": 4000,
                     "spacing": 1.0}],
        thermal={"shape": "table", "table_time_s": [float(k) for k in range(len(path))],
                 "table_temperature_change_K": [float(at) for at in path * LARGEST_M / (alpha * length)],
                 "return_to_reference": False},
        reduced={"increments_per_branch": 20}, output={"samples_per_cycle": 1100})
    run = case.reduced().at([float(k + 1) for k in range(len(PRINTED))])
    force = np.abs(np.asarray(run["iwan_force_N"])[:, 0]) * np.sign([value for _, value in PRINTED])
    return Entry(
        name="iwan_loop", part="Contact and laws", title="Four-parameter Iwan joint (tmdsimpy)", kind=OTHER_CODE,
        source="tmd-lab/tmdsimpy 17d5fc3f, tmdsimpy/nlforces/iwan4_element.py, run with kt = 2 MN/m, Fs = 300 N, χ = "
        "-0.5, β = 1 and 4000 sliders; D. J. Segalman, J. Appl. Mech. 72 (2005) 752-760",
        uncertainty="4000 sliders: 3e-6",
        statement="An Iwan joint is moved to 0.6 of the slide at which it slips as a whole, back to -0.6 and on to 1.2 "
        "of it. Find its force.", case=case, tolerance=2e-4, reason="solver entries; the joint has 4000 Jenkins "
        "elements",
        rows=[Row(f"force {k + 1}, at {at:g}", "N", value, float(force[k]), scale=SLIP_N)
              for k, (at, value) in enumerate(PRINTED)],
        picture=Picture("slide over that of full slip", "force [N]", [
            Curve("ours", [0.0, *(at for at, _ in PRINTED)], [0.0, *force]),
            Curve("tmdsimpy", [at for at, _ in PRINTED], [value for _, value in PRINTED], ours=False)]),
        verdict="Both implementations of Segalman's joint have the same loop.")


if __name__ == "__main__":
    show(entry())
