# SPDX-License-Identifier: GPL-3.0-or-later
"""``statejump control``: sensitivities of the state jump of a case, and changes that keep it below a value."""
from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from textwrap import shorten

import click

from statejump.cli.terminal import CASE, QUIET, RESULTS, loaded, make_console, print_shown, undivided
from statejump.control import study
from statejump.control.capabilities import ControlStudy
from statejump.control.study import DesignChoices, Study, Sweep, number
from statejump.core.results_folder import Results
from statejump.core.tables import Shown
from statejump.kinds import require
from statejump.kinds.protocol import DemInput

LONGEST_NOTE = 60  # largest number of characters of a note in a table; control.csv has the whole note


def _table(title: str, done: Study, sweep: Sweep, unit: str) -> Shown:
    def shown(value: float | None) -> str:
        return "" if value is None else number(value * done.display_scale, 5)

    with_dem, rows = bool(done.dem), []
    for row in sweep.shown():
        marks = [name for name, value in (("case", sweep.own), ("recommended", sweep.recommended))
                 if value == row.value]
        note = shorten(row.note, LONGEST_NOTE, placeholder=" …")
        rows.append((
            number(row.value * sweep.display_scale, 5), *(shown(row.results.get(name)) for name in done.results),
            *([shown(row.dem_jump)] if with_dem else []), "; ".join(filter(None, [*marks, note])),
        ))
    heads = (sweep.label + unit, *done.results.values(), *([f"DEM [{done.display_unit}]"] if with_dem else []), "")
    return Shown(f"{title}: {sweep.parameter}", heads, rows, left=("",))


def _lines(title: str, done: Study) -> Iterator[Shown | str]:
    yield f"measure: {done.measure}"
    for sweep in done.sweeps:
        unit = "" if sweep.display_unit == "-" else f" [{sweep.display_unit}]"
        yield _table(title, done, sweep, unit)
        if done.wanted is not None:
            scale = sweep.display_scale
            ends = [f"{number(low * scale)} to {number(high * scale)}" for low, high in sweep.meets]
            yield f"not above the wanted jump:{unit} {', '.join(ends) if ends else 'no scanned value'}"
    yield f"jump of the case: {number(done.jump * done.display_scale, 6)} {done.display_unit}"
    if done.wanted is not None:
        yield f"wanted: at most {number(done.wanted * done.display_scale, 6)} {done.display_unit}"
    yield from done.sentences
    yield from (f"remark: {remark}" for remark in done.remarks)


@click.command("control")
@CASE
@click.option("--jump-below", type=float, metavar="VALUE",
              help="Wanted largest jump, in m.  [default: half of the case's]")
@click.option("--node", metavar="NAME", help="Of a truss: the node that jumps.  [default: the most moved one]")
@click.option("--add-spring", type=(str, str), multiple=True, metavar="A B",
              help="Of a truss: two nodes between which a spring may be added; may be given again.")
@click.option("--free", "--scale", "free", multiple=True, metavar="KEY",
              help="Of a truss: section.item.key, or section.*.key of all items, that the design may change; may be "
                   "given again. The best of them is named. Without: all that a jump may follow are tried, unless "
                   "springs may be added, and none is named best.")
@click.option("--runs", type=int, metavar="N",
              help=f"Runs of each ensemble, where one is needed.  [default: {study.RUNS}]")
@click.option("--dem", "with_dem", is_flag=True, help="Check the case and what is recommended in YADE too.")
@RESULTS
@QUIET
def control_command(
    case_file: Path, jump_below: float | None, node: str | None, add_spring: tuple[tuple[str, str], ...],
    free: tuple[str, ...], runs: int | None, with_dem: bool, results: Results, quiet: bool,
) -> None:
    """What governs the state jump of CASE, and the smallest spring that keeps it below a value.

    \b
    Examples:
      statejump control cases/table1.toml --jump-below 5e-6
      statejump control ring_12 --node J1 --jump-below 1e-6 --add-spring J0 J2 --free 'revolute.*.friction_coefficient'
    """
    from statejump.control import plot  # matplotlib, 0.4 s, after the study

    console = make_console(quiet)
    case = loaded(case_file, ControlStudy, *([DemInput] if with_dem else []))
    if with_dem:
        case.check_dem()
    with results.folder(case.name, case) as folder:
        with undivided(console, "control") as on_progress:
            done: Study = require(case, ControlStudy).control(
                case, jump_below=jump_below, runs=runs, with_dem=with_dem, on_progress=on_progress,
                choices=DesignChoices(node, add_spring, free))
        written = folder.publish(
            study.write(case.name, done, folder.staged) + plot.figure(case.title, done, folder.staged))
    print_shown(list(_lines(case.title, done)), console)
    console.print(f"results: {', '.join(str(path) for path in written)}")
