# SPDX-License-Identifier: GPL-3.0-or-later
"""``statejump figures``, ``slow``, ``hold`` and ``energy``: studies of the paper's umbrella rib. ``convergence``: the
study of its spring-slider. The command ``statejump`` finds them in the repository; ``python3 -m studies.paper figures``
needs only the package."""
from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from typing import Any, TypeVar

import click
from rich.console import Console

from statejump.cli.terminal import (
    CASE, QUIET, RESULTS, CaseFile, counted, loaded, make_console, print_shown, progress, undivided,
)
from statejump.core.case import Case
from statejump.core.errors import NotAllowed
from statejump.core.results_folder import Results
from statejump.kinds.spring_slider.case import SpringSliderCase
from statejump.kinds.umbrella.case import UmbrellaCase
from studies.paper import convergence, energy, hold, slow
from studies.paper.figures import study

Command = TypeVar("Command", bound=Callable[..., Any])
CaseType = TypeVar("CaseType", bound=Case)


def _case_or(shipped: str) -> Callable[[Command], Command]:
    """Return the argument CASE whose default is a shipped case."""
    return click.argument("case_file", metavar="[CASE]", default=f"cases/{shipped}.toml", type=CaseFile())


def _case(kind: type[CaseType], command: str, case_file: Path) -> CaseType:
    """Load a case. :raises NotAllowed: the case is of another kind"""
    case = loaded(case_file)
    if not isinstance(case, kind):
        raise NotAllowed("case.kind", case.kind, code="command_not_for_kind", file=case.origin.file, command=command,
                         kinds=repr(kind.KIND))
    return case


def _study(command: str, make: Callable[..., Any], case_file: Path, results: Results, quiet: bool) -> None:
    console = make_console(quiet)
    case = _case(UmbrellaCase, command, case_file)
    with undivided(console, "runs") as on_progress:
        done = make(case, results, on_progress)
    _print(done, console)


def _print(done: Any, console: Console) -> None:
    print_shown(done.summary_lines(), console)
    console.print(f"results: {', '.join(str(path) for path in done.written)}")


@contextmanager
def _part(console: Console, text: str, runs: int) -> Iterator[Callable[[], None]]:
    """Yield a function to call after each run: on a terminal it moves a progress bar, elsewhere it prints a line per
    part."""
    if not console.is_terminal:
        console.print(f"{text}: {runs} runs")
        yield lambda: None
        return
    with progress(console, f"{text}, {runs} runs") as on_progress:
        yield counted(on_progress, runs)


@click.command("figures")
@_case_or("umbrella")
@RESULTS
@QUIET
def figures_command(case_file: Path, results: Results, quiet: bool) -> None:
    """Figures 13 to 16 of the paper for CASE, both models, and a test of each of its claims.

    \b
    Example:
      statejump figures cases/umbrella.toml
    """
    console = make_console(quiet)
    case = _case(UmbrellaCase, "figures", case_file)
    _print(study.make(case, results, partial(_part, console)), console)


@click.command("slow")
@_case_or("umbrella_bias")
@RESULTS
@QUIET
def slow_command(case_file: Path, results: Results, quiet: bool) -> None:
    """Jump of both models of CASE against the quasi-static path, for slower and slower cycles.

    \b
    Example:
      statejump slow cases/umbrella_bias.toml
    """
    _study("slow", slow.make, case_file, results, quiet)


@click.command("hold")
@_case_or("umbrella_hold")
@RESULTS
@QUIET
def hold_command(case_file: Path, results: Results, quiet: bool) -> None:
    """Loaded joint of CASE left alone for 10 s, both models: Mindlin's friction holds, Ambrosio's creeps.

    \b
    Example:
      statejump hold cases/umbrella_hold.toml
    """
    _study("hold", hold.make, case_file, results, quiet)


@click.command("energy")
@CASE
@RESULTS
@QUIET
def energy_command(case_file: Path, results: Results, quiet: bool) -> None:
    """Energy account of CASE against the steps of both models, also without friction and damping.

    \b
    Example:
      statejump energy cases/umbrella_damped.toml
    """
    _study("energy", energy.make, case_file, results, quiet)


@click.command("convergence")
@CASE
@click.option("--decades", type=click.IntRange(0, 3), default=0, show_default=True,
              help="How much longer than 4 periods cycles last, and how much shorter than 0.025 of the stable one time "
                   "steps are; every decade takes ten times as long.")
@RESULTS
@QUIET
def convergence_command(case_file: Path, decades: int, results: Results, quiet: bool) -> None:
    """DEM error of CASE against the duration of the cycle and the time step, as a table.

    \b
    Example:
      statejump convergence cases/table1.toml
    """
    console = make_console(quiet)
    case = _case(SpringSliderCase, "convergence", case_file)
    case.check_dem()
    with results.folder(case.name, case) as folder:
        with progress(console, "convergence") as on_progress:
            found = convergence.convergence(case, on_progress, decades)
        _, text = folder.publish(found.write(folder.staged))
    console.print(text.read_text(encoding="utf-8"))
