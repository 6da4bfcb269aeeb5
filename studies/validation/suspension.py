# SPDX-License-Identifier: GPL-3.0-or-later
"""Three-span suspension cable: anchorages, rolling saddles, dead load of the middle span."""
from __future__ import annotations

from math import hypot

import attrs
import numpy as np
from manual import link, node, truss

import statejump as sj

FOOT = 0.3048
ALPHA, BAYS = 1.2e-5, 30
STRAIN = 2.5e-3  # of cables at 500 MPa
SAG_OF_HEIGHT = 0.85  # the cable ends above the roadway


@attrs.frozen
class Bridge:
    """A suspension bridge.

    :param tower_m: height of the saddles over the anchorages
    :param rise_m: height of the saddles over the roadway
    :param side_m: span between tower and anchorage
    """

    name: str
    span_m: float
    tower_m: float
    rise_m: float
    side_m: float
    weight_N_per_m: float = 7e5

    def case(self, change_K: float) -> sj.Case:
        """Return the cable under its load."""
        sag = SAG_OF_HEIGHT * self.rise_m
        pull = self.weight_N_per_m * self.span_m**2 / (8 * sag)
        rigidity = pull / STRAIN
        place = self.span_m * (np.arange(BAYS + 1) / BAYS - 0.5)
        height = 4 * sag * (place / self.span_m) ** 2
        bay = self.span_m / BAYS
        nodes = [node(f"N{k}", float(x), float(y), fixed="y" if k in (0, BAYS) else "",
                      force_N=[0.0, 0.0 if k in (0, BAYS) else -self.weight_N_per_m * bay])
                 for k, (x, y) in enumerate(zip(place, height))]
        nodes += [node(name, side * (self.span_m / 2 + self.side_m), sag - self.tower_m, fixed="xy")
                  for name, side in (("left", -1), ("right", 1))]

        def cable(name: str, first: str, last: str, length: float, along: float) -> dict[str, object]:
            free = length / (1 + pull * length / along / rigidity)
            return link(name, first, last, rigidity / 0.1, 0.1, ALPHA, stress_free_length_m=free)

        links = [cable(f"C{k}", f"N{k}", f"N{k + 1}", hypot(bay, float(height[k + 1] - height[k])), bay)
                 for k in range(BAYS)]
        backstay = hypot(self.side_m, self.tower_m)
        links += [cable("left backstay", "N0", "left", backstay, self.side_m),
                  cable("right backstay", f"N{BAYS}", "right", backstay, self.side_m)]
        return truss(self.name, nodes, change_K, link=links)

    def descent_m(self, change_K: float) -> float:
        """Return how much lower the middle hangs after a temperature change [m]."""
        moved = np.asarray(self.case(change_K).reduced()["displacement_m"])[:, BAYS // 2, 1]
        return float(moved.max() - moved.min())
