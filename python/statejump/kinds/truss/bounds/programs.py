# SPDX-License-Identifier: GPL-3.0-or-later
"""Linear programs whose bounds do not depend on the solver: each is recomputed from its multipliers."""
from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.optimize import linprog


@dataclass(frozen=True)
class Polytope:
    """Variables x with lowest <= x <= highest, all finite, and least <= rows x <= most."""

    rows: np.ndarray
    least: np.ndarray
    most: np.ndarray
    lowest: np.ndarray
    highest: np.ndarray

    def highest_value(self, cost: np.ndarray) -> float:
        """Return an upper bound of cost · x."""
        return self.solved(cost).bound

    def solved(self, cost: np.ndarray) -> Solved:
        """Return an upper bound of cost · x.

        By weak duality, max cost·x <= y·b + max (cost − Aᵀy)·x over the box of x, for any y >= 0. HiGHS proposes y.
        """
        matrix = np.concatenate((self.rows, -self.rows))
        right = np.concatenate((self.most, -self.least))
        size = np.linalg.norm(matrix, axis=1)
        kept = np.isfinite(right) & (size > 0)
        matrix, right = matrix[kept] / size[kept, None], right[kept] / size[kept]
        scale = float(np.abs(cost).max()) or 1.0
        dual, x = np.zeros(len(right)), None
        found = linprog(-cost / scale, A_ub=matrix if len(right) else None, b_ub=right if len(right) else None,
                        bounds=np.column_stack((self.lowest, self.highest)), method="highs")
        if found.status == 0:
            x = np.clip(found.x, self.lowest, self.highest)
            if len(right):
                dual = scale * np.maximum(0.0, -np.asarray(found.ineqlin.marginals))
        rest = cost - matrix.T @ dual
        bound = float(dual @ right + np.where(rest > 0, rest * self.highest, rest * self.lowest).sum())
        whole = np.zeros(2 * len(self.rows))
        whole[kept] = dual / size[kept]
        return Solved(bound, x, whole[:len(self.rows)] - whole[len(self.rows):])


@dataclass(frozen=True)
class Solved:
    """An upper bound, and what the solver proposes.

    :param x: variables; None: the solver found none
    :param dual: multiplier of each row, positive at its upper end
    """

    bound: float
    x: np.ndarray | None
    dual: np.ndarray
