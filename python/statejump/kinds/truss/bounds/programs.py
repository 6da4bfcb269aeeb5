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
        """Return an upper bound of cost · x.

        By weak duality, max cost·x <= y·b + max (cost − Aᵀy)·x over the box of x, for any y >= 0. HiGHS proposes y.
        """
        matrix = np.concatenate((self.rows, -self.rows))
        right = np.concatenate((self.most, -self.least))
        finite = np.isfinite(right)
        matrix, right = matrix[finite], right[finite]
        size = np.linalg.norm(matrix, axis=1)
        matrix, right = matrix[size > 0] / size[size > 0, None], right[size > 0] / size[size > 0]
        scale = float(np.abs(cost).max()) or 1.0
        dual = np.zeros(len(right))
        if len(right):
            found = linprog(-cost / scale, A_ub=matrix, b_ub=right, bounds=np.column_stack((self.lowest, self.highest)),
                            method="highs")
            if found.status == 0:
                dual = scale * np.maximum(0.0, -np.asarray(found.ineqlin.marginals))
        rest = cost - matrix.T @ dual
        return float(dual @ right + np.where(rest > 0, rest * self.highest, rest * self.lowest).sum())
