# SPDX-License-Identifier: GPL-3.0-or-later
"""``statejump control``: what governs the state jump of a case, and what keeps it below a value."""
from __future__ import annotations

from math import isfinite
from pathlib import Path
from typing import Optional

import click
from rich.console import Console
from rich.table import Table

from statejump.control import ensemble as control_ensemble, loaded as control_loaded, plot as control_plot
from statejump.kinds.spring_slider import control as control_spring_slider
from statejump.kinds.registry import Case, SpringSliderCase, load_case
from statejump.control.study import Progress, Study, number, write
from statejump.core.errors import StatejumpError
from statejump.core.output import results_folder
from statejump.cli.terminal import CASE, QUIET, RESULTS, make_console, undivided


def is_loaded(case: Case) -> bool:
    """Whether the joint of an ``umbrella`` case is loaded by a biased torsion spring from the start."""
    return case.start.mode == "loaded"


def study(
    case: Case,
    jump_below: Optional[float] = None,
    runs: Optional[int] = None,
    with_dem: bool = False,
    tell: Progress = lambda fraction: None,
) -> Study:
    """Study a case of any kind.

    :param jump_below: wanted largest jump [m] or [rad]; None: half of what the case has
    :param runs: size of the ensemble; None: the default, and the only choice where none is run
    :raises StatejumpError: bad input, or a run failed
    """
    if jump_below is not None and not (isfinite(jump_below) and jump_below > 0):
        raise StatejumpError(
            f"--jump-below = {jump_below!r} is not allowed: must be a finite number above 0 "
            f"[{'m' if isinstance(case, SpringSliderCase) else 'rad'}]"
        )
    single = isinstance(case, SpringSliderCase) or is_loaded(case)
    if runs is not None and single:
        raise StatejumpError(
            f"--runs = {runs} is not allowed: case {case.name} has one exact path, no ensemble is run"
        )
    if runs is not None and runs < 2:
        raise StatejumpError(f"--runs = {runs} is not allowed: must be at least 2")
    if isinstance(case, SpringSliderCase):
        return control_spring_slider.study(case, jump_below, with_dem, tell)
    if single:
        return control_loaded.study(case, jump_below, with_dem, tell)
    runs = runs or control_ensemble.RUNS
    return control_ensemble.study(case, jump_below, runs, with_dem, tell)


def _print(case: Case, done: Study, console: Console) -> None:
    console.print(f"measure: {done.measure}")
    with_dem = bool(done.dem)

    def shown(value: Optional[float]) -> str:
        return "" if value is None else number(value * done.display_scale, 5)

    for sweep in done.sweeps:
        unit = "" if sweep.display_unit == "-" else f" [{sweep.display_unit}]"
        table = Table(title=f"{case.title}: {sweep.parameter}")
        table.add_column(sweep.label + unit, justify="right")
        for heading in done.results.values():
            table.add_column(heading, justify="right")
        if with_dem:
            table.add_column(f"DEM [{done.display_unit}]", justify="right")
        table.add_column("")
        for row in sweep.shown():
            marks = [name for name, value in (("case", sweep.own), ("recommended", sweep.recommended))
                     if value == row.value]
            table.add_row(
                number(row.value * sweep.display_scale, 5),
                *(shown(row.results.get(name)) for name in done.results),
                *([shown(row.dem_jump)] if with_dem else []),
                "; ".join(filter(None, [*marks, row.note])),
            )
        console.print(table)
        if done.wanted is not None:
            scale = sweep.display_scale
            ends = [f"{number(low * scale)} to {number(high * scale)}" for low, high in sweep.meets]
            console.print(f"not above the wanted jump:{unit} {', '.join(ends) if ends else 'no scanned value'}")
    console.print(f"jump of the case: {number(done.jump * done.display_scale, 6)} {done.display_unit}")
    if done.wanted is not None:
        console.print(f"wanted: at most {number(done.wanted * done.display_scale, 6)} {done.display_unit}")
    for sentence in done.sentences:
        console.print(sentence)
    for remark in done.remarks:
        console.print(f"remark: {remark}")


@click.command("control")
@CASE
@click.option("--jump-below", type=float, metavar="VALUE",
              help="Wanted largest jump, in m or, for an umbrella, rad.  [default: half of the case's]")
@click.option("--runs", type=int, metavar="N",
              help=f"Runs of each ensemble, where one is needed.  [default: {control_ensemble.RUNS}]")
@click.option("--dem", "with_dem", is_flag=True, help="Check the case and what is recommended in YADE too.")
@RESULTS
@QUIET
def control_command(
    case_file: Path, jump_below: Optional[float], runs: Optional[int], with_dem: bool, results: Path, quiet: bool
) -> None:
    """What governs the state jump of CASE, and the smallest spring that keeps it below a value.

    \b
    Example:
      statejump control cases/table1.toml --jump-below 5e-6
    """
    console = make_console(quiet)
    case = load_case(case_file)
    folder = results_folder(results, case.name)
    with undivided(console, "control") as tell:
        done = study(case, jump_below, runs, with_dem, tell)
    written = write(case.name, done, folder) + control_plot.figure(case.title, done, folder)
    _print(case, done, console)
    console.print(f"results: {', '.join(str(path) for path in written)}")
