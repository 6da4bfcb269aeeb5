# SPDX-License-Identifier: GPL-3.0-or-later
"""Varied parameters and their values in sample ``i``, which depend only on the seed and ``i``."""
from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import exp, fsum, inf, log, log1p, prod, sqrt

import numpy as np
from scipy.special import ndtr, ndtri

DISTRIBUTIONS = ("normal", "truncated_normal", "lognormal", "uniform")


@dataclass(frozen=True)
class Distribution:
    """A parameter as a random variable. ``mean`` and ``standard_deviation`` are those of the parameter, not of its
    logarithm. For a truncated normal variable they are those of the distribution before truncation."""

    keys: tuple[str, ...]  # paths section.key; all get the same value
    distribution: str
    mean: float = 0.0
    standard_deviation: float = 0.0
    low: float = -inf
    high: float = inf

    def draw(self, generator: np.random.Generator) -> float:
        """Return one value. It uses exactly one variate of the generator."""
        if self.distribution == "uniform":
            return float(self.low + (self.high - self.low) * generator.random())
        if self.distribution == "truncated_normal":
            return self._truncated(generator.random())
        return self.at(generator.standard_normal())

    def at(self, variate: float) -> float:
        """Return the value at a variate of the standard normal distribution, of the same cumulative probability."""
        if self.distribution == "uniform":
            return float(self.low + (self.high - self.low) * ndtr(variate))
        if self.distribution == "truncated_normal":
            return self._truncated(float(ndtr(variate)))
        if self.distribution == "normal":
            return float(self.mean + self.standard_deviation * variate)
        spread = sqrt(log1p((self.standard_deviation / self.mean) ** 2))
        return float(exp(log(self.mean) - 0.5 * spread**2 + spread * variate))

    def probabilities(self) -> tuple[float, float, float]:
        """Return the cumulative probabilities of both limits of a truncated normal variable, and a sign. The sign
        selects the tail in which small probabilities keep their digits."""
        ends = [(end - self.mean) / self.standard_deviation for end in (self.low, self.high)]
        sign = -1.0 if ends[0] > 0 else 1.0
        low, high = sorted(float(ndtr(sign * end)) for end in ends)
        return low, high, sign

    def _truncated(self, variate: float) -> float:
        low, high, sign = self.probabilities()
        value = self.mean + sign * self.standard_deviation * float(ndtri(low + (high - low) * variate))
        return min(max(value, self.low), self.high)


@dataclass(frozen=True)
class Independent:
    """A parameter of every item of a list, such as ``slider.*.friction_coefficient``, with an independent random value
    for each item, as in manufacture. The column of the table has the mean over the items."""

    keys: tuple[str, ...]
    items: tuple[Distribution, ...]  # keys with the item's name

    def draws(self, generator: np.random.Generator) -> list[float]:
        """Return one random value per item. Each item uses one variate of the generator, in the order of the items."""
        return [item.draw(generator) for item in self.items]


@dataclass(frozen=True)
class Values:
    """A parameter that takes the values of a list."""

    keys: tuple[str, ...]
    values: tuple[float, ...]
    spacing: str = "linear"


Random = Distribution | Independent
Varied = Distribution | Independent | Values


def number_of_points(vary: Sequence[Values]) -> int:
    """Points of the grid of all lists."""
    return prod(len(axis.values) for axis in vary)


def montecarlo_draws(
    vary: Sequence[Random], seed: int, index: int
) -> list[tuple[Distribution, float]]:
    """Return all random values of sample ``index``, in the order of the parameters and of their items."""
    generator = np.random.default_rng([seed, index])
    found: list[tuple[Distribution, float]] = []
    for parameter in vary:
        if isinstance(parameter, Independent):
            found += zip(parameter.items, parameter.draws(generator))
        else:
            found.append((parameter, parameter.draw(generator)))
    return found


def montecarlo_values(vary: Sequence[Random], seed: int, index: int) -> list[float]:
    """Return the values of sample ``index``, one per varied parameter; for an independent one, the mean over items."""
    draws = iter(montecarlo_draws(vary, seed, index))
    found = []
    for parameter in vary:
        count = len(parameter.items) if isinstance(parameter, Independent) else 1
        found.append(fsum(next(draws)[1] for _ in range(count)) / count)
    return found


def sweep_values(vary: Sequence[Values], index: int) -> list[float]:
    """Return the values of grid point ``index`` of a sweep; the values of the last list vary fastest."""
    found: list[float] = []
    for axis in reversed(vary):
        index, place = divmod(index, len(axis.values))
        found.append(axis.values[place])
    return found[::-1]
