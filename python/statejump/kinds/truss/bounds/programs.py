# SPDX-License-Identifier: GPL-3.0-or-later
"""Linear programs whose bounds do not depend on the solver: each is recomputed from its multipliers."""
from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.optimize import linprog

INFEASIBLE = 2  # status of linprog
ROUNDED = 1e-9  # violation of a row, over the size of its terms


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
        The bound is −∞ if multipliers prove that no x exists.
        """
        matrix, right, kept, size = self._scaled()
        scale = float(np.abs(cost).max()) or 1.0
        dual, x = np.zeros(len(right)), None
        found = linprog(-cost / scale, A_ub=matrix if len(right) else None, b_ub=right if len(right) else None,
                        bounds=np.column_stack((self.lowest, self.highest)), method="highs")
        if found.status == 0:
            x = np.clip(found.x, self.lowest, self.highest)
            if len(right):
                dual = scale * np.maximum(0.0, -np.asarray(found.ineqlin.marginals))
        elif found.status == INFEASIBLE and self._is_empty(matrix, right):
            return Solved(-np.inf, None, np.zeros(len(self.rows)))
        rest = cost - matrix.T @ dual
        bound = float(dual @ right + np.where(rest > 0, rest * self.highest, rest * self.lowest).sum())
        whole = np.zeros(2 * len(self.rows))
        whole[kept] = dual / size[kept]
        return Solved(bound, x, whole[:len(self.rows)] - whole[len(self.rows):])

    def _scaled(self) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """Return A and b of A x <= b with rows of the length 1, which rows these are, and the lengths of all rows."""
        matrix = np.concatenate((self.rows, -self.rows))
        right = np.concatenate((self.most, -self.least))
        size = np.linalg.norm(matrix, axis=1)
        kept = np.isfinite(right) & (size > 0)
        return matrix[kept] / size[kept, None], right[kept] / size[kept], kept, size

    def _is_empty(self, matrix: np.ndarray, right: np.ndarray) -> bool:
        """Whether multipliers prove that every x violates a row by more than rounding."""
        scale = np.abs(matrix) @ np.maximum(np.abs(self.lowest), np.abs(self.highest)) + np.abs(right) + 1e-300
        eased = Polytope(np.column_stack((matrix / scale[:, None], -np.ones(len(right)))),
                         np.full(len(right), -np.inf), right / scale, np.append(self.lowest, 0.0),
                         np.append(self.highest, 2.0))
        return eased.highest_value(np.append(np.zeros(len(self.lowest)), -1.0)) < -ROUNDED


@dataclass(frozen=True)
class Solved:
    """An upper bound, and what the solver proposes.

    :param x: variables; None: the solver found none
    :param dual: multiplier of each row, positive at its upper end
    """

    bound: float
    x: np.ndarray | None
    dual: np.ndarray
