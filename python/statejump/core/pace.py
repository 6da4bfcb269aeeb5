# SPDX-License-Identifier: GPL-3.0-or-later
"""Pace of a run with time steps: number of steps, rate and remaining time, shown beside its progress."""
from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar

LEAST_S = 10.0  # duration below which the pace of a run is not shown
HOUR_S = 3600.0
WARNING = ("warning: the run takes more than an hour; a shorter thermal.period_s takes fewer steps, 'statejump "
           "reduced' takes none")

_show: ContextVar[Callable[[str], None] | None] = ContextVar("_show", default=None)


@contextmanager
def shown_by(show: Callable[[str], None]) -> Iterator[None]:
    """Show the pace of runs in this context by a function that prints a line."""
    token = _show.set(show)
    try:
        yield
    finally:
        _show.reset(token)


def show_pace(steps: int, steps_per_s: float, done: float) -> None:
    """Show the pace of a run, and a warning if it takes more than an hour.

    :param done: finished fraction of the steps
    """
    show = _show.get()
    left_s = steps * (1 - done) / steps_per_s
    if show is None or left_s < LEAST_S:
        return
    show(f"{number(steps)} steps, {number(steps_per_s)} steps/s, {duration(left_s)} left")
    if left_s > HOUR_S:
        show(WARNING)


def number(value: float) -> str:
    """Return a count with its first three digits, for example ``123 000`` or ``2.59e+10``."""
    rounded = float(f"{value:.3g}")
    return f"{rounded:.3g}" if rounded >= 1e9 else f"{rounded:,.0f}".replace(",", " ")


def duration(seconds: float) -> str:
    """Return a duration with its unit, for example ``4 min``."""
    for unit, size in (("d", 86400.0), ("h", HOUR_S), ("min", 60.0)):
        if seconds >= 1.5 * size:
            return f"{seconds / size:.2g} {unit}"
    return f"{seconds:.0f} s"
