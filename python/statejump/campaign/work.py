# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs samples in a worker. Every sample ends with outcomes or with an error message."""
from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass, field
from math import nan

import numpy as np

from statejump.campaign.outputs import needs_all_samples, values
from statejump.campaign.plan import Recipe
from statejump.core.case import Case
from statejump.core.errors import StatejumpError
from statejump.core.notes import Note
from statejump.core.progress import silent
from statejump.core.run import Run
from statejump.kinds import KINDS, has, of, register, require
from statejump.kinds.loading import parse_case
from statejump.kinds.protocol import DemModel, QuickModel, ReducedModel

BATCH_S = 0.5  # duration of a task [s], long compared with Dask's overhead of a millisecond
MOST_IN_BATCH = 20_000


@dataclass(frozen=True)
class Sample:
    """A finished sample: either values, or an error message and its kind."""

    index: int
    values: tuple[float, ...] | None
    error: str = ""
    error_kind: str = ""


def sampled(case: Case, model: str, outputs: Sequence[str]) -> Run:
    """Run one sampled case. Keep the complete history only if an output needs it.

    :raises StatejumpError: the run failed
    """
    if model == "dem":
        found: Run = require(case, DemModel).dem(case, silent)
    elif has(case, QuickModel) and not any(needs_all_samples(name) for name in outputs):
        found = require(case, QuickModel).quick(case)
    else:
        found = require(case, ReducedModel).reduced(case, silent)
    return found


def outcome(case: Case, model: str, outputs: Sequence[str] = ()) -> dict[str, float]:
    """Run one sampled case and return its outcomes and outputs.

    :raises StatejumpError: the run failed
    """
    run = sampled(case, model, outputs)
    # Outcomes at the end of the program are NaN for a sample whose program ends at the reference temperature.
    nothing = dict.fromkeys(of(case).AT_PROGRAM_END, nan)
    return nothing | of(case).recorded(case, run) | values(outputs, run)


def run_sample(recipe: Recipe, index: int) -> Sample:
    """Run one sample; a failure becomes its error message."""
    try:
        found = outcome(parse_case(recipe.data(index)), recipe.model, recipe.outputs)
        return Sample(index, tuple(float(found[name]) for name in recipe.outcomes))
    except StatejumpError as problem:
        return Sample(index, None, _one_line(str(problem)), _one_line(problem.general()))
    except Exception as problem:  # any exception: a failed sample must not end the campaign
        said = Note("sample_failed", error=type(problem).__name__, text=_one_line(str(problem)))
        return Sample(index, None, said, said)


def _one_line(text: str) -> str:
    return " ".join(text.split())


@dataclass(frozen=True)
class Batch:
    """Several finished samples.

    :param values: outcomes (samples, outcomes); those of a failed sample are NaN
    :param errors: error messages of the failed samples, by index in the batch
    :param error_kinds: error messages without the numbers that differ between failures of one kind
    """

    indices: tuple[int, ...]
    values: np.ndarray
    errors: dict[int, str]
    error_kinds: dict[int, str] = field(default_factory=dict)


def batch_of(samples: Sequence[Sample], outcomes: int) -> Batch:
    """Put samples together; ``outcomes``: number of columns."""
    values = np.full((len(samples), outcomes), np.nan)
    for row, sample in zip(values, samples):
        if sample.values is not None:
            row[:] = sample.values
    failed = [sample for sample in samples if sample.values is None]
    return Batch(tuple(sample.index for sample in samples), values, {sample.index: sample.error for sample in failed},
                 {sample.index: sample.error_kind for sample in failed})


def run_samples(recipe: Recipe, indices: Sequence[int]) -> tuple[float, Batch]:
    """Run several samples; return the duration [s] and the finished samples."""
    started = time.perf_counter()
    for place in recipe.kinds:
        if place not in KINDS.values():
            register(place)
    done = batch_of([run_sample(recipe, index) for index in indices], len(recipe.outcomes))
    return time.perf_counter() - started, done


class Batches:
    """Divides the missing samples into batches of about BATCH_S seconds, according to measured durations.

    :param missing: numbers of the samples
    :param model: ``reduced`` or ``dem``; DEM samples are run one by one
    :param queued: number of batches that are queued per worker
    """

    def __init__(self, missing: list[int], model: str, queued: int) -> None:
        self.missing, self.given, self.size, self.queued = missing, 0, 1, queued
        self.one_by_one = model == "dem"

    @property
    def left(self) -> int:
        """Samples that are not handed out."""
        return len(self.missing) - self.given

    def next(self, workers: int) -> list[int]:
        """Return the next batch; empty at the end."""
        # The last batches are smaller, so that all workers finish at about the same time.
        size = 1 if self.one_by_one else max(1, min(self.size, -(-self.left // (self.queued * workers))))
        batch = self.missing[self.given : self.given + size]
        self.given += len(batch)
        return batch

    def learn(self, count: int, seconds: float) -> None:
        """Update the batch size from a measured duration, at most by a factor of four, because a worker's first sample
        is slow."""
        fitting = int(BATCH_S / max(seconds / count, 1e-9))
        self.size = max(1, min(fitting, 4 * count, MOST_IN_BATCH))
