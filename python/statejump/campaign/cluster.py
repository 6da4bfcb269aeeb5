# SPDX-License-Identifier: GPL-3.0-or-later
"""Clusters of Dask's ``distributed``: one on this machine, or a running scheduler."""
from __future__ import annotations

import asyncio
import logging
import os
import re
import signal
import socket
import sys
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from typing import Any

import dask

# Set before distributed is imported, because it and its workers read their log levels from here.
_QUIET = {
    "logging": {name: "critical" for name in ("distributed", "distributed.client", "bokeh", "tornado", "asyncio")},
    "distributed.comm.timeouts.connect": "5s",
    "distributed.scheduler.allowed-failures": 1,  # a task whose worker dies is tried once more
    # By default a local cluster drops a worker whose process does not return in time and starts no other. With this
    # value its nanny restarts the worker at any time.
    "distributed.deploy.lost-worker-timeout": "365 days",
    # Disable unused diagnostics: a profile that interrupts the samples a hundred times per second, and response times
    # of event loops.
    "distributed.worker.profile.enabled": False,
    "distributed.admin.tick.interval": "1s",
}
dask.config.set(_QUIET)

from distributed import Client, LocalCluster, Status  # noqa: E402

from statejump._version import __version__  # noqa: E402
from statejump.core.errors import NotAllowed, StatejumpError, shown  # noqa: E402
from statejump.core.scratch import scratch  # noqa: E402

OPTION = "--scheduler"
ADDRESS = "must be the address of a running dask scheduler, as 'tcp://host:8786'"
CONNECT_S = 5
WORKERS_S = 10  # longest wait for the workers of a scheduler [s]


class SchedulerUnusable(StatejumpError):
    """A scheduler is unusable: ``--scheduler = ADDRESS WHAT[: CAUSE]``."""

    def __init__(self, address: str, **more: Any) -> None:
        super().__init__(key=OPTION, value=address, **more)

    def phrase(self) -> str:
        return f"{self.key} = {shown(self.value)} {self.what}"


@contextmanager
def open_client(scheduler: str | None, workers: int) -> Iterator[Client]:
    """Yield a client of a Dask cluster. On exit, end every process that this function started.

    :param scheduler: address of a running scheduler; None: a cluster on this machine
    :param workers: number of single-threaded processes of the cluster on this machine
    :raises StatejumpError: the scheduler cannot be reached, has no workers, or its workers run another version
    """
    with ExitStack() as stack:
        stack.enter_context(_quiet())
        if scheduler is None:
            client = stack.enter_context(_local(workers))
        else:
            client = stack.enter_context(_existing(scheduler))
        yield client


@contextmanager
def _quiet() -> Iterator[None]:
    """Silence Dask's messages about lost connections, because the campaign itself reports lost connections."""
    loggers = [logging.getLogger(name) for name in ("distributed", "tornado", "asyncio", "concurrent.futures")]
    levels = [logger.level for logger in loggers]
    for logger in loggers:
        logger.setLevel(logging.CRITICAL + 1)
    try:
        yield
    finally:
        for logger, level in zip(loggers, levels):
            logger.setLevel(level)


@contextmanager
def _local(workers: int) -> Iterator[Client]:
    with scratch() as folder:
        environment = {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1", "TMPDIR": str(folder)}
        with _no_main_file(), ExitStack() as stack:
            with _interrupt_blocked():
                cluster = LocalCluster(
                    n_workers=workers, threads_per_worker=1, processes=True, dashboard_address="127.0.0.1:0",
                    worker_dashboard_address="127.0.0.1:0",
                    silence_logs=logging.CRITICAL + 1, local_directory=str(folder), memory_limit=0,
                    env=environment,
                )
                stack.callback(_close, cluster)
                client = stack.enter_context(Client(cluster))
            client.run(_version)  # imports the package everywhere
            yield client


def restarts_workers(client: Client) -> bool:
    """Return whether a local cluster is restarting a worker because its process ended."""
    nannies = client.cluster.workers.values() if client.cluster is not None else ()
    over = (Status.closing, Status.closed, Status.closing_gracefully, Status.failed)
    return any(nanny.status not in over for nanny in nannies)


def kill_workers(cluster: LocalCluster) -> None:
    """End the workers at once, even during a run."""
    for nanny in list(cluster.workers.values()):
        process = None if nanny.process is None else nanny.process.process
        nanny.auto_restart = False
        if process is not None and process.pid:
            try:
                os.kill(process.pid, signal.SIGKILL)
            except ProcessLookupError:
                pass


def _close(cluster: LocalCluster) -> None:
    kill_workers(cluster)
    cluster.close(timeout=10)
    cluster.__exit__(None, None, None)  # only this ends the thread of its event loop and the thread that watches it


@contextmanager
def _interrupt_blocked() -> Iterator[None]:
    """Block Ctrl-C in threads and processes started in this context, so that only this thread ends the campaign."""
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


@contextmanager
def _no_main_file() -> Iterator[None]:
    """Hide the running script from processes that start in this context. They would otherwise run the script again."""
    main = sys.modules["__main__"]
    hidden = {name: main.__dict__.pop(name) for name in ("__file__", "__spec__") if name in main.__dict__}
    main.__dict__["__spec__"] = None
    try:
        yield
    finally:
        main.__dict__.update(hidden)


@contextmanager
def _existing(address: str) -> Iterator[Client]:
    found = re.fullmatch(r"(?:(?:tcp|tls)://)?(\[[0-9a-fA-F:]+\]|[^\s:/\[\]]+):(\d{1,5})", address)
    if found is None or int(found[2]) > 65535:
        raise NotAllowed(OPTION, address, ADDRESS, code="scheduler_address")
    _check_security(address)
    try:
        # Try the connection once before Dask, which retries for a long time.
        socket.create_connection((found[1].strip("[]"), int(found[2])), timeout=CONNECT_S).close()
        client = Client(address, timeout=CONNECT_S, set_as_default=False)
    except (OSError, ValueError, asyncio.TimeoutError):
        raise SchedulerUnusable(address, code="scheduler_not_reached", cause=ADDRESS, connect_s=CONNECT_S) from None
    try:
        try:
            client.wait_for_workers(1, timeout=WORKERS_S)
        except asyncio.TimeoutError:
            raise SchedulerUnusable(address, code="scheduler_without_workers", workers_s=WORKERS_S) from None
        try:
            versions = client.run(_version)
        except Exception as problem:  # the package is missing on the workers, or has another version
            raise SchedulerUnusable(address, code="scheduler_without_statejump",
                                    cause=f"{type(problem).__name__}: {problem}", here=__version__) from None
        for worker, version in versions.items():
            if version != __version__:
                raise SchedulerUnusable(address, code="scheduler_of_other_version", worker=worker, version=version,
                                        here=__version__)
        yield client
    finally:
        client.close(timeout=CONNECT_S)


def _check_security(address: str) -> None:
    """Raise SchedulerUnusable if Dask's configuration requires encryption that the address does not provide, or has no
    readable TLS certificates."""
    from distributed.security import Security  # loaded only for addresses tls://

    security = Security()
    if not address.startswith("tls://"):
        if security.require_encryption:
            raise SchedulerUnusable(address, code="scheduler_not_encrypted")
        return
    cause = "Dask's configuration has no distributed.comm.tls"
    try:
        if security.get_connection_args("client").get("ssl_context") is not None:
            return
    except OSError as problem:  # of ssl as well
        cause = str(problem)
    raise SchedulerUnusable(address, code="scheduler_without_certificates", cause=cause)


def _version() -> str:
    return __version__
