# SPDX-License-Identifier: GPL-3.0-or-later
"""``statejump info``, ``statejump export`` and ``statejump compare FILE FILE``."""
from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path

import click
import numpy as np
from rich.console import Console

from statejump.cli.terminal import QUIET, WAIT, make_console, number, print_comparison, print_table, progress
from statejump.core.comparison import FIRST, SECOND
from statejump.core.errors import Interrupted, StatejumpError, TolerancesMissed
from statejump.core.results_folder import Results
from statejump.core.run import GROUPS, Column
from statejump.core.tables import Shown
from statejump.core.units import unit_of
from statejump.results import export_csv
from statejump.results.contents import Answers, Result
from statejump.results.difference import RunDifference, case_differences, difference
from statejump.results.read import read

FILE = click.argument("file", metavar="FILE", type=click.Path(path_type=Path))
FORMATS = ("csv", "xlsx", "vtu", "paraview", "all")
MODEL_NAMES = {"reduced": "reduced", "dem": "DEM"}
FRAMES = 200
SHOWN_EVENTS = 12


def _value(value: float) -> str:
    return number(None if math.isnan(value) else value)


@click.command("info")
@FILE
def info_command(file: Path) -> None:
    """What is in a result FILE: case, provenance, numbers, events, verdict, columns.

    \b
    Example:
      statejump info results/table1/comparison.h5
    """
    console = make_console(False)
    result = read(file)
    print_table(_header(result), console)
    print_table(_summary(result), console)
    _print_events(result, console)
    if result.rows is not None:
        verdict = "passed" if result.passed else "a tolerance is missed"
        print_comparison(f"{result.title}: {verdict}", result.rows, console)
    if result.answers is not None:
        _print_answers(result.answers, console)
    _print_contents(result, console)
    for warning in result.warnings:
        console.print(f"warning: {warning}")
    if not result.complete:
        console.print("warning: not complete: the run was interrupted, the file holds what there was")


def _header(result: Result) -> Shown:
    rows = {
        "case": f"{result.name}, kind {result.kind}", "source": result.source,
        "written by": f"statejump {result.command}",
        "complete": "yes" if result.complete else "no",
        **{key.replace("_", " "): str(value) for key, value in sorted(result.provenance.items())},
        "parts": ", ".join(f"{part['name']} ({part['type']})" for part in result.scene["parts"][:SHOWN_EVENTS])
        + (" ..." if len(result.scene["parts"]) > SHOWN_EVENTS else ""),
    }
    return Shown(result.title, ("", "value"), [(key, value or "not known") for key, value in rows.items()],
                 left=("", "value"))


def _summary(result: Result) -> Shown:
    names = sorted({name for run in result.models.values() for name in run.summary})
    rows = [
        (name, unit_of(name),
         *(_value(run.summary[name]) if name in run.summary else "" for run in result.models.values()))
        for name in names
    ]
    return Shown("summary", ("quantity", "unit", *(MODEL_NAMES[model] for model in result.models)), rows,
                 left=("quantity", "unit"))


def _print_events(result: Result, console: Console) -> None:
    for model, run in result.models.items():
        rows = [
            (event.kind, event.joint, f"{event.temperature_change_K:.6f}", f"{event.time_s:.6f}",
             f"{event.time_uncertainty_s:.2g}")
            for event in run.events[:SHOWN_EVENTS]
        ]
        print_table(Shown(f"events, {MODEL_NAMES[model]}", ("event", "joint", "ΔT [K]", "time [s]", "± [s]"), rows,
                          left=("event", "joint")), console)
        if len(run.events) > SHOWN_EVENTS:
            console.print(f"and {len(run.events) - SHOWN_EVENTS:,} more: statejump export --format csv")


def _print_answers(answers: Answers, console: Console) -> None:
    numbers = [(name, scalar.unit, _value(scalar.value)) for name, scalar in sorted(answers.summary.items())]
    print_table(Shown(f"answers: {answers.text}", ("quantity", "unit", "value"), numbers, left=("quantity", "unit")),
                console)
    console.print(f"{answers.verdict}: {answers.verdict_text}")
    for note in answers.notes:
        console.print(f"note: {note}")
    tables = [(name, f"{len(rows):,}", ", ".join(rows[0]) if rows else "") for name, rows in answers.tables.items()]
    print_table(Shown("tables of answers", ("table", "rows", "columns"), tables, left=("table", "columns")), console)


def _shape(column: Column) -> str:
    parts = [f"{column.values.shape[0]:,} samples"]
    if column.items:
        parts.append(f"{column.values.shape[1]:,} {column.items}")
    if column.values.ndim == 3:
        parts.append("3")
    return " × ".join(parts)


def _print_contents(result: Result, console: Console) -> None:
    headings = ("place", "unit", "shape", "smallest", "largest")
    for model, run in result.models.items():
        rows = [
            (f"{group}/{name}", column.unit, _shape(column), *_extremes(column))
            for group in GROUPS for name, column in sorted(getattr(run, group).items())
        ]
        print_table(Shown(f"columns, {MODEL_NAMES[model]}", headings, rows, left=("place", "unit", "shape")), console)


def _extremes(column: Column) -> tuple[str, str]:
    if column.labels:
        return ", ".join(column.labels), ""
    known = column.values[~np.isnan(column.values)]
    return (number(float(known.min())), number(float(known.max()))) if known.size else ("none", "none")


@click.command("export")
@FILE
@click.option("--format", "form", type=click.Choice(FORMATS), default="all", show_default=True,
              help="csv: tables; xlsx: a workbook of them; vtu: VTK series; paraview: VTK series and a script that "
                   "opens them; all: csv and paraview.")
@click.option("--to", "folder", type=click.Path(path_type=Path), default=None,
              help="Folder that gets the files. [default: FILE without its suffix]")
@click.option("--frames", type=click.IntRange(min=0), default=FRAMES, show_default=True,
              help="Samples in the VTK series, evenly spread; 0: all.")
@WAIT
@QUIET
def export_command(
    file: Path, form: str, folder: Path | None, frames: int, wait: bool, quiet: bool
) -> None:
    """CSV tables, a workbook or ParaView files of a result FILE.

    \b
    Example:
      statejump export results/table1/comparison.h5 --format paraview
    """
    console = make_console(quiet)
    result = read(file)
    target = folder if folder is not None else file.with_suffix("")
    if target == file:
        raise StatejumpError(code="suffix_missing", file=file)
    with Results(target.parent, wait).folder(target.name) as there:
        written: list[Path] = []
        if form in ("csv", "all"):
            written += export_csv.write_all(result, there.staged)
        if form == "xlsx":
            from statejump.results import export_xlsx  # openpyxl, 0.2 s, which may be missing

            written.append(export_xlsx.write(result, there.staged / f"{file.stem}.xlsx"))
        elif form != "csv":
            from statejump.results import export_vtk, paraview_script  # VTK, 0.5 s

            try:
                with progress(console, "VTK files") as report:
                    written += export_vtk.write_all(result, there.staged, frames, report)
            except KeyboardInterrupt:
                raise Interrupted() from None
            if form != "vtu":
                written.append(paraview_script.write_script(result, there.staged))
        written = there.publish(written)
    console.print(f"written: {', '.join(str(path) for path in written)}")


def compare_files(files: Sequence[Path], console: Console) -> None:
    """Print a comparison of two result files of the same case.

    :raises TolerancesMissed: a tolerance of the case in the first file is missed
    :raises StatejumpError: these are not two result files of the same case
    """
    if len(files) != 2:
        raise StatejumpError(code="wrong_number_of_files", files=len(files))
    first, second = (read(file) for file in files)
    found = difference(first, second)
    for place, file in zip((FIRST, SECOND), files):
        console.print(f"{place}: {file}")
    for text in case_differences(first, second)[1]:
        console.print(f"computed otherwise: {text}")
    for key in sorted({*first.provenance} & {*second.provenance}):
        if first.provenance[key] != second.provenance[key]:
            console.print(f"computed otherwise: {key} = {first.provenance[key]} and {second.provenance[key]}")
    missed: list[str] = []
    for runs in found:
        _print_difference(first.title, runs, console)
        missed += runs.missed
    if not (first.complete and second.complete):
        console.print("not judged: a run is not complete; its common time is compared")
    if missed:
        raise TolerancesMissed(missed, file=f"{files[0]}, {files[1]}")


def _print_difference(title: str, runs: RunDifference, console: Console) -> None:
    names = {place: f"{place}, {MODEL_NAMES[model]}" for place, model in zip((FIRST, SECOND), runs.names)}
    print_table(Shown(
        f"{title}: summary", ("quantity", "unit", *names.values(), "difference"),
        [(name, unit, _value(one), _value(other), _value(other - one)) for name, unit, one, other in runs.summary],
        left=("quantity", "unit"),
    ), console)
    print_table(Shown(
        "largest difference over time", ("column", "unit", "difference", "at [s]", "range of the first"),
        [(column.name, column.unit, number(column.largest), number(column.time_s), number(column.range))
         for column in runs.columns],
        left=("column", "unit"),
    ), console)
    print_table(Shown(
        "events", ("event", "first: count", "second: count", "first: ΔT [K]", "second: ΔT [K]"),
        [(event.kind, *map(str, event.counts), *map(number, event.first_K)) for event in runs.events], left=("event",),
    ), console)
    for name in runs.lacking:
        console.print(f"not compared: only one file has {name}")
    for name in runs.not_finite:
        console.print(f"not finite in one file where it is in the other: {name}")
    if runs.rows is not None:
        print_comparison("against the tolerances of the case", runs.rows, console, names)
