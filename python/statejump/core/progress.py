# SPDX-License-Identifier: GPL-3.0-or-later
"""Progress of long runs, reported to a function of the caller or shown on standard error."""
from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from itertools import count
from time import monotonic
from typing import TYPE_CHECKING, Any

from statejump.core.errors import printable
from statejump.core.pace import shown_by

if TYPE_CHECKING:
    from rich.console import Console  # 0.1 s; a run in Python prints nothing

OnProgress = Callable[[float], None]
LONGEST_SILENCE_S = 60.0  # time between two lines of progress


def silent(share: float) -> None:
    """Ignore the progress."""


@contextmanager
def shown(progress: bool | OnProgress, label: str) -> Iterator[OnProgress]:
    """Yield a function that receives the finished fraction of a run, 0 to 1.

    :param progress: False: that function does nothing; True: it shows the fraction on standard error; else it is called
    """
    if callable(progress):
        yield progress
    elif not progress:
        yield silent
    else:
        with bar(label) as on_progress:
            yield on_progress


def console(**settings: Any) -> Console:
    """Return a console of the library rich that prints plain text, without styles and control characters."""
    from rich.console import Console  # 0.1 s; a run in Python prints nothing
    from rich.text import Text  # as Console

    class Plain(Console):
        def render_str(self, text: str, *arguments: Any, **more: Any) -> Text:
            return super().render_str(printable(text), *arguments, **more)

    # Units are in square brackets, which rich would interpret as styles.
    return Plain(highlight=False, soft_wrap=True, markup=False, **settings)


@contextmanager
def bar(label: str) -> Iterator[OnProgress]:
    """Yield a function that shows the finished fraction on standard error: a bar on a terminal, else lines."""
    with on_console(console(stderr=True), label) as on_progress:
        yield on_progress


@contextmanager
def on_console(console: Console, label: str) -> Iterator[OnProgress]:
    """Yield a function that shows the finished fraction on a console: a bar on a terminal, else lines. The pace of runs
    with time steps is shown there too."""
    with _shares(console, label) as on_progress, shown_by(lambda text: console.print(f"{label}: {text}")):
        yield on_progress


@contextmanager
def _shares(console: Console, label: str) -> Iterator[OnProgress]:
    from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn  # as Console

    if console.is_terminal:
        columns = (TextColumn("{task.description}"), BarColumn(), TextColumn("{task.percentage:>3.0f} %"),
                   TimeElapsedColumn(), TimeRemainingColumn())
        with Progress(*columns, console=console) as shown_bar:
            task = shown_bar.add_task(label, total=1.0)
            yield lambda share: shown_bar.update(task, completed=share)
        return
    tenths, printed_s = [-1], [monotonic()]

    def line(share: float) -> None:
        if share >= 1 and tenths[0] < 0:
            return  # a run that ends at once needs no progress
        if int(10 * share) > tenths[0] or monotonic() > printed_s[0] + LONGEST_SILENCE_S:
            digits = 0 if int(10 * share) > tenths[0] else 2
            tenths[0], printed_s[0] = int(10 * share), monotonic()
            console.print(f"{label}: {100 * share:.{digits}f} %")

    yield line


def one_of(on_progress: OnProgress, done: int, total: int) -> OnProgress:
    """Return the progress function of one of ``total`` equal runs after ``done`` runs; it reports the total
    fraction."""
    return lambda share: on_progress((done + share) / total)


def counted(on_progress: OnProgress, total: int) -> Callable[[], None]:
    """Return a function to call after each of ``total`` runs. It reports the finished fraction of all runs."""
    finished = count(1)
    return lambda: on_progress(next(finished) / total)
