# SPDX-License-Identifier: GPL-3.0-or-later
"""FORM: the most probable point on the limit, and the checks that FORM is valid there."""
from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import isnan
from typing import Any

import numpy as np

from statejump.campaign.rare.guard import Guard, refused
from statejump.campaign.rare.model import Model
from statejump.core import libraries

STEP = 1e-2  # of finite differences [standard deviations]
CONVERGED = 1e-2
MOST_RUNS = 2000
SIDE = 0.1  # distance of the points on both sides of the design point [standard deviations]
KINK = 0.25  # difference of the gradients on both sides, relative to their mean
OPPOSITE = 1.15  # distance of the opposite point that is checked, in distances of the design point
BEYOND = (0.25, 0.5, 1.0)  # distances beyond the design point, in units of the decay length of the density


@dataclass(frozen=True)
class DesignPoint:
    """The most probable point of the event.

    :param variates: the point in standard normal variates
    :param index: its distance from the origin, negative if the origin belongs to the event
    :param probability: FORM's probability
    :param runs: runs of the search
    :param checks: runs of the checks
    """

    variates: tuple[float, ...]
    index: float
    probability: float
    runs: int
    checks: int


def found_by(model: Model) -> DesignPoint:
    """Search the design point and check it.

    :raises StatejumpError: FORM found no design point, or is invalid there
    """
    ot, count = libraries.openturns(), model.count
    if model.at([0.0] * count) > 0:
        raise refused(model, "rare_frequent")
    guard = Guard(model)
    limit = ot.Function(ot.PythonFunction(count, 1, guard.called))
    limit.setGradient(ot.NonCenteredFiniteDifferenceGradient([STEP] * count, limit.getEvaluation()))
    event = ot.ThresholdEvent(ot.CompositeRandomVector(limit, ot.RandomVector(ot.Normal(count))), ot.Greater(), 0.0)
    algorithm = ot.FORM(_solver(ot), event, [0.0] * count)
    guard.run(algorithm)
    result = algorithm.getResult()
    point = [float(one) for one in result.getStandardSpaceDesignPoint()]
    if not abs(model.at(point)) < CONVERGED:
        raise refused(model, "rare_no_design_point", runs=model.runs, error="the search does not converge")
    runs = model.runs
    _check(model, point)
    return DesignPoint(tuple(point), float(result.getHasoferReliabilityIndex()), float(result.getEventProbability()),
                       runs, model.runs - runs)


def _solver(ot: Any) -> Any:
    """Return sequential quadratic programming of NLopt: it needs a third of the runs of Abdo-Rackwitz."""
    solver = ot.NLopt("LD_SLSQP")
    solver.setMaximumEvaluationNumber(MOST_RUNS)
    for tolerance in (solver.setMaximumAbsoluteError, solver.setMaximumRelativeError, solver.setMaximumResidualError,
                      solver.setMaximumConstraintError):
        tolerance(CONVERGED)
    return solver


def _check(model: Model, point: Sequence[float]) -> None:
    """Raise StatejumpError if the limit has a tent, a kink or a second design point.

    Beyond the design point the density decays over 1/beta, so there the outcome must stay beyond the limit.
    """
    centre = np.array(point)
    beta = float(np.linalg.norm(centre))
    for decay in BEYOND:
        distance = decay / max(beta, 1.0)
        if not model.at(centre * (1 + distance / beta)) > 0:
            raise refused(model, "rare_tent", deviations=distance)
    if model.at(-OPPOSITE * centre) > 0:
        raise refused(model, "rare_not_unique")
    here = model.at(point)
    sides = [np.array([sign * (model.at(centre + sign * SIDE * step) - here) for step in np.eye(len(centre))])
             for sign in (1, -1)]
    mean = np.linalg.norm(sides[0] + sides[1]) / 2
    differs = float(np.linalg.norm(sides[0] - sides[1]) / mean) if mean > 0 else np.inf
    if isnan(differs) or differs > KINK:
        raise refused(model, "rare_kink", percent=100 * differs)
