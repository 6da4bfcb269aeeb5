# SPDX-License-Identifier: GPL-3.0-or-later
"""Least-squares fit of a joint to a loop, intervals by profile likelihood, choice of the joint by BIC.

The force has Gaussian noise with one unknown standard deviation σ. It may be correlated: n rows then count as m = n/τ
independent rows. With the sum of squared residuals RSS, ln L = -m/2 (ln(2π RSS/n) + 1). The interval of a parameter
ends where its profile exceeds RSS by κ F/(n - p) of RSS. F is the quantile of F(1, m - p) for p parameters, and κ the
factor by which correlation increases the variance of an estimate. If residuals are correlated, the change of the joint
between cycles gives a second product κ F, with F(1, C - 1) for C cycles; the larger product counts.
"""
from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from math import exp, inf, isfinite, log, pi, sqrt

import numpy as np
from scipy.optimize import brentq, least_squares
from scipy.stats import f as f_distribution

from statejump.identification.loop import Loop
from statejump.identification.models import (
    MODELS, PARAMETERS, POSITIVE, START, Model, containing, with_part)
from statejump.identification.noise import Noise, between_cycles, cycles_of, noise_of

STARTS = 4  # number of grid points at which searches start
STARTS_FROM_PART = 2  # the same for searches that start from the optimum of a part
CLOSE = 1e-3  # accuracy of the ends of an interval, as a fraction of its half width
NEAREST = 1e-12  # smallest distance of an end from the optimum, as a fraction of the search range
AT_END = 0.01  # fraction of the search range within which a parameter counts as at an end of the range
DEPENDS = 0.25  # shift of a parameter, over its half width, from which it depends on another one at its end
ROUNDING = 1e-9  # fraction of half the force range of the loop below which noise is rounding


@dataclass(frozen=True)
class Interval:
    """Confidence interval of a parameter. An end that the loop does not determine is infinite."""

    low: float
    high: float

    @property
    def bounded(self) -> bool:
        """Whether both ends are there."""
        return isfinite(self.low) and isfinite(self.high)


STOPS = ("clearance_minus", "clearance_plus")
ZEROS = dict.fromkeys(("friction", "play", "preload_stiffness"), 0.0)
ENDLESS = dict.fromkeys(("friction", "stop_stiffness", *STOPS), inf)


class Problem:
    """Search for the best fit of a joint to a loop.

    Coordinates of a point are parameters in units of the loop's size; those of positive parameters are logarithms. At
    an end of its search range, a parameter of a slide has no effect: it is 0 or infinite. The search for a joint
    therefore includes the simpler joints that it contains.
    """

    def __init__(self, model: Model, loop: Loop) -> None:
        self.model = model
        free_start = loop.start == "unknown" and "friction" in model.parameters
        self.names = (*model.parameters, START) if free_start else model.parameters
        self.displacement, self.force = loop.displacement, loop.force
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
        for place, name in enumerate(self.names):
            if name in STOPS:  # clearances are not negative
                self.low[place] = max(self.low[place], -self.offsets[place] / half)
        slides = model.answer is MODELS["coulomb"].answer
        self.limits = [(place, end, limit) for place, name in enumerate(self.names)
                       if slides or name == "preload_stiffness"
                       for end, limit in ((self.low[place], ZEROS.get(name)), (self.high[place], ENDLESS.get(name)))
                       if limit is not None]

    def _sought(self, relative: Sequence[float]) -> np.ndarray:
        found = np.array(relative, dtype=float)
        with np.errstate(divide="ignore"):  # a part that lacks the parameter has its value without effect
            found[self.logarithmic] = np.log(found[self.logarithmic])
        return found

    def values(self, point: np.ndarray) -> dict[str, float]:
        """Return the parameters at a point of the search, in SI units."""
        relative = np.where(self.logarithmic, np.exp(np.where(self.logarithmic, point, 0.0)), point)
        found = (relative * self.units + self.offsets).tolist()
        for place, end, limit in self.limits:
            if point[place] == end:
                found[place] = limit
        return dict(zip(self.names, found))

    def point(self, values: dict[str, float]) -> np.ndarray:
        """Return the point of the search for parameters in SI units."""
        found = self._sought([(values[name] - offset) / unit
                              for name, offset, unit in zip(self.names, self.offsets, self.units)])
        return np.asarray(np.clip(found, self.low, self.high))

    def value(self, place: int, coordinate: float) -> float:
        """Return the parameter for a coordinate of the search; infinite at an end of the search range."""
        if coordinate <= self.low[place]:
            return -inf
        if coordinate >= self.high[place]:
            return inf
        relative = exp(coordinate) if self.logarithmic[place] else coordinate
        return float(relative * self.units[place] + self.offsets[place])

    def residual(self, point: np.ndarray) -> np.ndarray:
        """Return measured minus computed force in every row, in units of half the force range of the loop."""
        answered = self.model.answer(self.values(point), self.displacement, self.memory)
        found: np.ndarray = (self.force - answered) / self.half_force
        return found

    def squares(self, point: np.ndarray) -> float:
        """Return the sum of squared residuals. It is not smaller than the sum that rounding causes."""
        rest = self.residual(point)
        return max(float(rest @ rest), len(rest) * ROUNDING**2)

    def best(self, start: np.ndarray, held: int | None = None) -> tuple[np.ndarray, float]:
        """Return the point near a start with the smallest sum of squares, and that sum.

        :param held: index of a coordinate that is not varied
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
        first = np.array(start)
        first[free] = np.clip(first[free], self.low[free], self.high[free])
        point[free] = found.x
        ends = self.squares(first), self.squares(point)
        # The search moves its start inside of the bounds; the result may then be worse than the start on a bound.
        return (first, ends[0]) if ends[0] <= ends[1] else (point, ends[1])

    def starts(self) -> list[np.ndarray]:
        """Return the best starts of the grid."""
        grid = [self._sought([relative[name] for name in self.names]) for relative in self.model.starts(self.names)]
        return self._lowest(grid, STARTS)

    def starts_of(self, part: Fit) -> list[np.ndarray]:
        """Return start points of the search: the best fit of a simpler joint, with start values of the parameters that
        it lacks."""
        values = {**dict.fromkeys((START,), 0.0), **part.values}
        there = self.point(with_part(self.model, part.model, values, self.memory, self.displacement))
        more = [name for name in self.names if name not in part.values]
        grid = []
        for relative in self.model.starts(more):
            start = np.array(there)
            for name, value in relative.items():
                place = self.names.index(name)
                start[place] = log(value) if self.logarithmic[place] else value
            grid.append(start)
        return [there, *self._lowest(grid, STARTS_FROM_PART)]

    def _lowest(self, starts: list[np.ndarray], count: int) -> list[np.ndarray]:
        starts = [np.clip(start, self.low, self.high) for start in starts]
        order = np.argsort([self.squares(start) for start in starts], kind="stable")
        return [starts[place] for place in order[:count]]

    def jacobian(self, point: np.ndarray) -> np.ndarray:
        """Return the derivatives of the residual (rows, parameters)."""
        columns = []
        for place in range(len(point)):
            step = 1e-6 if point[place] + 1e-6 <= self.high[place] else -1e-6
            there = np.array(point)
            there[place] += step
            columns.append((self.residual(there) - self.residual(point)) / step)
        return np.array(columns).T


@dataclass(frozen=True)
class Fit:
    """The best fit of a joint to a loop.

    :param model: the joint
    :param values: parameters of the joint by name, in SI units
    :param noise: standard deviation σ of the force
    :param rows: number of fitted rows
    :param rows_each: number of rows that count as one independent row
    """

    model: Model
    values: dict[str, float]
    noise: float
    rows: int
    point: np.ndarray
    squares: float
    rows_each: float = 1.0

    @property
    def independent_rows(self) -> float:
        """Equivalent number of independent rows."""
        return self.rows / self.rows_each

    @property
    def log_likelihood(self) -> float:
        """Natural logarithm, of the independent rows."""
        return -0.5 * self.independent_rows * (log(2 * pi * self.noise**2) + 1)

    @property
    def bic(self) -> float:
        """Schwarz's criterion; smaller is better, and σ counts as a parameter."""
        return (len(self.values) + 1) * log(self.independent_rows) - 2 * self.log_likelihood


def _fit(problem: Problem, point: np.ndarray, squares: float) -> Fit:
    rows = len(problem.force)
    noise = sqrt(squares / rows) * problem.half_force
    return Fit(problem.model, problem.values(point), noise, rows, point, squares)


class Fits:
    """The fits of all joints to a loop. A joint fits at least as well as each joint that it contains."""

    def __init__(self, loop: Loop) -> None:
        self.loop = loop
        self._found: dict[str, Fit] = {}

    def fit(self, name: str) -> Fit:
        """Return the fit of a joint with the smallest sum of squares; fits of simpler joints are start points."""
        if name not in self._found:
            model = MODELS[name]
            problem = Problem(model, self.loop)
            starts = problem.starts()
            for part in model.parts:
                starts += problem.starts_of(self.fit(part))
            self._found[name] = _fit(problem, *min(map(problem.best, starts), key=lambda each: each[1]))
        return self._found[name]

    def improve(self, better: Fit) -> None:
        """Replace the fit of a joint by a better fit, and update the fits of the joints that contain this joint."""
        self._found[better.model.name] = better
        for name in containing(better.model.name):
            before = self._found.get(name)
            if before is not None and before.squares > better.squares:
                problem = Problem(MODELS[name], self.loop)
                point, squares = problem.best(problem.starts_of(better)[0])
                if squares < before.squares:
                    self._found[name] = _fit(problem, point, squares)

    def ranked(self, names: Sequence[str]) -> list[Fit]:
        """Return the fits of joints, the best by BIC first. Residuals of the best fit determine the number of
        independent rows for all fits."""
        found = [self.fit(name) for name in names]
        rows_each = noise_at(min(found, key=lambda each: each.squares), self.loop).rows_each
        return sorted((replace(each, rows_each=rows_each) for each in found), key=lambda each: each.bic)


def noise_at(best: Fit, loop: Loop) -> Noise:
    """Return the correlation of the noise of a loop, from the residuals of a fit."""
    problem = Problem(best.model, loop)
    return noise_of(problem.residual(best.point), problem.jacobian(best.point), problem.displacement)


class _Better(Exception):
    """A profile found a point that is better than the fit."""

    def __init__(self, point: np.ndarray, squares: float) -> None:
        super().__init__()
        self.point, self.squares = point, squares


class Profile:
    """Sum of squares over one parameter, minimised over all others."""

    def __init__(self, problem: Problem, best: Fit, name: str) -> None:
        self.problem, self.best, self.place = problem, best, problem.names.index(name)
        self.known = {float(best.point[self.place]): (best.point, 0.0)}

    def rise(self, coordinate: float) -> float:
        """Return the relative increase of the smallest sum of squares when the parameter is held at a coordinate."""
        near = min(self.known, key=lambda each: abs(each - coordinate))
        if near == coordinate:
            return self.known[near][1]
        start = np.array(self.known[near][0])
        start[self.place] = coordinate
        point, squares = self.problem.best(start, held=self.place)
        if squares < self.best.squares * (1 - 1e-9):
            raise _Better(point, squares)
        risen = squares / self.best.squares - 1
        self.known[coordinate] = (point, risen)
        return risen

    def end(self, direction: int, step: float, most: float) -> float:
        """Return the coordinate at which the sum of squares has grown by the fraction ``most``, or the end of the
        range."""
        bound = float((self.problem.high if direction > 0 else self.problem.low)[self.place])
        nearest = NEAREST * float(self.problem.high[self.place] - self.problem.low[self.place])
        centre = float(self.best.point[self.place])
        widest = direction * (bound - centre)
        if widest <= nearest:
            return bound

        def risen(distance: float) -> float:
            return self.rise(bound if distance >= widest else centre + direction * distance) - most

        outside = min(step, widest)
        inside = outside
        while risen(inside) > 0:
            inside, outside = inside / 4, inside
            if inside <= nearest:
                return centre + direction * outside
        while risen(outside) <= 0:
            if outside == widest:
                return bound
            inside, outside = outside, min(2 * outside, widest)
        return centre + direction * exp(float(brentq(
            lambda distance: risen(exp(distance)), log(inside), log(outside), xtol=CLOSE)))

    @cached_property
    def movements(self) -> dict[int, np.ndarray]:
        """Return the change of all parameters over the last part of the profile, for each end of the range that it
        reaches."""
        found = {}
        for direction, ends in ((-1, self.problem.low), (1, self.problem.high)):
            bound, widest = ends[self.place], AT_END * (self.problem.high - self.problem.low)[self.place]
            at = [each for each in self.known if abs(each - bound) <= widest]
            before = [each for each in self.known if abs(each - bound) > widest]
            if at and before:
                last, near = (min(each, key=lambda one: abs(one - bound)) for each in (at, before))
                found[direction] = self.known[last][0] - self.known[near][0]
        return found


@dataclass(frozen=True)
class Intervals:
    """Confidence intervals of the parameters of a fit.

    :param of: interval of each parameter, by name
    :param because: for a parameter without bound: name of the other unbounded parameter that causes this
    """

    of: dict[str, Interval]
    because: dict[str, str]


def intervals(fits: Fits, model: str, confidence: float, names: Sequence[str] | None = None) -> tuple[Fit, Intervals]:
    """Return the interval of each parameter, and the fit, which a profile may have improved.

    :param confidence: confidence level
    :param names: names of the parameters; None: all parameters
    """
    while True:
        best = fits.fit(model)
        problem = Problem(best.model, fits.loop)
        wanted = [name for name in problem.names if name in names] if names is not None else problem.names
        try:
            return best, _intervals(problem, best, confidence, wanted)
        except _Better as better:
            fits.improve(_fit(problem, better.point, better.squares))


def _intervals(problem: Problem, best: Fit, confidence: float, names: Sequence[str]) -> Intervals:
    jacobian, residual = problem.jacobian(best.point), problem.residual(best.point)
    noise, cycles = noise_of(residual, jacobian, problem.displacement), cycles_of(problem.displacement)
    freedoms = best.rows - len(problem.names)
    quantile = float(f_distribution.ppf(confidence, 1, max(1.0, best.rows / noise.rows_each - len(problem.names))))
    changes = float(f_distribution.ppf(confidence, 1, max(1, cycles[-1]))) if noise.correlated else 0.0
    profiles, ends = {}, {}
    for name in names:
        place = problem.names.index(name)
        others = np.delete(jacobian, place, axis=1)
        own = jacobian[:, place] - others @ np.linalg.lstsq(others, jacobian[:, place], rcond=None)[0]
        most = max(noise.inflation(own) * quantile, between_cycles(own, residual, cycles) * changes) / freedoms
        widest = float(problem.high[place] - problem.low[place])
        size = float(own @ own)
        step = sqrt(most * best.squares / size) if size > 0 else inf
        profiles[name] = Profile(problem, best, name)
        ends[name] = [profiles[name].end(direction, step if step < 0.1 * widest else 1e-3 * widest, most)
                      for direction in (-1, 1)]
    found = {name: Interval(*(problem.value(problem.names.index(name), end) for end in both))
             for name, both in ends.items()}
    because = {}
    for name, profile in profiles.items():
        for way, cause in _dependence(problem, profile, ends[name], profiles).items():
            found[name] = Interval(found[name].low if way > 0 else -inf, found[name].high if way < 0 else inf)
            because[name] = cause
    return Intervals({name: interval for name, interval in found.items() if name != START}, because)


def _dependence(problem: Problem, profile: Profile, ends: Sequence[float], profiles: dict[str, Profile]) -> dict[
    int, str
]:
    """Return the ends of an interval that are finite only because another parameter is at the end of its search range,
    with the name of that parameter."""
    found = {}
    half = (ends[1] - ends[0]) / 2
    for way, end in zip((-1, 1), ends):
        point = profile.known[min(profile.known, key=lambda each: abs(each - end))][0]
        for name, other in profiles.items():
            if other is profile or name == START:
                continue
            for direction, moved in other.movements.items():
                bound = (problem.high if direction > 0 else problem.low)[other.place]
                near = abs(point[other.place] - bound) <= AT_END * (problem.high - problem.low)[other.place]
                if near and way * moved[profile.place] > DEPENDS * half:
                    found[way] = name
    return found
