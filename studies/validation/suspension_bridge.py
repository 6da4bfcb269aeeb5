# SPDX-License-Identifier: GPL-3.0-or-later
"""Sag of the Verrazzano-Narrows Bridge in summer and winter."""
from __future__ import annotations

from math import hypot, sqrt

from manual import ORDER, Entry, Row, link, node, show, truss

import numpy as np

FOOT = 0.3048
SPAN_M, TOWER_M, ROADWAY_M, SIDE_M = 4260 * FOOT, 690 * FOOT, 228 * FOOT, 1215 * FOOT
SAG_M = 0.85 * (TOWER_M - ROADWAY_M)  # the cable ends above the roadway
SEASONS_K, ALPHA, BAYS = 50.0, 1.2e-5, 30
STRAIN = 2.5e-3  # of cables at 500 MPa
WEIGHT_N_PER_M = (60_000 + 40_000) * 8896.4 / SPAN_M


def entry() -> Entry:
    pull = WEIGHT_N_PER_M * SPAN_M**2 / (8 * SAG_M)
    rigidity = pull / STRAIN
    place = SPAN_M * (np.arange(BAYS + 1) / BAYS - 0.5)
    height = 4 * SAG_M * (place / SPAN_M) ** 2
    bay = SPAN_M / BAYS
    nodes = [node(f"N{k}", float(x), float(y), fixed="y" if k in (0, BAYS) else "",
                  force_N=[0.0, 0.0 if k in (0, BAYS) else -WEIGHT_N_PER_M * bay]) for k, (x, y) in enumerate(zip(place, height))]
    ends = [("left", -1), ("right", 1)]
    nodes += [node(name, side * (SPAN_M / 2 + SIDE_M), SAG_M - TOWER_M, fixed="xy") for name, side in ends]
    links = []

    def cable(name: str, first: str, last: str, length: float, along: float) -> None:
        tension = pull * length / along
        links.append(link(name, first, last, rigidity / 0.1, 0.1, ALPHA, stress_free_length_m=length / (1 + tension / rigidity)))

    for k in range(BAYS):
        length = hypot(bay, float(height[k + 1] - height[k]))
        cable(f"C{k}", f"N{k}", f"N{k + 1}", length, bay)
    for (name, _), saddle in zip(ends, ("N0", f"N{BAYS}")):
        cable(f"side {name}", saddle, name, sqrt(SIDE_M**2 + TOWER_M**2), SIDE_M)
    case = truss("suspension_bridge", nodes, SEASONS_K, link=links)
    run = case.reduced()
    moved = np.asarray(run["displacement_m"])[:, BAYS // 2, 1]
    lowered = float(moved.max() - moved.min())
    return Entry(
        name="suspension_bridge", part="Whole structures",
        title="Sag of the Verrazzano-Narrows Bridge in summer (order of magnitude)", kind=ORDER,
        source="roadway 12 ft lower in summer than in winter: sightseersdelight.com and pbase.com/image/158349617, after the "
        "bridge's operator; span 4260 ft, towers 690 ft, roadway 228 ft, cables 10 000 t each, roadway 60 000 t: Encyclopaedia "
        "Britannica", uncertainty="the seasonal change of the steel is not stated: 50 K are taken; sag and side spans (1215 ft) are "
        "estimates",
        statement="Steel cables hang over two towers and are held in anchorages; saddles roll on the towers. Find how much lower "
        "the middle hangs if the cables warm by 50 K.", case=case, tolerance=1.0, reason="a factor of two",
        rows=[Row("descent of the middle", "m", 12 * FOOT, lowered, low=6 * FOOT, high=24 * FOOT)],
        verdict="The order of magnitude agrees. A stiffening girder and the real seasonal change would be needed for more.")


if __name__ == "__main__":
    show(entry())
