# SPDX-License-Identifier: GPL-3.0-or-later
"""Code shared by commands: console, options, progress, tables."""
from __future__ import annotations

import os
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from functools import wraps
from pathlib import Path
from typing import Any, TypeVar, cast

import click
from rich.console import Console
from rich.table import Table

from statejump.core.case import Case
from statejump.core.comparison import Quantity, sides
from statejump.core.errors import Interrupted
from statejump.core.progress import console, counted, on_console
from statejump.core.results_folder import Results
from statejump.core.tables import Shown
from statejump.kinds import require
from statejump.kinds.loading import found_case, load_case

__all__ = ["CASE", "QUIET", "RESULTS", "WAIT", "CaseFile", "counted", "loaded", "make_console", "number",
           "print_comparison", "print_shown", "print_table", "progress", "since_start_s", "undivided"]


Command = TypeVar("Command", bound=Callable[..., Any])


class CaseFile(click.Path):
    """Argument for a case file: the given path or, if it does not exist, a shipped case from any folder."""

    def __init__(self) -> None:
        super().__init__(path_type=Path)

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        return found_case(Path(os.fsdecode(super().convert(value, param, ctx))))


CASE = click.argument("case_file", metavar="CASE", type=CaseFile())
WAIT = click.option("--wait", is_flag=True, help="Wait where another run is at work in the same folder.")
FORCE = click.option("--force", is_flag=True, help="Replace results of another case that has the same name.")


def RESULTS(command: Command) -> Command:
    """Add to a command the options of its results folder. The command receives them as one argument ``results``."""

    @wraps(command)
    def called(results: Path, wait: bool, force: bool, **values: Any) -> Any:
        return command(results=Results(results, wait, force), **values)

    return cast(Command, click.option(
        "--results", default="results", show_default=True, type=click.Path(path_type=Path),
        help="Folder that gets one folder per case.",
    )(WAIT(FORCE(called))))


QUIET = click.option("--quiet", is_flag=True, help="Print errors only.")


def make_console(quiet: bool) -> Console:
    """Return the console of a command."""
    made = console(quiet=quiet)
    if not made.is_terminal:  # a pipe or a log has no width, so numbers must not be truncated
        made.width = 160
    return made


def since_start_s() -> float:
    """Return the wall time since the start of the process [s], including the start of Python."""
    fields = Path("/proc/self/stat").read_text(encoding="utf-8").rpartition(")")[2].split()
    started_s = int(fields[19]) / os.sysconf("SC_CLK_TCK")  # field 22 of proc(5), in ticks since system start
    return time.clock_gettime(time.CLOCK_BOOTTIME) - started_s


def loaded(case_file: Path, *capabilities: type) -> Case:
    """Load a case. Raise NotAllowed if the kind of the case lacks a capability that the command needs."""
    case = load_case(case_file)
    for capability in capabilities:
        require(case, capability)
    return case


def number(value: float | None) -> str:
    """Return a number for a table."""
    return "none" if value is None else f"{value:.6g}"


def print_table(shown: Shown, console: Console) -> None:
    """Print a table."""
    table = Table(title=shown.title)
    for heading in shown.header:
        table.add_column(heading, justify="left" if heading in shown.left else "right")
    for row in shown.rows:
        table.add_row(*row)
    console.print(table)


def print_shown(parts: Sequence[Shown | str], console: Console) -> None:
    """Print tables and lines."""
    for part in parts:
        if isinstance(part, Shown):
            print_table(part, console)
        else:
            console.print(part)


def print_comparison(title: str, rows: Sequence[Quantity], console: Console,
                     names: dict[str, str] | None = None) -> None:
    """Print a comparison. ``names`` maps each source of values, such as a model, to the heading of its column."""
    heads = {"closed_form": "closed form", "reduced": "reduced", "dem": "DEM", "fe": "CalculiX", **(names or {})}
    known = sides(rows)
    table = Table(title=title)
    for heading in ("quantity", "unit", *(heads[side] for side in known), "difference", "tolerance", ""):
        table.add_column(heading, justify="left" if heading in ("quantity", "unit", "") else "right")
    for row in rows:
        values = [number(row.values[side]) if side in row.values else "" for side in known]
        table.add_row(row.name, row.unit, *values, number(row.difference), number(row.tolerance),
                      "pass" if row.passed else "MISSED" if row.finite else "NOT FINITE")
    console.print(table)


@contextmanager
def progress(console: Console, label: str) -> Iterator[Callable[[float], None]]:
    """Yield a function of the finished fraction: it moves a bar on a terminal, elsewhere it prints lines."""
    with on_console(console, label) as on_progress:
        yield on_progress


@contextmanager
def undivided(console: Console, label: str) -> Iterator[Callable[[float], None]]:
    """Show progress like :func:`progress`, for runs whose files are written together at the end. After Ctrl-C, report
    that nothing was written."""
    try:
        with progress(console, label) as on_progress:
            yield on_progress
    except (KeyboardInterrupt, Interrupted):
        raise Interrupted() from None
