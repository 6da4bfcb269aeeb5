# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks of a design: values over friction, random samples, tail probability, and the price of requirements."""
from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import inf, sqrt
from typing import Any

import numpy as np

from statejump.campaign.campaign_file import plan_for, vary_of
from statejump.campaign.plan import MONTECARLO
from statejump.campaign.rare.calls import MOST_RUNS, VARIATION, event_of, run
from statejump.campaign.sampling import Independent, Random, montecarlo_draws
from statejump.core import libraries
from statejump.core.errors import Interrupted, StatejumpError
from statejump.core.progress import OnProgress
from statejump.design.file import JUMP, RMS, TILT
from statejump.design.model import Model, Setting
from statejump.design.problem import Problem
from statejump.design.requirements import Requirement, Row, at_setting, rows_of
from statejump.kinds.truss.case import TrussCase
from statejump.schema.paths import split_path

FACTORS = np.sort(np.append(np.geomspace(0.05, 4.0, 24), 1.0))
FALLING = 1.01  # ratio of the peak below the nominal friction to the value at it, above which the design is beyond it
ACTIVE = 1e-3  # margin up to which a constraint has a price
FEW = 10  # failed samples up to which the tail is computed by itself
QUANTILE = 1.959964
OUTCOMES = {TILT: "reflector_tilt_change_rad", RMS: "reflector_rms_of_change_m"}


@dataclass(frozen=True)
class Profile:
    """The largest value over its limit, over factors on all friction coefficients; NaN: no path.

    :param worst: (factors,) of the design
    :param before: (factors,) of the unchanged case
    """

    factors: np.ndarray
    worst: np.ndarray
    before: np.ndarray

    @property
    def peak(self) -> tuple[float, float]:
        """Factor below 1 with the largest value, and this value over the limit."""
        below = np.where(self.factors < 1, self.worst, -inf)
        place = int(np.nanargmax(below))
        return float(self.factors[place]), float(below[place])

    @property
    def own(self) -> float:
        """The value over the limit at the friction of the case."""
        return float(self.worst[self.factors == 1.0][0])

    @property
    def falling(self) -> bool:
        """Whether less friction leads to larger values: the design is on the falling side of the tent."""
        return self.peak[1] > FALLING * self.own

    @property
    def false(self) -> bool:
        """Whether less friction violates a requirement that the friction of the case meets."""
        return self.falling and self.own <= 1 < self.peak[1]


def profile(model: Model, x: np.ndarray, start: np.ndarray, requirements: Sequence[Requirement]) -> Profile | None:
    """Return the values over friction; None if no requirement depends on paths."""
    some = [one for one in requirements if one.of_path and one.most]
    if not some:
        return None

    def worst(at: np.ndarray, factor: float) -> float:
        try:
            values = at_setting(model, at, some, Setting(friction=factor))
        except Interrupted:
            raise
        except StatejumpError:
            return float("nan")
        limits = [abs(row.requirement.limit) or 1.0 for row in rows_of(some, [Setting()])]
        return float((values / limits).max())

    return Profile(FACTORS, *(np.array([worst(at, one) for one in FACTORS]) for at in (x, start)))


@dataclass(frozen=True)
class Scattered:
    """Random samples of a design.

    :param violated: samples that violate a requirement
    :param failed: samples without a path; the interval counts them once within and once beyond the limits
    :param worst: smallest margin (samples,)
    """

    samples: int
    violated: int
    failed: int
    worst: np.ndarray

    @property
    def probability(self) -> float:
        """Probability that a sample violates a requirement."""
        return self.violated / self.samples

    @property
    def interval(self) -> tuple[float, float]:
        """Its 95 % interval, after Wilson."""
        return _wilson(self.violated, self.samples)[0], _wilson(self.violated + self.failed, self.samples)[1]


def _wilson(count: int, total: int) -> tuple[float, float]:
    share, square = count / total, QUANTILE**2 / total
    centre = (share + square / 2) / (1 + square)
    half = QUANTILE / (1 + square) * sqrt(share * (1 - share) / total + square / (4 * total))
    return max(0.0, centre - half) if count else 0.0, min(1.0, centre + half) if count < total else 1.0


def scattered(case: TrussCase, tables: Sequence[tuple[str, Mapping[str, Any]]], requirements: Sequence[Requirement],
              samples: int, seed: int, on_progress: OnProgress) -> Scattered:
    """Run random samples of a case. Sample i depends only on the seed and i, as in a Monte Carlo campaign."""
    vary: list[Random] = [one for one in vary_of(tables, case, MONTECARLO)]  # type: ignore[misc]
    model = Model(case, [])
    keys = [key for one in vary for item in (one.items if isinstance(one, Independent) else [one]) for key in item.keys]
    model.arrays = model.arrays and all(split_path(key)[::2] in model.numbers and _own(model, key) != 0 for key in keys)
    rows = rows_of(requirements, [Setting()])
    blocks = [setting for setting in (Setting(), None) if any(row.setting == setting for row in rows)]
    worst = np.full(samples, np.nan)
    for index in range(samples):
        more = [(key, value) for item, value in montecarlo_draws(vary, seed, index) for key in item.keys]
        try:
            values = np.concatenate([at_setting(model, np.zeros(0), requirements, one, more) for one in blocks])
            worst[index] = min(float(row.requirement.margins(value)) for row, value in zip(rows, values))
        except Interrupted:
            raise
        except StatejumpError:
            pass
        on_progress((index + 1) / samples)
    return Scattered(samples, int(np.count_nonzero(worst < 0)), int(np.isnan(worst).sum()), worst)


def _own(model: Model, path: str) -> float:
    section, item, key = split_path(path)
    return float(model.numbers[section, key][model.places[section][item]])


def tail(case: TrussCase, tables: Sequence[tuple[str, Mapping[str, Any]]], row: Row, seed: int,
         on_progress: OnProgress) -> tuple[Any, str]:
    """Return the tail probability of one row as :class:`~statejump.campaign.rare.Rare`, or None and the reason."""
    wanted = row.requirement
    outcome = f"jump:displacement_m[{row.label}]" if wanted.quantity == JUMP else OUTCOMES.get(wanted.quantity)
    if outcome is None or not wanted.most:
        return None, f"no tail probability: {wanted.quantity} is no outcome of a campaign"
    try:
        plan = plan_for(case, MONTECARLO, tables, samples=1, seed=seed, asked=[outcome] if ":" in outcome else [])
        return run(plan, event_of(plan, outcome, wanted.limit, None), "form", MOST_RUNS, VARIATION, 0, on_progress), ""
    except Interrupted:
        raise
    except StatejumpError as problem:
        return None, f"no tail probability: {problem}"


def prices(problem: Problem, x: np.ndarray) -> dict[str, float]:
    """Return by how many per cent the cost falls for a limit that is 1 % wider, by requirement.

    The multipliers of the active constraints are the solution of a non-negative least-squares problem.
    """
    margins = problem.margins(x)
    active = np.flatnonzero(margins < ACTIVE)
    low, high = np.transpose(problem.bounds)
    free = (x > low + ACTIVE) & (x < high - ACTIVE)
    found = dict.fromkeys((one.name for one in problem.requirements), 0.0)
    cost = problem.cost(x)
    if not len(active) or not free.any() or cost == 0:
        return found
    slopes = problem.margin_gradients(x)[active][:, free]
    multipliers, _ = libraries.scipy("optimize").nnls(slopes.T, problem.cost_gradient(x)[free])
    for place, one in zip(active, multipliers):
        found[problem.rows[place].requirement.name] += float(one / abs(cost))
    return found
