# SPDX-License-Identifier: GPL-3.0-or-later
"""Correlation of the noise between rows: the equivalent number of independent rows, and the widening of intervals.

With correlated noise, least squares remain unbiased, but the variance of an estimate grows. Let h be the part of the
force's derivative by a parameter that no other parameter explains. Its estimate has the variance s²/(h·h) for
independent noise of variance s², and κ s²/(h·h) for noise with correlations ρ, with κ = Σ ρ(i-j) h(i) h(j)/(h·h). An
autoregression of the residuals (Burg) estimates the correlations; BIC chooses its order.

The misfit of the formula of a joint repeats in every cycle, so averaging over cycles does not reduce it. With
correlation c of residuals one cycle apart, C cycles multiply κ by 1 + (C - 1) c.

A measured joint also changes from cycle to cycle. Let g be the sums of h r in each cycle, with the residual r. Cycles
that change independently give the variance κ s²/(h·h) with κ = Σ g² C/((C - 1) s² h·h), known with C - 1 degrees of
freedom (the cluster-robust variance of K.-Y. Liang and S. L. Zeger, Biometrika 73, 1986).
"""
from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from math import log

import numpy as np
from scipy.signal import fftconvolve, lfilter

MOST_LAGS = 12  # largest order of the autoregression
ROWS_A_LAG = 10
FEWEST_CYCLES = 3  # below this, a loop does not show how a joint changes from cycle to cycle
TURN = 0.2  # smallest way back at a reversal of a cycle, as a fraction of the range of the path
SAME_PLACE = 0.5  # correlation of the displacement above which a lag counts as a whole number of cycles
CHANCE = 5.0  # number of standard deviations of a correlation that count as chance; the largest of hundreds is tested
FORGOTTEN = 1e-4  # correlations below this are omitted
REFINEMENTS = 5  # iterations of the correction for fitted parameters; its error is then below a percent


@dataclass(frozen=True)
class Noise:
    """Correlations of the noise of a loop.

    :param correlations: correlations between rows 0, 1, 2, … apart
    :param repeated: correlation between residuals one cycle apart
    :param cycles: number of cycles
    """

    correlations: np.ndarray
    repeated: float = 0.0
    cycles: float = 1.0

    @cached_property
    def _by_cycles(self) -> float:
        return 1 + max(0.0, self.cycles - 1) * self.repeated

    @property
    def correlated(self) -> bool:
        """Whether neighbouring rows are correlated: noise of the rig, or misfit of the formula."""
        return len(self.correlations) > 1 or self.repeated > 0

    @cached_property
    def rows_each(self) -> float:
        """Number of rows that count as one independent row: 1 + 2 Σ ρ, summed up to the first correlation ρ that is not
        positive, times the factor for repeated cycles."""
        positive = self.correlations > 0
        last = len(positive) if positive.all() else int(np.argmin(positive))
        return max(1.0, 2 * float(self.correlations[:last].sum()) - 1) * self._by_cycles

    def inflation(self, derivative: np.ndarray) -> float:
        """Return κ, the factor by which correlation increases the variance of an estimate.

        :param derivative: h of the estimated parameter in every row, see the module
        """
        lags = min(len(self.correlations), len(derivative))
        products = _products(derivative, lags)
        if not products[0] > 0:
            return self.rows_each
        return max(1.0, float(2 * self.correlations[:lags] @ products / products[0]) - 1) * self._by_cycles


INDEPENDENT = Noise(np.ones(1))


def noise_of(residual: np.ndarray, jacobian: np.ndarray, path: np.ndarray) -> Noise:
    """Return the noise whose correlations explain those of given residuals.

    :param residual: residual of every row
    :param jacobian: derivatives of the residual by the parameters (rows, parameters)
    :param path: displacements
    """
    near = _near(residual, jacobian)
    return replace(near, **_repeated(residual, path, near.rows_each))


def _repeated(residual: np.ndarray, path: np.ndarray, rows_each: float) -> dict[str, float]:
    """Return the correlation between the residuals of successive cycles, and the number of cycles."""
    rows = len(path)
    lags = np.arange(rows // 2)
    left = rows - lags
    here, there = (_products(values - values.mean(), len(lags)) for values in (path, residual))
    if not there[0] > 0:
        return {}
    at, again = here * rows / (here[0] * left), there * rows / (there[0] * left)
    back = np.flatnonzero(at <= 0)
    whole = (at > SAME_PLACE) & (lags > back[0]) if back.size else np.zeros(len(lags), dtype=bool)
    if not whole.any():
        return {}
    lag = int(np.argmax(np.where(whole, again, -np.inf)))
    first = int(np.argmax(np.where(whole & (lags <= 1.5 * np.argmax(whole)), at, -np.inf)))
    if again[lag] <= CHANCE * np.sqrt(rows_each / left[lag]):
        return {}
    return {"repeated": float(min(again[lag], 1.0)), "cycles": rows / first}


def _near(residual: np.ndarray, jacobian: np.ndarray) -> Noise:
    """Return the correlations of successive rows.

    A fit absorbs slow noise: its residuals are less correlated than the noise. If Q is an orthonormal basis of the
    Jacobian and R the correlation matrix of the noise, the matrix of the residuals is (1 - Q Qᵀ) R (1 - Q Qᵀ).
    """
    most = min(MOST_LAGS, len(residual) // ROWS_A_LAG)
    seen = _products(residual, most + 1)
    if not seen[0] > 0 or most < 1:
        return INDEPENDENT
    order = _order(residual, most)
    if not order:
        return INDEPENDENT
    basis = _basis(jacobian)
    seen = seen[:order + 1] / len(residual)
    found = _correlations(_burg(residual, order)[0], len(residual))
    for _ in range(REFINEMENTS):
        lost = _lost(basis, found, order)
        corrected = seen / seen[0] * (1 - lost[0]) + lost
        refined = _autoregression(corrected)
        if refined is None:
            break
        found = _correlations(refined, len(residual))
    return Noise(found)


def cycles_of(path: np.ndarray) -> np.ndarray:
    """Return the number of the cycle of every row, from 0. A cycle begins at every second reversal of the path; rows
    before the second reversal belong to the first cycle."""
    least = TURN * float(np.ptp(path))
    turns: list[int] = []
    heading = low = high = 0
    for row, here in enumerate(path):
        low, high = (row if here < path[low] else low), (row if here > path[high] else high)
        if heading >= 0 and path[high] - here > least:
            turns += [high] if heading else []
            heading, low = -1, row
        elif heading <= 0 and here - path[low] > least:
            turns += [low] if heading else []
            heading, high = 1, row
    found = np.zeros(len(path), dtype=int)
    for turn in turns[2::2]:
        found[turn:] += 1
    return found


def between_cycles(derivative: np.ndarray, residual: np.ndarray, cycles: np.ndarray) -> float:
    """Return κ of a joint that changes from cycle to cycle; 0 if the loop has too few cycles.

    :param derivative: h of the estimated parameter in every row, see the module
    :param residual: residual of every row
    :param cycles: number of the cycle of every row
    """
    count = int(cycles[-1]) + 1
    size = float(residual @ residual) / len(residual) * float(derivative @ derivative)
    if count < FEWEST_CYCLES or not size > 0:
        return 0.0
    sums = np.bincount(cycles, derivative * residual)
    return float(sums @ sums) * count / (count - 1) / size


def _products(values: np.ndarray, lags: int) -> np.ndarray:
    """Return the sums Σ v_i v_{i+k} over i, for k = 0, 1, ... lags - 1."""
    if lags <= 64:
        return np.array([values[:len(values) - lag] @ values[lag:] for lag in range(lags)])
    return np.asarray(fftconvolve(values, values[::-1])[len(values) - 1:len(values) - 1 + lags])


def _basis(jacobian: np.ndarray) -> np.ndarray:
    """Return an orthonormal basis of the columns of a Jacobian; linearly dependent columns are omitted."""
    scale = np.linalg.norm(jacobian, axis=0)
    columns = jacobian[:, scale > 0] / scale[scale > 0]
    if not columns.shape[1]:
        return columns
    left, sizes, _ = np.linalg.svd(columns, full_matrices=False)
    return np.asarray(left[:, sizes > 1e-8 * sizes[0]])


def _lost(basis: np.ndarray, correlations: np.ndarray, order: int) -> np.ndarray:
    """Return by how much the fit reduces the mean products of noise in rows 0 to ``order`` apart."""
    rows = len(basis)
    both = np.concatenate((correlations[:0:-1], correlations))
    turned = np.array([fftconvolve(column, both)[len(correlations) - 1:len(correlations) - 1 + rows]
                       for column in basis.T]).T  # R Q
    inner = basis @ (basis.T @ turned)  # Q Qᵀ R Q
    lost = np.empty(order + 1)
    for lag in range(order + 1):
        here, there = slice(0, rows - lag), slice(lag, rows)
        once = np.sum(basis[here] * turned[there]) + np.sum(turned[here] * basis[there])
        lost[lag] = (once - np.sum(inner[here] * basis[there])) / rows
    return lost


def _burg(values: np.ndarray, order: int) -> tuple[np.ndarray, list[float]]:
    """Return the coefficients of an autoregression, and the variance that each order leaves (J. P. Burg, 1967)."""
    forward, backward = values[1:], values[:-1]
    coefficients, left = np.zeros(0), [float(values @ values) / len(values)]
    for _ in range(order):
        total = float(forward @ forward + backward @ backward)
        reflection = 2 * float(forward @ backward) / total if total > 0 else 0.0
        coefficients = np.append(coefficients - reflection * coefficients[::-1], reflection)
        left.append(left[-1] * (1 - reflection**2))
        forward, backward = (forward - reflection * backward)[1:], (backward - reflection * forward)[:-1]
    return coefficients, left


def _order(values: np.ndarray, most: int) -> int:
    """Return the order of least BIC."""
    left, rows = _burg(values, most)[1], len(values)
    return int(np.argmin([rows * log(max(each, left[0] * 1e-12)) + lag * log(rows) for lag, each in enumerate(left)]))


def _autoregression(products: np.ndarray) -> np.ndarray | None:
    """Return the coefficients of the autoregression with the given mean products (Levinson); None if it is unstable."""
    coefficients, left = np.zeros(0), float(products[0])
    for lag in range(1, len(products)):
        if not left > 0:
            return None
        reflection = float(products[lag] - coefficients @ products[lag - 1:0:-1][:lag - 1]) / left
        if not abs(reflection) < 1:
            return None
        coefficients = np.append(coefficients - reflection * coefficients[::-1], reflection)
        left *= 1 - reflection**2
    return coefficients


def _correlations(coefficients: np.ndarray, rows: int) -> np.ndarray:
    """Return the correlations of an autoregression, up to the last correlation that is not negligible."""
    impulse = np.zeros(4 * rows)
    impulse[0] = 1.0
    answer = lfilter([1.0], np.append(1.0, -coefficients), impulse)
    products = _products(answer, rows)
    found = products / products[0]
    far = np.flatnonzero(np.abs(found) > FORGOTTEN)
    return np.asarray(found[:far[-1] + 1])
