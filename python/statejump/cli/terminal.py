# SPDX-License-Identifier: GPL-3.0-or-later
"""What commands share on the terminal: console, options, progress."""
from __future__ import annotations

from contextlib import contextmanager
from itertools import count
from pathlib import Path
from typing import Any, Callable, Iterator, Optional, Sequence, TypeVar

import click
from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn
from rich.table import Table

from statejump import _paths
from statejump.kinds.registry import Case, load_case
from statejump.core.comparison import Quantity
from statejump.core.errors import Interrupted, StatejumpError



class CaseFile(click.Path):
    """A case file: as given, or, where there is none, that of the cases that come with the program, so that
    ``cases/table1.toml`` is found from every folder."""

    def __init__(self) -> None:
        super().__init__(path_type=Path)

    def convert(self, value: Any, param: Optional[click.Parameter], ctx: Optional[click.Context]) -> Any:
        path = super().convert(value, param, ctx)
        shipped = _paths.SHARE / path
        return shipped if path.parts[:1] == ("cases",) and not path.exists() and shipped.exists() else path


CASE = click.argument("case_file", metavar="CASE", type=CaseFile())
RESULTS = click.option(
    "--results", default="results", show_default=True, type=click.Path(path_type=Path),
    help="Folder that gets one folder per case.",
)
QUIET = click.option("--quiet", is_flag=True, help="Print errors only.")

CaseType = TypeVar("CaseType", bound=Case)


def make_console(quiet: bool) -> Console:
    """Return the console of a command."""
    # Units stand in square brackets, which rich would take for styles.
    console = Console(quiet=quiet, highlight=False, soft_wrap=True, markup=False)
    if not console.is_terminal:  # a pipe or a log has no width: do not cut numbers short
        console.width = 160
    return console


def load_kind(case_file: Path, *kinds: type[CaseType]) -> CaseType:
    """Load a case of one of the kinds that the command is for; StatejumpError for any other."""
    case = load_case(case_file)
    if not isinstance(case, kinds):
        command = click.get_current_context().command_path.split(" ", 1)[1]
        allowed = " and ".join(repr(kind.KIND) for kind in kinds)
        raise StatejumpError(
            f"{case_file}: case.kind = {case.kind!r} is not allowed: 'statejump {command}' is for "
            f"{allowed}"
        )
    return case


def number(value: Optional[float]) -> str:
    """Return a number for a table."""
    return "none" if value is None else f"{value:.6g}"


def print_comparison(
    title: str, rows: Sequence[Quantity], console: Console, names: tuple[str, str] = ("reduced", "DEM")
) -> None:
    """Print rows of a comparison; ``names`` head the two columns of values."""
    table = Table(title=title)
    for heading in ("quantity", "unit", *names, "difference", "tolerance", ""):
        table.add_column(heading, justify="left" if heading in ("quantity", "unit", "") else "right")
    for row in rows:
        table.add_row(row.name, row.unit, number(row.reduced), number(row.dem), number(row.difference),
                      number(row.tolerance), "pass" if row.passed else "MISSED")
    console.print(table)


@contextmanager
def progress(console: Console, label: str) -> Iterator[Callable[[float], None]]:
    """Yield a function that takes the finished fraction: a bar on a terminal, with a line every
    10 % elsewhere."""
    if console.is_terminal:
        columns = (TextColumn("{task.description}"), BarColumn(), TextColumn("{task.percentage:>3.0f} %"),
                   TimeElapsedColumn(), TimeRemainingColumn())
        with Progress(*columns, console=console) as bar:
            task = bar.add_task(label, total=1.0)
            yield lambda fraction: bar.update(task, completed=fraction)
        return
    told = [-1]

    def line(fraction: float) -> None:
        if int(10 * fraction) > told[0]:
            told[0] = int(10 * fraction)
            console.print(f"{label}: {100 * fraction:.0f} %")

    yield line


@contextmanager
def undivided(console: Console, label: str) -> Iterator[Callable[[float], None]]:
    """As :func:`progress`, of runs that are written together at the end: Ctrl-C says that nothing was."""
    try:
        with progress(console, label) as tell:
            yield tell
    except (KeyboardInterrupt, Interrupted):
        raise Interrupted("interrupted; nothing was written") from None


def counted(tell: Callable[[float], None], total: int) -> Callable[[], None]:
    """Return what to call after each of so many runs; it tells the finished fraction."""
    finished = count(1)
    return lambda: tell(next(finished) / total)
