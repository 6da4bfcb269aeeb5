# SPDX-License-Identifier: GPL-3.0-or-later
"""Maximum likelihood of a joint for a loop, intervals by profile likelihood, choice by BIC.

Noise of the force is Gaussian, independent from row to row, of one unknown scale σ: with RSS the sum of squares of the
residuals of n rows, the likelihood with the best σ is ln L = -n/2 (ln(2π RSS/n) + 1), a function of RSS alone.
"""
from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import exp, inf, isfinite, log, pi, sqrt

import numpy as np
from scipy.optimize import brentq, least_squares
from scipy.stats import chi2

from statejump.identification.loop import Loop
from statejump.identification.models import MODELS, PARAMETERS, POSITIVE, Model

STARTS = 4  # best of the grid of starts that are followed
CLOSE = 1e-3  # of an interval's half width: to this its ends are found
ROUNDING = 1e-9  # of half of the loop's force: noise below is that of the arithmetic


@dataclass(frozen=True)
class Interval:
    """Where a parameter is, at a level of confidence; an end that the loop does not bound is infinite."""

    low: float
    high: float

    @property
    def bounded(self) -> bool:
        """Whether both ends are there."""
        return isfinite(self.low) and isfinite(self.high)


class Problem:
    """A joint and a loop. Points of the search are in units of the loop's size, positive parameters as logarithms."""

    def __init__(self, model: Model, loop: Loop) -> None:
        self.model, self.names = model, model.parameters
        self.displacement, self.force = loop.fitted
        self.memory = loop.memory
        self.half_force = float(np.ptp(self.force)) / 2
        half = float(np.ptp(loop.displacement)) / 2
        middle = float(np.min(loop.displacement)) + half
        units = {"displacement": half, "force": self.half_force, "stiffness": self.half_force / half, "-": 1.0}
        offsets = {"clearance_minus": -middle, "clearance_plus": middle, "preload": float(np.min(self.force))
                   + self.half_force}
        self.units = np.array([units[PARAMETERS[name].dimension] for name in self.names])
        self.offsets = np.array([offsets.get(name, 0.0) for name in self.names])
        self.logarithmic = np.array([PARAMETERS[name].scale == POSITIVE for name in self.names])
        self.low, self.high = (self._sought([getattr(PARAMETERS[name], end) for name in self.names])
                               for end in ("low", "high"))

    def _sought(self, relative: Sequence[float]) -> np.ndarray:
        found = np.array(relative, dtype=float)
        found[self.logarithmic] = np.log(found[self.logarithmic])
        return found

    def values(self, point: np.ndarray) -> dict[str, float]:
        """Return the parameters of a point of the search, in SI units."""
        relative = np.where(self.logarithmic, np.exp(np.where(self.logarithmic, point, 0.0)), point)
        return dict(zip(self.names, (relative * self.units + self.offsets).tolist()))

    def point(self, values: dict[str, float]) -> np.ndarray:
        """Return the point of the search of parameters in SI units."""
        return self._sought([(values[name] - offset) / unit
                             for name, offset, unit in zip(self.names, self.offsets, self.units)])

    def value(self, place: int, coordinate: float) -> float:
        """Return one parameter of a coordinate of the search; infinite at an end of what is sought."""
        if coordinate <= self.low[place]:
            return -inf
        if coordinate >= self.high[place]:
            return inf
        relative = exp(coordinate) if self.logarithmic[place] else coordinate
        return float(relative * self.units[place] + self.offsets[place])

    def residual(self, point: np.ndarray) -> np.ndarray:
        """Return measured minus answered force, in units of half of the loop's force."""
        answered = self.model.answer(self.values(point), self.displacement, self.memory)
        found: np.ndarray = (self.force - answered) / self.half_force
        return found

    def squares(self, point: np.ndarray) -> float:
        """Return the sum of squares of the residuals, at least that of rounding."""
        rest = self.residual(point)
        return max(float(rest @ rest), len(rest) * ROUNDING**2)

    def best(self, start: np.ndarray, held: int | None = None) -> tuple[np.ndarray, float]:
        """Return the point of the least sum of squares near a start, and that sum.

        :param held: place of a coordinate that does not move
        """
        free = [place for place in range(len(start)) if place != held]
        point = np.array(start)
        if not free:
            return point, self.squares(point)

        def moved(part: np.ndarray) -> np.ndarray:
            point[free] = part
            return self.residual(point)

        inside = np.clip(point[free], self.low[free], self.high[free])
        found = least_squares(moved, inside, bounds=(self.low[free], self.high[free]), x_scale="jac", ftol=1e-10,
                              xtol=1e-10, gtol=1e-12, max_nfev=200)
        point[free] = found.x
        return point, self.squares(point)

    def search(self) -> tuple[np.ndarray, float]:
        """Return the best point that is found from the grid of starts, and its sum of squares."""
        starts = []
        for relative in self.model.starts():
            starts.append(self._sought([relative[name] for name in self.names]))
        order = np.argsort([self.squares(start) for start in starts], kind="stable")
        return min((self.best(starts[place]) for place in order[:STARTS]), key=lambda each: each[1])

    def spread(self, point: np.ndarray, squares: float) -> np.ndarray:
        """Return standard deviations by the curvature at the best point; NaN of what the residuals do not follow."""
        step = 1e-6
        columns = []
        for place in range(len(point)):
            there = np.array(point)
            there[place] += step
            columns.append((self.residual(there) - self.residual(point)) / step)
        jacobian = np.array(columns).T
        with np.errstate(all="ignore"):
            try:
                covariance = np.linalg.inv(jacobian.T @ jacobian) * squares / len(self.force)
            except np.linalg.LinAlgError:
                return np.full(len(point), np.nan)
            return np.sqrt(np.diag(covariance))


@dataclass(frozen=True)
class Fit:
    """A joint that fits a loop best.

    :param model: the joint
    :param values: its parameters by name, SI units
    :param noise: σ of the force, by maximum likelihood
    :param log_likelihood: natural logarithm
    :param rows: how many were fitted
    """

    model: Model
    values: dict[str, float]
    noise: float
    log_likelihood: float
    rows: int
    point: np.ndarray
    squares: float

    @property
    def bic(self) -> float:
        """Schwarz's criterion, the less the better; σ is a parameter too."""
        return (len(self.values) + 1) * log(self.rows) - 2 * self.log_likelihood


def _fit(problem: Problem, point: np.ndarray, squares: float) -> Fit:
    rows = len(problem.force)
    noise = sqrt(squares / rows) * problem.half_force
    return Fit(problem.model, problem.values(point), noise, -0.5 * rows * (log(2 * pi * noise**2) + 1), rows, point,
               squares)


def fit(model: Model, loop: Loop) -> Fit:
    """Return a joint of the greatest likelihood for a loop."""
    problem = Problem(model, loop)
    return _fit(problem, *problem.search())


def fits(loop: Loop, names: Sequence[str]) -> list[Fit]:
    """Return the fits of joints, the best by BIC first."""
    return sorted((fit(MODELS[name], loop) for name in names), key=lambda each: each.bic)


def threshold(confidence: float) -> float:
    """Return how far twice the logarithm of the likelihood may fall inside of an interval (Wilks)."""
    return float(chi2.ppf(confidence, 1))


class _Better(Exception):
    """A profile found a better point than the one that was the best."""

    def __init__(self, point: np.ndarray, squares: float) -> None:
        super().__init__()
        self.point, self.squares = point, squares


class Profile:
    """Likelihood of one parameter, with the best of all others."""

    def __init__(self, problem: Problem, best: Fit, name: str) -> None:
        self.problem, self.best, self.place = problem, best, problem.names.index(name)
        self.known = {float(best.point[self.place]): (best.point, 0.0)}

    def drop(self, coordinate: float) -> float:
        """Return by how much twice the logarithm of the likelihood falls."""
        near = min(self.known, key=lambda each: abs(each - coordinate))
        if near == coordinate:
            return self.known[near][1]
        start = np.array(self.known[near][0])
        start[self.place] = coordinate
        point, squares = self.problem.best(start, held=self.place)
        if squares < self.best.squares * (1 - 1e-9):
            raise _Better(point, squares)
        fallen = self.best.rows * log(squares / self.best.squares)
        self.known[coordinate] = (point, fallen)
        return fallen

    def end(self, direction: int, step: float, most: float) -> float:
        """Return where the likelihood has fallen by ``most``; the bound of the search where it does not."""
        bound = float((self.problem.high if direction > 0 else self.problem.low)[self.place])
        inside = float(self.best.point[self.place])
        while True:
            outside = inside + direction * step
            if (outside - bound) * direction >= 0:
                outside = bound
            if self.drop(outside) > most:
                break
            if outside == bound:
                return bound
            inside, step = outside, 2 * step
        if inside == outside:
            return outside
        return float(brentq(lambda coordinate: self.drop(coordinate) - most, inside, outside,
                            xtol=CLOSE * abs(outside - inside)))


def intervals(best: Fit, loop: Loop, confidence: float, names: Sequence[str] | None = None) -> tuple[
    Fit, dict[str, Interval]
]:
    """Return the interval of each parameter, and the fit, which a profile may have made better.

    :param confidence: as 0.95
    :param names: of which parameters; None: of all
    """
    most = threshold(confidence)
    while True:
        problem = Problem(best.model, loop)
        spread = problem.spread(best.point, best.squares)
        found = {}
        try:
            for name in problem.names if names is None else names:
                place = problem.names.index(name)
                widest = problem.high[place] - problem.low[place]
                step = sqrt(most) * spread[place]
                step = step if 0 < step < 0.1 * widest else 1e-3 * widest
                profile = Profile(problem, best, name)
                low, high = (profile.end(direction, float(step), most) for direction in (-1, 1))
                found[name] = Interval(problem.value(place, low), problem.value(place, high))
        except _Better as better:
            best = _fit(problem, better.point, better.squares)
            continue
        return best, found
