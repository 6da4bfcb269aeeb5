# SPDX-License-Identifier: GPL-3.0-or-later
"""Strip of two bonded layers as two beams with offsets between common nodes."""
from __future__ import annotations

import attrs
import numpy as np
from manual import hottest, node, truss
from scipy.interpolate import CubicSpline

import statejump as sj

BEAMS = 8


@attrs.frozen
class Strip:
    """Two layers of equal thickness.

    :param layer_m: thickness of each layer
    :param upper: Young's modulus and thermal expansion of the upper layer; ``lower`` likewise
    """

    name: str
    length_m: float
    layer_m: float
    width_m: float
    upper: tuple[float, float]
    lower: tuple[float, float]
    change_K: float

    @property
    def curvature_per_m(self) -> float:
        """Timoshenko's curvature 12 Δε/(h (n + 14 + 1/n)), h the thickness of a layer, n the ratio of the moduli."""
        ratio = self.upper[0] / self.lower[0]
        misfit = (self.lower[1] - self.upper[1]) * self.change_K
        return 12 * misfit / (self.layer_m * (ratio + 14 + 1 / ratio))

    def case(self) -> sj.Case:
        """Return the clamped strip."""
        nodes = [node(f"N{k}", k * self.length_m / BEAMS, 0.0, clamped=k == 0) for k in range(BEAMS + 1)]
        beams = []
        for layer, (young, alpha), side in (("upper", self.upper, 0.5), ("lower", self.lower, -0.5)):
            offset = [0.0, side * self.layer_m]
            beams += [{"name": f"{layer} {k}", "nodes": [f"N{k}", f"N{k + 1}"], "young_modulus_Pa": young,
                       "shape": "rectangle", "dimensions_m": [self.layer_m, self.width_m],
                       "thermal_expansion_per_K": alpha,
                       "offset_first_m": offset, "offset_second_m": offset} for k in range(BEAMS)]
        return truss(self.name, nodes, self.change_K, beam=beams)

    def deflection_m(self, along_m: float | None = None) -> float:
        """Return our deflection [m], upwards, of the end, or at a distance from the clamp on the straight strip."""
        at = np.asarray(hottest(self.case().reduced(), "position_m"))
        return float(at[-1, 1] if along_m is None else CubicSpline(at[:, 0], at[:, 1])(along_m))

    def arc_m(self) -> float:
        """Return the deflection of the end of an arc of Timoshenko's curvature, whose interface expands [m]."""
        total = self.upper[0] + self.lower[0]
        free = (self.upper[0] * self.upper[1] + self.lower[0] * self.lower[1]) / total * self.change_K
        strain = free + self.curvature_per_m * self.layer_m / 2 * (self.upper[0] - self.lower[0]) / total
        curvature = self.curvature_per_m / (1 + strain)
        return float((1 - np.cos(curvature * self.length_m * (1 + strain))) / curvature)
