# SPDX-License-Identifier: GPL-3.0-or-later
"""What a campaign varies, and the values of sample ``i``: they depend on the seed and ``i`` alone."""
from __future__ import annotations

from dataclasses import dataclass
from math import exp, inf, log, log1p, prod, sqrt
from typing import Any, Sequence, Union

import numpy as np
from scipy.special import ndtr, ndtri

DISTRIBUTIONS = ("normal", "truncated_normal", "lognormal", "uniform")


@dataclass(frozen=True)
class Distribution:
    """A parameter as a random variable. ``mean`` and ``standard_deviation`` are those of the
    parameter itself, of the normal variable before it is truncated."""

    keys: tuple[str, ...]  # as section.key; all of them get the same value
    distribution: str
    mean: float = 0.0
    standard_deviation: float = 0.0
    low: float = -inf
    high: float = inf

    def draw(self, generator: np.random.Generator) -> float:
        """Return one value; takes exactly one variate from the generator."""
        if self.distribution == "uniform":
            return float(self.low + (self.high - self.low) * generator.random())
        if self.distribution == "truncated_normal":
            return self._truncated(generator.random())
        variate = generator.standard_normal()
        if self.distribution == "normal":
            return float(self.mean + self.standard_deviation * variate)
        spread = sqrt(log1p((self.standard_deviation / self.mean) ** 2))
        return float(exp(log(self.mean) - 0.5 * spread**2 + spread * variate))

    def probabilities(self) -> tuple[float, float, float]:
        """Cumulated probability of both limits, and the sign with which they are on the side on
        which small probabilities keep their digits."""
        ends = [(end - self.mean) / self.standard_deviation for end in (self.low, self.high)]
        sign = -1.0 if ends[0] > 0 else 1.0
        low, high = sorted(float(ndtr(sign * end)) for end in ends)
        return low, high, sign

    def _truncated(self, variate: float) -> float:
        low, high, sign = self.probabilities()
        value = self.mean + sign * self.standard_deviation * float(ndtri(low + (high - low) * variate))
        return min(max(value, self.low), self.high)


@dataclass(frozen=True)
class Values:
    """A parameter that takes the values of a list."""

    keys: tuple[str, ...]
    values: tuple[Union[int, float], ...]
    spacing: str = "linear"


def number_of_points(vary: Sequence[Values]) -> int:
    """Points of the grid of all lists."""
    return prod(len(axis.values) for axis in vary)


def montecarlo_values(vary: Sequence[Distribution], seed: int, index: int) -> list[float]:
    """Values of sample ``index``, one per varied parameter."""
    generator = np.random.default_rng([seed, index])
    return [parameter.draw(generator) for parameter in vary]


def sweep_values(vary: Sequence[Values], index: int) -> list[Union[int, float]]:
    """Values of point ``index`` of the grid; the last list runs fastest."""
    found: list[Union[int, float]] = []
    for axis in reversed(vary):
        index, place = divmod(index, len(axis.values))
        found.append(axis.values[place])
    return found[::-1]


def changed_data(
    data: dict[str, dict[str, Any]], vary: Sequence[Union[Distribution, Values]], values: Sequence[float]
) -> dict[str, dict[str, Any]]:
    """Return the parsed case file with the values of one sample."""
    changed = {section: dict(keys) for section, keys in data.items()}
    for parameter, value in zip(vary, values):
        for path in parameter.keys:
            section, key = path.split(".")
            changed.setdefault(section, {})[key] = value
    return changed
