# SPDX-License-Identifier: GPL-3.0-or-later
"""Running the samples of a campaign that are still missing, in batches, on a Dask cluster."""
from __future__ import annotations

import os
import time
from concurrent.futures import CancelledError
from dataclasses import dataclass, field
from typing import Callable, Iterator, Optional, TypeVar

from statejump.core.errors import StatejumpError
from statejump.campaign.campaign_file import Campaign
from statejump.campaign.cluster import open_client
from statejump.campaign.journal import Journal
from statejump.campaign.work import Batch, Sample, batch_of, run_samples

from distributed import Client, Future, KilledWorker, wait  # noqa: E402, after cluster set it up

BATCH_S = 0.5  # wanted length of a task: long against the millisecond that a task costs
MOST_IN_BATCH = 20_000
QUEUED = 2  # tasks per worker, so that none waits for the next
LOOK_S = 5.0  # how often workers are counted while none of them has finished a task
NO_WORKERS_S = 60.0  # how long a cluster whose workers are all gone is waited for


@dataclass
class Statistics:
    """How a campaign was run."""

    already_there: int
    run_now: int = 0
    workers: int = 0
    wall_time_s: float = 0.0  # of the samples, without starting the cluster
    worker_time_s: float = 0.0  # sum over all tasks
    batch_sizes: list[int] = field(default_factory=list)

    @property
    def samples_per_second(self) -> float:
        """Samples per second of wall time."""
        return self.run_now / self.wall_time_s if self.wall_time_s > 0 else 0.0


class _Batches:
    """Hands out the missing samples in batches that last about BATCH_S, and learns how many."""

    def __init__(self, missing: list[int], model: str) -> None:
        self.missing, self.given, self.size = missing, 0, 1
        self.one_by_one = model == "dem"

    def next(self, workers: int) -> list[int]:
        left = len(self.missing) - self.given
        # The last batches are smaller: all workers end at the same time.
        size = 1 if self.one_by_one else max(1, min(self.size, -(-left // (QUEUED * workers))))
        batch = self.missing[self.given : self.given + size]
        self.given += len(batch)
        return batch

    def learn(self, count: int, seconds: float) -> None:
        """At most four times as many as were timed: the first sample of a worker is no measure."""
        fitting = int(BATCH_S / max(seconds / count, 1e-9))
        self.size = max(1, min(fitting, 4 * count, MOST_IN_BATCH))


def run_missing(
    campaign: Campaign,
    journal: Journal,
    scheduler: Optional[str],
    workers: Optional[int],
    tell: Callable[[float], None],
) -> Statistics:
    """Run what the journal lacks; every finished batch is in it before the next is counted.

    :param scheduler: address of a running scheduler; None: a cluster on this machine
    :param workers: processes of that cluster; None: one per core
    :param tell: called with the finished fraction of all samples
    :raises StatejumpError: no cluster; what is finished stays in the journal
    """
    missing = [index for index in range(campaign.samples) if index not in journal.finished]
    done = Statistics(already_there=campaign.samples - len(missing))
    if not missing:
        return done
    workers = min(workers or len(os.sched_getaffinity(0)), len(missing))
    with open_client(scheduler, workers, campaign.model) as client:
        started = time.perf_counter()
        tell(done.already_there / campaign.samples)
        done.workers = _slots(client)
        for seconds, batch in _finished(client, campaign, missing):
            journal.add(batch)
            done.run_now += len(batch.indices)
            done.worker_time_s += seconds
            done.batch_sizes.append(len(batch.indices))
            done.wall_time_s = time.perf_counter() - started
            tell((done.already_there + done.run_now) / campaign.samples)
    return done


def _slots(client: Client) -> int:
    workers = client.scheduler_info()["workers"].values()
    return max(1, sum(int(worker["nthreads"]) for worker in workers))


def _finished(
    client: Client, campaign: Campaign, missing: list[int]
) -> Iterator[tuple[float, Batch]]:
    """Yield finished batches. Samples whose worker died go one by one, each alone, at the end: only a
    sample that kills its worker also then is to blame."""
    batches = _Batches(missing, campaign.model)
    running: set[Future] = set()
    asked: dict[str, list[int]] = {}
    suspects: list[int] = []

    def submit() -> bool:
        batch = batches.next(_slots(client))
        if batch:
            future = client.submit(run_samples, campaign, batch, pure=False)
            asked[future.key] = batch
            running.add(future)
        return bool(batch)

    while len(asked) < QUEUED * _slots(client) and submit():
        pass
    while running:
        for future in _some_of(client, running):
            running.remove(future)
            batch = asked.pop(future.key)
            answer = _answer(client, future)
            future.release()
            if answer is None:
                suspects += batch
            else:
                batches.learn(len(batch), answer[0])
                yield answer
        while len(asked) < QUEUED * _slots(client) and submit():
            pass
    for index in suspects:
        future = client.submit(run_samples, campaign, [index], pure=False)
        lost = Sample(index, None, "the run ended its worker process, time and again")
        yield _answer(client, future) or (0.0, batch_of([lost], len(campaign.units)))


Given = TypeVar("Given")


def _patiently(client: Client, ask: Callable[[], Given]) -> Given:
    """Ask until there is an answer; TimeoutError means not yet. :raises StatejumpError: the cluster is gone, or
    all its workers have been for too long"""
    alone_since: Optional[float] = None
    while True:
        try:
            return ask()
        except TimeoutError:
            now = time.monotonic()
            alone_since = None if client.scheduler_info()["workers"] else alone_since or now
            if alone_since is not None and now - alone_since >= NO_WORKERS_S:
                raise StatejumpError(
                    f"the dask scheduler has had no workers for {NO_WORKERS_S:g} s; finished samples are kept, the same "
                    "command goes on with the others"
                ) from None
        except (CancelledError, OSError) as problem:
            raise StatejumpError(
                f"the connection to the dask scheduler was lost ({type(problem).__name__}); finished samples are kept, "
                "the same command goes on with the others"
            ) from None


def _some_of(client: Client, running: set[Future]) -> set[Future]:
    """Wait for at least one future. :raises StatejumpError: see :func:`_patiently`"""
    with client.as_current():
        return set(_patiently(client, lambda: wait(running, timeout=LOOK_S, return_when="FIRST_COMPLETED")).done)


def _answer(client: Client, future: Future) -> Optional[tuple[float, Batch]]:
    """Result of a batch; None: its worker died. A result is lost with the worker that has it, and is then
    computed again. :raises StatejumpError: see :func:`_patiently`"""
    try:
        return _patiently(client, lambda: future.result(timeout=LOOK_S))
    except KilledWorker:
        return None
