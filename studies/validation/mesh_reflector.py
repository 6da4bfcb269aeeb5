# SPDX-License-Identifier: GPL-3.0-or-later
"""Repeatability of AstroMesh beside the jump of a ring truss."""
from __future__ import annotations

from manual import ORDER, Entry, Row, show

import statejump as sj


def entry() -> Entry:
    case = sj.truss.ring(12, radial_clearance_m=1e-5)
    run = case.reduced()
    places = [one["position_m"] for one in case.to_dict()["node"]]
    diameter = 2 * max((x**2 + y**2) ** 0.5 for x, y, *_ in places)
    return Entry(
        name="mesh_reflector", part="Whole structures", title="Repeatability of AstroMesh (order of magnitude)",
        kind=ORDER,
        source="M. W. Thomson, The AstroMesh deployable reflector, IEEE AP-S 1999 (studylib.net/doc/25644459): "
        "repeatability below 5e-6 of the diameter, rms, measured on two models after deployment",
        uncertainty="an upper limit; not the same quantity: "
        "deployment there, a temperature cycle here, with joints of 10 µm clearance that the paper does not state",
        statement="A ring truss of twelve bays with clearance joints is heated by 100 K and cools again. Compare its "
        "largest jump over the diameter with the repeatability of a ring-stiffened mesh reflector.", case=case,
        tolerance=1.0,
        reason="an upper limit and two orders of magnitude below it",
        rows=[Row("largest jump over the diameter", "1", 5e-6, run.summary["largest_jump_m"] / diameter, low=5e-8,
                  high=5e-6)],
        verdict="The jump of a plausible ring is below the measured repeatability and not negligible beside it.")


if __name__ == "__main__":
    show(entry())
