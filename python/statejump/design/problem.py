# SPDX-License-Identifier: GPL-3.0-or-later
"""The design as an optimisation problem: cost, rows of constraints, their derivatives, and the best point so far."""
from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from statejump.core.errors import Interrupted, StatejumpError
from statejump.core.progress import OnProgress
from statejump.design.cost import MASS, Formula
from statejump.design.gradients import gradients
from statejump.design.model import Model, Setting
from statejump.design.requirements import Requirement, Row, at_setting, rows_of, total_mass_kg

NO_PATH = -1.0  # margin of the rows of a truss without a path
FAR = 0.5  # margin beyond which the rows of a point of the grid get no derivatives
SLACK = 2e-5  # margin that the search keeps, so that rounding violates no requirement
MASS_STEP = 1e-4
RADIUS = 0.4  # largest change of x of a short step: factor 1.5


@dataclass
class Best:
    """The best point so far: of least cost among those that meet the requirements, else of least violation."""

    x: np.ndarray
    cost: float = np.inf
    margin: float = -np.inf

    def offer(self, x: np.ndarray, cost: float, margin: float) -> None:
        """Keep a point if it is better."""
        better = cost < self.cost if self.margin >= 0 and margin >= 0 else margin > self.margin
        if better:
            self.x, self.cost, self.margin = x.copy(), cost, margin


@dataclass
class Problem:
    """Cost and constraints over a grid.

    :param grid: points of friction and clearances
    :param failures: number of points without a path, and the first message
    """

    model: Model
    formula: Formula
    requirements: Sequence[Requirement]
    grid: Sequence[Setting]
    step: float
    on_progress: OnProgress
    iterations: int
    best: Best = field(init=False)
    rows: list[Row] = field(init=False)
    failures: int = 0
    first_failure: str = ""
    iteration: int = 0
    derivatives: int = 0
    centre: np.ndarray | None = None  # of the box of RADIUS in which the search stays; None: no box
    _kept: dict[bytes, tuple[np.ndarray, np.ndarray]] = field(default_factory=dict)
    _masses: dict[bytes, float] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self.rows = rows_of(self.requirements, self.grid)
        self.best = Best(np.array([group.start for group in self.model.groups]))

    @property
    def bounds(self) -> list[tuple[float, float]]:
        """Bounds of x."""
        found = [(group.x(group.low), group.x(group.high)) for group in self.model.groups]
        if self.centre is None:
            return found
        return [(max(low, at - RADIUS), min(high, at + RADIUS)) for (low, high), at in zip(found, self.centre)]

    def clipped(self, x: np.ndarray) -> np.ndarray:
        """Return x within its bounds, which searches leave by rounding."""
        return np.clip(x, *np.transpose(self.bounds))

    def _mass_kg(self, x: np.ndarray) -> float:
        if x.tobytes() not in self._masses:
            self._masses = {x.tobytes(): total_mass_kg(self.model.case(x).resolve())}
        return self._masses[x.tobytes()]

    def _named(self, x: np.ndarray) -> dict[str, np.ndarray]:
        factors: dict[str, list[float]] = {}
        for group, one in zip(self.model.groups, x):
            factors.setdefault(group.name, []).append(group.factor(one))
        named = {name: np.array(values) for name, values in factors.items()}
        named[MASS] = np.array(self._mass_kg(x) if self.formula.uses_mass else 0.0)
        return named

    @cached_property
    def scale(self) -> float:
        """Size of the cost, by which searches divide it, so that tolerances are relative."""
        return abs(self.cost(self.best.x)) or 1.0

    def cost(self, x: np.ndarray) -> float:
        """Return the cost."""
        return self.formula(self._named(self.clipped(x))).real

    def cost_gradient(self, x: np.ndarray) -> np.ndarray:
        """Return the derivatives of the cost by x."""
        x = self.clipped(x)
        values = self._named(x)
        slopes = {name: np.zeros((len(x), *np.shape(one))) for name, one in values.items()}
        seen: dict[str, int] = {}
        for index, (group, one) in enumerate(zip(self.model.groups, x)):
            place = seen[group.name] = seen.get(group.name, -1) + 1
            slopes[group.name][index, place] = group.slope(one)
            if self.formula.uses_mass:
                moved = np.eye(len(x))[index] * MASS_STEP
                slopes[MASS][index] = (self._mass_kg(x + moved) - self._mass_kg(x - moved)) / (2 * MASS_STEP)
        return self.formula.gradient(values, slopes)

    def _blocks(self) -> list[Setting | None]:
        """Return the points of the grid, and None for rows that do not depend on it."""
        without = any(row.setting is None for row in self.rows)
        return [*(self.grid if any(row.setting is not None for row in self.rows) else ()), *([None] if without else [])]

    def _of(self, setting: Setting | None) -> list[int]:
        return [place for place, row in enumerate(self.rows) if row.setting == setting]

    def values(self, x: np.ndarray) -> np.ndarray:
        """Return the values of all rows; NaN at points of the grid without a path."""
        found = np.full(len(self.rows), np.nan)
        for setting in self._blocks():
            try:
                found[self._of(setting)] = at_setting(self.model, x, self.requirements, setting)
            except Interrupted:
                raise
            except StatejumpError as problem:
                self.failures += 1
                self.first_failure = self.first_failure or str(problem)
        return found

    def margins_of(self, values: np.ndarray) -> np.ndarray:
        """Return the margins of all rows."""
        found = np.array([float(row.requirement.margins(value)) for row, value in zip(self.rows, values)])
        return np.where(np.isfinite(found), found, NO_PATH)

    def margins(self, x: np.ndarray) -> np.ndarray:
        """Return the margins of all rows less SLACK."""
        x = self.clipped(x)
        if x.tobytes() not in self._kept:
            values = self.values(x)
            margins = self.margins_of(values)
            self.best.offer(x, self.cost(x), float(margins.min()))
            self._kept = dict([*self._kept.items()][-3:])
            self._kept[x.tobytes()] = values, margins
        return self._kept[x.tobytes()][1] - SLACK

    def margin_gradients(self, x: np.ndarray) -> np.ndarray:
        """Return the derivatives (rows, variables) of the margins; zero where a margin is above FAR."""
        x = self.clipped(x)
        self.margins(x)
        values, margins = self._kept[x.tobytes()]
        found = np.zeros((len(self.rows), len(x)))
        for setting in self._blocks():
            rows = self._of(setting)
            if np.isfinite(values[rows]).all() and margins[rows].min() < FAR:
                slopes = gradients(self.model, x, self.requirements, setting, self.step, values[rows])
                scale = [(-1.0 if self.rows[row].requirement.most else 1.0)
                         / (abs(self.rows[row].requirement.limit) or 1.0) for row in rows]
                found[rows] = slopes * np.array(scale)[:, None]
        self.iteration += 1
        self.derivatives += 1
        self.on_progress(min(1.0, self.iteration / self.iterations))
        return found
