# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs ensembles of the rib on all cores: one case from initial positions in a small disc, in both models."""
from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import TypeVar

import numpy as np

from statejump.core.run import Columns, Run
from statejump.kinds.umbrella import dem, reduced, result
from statejump.kinds.umbrella.case import UmbrellaCase
from statejump.schema.paths import with_values

T, R = TypeVar("T"), TypeVar("R")


def start_offsets(case: UmbrellaCase, count: int) -> Iterator[np.ndarray]:
    """Yield offsets (2) [m] of the journal's initial position, evenly spread over a disc. They depend only on the seed;
    the first offsets are the same for any number of runs."""
    for index in range(count):
        generator = np.random.default_rng([case.ensemble.seed, index])
        radius = case.ensemble.start_spread_m * np.sqrt(generator.random())
        angle = 2 * np.pi * generator.random()
        yield radius * np.array([np.cos(angle), np.sin(angle)])


@dataclass(frozen=True)
class EnsembleOfRuns:
    """Runs from nearby starts, on common times."""

    time_s: np.ndarray  # (samples)
    temperature_change_K: np.ndarray  # (samples)
    theta2_rad: np.ndarray  # (runs, samples)
    end_eccentricity_m: np.ndarray  # (runs, 2)

    @property
    def deflection_rad(self) -> np.ndarray:
        """θ2 − θ2(0) of every run (runs, samples)."""
        return self.theta2_rad - self.theta2_rad[:, :1]

    @property
    def range_rad(self) -> np.ndarray:
        """Largest minus smallest θ2 of every run (runs)."""
        return np.ptp(self.theta2_rad, axis=1)

    @property
    def jump_rad(self) -> np.ndarray:
        """Jump (runs) [rad] of every run: θ2 at the end minus θ2 at the start."""
        return self.deflection_rad[:, -1]


def for_ensemble(case: UmbrellaCase) -> UmbrellaCase:
    """Return the case with the time steps that its ensembles use in both models."""
    return with_values(
        case,
        {
            "reduced.steps_per_cycle": case.ensemble.reduced_steps_per_cycle,
            "dem.steps_per_cycle": case.ensemble.dem_steps_per_cycle,
        },
    )


def gather(runs: Sequence[Columns | Run]) -> EnsembleOfRuns:
    """Stack the runs of an ensemble."""
    first = runs[0]
    return EnsembleOfRuns(
        first["time_s"],
        first["temperature_change_K"],
        np.stack([run["theta2_rad"] for run in runs]),
        np.array([[run["eccentricity_x_m"][-1], run["eccentricity_y_m"][-1]] for run in runs]),
    )


def _at_once(items: Iterable[T], run: Callable[[T], R], progress: Callable[[], None]) -> list[R]:
    """Run each item, with one process per core; results are in the order of the items.

    :param progress: called after each item
    """

    def one(item: T) -> R:
        done = run(item)
        progress()
        return done

    with ThreadPoolExecutor(os.cpu_count()) as pool:
        return list(pool.map(one, items))


def ensemble(
    case: UmbrellaCase, runs: int | None = None, progress: Callable[[], None] = lambda: None
) -> EnsembleOfRuns:
    """Run the reduced model from ``runs`` initial positions (default: the number in the case), on all cores.

    The result does not depend on the number of cores.
    """
    offsets = start_offsets(case, runs or case.ensemble.reduced_runs)
    fine = for_ensemble(case)

    def run(offset: np.ndarray) -> Columns:
        columns: Columns = reduced.integrate(fine, offset).columns()
        return columns

    return gather(_at_once(offsets, run, progress))


def execute_all(cases: Sequence[UmbrellaCase], progress: Callable[[], None] = lambda: None) -> list[Run]:
    """Run several cases in YADE, on all cores; results in the given order."""

    def run(case: UmbrellaCase) -> Run:
        done = dem.execute(case)
        return result.dem_run(case, done.columns, done.about)

    return _at_once(cases, run, progress)


def dem_ensemble(
    case: UmbrellaCase, runs: int | None = None, progress: Callable[[], None] = lambda: None
) -> EnsembleOfRuns:
    """Run the case in YADE from ``runs`` initial positions (default: the number in the case), on all cores."""
    offsets = start_offsets(case, runs or case.ensemble.dem_runs)
    fine = for_ensemble(case)
    return gather(_at_once(offsets, lambda offset: dem.execute(fine, offset).columns, progress))
