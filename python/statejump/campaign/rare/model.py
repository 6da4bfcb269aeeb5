# SPDX-License-Identifier: GPL-3.0-or-later
"""The outcome of a campaign as a function of independent standard normal variates."""
from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, fields
from math import isnan, nan
from typing import Any

import numpy as np

from statejump.campaign.plan import Plan, Recipe
from statejump.campaign.rare.kept import Kept
from statejump.campaign.sampling import Distribution, Independent
from statejump.campaign.work import run_sample
from statejump.core.progress import OnProgress
from statejump.schema.paths import filled

METHODS = {"form": "FORM and importance sampling", "subset": "subset simulation"}


def items_of(recipe: Recipe) -> list[Distribution]:
    """Return the random variables in the order of :func:`statejump.campaign.sampling.montecarlo_draws`."""
    found: list[Distribution] = []
    for parameter in recipe.vary:
        if isinstance(parameter, Independent):
            found += parameter.items
        elif isinstance(parameter, Distribution):
            found.append(parameter)
    return found


@dataclass(frozen=True, kw_only=True)
class Shifted(Recipe):
    """Samples around a centre in the space of standard normal variates. A sample depends only on the centre, the seed
    and its number.

    :param centre: one variate per random variable
    """

    centre: tuple[float, ...]

    def point(self, index: int) -> np.ndarray:
        """Return the variates of sample ``index``."""
        return np.random.default_rng([self.seed or 0, index]).standard_normal(len(self.centre)) + self.centre

    def data(self, index: int) -> dict[str, Any]:
        """Return the case file of sample ``index``; of the centre itself for -1."""
        variates = np.array(self.centre) if index < 0 else self.point(index)
        return filled(self.case_data, [(key, item.at(float(variate))) for item, variate in zip(items_of(self), variates)
                                       for key in item.keys])


@dataclass(frozen=True)
class Event:
    """An outcome beyond a limit.

    :param outcome: name of the outcome, with its unit
    :param limit: the limit in this unit
    :param above: whether values above the limit count; else values below it
    """

    outcome: str
    limit: float
    above: bool

    def __str__(self) -> str:
        return f"{self.outcome} {'above' if self.above else 'below'} {self.limit:g}"

    def margin(self, value: float) -> float:
        """Return by how much a value is beyond the limit, relative to the limit; NaN if there is no value."""
        scale = abs(self.limit) or 1.0
        return (value - self.limit) / scale * (1 if self.above else -1)


@dataclass
class Model:
    """Runs samples, and counts runs and failures.

    :param expected: number of runs after which the progress is 1
    :param kept: finished runs; None: they are not kept
    :param workers: processes for importance sampling; None: this process
    :param scheduler: address of a running Dask scheduler in place of these processes
    """

    plan: Plan
    event: Event
    on_progress: OnProgress
    expected: int
    runs: int = 0
    without_value: int = 0
    failures: list[str] = field(default_factory=list)
    known: dict[tuple[float, ...], float] = field(default_factory=dict)
    kept: Kept | None = None
    workers: int | None = None
    scheduler: str | None = None

    @property
    def count(self) -> int:
        """Number of random variables."""
        return len(items_of(self.plan))

    def around(self, centre: Sequence[float]) -> Shifted:
        """Return the recipe of samples around a centre."""
        given = {item.name: getattr(self.plan, item.name) for item in fields(Recipe)}
        return Shifted(**given, centre=tuple(float(one) for one in centre))

    def margin(self, recipe: Shifted, index: int = -1) -> float:
        """Run a sample, or the centre, and return its margin; NaN if the sample failed or has no value."""
        sample = None if self.kept is None else self.kept.samples.get((recipe.centre, index))
        if sample is None:
            sample = run_sample(recipe, index)
            if self.kept is not None:
                self.kept.add(recipe.centre, sample)
        self.runs += 1
        self.on_progress(min(1.0, self.runs / self.expected))
        if sample.values is None:
            self.failures.append(sample.error)
            return nan
        found = self.event.margin(sample.values[recipe.outcomes.index(self.event.outcome)])
        self.without_value += isnan(found)
        return found

    def at(self, variates: Iterable[float]) -> float:
        """Return the margin at a point. A point is run once."""
        place = tuple(float(one) for one in variates)
        if place not in self.known:
            self.known[place] = self.margin(self.around(place))
        return self.known[place]
