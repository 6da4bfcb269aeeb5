# SPDX-License-Identifier: GPL-3.0-or-later
"""Measured deflections of a pine rod: Ball 1871. Stiffness from small loads, prediction of larger ones."""
from __future__ import annotations

from manual import MEASUREMENT, Curve, Entry, Picture, Row, node, section, show, truss

import numpy as np

import statejump as sj

INCH, POUND = 0.0254, 4.4482216152605
SPAN_M, SIDE_M = 40 * INCH, 1 * INCH
TABLE = [(14, 0.19), (28, 0.37), (42, 0.55), (56, 0.74), (70, 0.94), (84, 1.13), (98, 1.35), (112, 1.61), (126, 1.95),
         (140, 2.37)]


def loaded(young_Pa: float, load_lb: float) -> sj.Case:
    """Return the rod on its supports; one slides."""
    keys = section(young_Pa, SIDE_M**2, SIDE_M**4 / 12, thermal_expansion_per_K=0.0)
    return truss("pine_rod", [node("A", 0.0, 0.0, fixed="xy"),
                              node("M", SPAN_M / 2, 0.0, force_N=[0.0, -load_lb * POUND]),
                              node("B", SPAN_M, 0.0, fixed="y")],
                 beam=[{"name": "AM", "nodes": ["A", "M"], **keys}, {"name": "MB", "nodes": ["M", "B"], **keys}])


def deflection_in(young_Pa: float, load_lb: float) -> float:
    """Return the deflection of the middle [in]."""
    return -float(loaded(young_Pa, load_lb).reduced()["displacement_m"][0, 1, 1]) / INCH


def entry() -> Entry:
    small = np.array(TABLE[:4])
    compliance = float(small[:, 0] @ small[:, 1] / (small[:, 0] @ small[:, 0])) * INCH / POUND  # m/N
    young = SPAN_M**3 / (48 * compliance * SIDE_M**4 / 12)
    rows = [Row(f"deflection under {load} lb", "in", value, deflection_in(young, load), low=0.95 * value,
                high=1.05 * value)
            for load, value in TABLE[4:7]]
    return Entry(
        name="pine_rod", part="Joints from tests", title="Pine rod under a central load: small loads identified, "
        "larger predicted",
        kind=MEASUREMENT, source="R. S. Ball, Experimental Mechanics, 1871, article 364, Table XXIII (public domain)",
        uncertainty="telescope readings 0.01 in; pine creeps",
        statement="A rod of pine, 1 x 1 in, lies on supports 40 in apart. Loads of 14 to 56 lb give its modulus. "
        "Predict the deflections under 70, 84 and 98 lb. Beyond 98 lb, Ball saw permanent injury.",
        case=loaded(young, 98.0), tolerance=0.05,
        reason="interval of 5 %: readings and creep of the wood", rows=rows,
        picture=Picture("load [lb]", "deflection [in]", [
            Curve("predicted", [0, 140], [0.0, deflection_in(young, 140.0)]),
            Curve("measured", [load for load, _ in TABLE], [value for _, value in TABLE], ours=False)]),
        verdict="The elastic rod predicts the deflections up to the load at which the wood yields.")


if __name__ == "__main__":
    show(entry())
