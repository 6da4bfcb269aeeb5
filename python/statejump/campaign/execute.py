# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs the missing samples of a campaign: a few in this process, many on a Dask cluster. A sample depends only on the
seed and on its number. The table of samples is therefore the same wherever they run."""
from __future__ import annotations

import os
import time
from dataclasses import dataclass, field

from statejump.campaign.journal import Kept
from statejump.campaign.plan import Plan
from statejump.campaign.work import Batch, Batches, run_samples
from statejump.core.progress import OnProgress

# Time [s] for which samples are run in this process before workers are started: about the start time of workers.
HERE_S = 2.0
# Number of finished samples from which the time of the others is estimated; the first sample is slower than the others.
FORESEEN_FROM = 3


@dataclass
class Statistics:
    """How a campaign was run."""

    already_there: int
    run_now: int = 0
    workers: int = 0
    wall_time_s: float = 0.0  # samples and start of the cluster
    start_time_s: float = 0.0  # part of the run time before the cluster was ready
    worker_time_s: float = 0.0  # sum over all tasks
    batch_sizes: list[int] = field(default_factory=list)
    note: str = ""  # note of the journal

    @property
    def samples_per_second(self) -> float:
        """Samples per second of wall time."""
        return self.run_now / self.wall_time_s if self.wall_time_s > 0 else 0.0


class _Account:
    """Keeps finished batches and counts them."""

    def __init__(self, campaign: Plan, kept: Kept, done: Statistics, on_progress: OnProgress) -> None:
        self.campaign, self.kept, self.done, self.on_progress = campaign, kept, done, on_progress

    def add(self, seconds: float, batch: Batch) -> None:
        done = self.done
        self.kept.add(batch)
        done.run_now += len(batch.indices)
        done.worker_time_s += seconds
        done.batch_sizes.append(len(batch.indices))
        self.on_progress((done.already_there + done.run_now) / self.campaign.samples)


def run_missing(
    campaign: Plan, kept: Kept, scheduler: str | None, workers: int | None, on_progress: OnProgress,
) -> Statistics:
    """Run the missing samples. Every finished batch is stored before the next is counted.

    :param kept: stored samples; this function adds finished samples
    :param scheduler: address of a running scheduler; None: a cluster on this machine
    :param workers: number of processes of the cluster on this machine; None: one per core, or none for a reduced model
        if this process is as fast as the start of workers
    :param on_progress: called with the finished fraction of all samples
    :raises StatejumpError: no cluster is available; finished samples are stored
    """
    missing = [index for index in range(campaign.samples) if index not in kept.finished]
    done = Statistics(already_there=campaign.samples - len(missing))
    if not missing:
        return done
    account = _Account(campaign, kept, done, on_progress)
    on_progress(done.already_there / campaign.samples)
    if scheduler is None and workers is None and campaign.model == "reduced":
        missing = _here(campaign, missing, account)
    if missing:
        _on_workers(campaign, missing, scheduler, workers, account)
    return done


def _here(campaign: Plan, missing: list[int], account: _Account) -> list[int]:
    """Run samples in this process until HERE_S has passed, or until workers, including their start, would be faster.
    Return the remaining samples."""
    batches, started, done = Batches(missing, campaign.model, 1), time.perf_counter(), account.done
    cores = len(os.sched_getaffinity(0))
    done.workers = 1
    sooner = False
    while batches.left and done.wall_time_s < HERE_S and not sooner:
        seconds, batch = run_samples(campaign.recipe, batches.next(1))
        count = len(batch.indices)
        batches.learn(count, seconds)
        account.add(seconds, batch)
        done.wall_time_s = time.perf_counter() - started
        left = seconds / count * batches.left
        sooner = done.run_now >= FORESEEN_FROM and left > HERE_S + left / cores
    return missing[batches.given:]


def _on_workers(
    campaign: Plan, missing: list[int], scheduler: str | None, workers: int | None, account: _Account
) -> None:
    from statejump.campaign.distribute import workers_for  # Dask, 0.6 s; small campaigns do not need it

    done = account.done
    wanted = min(workers or len(os.sched_getaffinity(0)), len(missing))
    before, started = done.wall_time_s, time.perf_counter()
    with workers_for(campaign.recipe, scheduler, wanted) as cluster:
        done.start_time_s = time.perf_counter() - started
        done.workers = cluster.count
        for seconds, batch in cluster.run(missing):
            account.add(seconds, batch)
            done.wall_time_s = before + time.perf_counter() - started
