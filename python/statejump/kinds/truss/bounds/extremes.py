# SPDX-License-Identifier: GPL-3.0-or-later
"""Largest Euclidean norm of E λ over a box |λ| <= 1: exact in one and two dimensions, otherwise from both sides.

In more dimensions the maximum is NP-hard. Signs that no single flip improves give a value that is reached. Weak duality
gives a bound: |E λ|² <= λ_max(E Y⁻¹ Eᵀ) Σ y for any y > 0.
"""
from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.optimize import minimize

POWERS = (8.0, 64.0, 512.0)  # of the smooth maximum of eigenvalues, while y is improved
MOST_WORK = 2e7  # rows² columns of E while y is improved
POWERED = 100  # steps of λ = sgn EᵀE λ before single flips
FLIP_WORK = 20_000_000  # entries of E that single flips of a start look at
FEW = 200_000  # entries of E up to which all starts are tried
STARTS = 24  # sign vectors from which single flips start
ROUNDED = 1e-12  # relative error of an eigenvalue
NOTHING = 1e-14  # relative size of columns that count as zero


@dataclass(frozen=True)
class Farthest:
    """The largest norm of E λ.

    :param bound: it is at most this
    :param reached: norm at ``sign``
    :param sign: λ (n,) of -1 and 1
    """

    bound: float
    reached: float
    sign: np.ndarray

    def direction(self, columns: np.ndarray) -> np.ndarray:
        """Return the unit vector E λ/|E λ| of the value that is reached."""
        found = columns @ self.sign
        size = float(np.linalg.norm(found))
        return np.asarray(found / size) if size > 0 else np.eye(len(columns))[0]


def farthest(columns: np.ndarray) -> Farthest:
    """Return the largest norm of E λ over |λ| <= 1.

    :param columns: E (m, n), one column for every λ
    """
    rows, count = columns.shape
    if rows == 1:
        value = float(np.abs(columns).sum())
        return Farthest(value, value, _signs(columns[0]))
    left, size, right = np.linalg.svd(columns, full_matrices=False)
    rank = int((size > NOTHING * size.max(initial=0.0)).sum())
    if rank <= 1:
        sign = _signs(right[0]) if rank else np.ones(count)
        value = float(np.linalg.norm(columns @ sign))
        return Farthest(value, value, sign)
    reduced = size[:rank, None] * right[:rank]
    if rank == 2:
        sign = _of_zonogon(reduced)
        value = float(np.linalg.norm(reduced @ sign))
        return Farthest(value, value, sign)
    sign = _flipped(reduced)
    reached = float(np.linalg.norm(reduced @ sign))
    return Farthest(max(_dual(reduced), reached), reached, sign)


def zonogon(columns: np.ndarray) -> np.ndarray:
    """Return the corners (k, 2) of the zonogon {E λ : |λ| <= 1} counter-clockwise.

    :param columns: E (2, n)
    """
    signs = _corner_signs(columns)
    half = signs @ columns.T
    return np.concatenate((half, -half))


def _corner_signs(columns: np.ndarray) -> np.ndarray:
    """Return the signs (k, n) at half of the corners of a zonogon, by the angles of its generators."""
    upward = np.where((columns[1] > 0) | ((columns[1] == 0) & (columns[0] > 0)), 1.0, -1.0)
    order = np.argsort(np.arctan2(upward * columns[1], upward * columns[0]), kind="stable")
    count = columns.shape[1]
    # From the corner where all generators are reversed, one after another turns round.
    signs = -np.ones((count + 1, count))
    signs[np.tril_indices(count + 1, -1, count)] = 1.0
    made = np.empty_like(signs)
    made[:, order] = signs
    return np.asarray(made[:-1] * upward)


def _of_zonogon(columns: np.ndarray) -> np.ndarray:
    """Return the signs at the farthest corner, without a matrix of all corners."""
    upward = np.where((columns[1] > 0) | ((columns[1] == 0) & (columns[0] > 0)), 1.0, -1.0)
    ways = upward * columns
    order = np.argsort(np.arctan2(ways[1], ways[0]), kind="stable")
    corners = -ways.sum(axis=1)[:, None] + 2 * np.cumsum(ways[:, order], axis=1)
    turned = int(np.argmax((corners**2).sum(axis=0))) + 1
    sign = -upward
    sign[order[:turned]] = upward[order[:turned]]
    return np.asarray(sign)


def _signs(values: np.ndarray) -> np.ndarray:
    return np.where(values >= 0, 1.0, -1.0)


def _flipped(columns: np.ndarray) -> np.ndarray:
    """Return signs that no single flip improves, the best of several starts."""
    rows, count = columns.shape
    ways = np.concatenate((np.eye(rows)[:STARTS // 2], np.random.default_rng(0).standard_normal((STARTS // 2, rows))))
    ways = ways if rows * count <= FEW else ways[:2]
    best, most = np.ones(count), -1.0
    square = (columns**2).sum(axis=0)
    for way in ways:
        sign = _signs(way @ columns)
        total = columns @ sign
        for _ in range(POWERED):  # |E λ| grows with each step
            sign, before = _signs(total @ columns), sign
            total = columns @ sign
            if np.array_equal(sign, before):
                break
        for _ in range(min(10 * count, FLIP_WORK // (rows * count))):
            # A flip of sign i changes |E λ|² by −4 λ_i e_i·E λ + 4 |e_i|².
            gain = square - sign * (total @ columns)
            flip = int(gain.argmax())
            if gain[flip] <= NOTHING * square.max():
                break
            total = total - 2 * sign[flip] * columns[:, flip]
            sign[flip] = -sign[flip]
        if total @ total > most:
            best, most = sign.copy(), float(total @ total)
    return best


def _dual(columns: np.ndarray) -> float:
    """Return a bound of the norm by weak duality. The search for y needs no care: any y > 0 gives a bound."""
    length = np.linalg.norm(columns, axis=0)
    kept = columns[:, length > NOTHING * length.max()]
    # Neglected columns add at most their lengths.
    rest = float(length[length <= NOTHING * length.max()].sum())
    scale = float(np.linalg.norm(kept))
    kept = kept / scale
    log_y = np.log(np.linalg.norm(kept, axis=0))
    best = _dual_value(kept, log_y)
    for power in POWERS if len(kept)**2 * kept.shape[1] <= MOST_WORK else ():
        log_y = minimize(_smooth_dual, log_y, args=(kept, power), jac=True, method="L-BFGS-B",
                         options={"maxiter": 200}).x
        best = min(best, _dual_value(kept, log_y))
    return scale * best + rest


def _dual_value(columns: np.ndarray, log_y: np.ndarray) -> float:
    y = np.exp(log_y - log_y.max())
    highest = float(np.linalg.eigvalsh((columns / y) @ columns.T)[-1]) if np.all(y > 0) else np.inf
    return float(np.sqrt(highest * (1 + ROUNDED * len(columns)) * y.sum()))


def _smooth_dual(log_y: np.ndarray, columns: np.ndarray, power: float) -> tuple[float, np.ndarray]:
    """Return log of (Σ λ_k^p)^(1/p) Σ y and its gradient by log y."""
    y = np.exp(np.clip(log_y, -200.0, 200.0))
    value, vector = np.linalg.eigh((columns / y) @ columns.T)
    value = np.maximum(value, 1e-300)
    weight = np.exp(power * (np.log(value) - np.log(value[-1])))
    total = weight.sum()
    gradient = -((vector.T @ columns) ** 2 / y * (weight / value / total)[:, None]).sum(axis=0) + y / y.sum()
    return float(np.log(value[-1]) + np.log(total) / power + np.log(y.sum())), gradient
