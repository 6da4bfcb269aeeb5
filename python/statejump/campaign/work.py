# SPDX-License-Identifier: GPL-3.0-or-later
"""What a worker does: run some samples. Every sample ends as outcomes or as a sentence."""
from __future__ import annotations

import time
from dataclasses import dataclass
from typing import Optional, Sequence

import numpy as np

from statejump.kinds.registry import parse_case
from statejump.core.errors import StatejumpError
from statejump.campaign.campaign_file import Campaign
from statejump.campaign.outcomes import outcome

NAME = "sample"


@dataclass(frozen=True)
class Sample:
    """A finished sample: either values or an error."""

    index: int
    values: Optional[tuple[float, ...]]
    error: str = ""


def run_sample(campaign: Campaign, index: int) -> Sample:
    """Run one sample; whatever goes wrong is its error, in one sentence."""
    try:
        case = parse_case(campaign.data(index), NAME)
        found = outcome(case, campaign.model)
        return Sample(index, tuple(float(found[name]) for name in campaign.units))
    except StatejumpError as problem:
        return Sample(index, None, _one_line(str(problem).removeprefix(f"{NAME}: ")))
    except Exception as problem:  # one sample never ends the campaign
        return Sample(index, None, _one_line(f"the run failed: {type(problem).__name__}: {problem}"))


def _one_line(text: str) -> str:
    return " ".join(text.split())


@dataclass(frozen=True)
class Batch:
    """Finished samples together; values of a failed one are NaN."""

    indices: tuple[int, ...]
    values: np.ndarray  # (samples, outcomes)
    errors: dict[int, str]  # of the failed samples, by index


def batch_of(samples: Sequence[Sample], outcomes: int) -> Batch:
    """Put samples together; ``outcomes``: number of columns."""
    values = np.full((len(samples), outcomes), np.nan)
    for row, sample in zip(values, samples):
        if sample.values is not None:
            row[:] = sample.values
    errors = {sample.index: sample.error for sample in samples if sample.values is None}
    return Batch(tuple(sample.index for sample in samples), values, errors)


def run_samples(campaign: Campaign, indices: Sequence[int]) -> tuple[float, Batch]:
    """Run several samples; return the seconds that they took, and the samples."""
    started = time.perf_counter()
    done = batch_of([run_sample(campaign, index) for index in indices], len(campaign.units))
    return time.perf_counter() - started, done
