# SPDX-License-Identifier: GPL-3.0-or-later
"""Probabilities with intervals: importance sampling around the design point, and subset simulation. Sobol indices."""
from __future__ import annotations

from dataclasses import dataclass
from math import exp, inf, isnan, sqrt

import numpy as np

from statejump.campaign.rare.guard import Guard, refused
from statejump.campaign.rare.design_point import DesignPoint
from statejump.campaign.rare.kept import Kept, ahead
from statejump.campaign.rare.model import Model
from statejump.core import libraries

FEWEST_RUNS = 100
LARGEST_VARIATION = 0.3  # of importance sampling; more means that the design point does not represent the event
QUANTILE = 1.959964  # of the 95 % interval
BLOCK = 100


@dataclass(frozen=True)
class Estimate:
    """A probability.

    :param low: lower end of the 95 % interval; failed samples count as within the limit
    :param high: upper end; failed samples count as beyond the limit
    :param variation: coefficient of variation
    """

    probability: float
    low: float
    high: float
    variation: float
    runs: int


def importance_sampling(model: Model, design: DesignPoint, most_runs: int, variation: float) -> Estimate:
    """Sample around the design point until the coefficient of variation is reached.

    :raises StatejumpError: the coefficient of variation stays above LARGEST_VARIATION
    """
    recipe, centre = model.around(design.variates), np.array(design.variates)
    beyond: list[float] = []
    failed: list[float] = []
    with ahead(model.kept or Kept(model.plan), recipe, recipe.centre, model.workers, model.scheduler) as run_ahead:
        for index in range(most_runs):
            if index % BLOCK == 0:
                run_ahead(range(index, min(index + BLOCK, most_runs)))
            failures = len(model.failures)
            margin = model.margin(recipe, index)
            # Density of the standard normal distribution over that of the samples.
            weight = exp(0.5 * float(centre @ centre) - float(centre @ recipe.point(index)))
            failed.append(weight if len(model.failures) > failures else 0.0)
            beyond.append(weight if margin > 0 else 0.0)
            if index + 1 >= FEWEST_RUNS and _statistics(beyond)[1] <= variation:
                break
    found, spread = _statistics(beyond)
    if spread > LARGEST_VARIATION:
        raise refused(model, "rare_not_sampled", variation=spread, runs=len(beyond))
    worst, worst_spread = _statistics([one + other for one, other in zip(beyond, failed)])
    return Estimate(found, found * exp(-QUANTILE * spread), min(1.0, worst * exp(QUANTILE * worst_spread)), spread,
                    len(beyond))


def _statistics(values: list[float]) -> tuple[float, float]:
    """Return the mean and its coefficient of variation."""
    mean = float(np.mean(values))
    return mean, float(np.std(values, ddof=1)) / sqrt(len(values)) / mean if mean > 0 else inf


def subset(model: Model, samples: int) -> Estimate:
    """Run subset simulation.

    :param samples: samples per level
    :raises StatejumpError: a sample failed, or no sample is beyond the limit
    """
    ot, before = libraries.openturns(), model.runs
    guard = Guard(model, strict=False)
    ot.RandomGenerator.SetSeed(model.plan.seed or 0)
    vector = ot.CompositeRandomVector(ot.Function(ot.PythonFunction(model.count, 1, guard.called)),
                                      ot.RandomVector(ot.Normal(model.count)))
    algorithm = ot.SubsetSampling(ot.ThresholdEvent(vector, ot.Greater(), 0.0))
    algorithm.setBlockSize(BLOCK)
    algorithm.setMaximumOuterSampling(max(1, samples // BLOCK))
    guard.run(algorithm)
    _check_failures(model)
    found = float(algorithm.getResult().getProbabilityEstimate())
    if not found > 0:
        raise refused(model, "rare_not_reached", runs=model.runs)
    spread = float(algorithm.getResult().getCoefficientOfVariation())
    return Estimate(found, found * exp(-QUANTILE * spread), min(1.0, found * exp(QUANTILE * spread)), spread,
                    model.runs - before)


def _check_failures(model: Model) -> None:
    if model.failures:
        raise refused(model, "rare_failed_samples", failed=len(model.failures), runs=model.runs,
                      error=model.failures[0])


@dataclass(frozen=True)
class Index:
    """Sobol indices of one random variable: fraction of the variance of the outcome."""

    first: float
    total: float
    total_low: float
    total_high: float


def sobol(model: Model, size: int) -> list[Index]:
    """Return the indices of every random variable from ``size`` times their number plus two runs.

    :raises StatejumpError: a sample failed
    """
    ot = libraries.openturns()
    ot.RandomGenerator.SetSeed(model.plan.seed or 0)
    points = ot.SobolIndicesExperiment(ot.Normal(model.count), size).generate()
    margins = [model.at(point) for point in points]
    _check_failures(model)
    if any(isnan(one) for one in margins):
        raise refused(model, "rare_no_value")
    found = ot.SaltelliSensitivityAlgorithm(points, [[one] for one in margins], size)
    ends = found.getTotalOrderIndicesInterval()
    return [Index(*map(float, one)) for one in zip(found.getFirstOrderIndices(), found.getTotalOrderIndices(),
                                                   ends.getLowerBound(), ends.getUpperBound())]
