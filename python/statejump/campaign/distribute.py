# SPDX-License-Identifier: GPL-3.0-or-later
"""Distribution of the samples of a campaign, in batches, to a Dask cluster."""
from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from concurrent.futures import CancelledError
from contextlib import contextmanager
from dataclasses import dataclass
from typing import TypeVar

from statejump.campaign.cluster import open_client, restarts_workers
from statejump.campaign.plan import Recipe
from statejump.campaign.work import Batch, Batches, Sample, batch_of, run_samples
from statejump.core.errors import StatejumpError
from statejump.core.notes import Note

from distributed import Client, Future, KilledWorker, wait  # noqa: E402, after cluster set it up

QUEUED = 2  # tasks queued per worker, so that no worker has to wait
LOOK_S = 5.0  # interval [s] at which the workers are counted while no task finishes
NO_WORKERS_S = 60.0  # longest wait [s] for a cluster without workers
RESTART_S = 900.0  # the same for a local cluster that restarts workers, over a minute on a busy machine
KEPT = "finished samples are kept, the same command goes on with the others"


@dataclass(frozen=True)
class Workers:
    """A cluster that is ready to run samples.

    :param count: number of samples that it runs at the same time
    :param run: function that yields the finished batches of the samples with given numbers, each with its duration [s]
    """

    count: int
    run: Callable[[list[int]], Iterator[tuple[float, Batch]]]


@contextmanager
def workers_for(recipe: Recipe, scheduler: str | None, workers: int) -> Iterator[Workers]:
    """Yield a cluster that can run the samples of a campaign. On exit, end every process that was started here.

    :param scheduler: address of a running scheduler; None: a cluster on this machine
    :param workers: number of processes of that cluster
    """
    with open_client(scheduler, workers) as client:
        yield Workers(_slots(client), lambda missing: _finished(client, recipe, missing))


def _slots(client: Client) -> int:
    workers = client.scheduler_info()["workers"].values()
    return max(1, sum(int(worker["nthreads"]) for worker in workers))


def _finished(
    client: Client, recipe: Recipe, missing: list[int]
) -> Iterator[tuple[float, Batch]]:
    """Yield finished batches. Samples whose worker died are repeated one by one at the end. If the worker of a repeated
    sample dies too, that sample is reported as the cause."""
    batches = Batches(missing, recipe.model, QUEUED)
    running: set[Future] = set()
    asked: dict[str, list[int]] = {}
    suspects: list[int] = []

    def submit() -> bool:
        batch = batches.next(_slots(client))
        if batch:
            future = client.submit(run_samples, recipe, batch, pure=False)
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
        future = client.submit(run_samples, recipe, [index], pure=False)
        lost = Sample(index, None, Note("worker_ended"))
        yield _answer(client, future) or (0.0, batch_of([lost], len(recipe.outcomes)))


Given = TypeVar("Given")


def _patiently(client: Client, ask: Callable[[], Given]) -> Given:
    """Wait for the result of a call that raises TimeoutError until its result is available. :raises StatejumpError: the
    cluster is gone, or has been without workers for too long"""
    alone_since: float | None = None
    while True:
        try:
            return ask()
        except TimeoutError:
            now = time.monotonic()
            alone_since = None if client.scheduler_info()["workers"] else alone_since or now
            patience = RESTART_S if restarts_workers(client) else NO_WORKERS_S
            if alone_since is not None and now - alone_since >= patience:
                raise StatejumpError(code="scheduler_lost_workers", patience=patience, advice=KEPT) from None
        except (CancelledError, OSError) as problem:
            raise StatejumpError(code="scheduler_connection_lost", problem=type(problem).__name__,
                                 advice=KEPT) from None


def _some_of(client: Client, running: set[Future]) -> set[Future]:
    """Wait for at least one future. :raises StatejumpError: see :func:`_patiently`"""
    with client.as_current():
        return set(_patiently(client, lambda: wait(running, timeout=LOOK_S, return_when="FIRST_COMPLETED")).done)


def _answer(client: Client, future: Future) -> tuple[float, Batch] | None:
    """Return the result of a batch; None if its worker died. Dask repeats a batch whose result is lost. :raises
    StatejumpError: see :func:`_patiently`
    :raises StatejumpError: see :func:`_patiently`"""
    try:
        return _patiently(client, lambda: future.result(timeout=LOOK_S))
    except KilledWorker:
        return None
