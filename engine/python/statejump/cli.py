# SPDX-License-Identifier: GPL-3.0-or-later
"""The ``statejump`` command. Exit status: 0 done, 1 a tolerance is missed, 2 bad input or a failed
run, 130 interrupted."""
from __future__ import annotations

import signal
import sys
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, Callable, TypeVar

import click
from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn
from rich.table import Table

from . import __version__, _engine, compare, convergence, dem, laws, plot, reduced
from .case import Case, SpringSliderCase, UmbrellaCase, load_case
from .errors import StatejumpError, Interrupted, TolerancesMissed
from .output import results_folder

CASE = click.argument("case_file", metavar="CASE", type=click.Path(path_type=Path))
RESULTS = click.option(
    "--results", default="results", show_default=True, type=click.Path(path_type=Path),
    help="Folder that gets one folder per case.",
)
QUIET = click.option("--quiet", is_flag=True, help="Print errors only.")


def _console(quiet: bool) -> Console:
    # Units stand in square brackets, which rich would take for styles.
    console = Console(quiet=quiet, highlight=False, soft_wrap=True, markup=False)
    if not console.is_terminal:  # a pipe or a log has no width: do not cut numbers short
        console.width = 160
    return console


def _run_dem(case: SpringSliderCase, folder: Path, console: Console, label: str = "DEM") -> Any:
    """Run the DEM with a progress bar on a terminal, with a line every 10 % elsewhere."""
    if console.is_terminal:
        columns = (TextColumn("{task.description}"), BarColumn(), TextColumn("{task.percentage:>3.0f} %"),
                   TimeElapsedColumn(), TimeRemainingColumn())
        with Progress(*columns, console=console) as bar:
            task = bar.add_task(f"{label}, {dem.number_of_steps(case):,} steps", total=1.0)
            return dem.run(case, folder, lambda fraction: bar.update(task, completed=fraction))
    told = [-1]

    def line(fraction: float) -> None:
        if int(10 * fraction) > told[0]:
            told[0] = int(10 * fraction)
            console.print(f"{label}: {100 * fraction:.0f} % of {dem.number_of_steps(case):,} steps")

    return dem.run(case, folder, line)


CaseType = TypeVar("CaseType", bound=Case)


def _load(case_file: Path, kind: type[CaseType]) -> CaseType:
    """Load a case of the kind that the command is for; StatejumpError for any other."""
    case = load_case(case_file)
    if not isinstance(case, kind):
        command = click.get_current_context().info_name
        raise StatejumpError(
            f"{case_file}: case.kind = {case.kind!r} is not allowed: 'statejump {command}' is for "
            f"{kind.KIND!r}"
        )
    return case


def _number(value: float | None) -> str:
    return "none" if value is None else f"{value:.6g}"


@click.group(context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(__version__, prog_name="statejump")
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
    """Exact reduced model of CASE: events, state jump, history.

    \b
    Example:
      statejump reduced cases/table1.toml
    """
    console = _console(quiet)
    case = _load(case_file, SpringSliderCase)
    path = reduced.solve(case)
    folder = results_folder(results, case.name)
    reduced.sample(path, reduced.sample_times(case)).write_csv(folder / "reduced_history.csv")
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
    _warn(case, path, console)
    console.print(f"history: {folder / 'reduced_history.csv'}")


def _warn(case: SpringSliderCase, path: Any, console: Console) -> None:
    for warning in (*path.warnings, *reduced.warnings(case)):
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
    console = _console(quiet)
    case = _load(case_file, SpringSliderCase)
    folder = results_folder(results, case.name)
    history = _run_dem(case, folder, console)
    jump = history["displacement_m"][-1] - history["displacement_m"][0]
    console.print(f"state jump: {jump:.6e} m after {case.thermal.cycles} cycle(s)")
    console.print(f"history: {folder / 'dem_history.csv'}")


@cli.command("compare")
@CASE
@RESULTS
@QUIET
def compare_command(case_file: Path, results: Path, quiet: bool) -> None:
    """Both models of CASE side by side; exit status 1 when a tolerance is missed.

    \b
    Example:
      statejump compare cases/table1.toml
    """
    console = _console(quiet)
    case = _load(case_file, SpringSliderCase)
    path = reduced.solve(case)
    folder = results_folder(results, case.name)
    history = _run_dem(case, folder, console)
    reduced.sample(path, history["time_s"]).write_csv(folder / "reduced_history.csv")
    rows = compare.compare(case, path, history)
    compare.write_comparison(case, rows, folder)
    figures = plot.figure(case, path, history, folder)
    table = Table(title=case.title)
    for heading in ("quantity", "unit", "reduced", "DEM", "difference", "tolerance", ""):
        table.add_column(heading, justify="left" if heading in ("quantity", "unit", "") else "right")
    for row in rows:
        table.add_row(row.name, row.unit, _number(row.reduced), _number(row.dem),
                      _number(row.difference), _number(row.tolerance), "pass" if row.passed else "MISSED")
    console.print(table)
    _warn(case, path, console)
    console.print(f"results: {folder / 'comparison.json'}, {', '.join(str(name) for name in figures)}")
    missed = [row.name for row in rows if not row.passed]
    if missed:
        raise TolerancesMissed(f"{case_file}: tolerance missed: {', '.join(missed)}")


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
    console = _console(quiet)
    case = _load(case_file, SpringSliderCase)
    folder = results_folder(results, case.name)
    variants = convergence.variants(case)
    # Only the table is a result: the histories of the runs go where they vanish.
    with TemporaryDirectory(prefix="statejump-") as scratch:
        try:
            histories = [
                _run_dem(variant, Path(scratch), console, f"{number}/{len(variants)}")
                for number, variant in enumerate(variants, start=1)
            ]
        except Interrupted:
            raise Interrupted("interrupted; no table was written") from None
    convergence.write(case, convergence.rows(variants, histories), folder)
    console.print((folder / "convergence.md").read_text(encoding="utf-8"))


@cli.command("laws")
@click.argument("case_file", metavar="[CASE]", required=False, type=click.Path(path_type=Path))
@RESULTS
@QUIET
def laws_command(case_file: Path | None, results: Path, quiet: bool) -> None:
    """Catalogue of contact laws, and their curves for the joint of CASE (the paper's without).

    \b
    Example:
      statejump laws
    """
    console = _console(quiet)
    case = _load(case_file, UmbrellaCase) if case_file is not None else None
    folder = results_folder(results, "laws")
    for kind in laws.KINDS:
        table = Table(title=f"{kind} laws", show_lines=True)
        for heading in ("name", "formula", "range", "source", "holds a static load"):
            table.add_column(heading, overflow="fold")
        for law in _engine.laws(kind):
            table.add_row(law["name"], law["formula"], law["range"], law["source"],
                          "yes" if law["holds_static_load"] else "no")
        console.print(table)
    if case is None:
        written = laws.figure(laws.paper_joint(), folder, "laws")
    else:
        written = laws.figure(laws.joint_of(case), folder, f"laws_{case.name}")
    console.print(f"curves: {', '.join(str(name) for name in written)}")


def _end(function: Callable[[], None]) -> int:
    try:
        function()
    except (TolerancesMissed, Interrupted) as error:
        click.echo(str(error), err=True)
        return error.exit_status
    except StatejumpError as error:
        click.echo(f"error: {error}", err=True)
        return error.exit_status
    except click.exceptions.Exit as error:
        return int(error.exit_code)
    except click.ClickException as error:
        click.echo(f"error: {error.format_message()}", err=True)
        return 2
    except (click.exceptions.Abort, KeyboardInterrupt):
        click.echo("interrupted", err=True)
        return 130
    return 0


def main() -> None:
    """Entry point of the launcher."""
    # Ended from outside, it ends YADE and cleans up as on Ctrl-C.
    signal.signal(signal.SIGTERM, lambda number, frame: sys.exit(128 + number))
    sys.exit(_end(lambda: cli.main(standalone_mode=False)))
