# SPDX-License-Identifier: GPL-3.0-or-later
"""The ``statejump`` command. With ``--json`` before the command a failure is one line of JSON on standard error.
Exit statuses: docs/mistakes.md."""
from __future__ import annotations

import signal
import sys
import traceback
from itertools import takewhile
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, Sequence

import click
import numpy as np
from rich.console import Console
from rich.table import Table

from statejump import __version__, _engine
from statejump.core import comparison as compare, yade_process as dem, errors
from statejump.kinds.spring_slider import convergence, figure as plot, reduced
from statejump.bore.bore import bore_command
from statejump.cli.campaign import montecarlo_command, sweep_command
from statejump.kinds.registry import SpringSliderCase, TrussCase, UmbrellaCase
from statejump.control.command import control_command
from statejump.core.errors import StatejumpError, Interrupted, TolerancesMissed
from statejump.core.history import History
from statejump.core.output import results_folder
from statejump.cli.laws import laws_command
from statejump.cli.report import report_command
from statejump.kinds.spring_slider import result as kind_spring_slider
from statejump.kinds.umbrella import result as kind_umbrella
from statejump.results import ModelRun
from statejump.cli.results import compare_files, export_command, info_command
from statejump.results.read import is_result_file
from statejump.results.record import Record, case_text
from statejump.schema.json_schema import schema_command
from statejump.kinds.statics.solve import statics_command
from statejump.cli.terminal import (
    CASE, CaseFile, QUIET, RESULTS, load_kind, make_console, number, print_comparison, progress,
)
from statejump.kinds.truss import run as truss_run
from statejump.cli.truss import truss_command
from statejump.kinds.umbrella import compare as umbrella_compare
from statejump.kinds.umbrella import dem as umbrella_dem
from statejump.kinds.umbrella import reduced as umbrella
from statejump.kinds.umbrella import figure as umbrella_plot
from statejump.paper.energy import energy_command
from statejump.paper.figures.command import figures_command
from statejump.paper.hold import hold_command
from statejump.paper.slow import slow_command

JSON = "--json"


def _dem_label(steps: int, label: str = "DEM") -> str:
    return f"{label}, {steps:,} steps"


@click.group(context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(__version__, prog_name="statejump")
@click.option(JSON, is_flag=True, expose_value=False, help="Failures as one line of JSON on standard error.")
def cli() -> None:
    """State jump of deployable structures: an exact reduced model and a DEM model in YADE.

    \b
    Example:
      statejump compare cases/table1.toml
    """


@cli.command("reduced")
@CASE
@RESULTS
@QUIET
def reduced_command(case_file: Path, results: Path, quiet: bool) -> None:
    """Reduced model of CASE: events, state jump, history.

    \b
    Example:
      statejump reduced cases/table1.toml
    """
    console = make_console(quiet)
    case = load_kind(case_file, SpringSliderCase, UmbrellaCase, TrussCase)
    folder = results_folder(results, case.name)
    record = Record("reduced", case, case_text(case_file), folder)
    if isinstance(case, UmbrellaCase):
        _reduced_umbrella(case, record, console)
    elif isinstance(case, TrussCase):
        truss_run.reduced(case, record, console)
    else:
        _reduced_spring_slider(case, record, console)
    console.print(f"results: {record.save()}, history: {folder / 'reduced_history.csv'}")


def _reduced_spring_slider(case: SpringSliderCase, record: Record, console: Console) -> None:
    path = reduced.solve(case)
    history = reduced.sample(path, reduced.sample_times(case))
    record.models["reduced"] = kind_spring_slider.reduced_run(case, path, history)
    table = Table(title=f"{case.title}: events of the first cycle")
    for heading in ("event", "stage", "ΔT [K]", "time [s]", "displacement [m]", "axial force [N]"):
        table.add_column(heading, justify="left" if heading in ("event", "stage") else "right")
    for event in path.events:
        if event.time_s <= case.dem.period_s:
            table.add_row(event.kind, f"{event.stage_before} → {event.stage_after}",
                          f"{event.temperature_change_K:.6f}", f"{event.time_s:.6f}",
                          f"{event.displacement_m:.6e}", f"{event.axial_force_N:.4f}")
    console.print(table)
    console.print(f"state jump: {path.state_jump_m:.6e} m after {case.thermal.cycles} cycle(s)")
    _warn(case, path, record, console)


def _reduced_umbrella(case: UmbrellaCase, record: Record, console: Console) -> None:
    run = umbrella.run(case)
    record.models["reduced"] = kind_umbrella.reduced_run(case, run)
    _print_first_contact(run.first_contact_temperature_change_K, run.first_contact_time_s, console)
    _print_umbrella_jump(case, run.history, console)
    console.print(
        f"{run.steps:,} steps, {run.contacts} contacts, energy residue {run.energy_residue_J:.3g} J"
    )


def _print_first_contact(change: float | None, time: float | None, console: Console) -> None:
    if change is None:
        console.print("first contact: none, the play is never used up")
    else:
        console.print(f"first contact: ΔT = {change:.6f} K at {time:.6f} s")


def _print_umbrella_jump(case: UmbrellaCase, history: History, console: Console) -> None:
    jumps = [float(history[f"{angle}_rad"][-1] - history[f"{angle}_rad"][0]) for angle in ("theta2", "theta4")]
    console.print(
        f"state jump: θ2 {jumps[0]:.6e} rad, θ4 {jumps[1]:.6e} rad after {case.thermal.cycles} cycle(s)"
    )
    if not umbrella.is_reproducible(case):
        console.print(
            "warning: without damping of links and pins the motion after contact is chaotic: one run's jump "
            "is one of many, see 'statejump figures'"
        )


def _warn(case: SpringSliderCase, path: Any, record: Record, console: Console) -> None:
    record.warnings += [*path.warnings, *reduced.warnings(case)]
    for warning in record.warnings:
        console.print(f"warning: {warning}")


@cli.command("dem")
@CASE
@RESULTS
@QUIET
def dem_command(case_file: Path, results: Path, quiet: bool) -> None:
    """DEM run of CASE in YADE: history.

    \b
    Example:
      statejump dem cases/table1.toml
    """
    console = make_console(quiet)
    case = load_kind(case_file, SpringSliderCase, UmbrellaCase, TrussCase)
    folder = results_folder(results, case.name)
    record = Record("dem", case, case_text(case_file), folder)
    if isinstance(case, UmbrellaCase):
        with progress(console, _dem_label(umbrella_dem.number_of_steps(case))) as report:
            done = umbrella_dem.run(case, folder, report, record.keep)
        _print_first_contact(
            done.summary["first_contact_temperature_change_K"], done.summary["first_contact_time_s"], console
        )
        _print_umbrella_jump(case, done.history, console)
    elif isinstance(case, TrussCase):
        done = truss_run.only_dem(case, record, console)
    else:
        done = _run_spring_slider(case, folder, console, keep=record.keep)
        jump = done.history["displacement_m"][-1] - done.history["displacement_m"][0]
        console.print(f"state jump: {jump:.6e} m after {case.thermal.cycles} cycle(s)")
    record.add_dem(done)
    console.print(f"results: {record.save()}, history: {folder / 'dem_history.csv'}")


def _run_spring_slider(
    case: SpringSliderCase, folder: Path, console: Console, label: str = "DEM", keep: dem.Keep | None = None
) -> dem.DemRun:
    with progress(console, _dem_label(dem.number_of_steps(case), label)) as report:
        return dem.run(case, folder, report, keep)


@cli.command("compare")
@click.argument("files", metavar="CASE|FILE FILE", nargs=-1, required=True, type=CaseFile())
@RESULTS
@QUIET
def compare_command(files: tuple[Path, ...], results: Path, quiet: bool) -> None:
    """Both models of CASE side by side, or two result files of the same case; exit status 1 when a
    tolerance is missed, 2 when the files are of different cases.

    \b
    Examples:
      statejump compare cases/table1.toml
      statejump compare results/table1/reduced.h5 results/table1/dem.h5
    """
    console = make_console(quiet)
    if len(files) > 1 or is_result_file(files[0]):
        compare_files(files, console)
    else:
        _compare_case(files[0], results, console)


def _compare_case(case_file: Path, results: Path, console: Console) -> None:
    case = load_kind(case_file, SpringSliderCase, UmbrellaCase, TrussCase)
    folder = results_folder(results, case.name)
    record = Record("compare", case, case_text(case_file), folder)
    if isinstance(case, UmbrellaCase):
        rows, figures = _compare_umbrella(case, record, console)
    elif isinstance(case, TrussCase):
        rows, figures = truss_run.both(case, record, console)
    else:
        rows, figures = _compare_spring_slider(case, record, console)
    compare.write_comparison(case, rows, folder)
    written = [record.save(rows), folder / "comparison.json", *figures]
    console.print(f"results: {', '.join(str(name) for name in written)}")
    missed = [row.name for row in rows if not row.passed]
    if missed:
        raise TolerancesMissed(f"{case_file}: tolerance missed: {', '.join(missed)}")


def _compare_spring_slider(
    case: SpringSliderCase, record: Record, console: Console
) -> tuple[list[compare.Quantity], list[Path]]:
    path = reduced.solve(case)

    def sampled(times_s: np.ndarray) -> ModelRun:
        return kind_spring_slider.reduced_run(case, path, reduced.sample(path, times_s))

    record.models["reduced"] = sampled(reduced.sample_times(case))
    done = _run_spring_slider(case, record.folder, console, keep=record.keep)
    record.models["reduced"] = sampled(done.history["time_s"])
    record.add_dem(done)
    rows = compare.compare(case, path, done.history)
    figures = plot.figure(case, path, done.history, record.folder)
    print_comparison(case.title, rows, console)
    _warn(case, path, record, console)
    return rows, figures


def _compare_umbrella(
    case: UmbrellaCase, record: Record, console: Console
) -> tuple[list[compare.Quantity], list[Path]]:
    run = umbrella.run(case)
    record.models["reduced"] = kind_umbrella.reduced_run(case, run)
    with progress(console, _dem_label(umbrella_dem.number_of_steps(case))) as report:
        done = umbrella_dem.run(case, record.folder, report, record.keep)
    record.add_dem(done)
    rows = umbrella_compare.compare(case, run, done)
    figures = umbrella_plot.figure(case, run.history, done.history, record.folder)
    print_comparison(case.title, rows, console)
    if not umbrella.is_reproducible(case):
        console.print(
            "without damping of links and pins the motion after contact is chaotic: compared point by point "
            "until the largest temperature; for the rest see 'statejump figures'"
        )
    return rows, figures


@cli.command("convergence")
@CASE
@RESULTS
@QUIET
def convergence_command(case_file: Path, results: Path, quiet: bool) -> None:
    """DEM error of CASE against the duration of the cycle and the time step, as a table.

    \b
    Example:
      statejump convergence cases/table1.toml
    """
    console = make_console(quiet)
    case = load_kind(case_file, SpringSliderCase)
    folder = results_folder(results, case.name)
    variants = convergence.variants(case)
    # Only the table is a result: the histories of the runs go where they vanish.
    with TemporaryDirectory(prefix="statejump-") as scratch:
        try:
            histories = [
                _run_spring_slider(variant, Path(scratch), console, f"{number}/{len(variants)}").history
                for number, variant in enumerate(variants, start=1)
            ]
        except Interrupted:
            raise Interrupted("interrupted; no table was written") from None
    convergence.write(case, convergence.rows(variants, histories), folder)
    console.print((folder / "convergence.md").read_text(encoding="utf-8"))


for _command in (
    figures_command, slow_command, hold_command, energy_command, control_command, statics_command,
    bore_command, montecarlo_command, sweep_command, report_command, info_command, export_command, truss_command,
    schema_command, laws_command,
):
    cli.add_command(_command)


def _told(error: BaseException, as_json: bool) -> int:
    """Tell what ended the command on standard error; return the exit status."""
    if isinstance(error, StatejumpError):
        failure = error.fields()
    elif isinstance(error, click.ClickException):
        failure = errors.fields("usage", error.format_message(), 2)
    elif isinstance(error, (click.exceptions.Abort, KeyboardInterrupt)):
        failure = errors.fields("interrupted", "interrupted", Interrupted.exit_status)
    else:  # a fault of the program: status 1 would say that a tolerance is missed
        failure = errors.fields(
            "internal", f"a fault of statejump itself: {type(error).__name__}: {error}", 2,
            remedy="run the command without --json for the traceback",
        )
        if not as_json:
            traceback.print_exception(error)
    if as_json:
        click.echo(errors.to_json(failure), err=True)
    else:
        is_error = failure["kind"] not in (TolerancesMissed.kind, Interrupted.kind)
        click.echo(("error: " if is_error else "") + failure["message"], err=True)
    return failure["exit_status"]


def run(arguments: Sequence[str]) -> int:
    """Run the command with these arguments and return its exit status; failures go to standard error."""
    as_json = JSON in takewhile(lambda word: word.startswith("-"), arguments)
    try:
        cli.main(list(arguments), standalone_mode=False)
    except click.exceptions.Exit as end:
        return int(end.exit_code)
    except (Exception, KeyboardInterrupt) as error:
        return _told(error, as_json)
    return 0


def main() -> None:
    """Entry point of the launcher."""
    # Ended from outside, it ends YADE and cleans up as on Ctrl-C.
    signal.signal(signal.SIGTERM, lambda number, frame: sys.exit(128 + number))
    sys.exit(run(sys.argv[1:]))
