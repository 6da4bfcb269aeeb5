# SPDX-License-Identifier: GPL-3.0-or-later
"""Rows of blocks that walk under temperature cycles: the case, the closed forms of blocks and of a continuous sheet."""
from __future__ import annotations

import attrs
import numpy as np
from manual import link, node, truss

import statejump as sj

CYCLES = 3


@attrs.frozen
class Walk:
    """A sheet or pipe in equal blocks; each block has an equal part of load and friction.

    :param load_N: force along the sheet of its weight, all blocks together
    :param end_N: force at its last node
    :param friction_N: friction limit of all blocks together
    """

    name: str
    blocks: int
    length_m: float
    stiffness_N: float
    alpha: float
    change_K: float
    friction_N: float
    load_N: float = 0.0
    end_N: float = 0.0

    @property
    def drift_N(self) -> float:
        """Force that pulls the sheet downwards."""
        return self.load_N + self.end_N

    @property
    def strain(self) -> float:
        """Free thermal strain less what friction holds back over the sheet."""
        return self.alpha * self.change_K - (self.friction_N - self.drift_N) / self.stiffness_N

    @property
    def continuous_m(self) -> float:
        """Walk per cycle of a continuous sheet [m]: its two resting points are drift/friction of its length apart."""
        return self.length_m * self.drift_N / self.friction_N * self.strain

    @property
    def apart(self) -> int:
        """Number of blocks between the two resting blocks; it has the parity of the other blocks."""
        odd = (self.blocks - 1) % 2
        return 2 * round((self.blocks * self.drift_N / self.friction_N - odd) / 2) + odd

    @property
    def blocks_m(self) -> float:
        """Walk per cycle of the blocks [m]."""
        return self.apart * self.length_m / self.blocks * self.strain

    def case(self) -> sj.Case:
        """Return the case."""
        count, pitch = self.blocks, self.length_m / self.blocks
        nodes = [node(f"N{k}", (k + 0.5) * pitch, 0.0, fixed="y",
                      force_N=[self.load_N / count + (self.end_N if k == count - 1 else 0.0), 0.0])
                 for k in range(count)]
        links = [link(f"L{k}", f"N{k}", f"N{k + 1}", self.stiffness_N / 1e-2, 1e-2, self.alpha)
                 for k in range(count - 1)]
        sliders = [{"name": f"S{k}", "nodes": [f"N{k}"], "axis": [1.0, 0.0], "friction_coefficient": 1.0,
                    "normal_force_N": self.friction_N / count} for k in range(count)]
        return truss(self.name, nodes, self.change_K, link=links, slider=sliders, thermal={"cycles": CYCLES})

    def walk_m(self) -> float:
        """Return our walk in the last cycle, mean of all nodes."""
        run = self.case().reduced().at([CYCLES - 1.0, float(CYCLES)])
        moved = np.asarray(run["displacement_m"])[:, :, 0].mean(axis=1)
        return float(moved[1] - moved[0])
