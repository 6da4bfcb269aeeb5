# SPDX-License-Identifier: GPL-3.0-or-later
"""``statejump reduced``, ``dem`` and ``compare``: run one model of a case, or compare both models."""
from __future__ import annotations

from pathlib import Path

import click
from rich.console import Console

from statejump import api
from statejump.cli import studies
from statejump.cli.results import compare_files
from statejump.cli.terminal import (
    CASE, QUIET, RESULTS, CaseFile, loaded, make_console, print_comparison, print_shown, progress,
)
from statejump.core.case import Case
from statejump.core.errors import Interrupted, TolerancesMissed
from statejump.kinds.limits import check_memory, history_of
from statejump.core.results_folder import Results, ResultsFolder
from statejump.core.run import Run, warnings_of
from statejump.core.scratch import scratch
from statejump.kinds import require, running
from statejump.kinds.protocol import (
    DemInput, DynamicModel, ModelComparison, QuasiStaticModel, ReducedModel, TracedModel,
)
from statejump.report.capabilities import RunText
from statejump.results.read import is_result_file
from statejump.results.record import save


def _print_summary(case: Case, runs: dict[str, Run], console: Console) -> None:
    print_shown(require(case, RunText).summary_lines(case, runs), console)


def _warn(case: Case, runs: dict[str, Run], console: Console) -> None:
    notes = case.thermal_notes if case.has_jump else ()
    for warning in warnings_of(runs.values()):
        console.print(f"{'note' if warning in notes else 'warning'}: {warning}")


def _check(case: Case, folder: ResultsFolder, *models: str) -> None:
    """Raise NotAllowed or NotWritten, before a run, if memory or disk space is too small for the history of the run."""
    for model in models:
        check_memory(case, model)
    folder.check_space(sum(history_of(case, model).disk_bytes for model in models))


def _finish(model: str, case: Case, run: Run, folder: ResultsFolder, console: Console) -> None:
    """Write the run of one model and print its summary."""
    runs = {model: run}
    written = folder.publish([save(model, case, runs, folder.staged)])
    _print_summary(case, runs, console)
    _warn(case, runs, console)
    console.print(f"results: {written[0]}, history: {folder.path / f'{model}_history.csv'}")


DYNAMIC = click.option(
    "--dynamic", is_flag=True, help="With inertia: a truss in motion. Results go to the folder CASE_dynamic.")


def _folder_name(case: Case, dynamic: bool) -> str:
    return f"{case.name}_dynamic" if dynamic else case.name


@click.command("reduced")
@CASE
@DYNAMIC
@click.option("--quasi-static", "slow", is_flag=True,
              help="Without inertia: paths of a loaded rib. Results go to the folder CASE_quasi_static.")
@click.option("--trace", metavar="FILE", type=click.Path(path_type=Path),
              help="CSV file with a row for every iteration of the truss solver.")
@RESULTS
@QUIET
def reduced_command(case_file: Path, dynamic: bool, slow: bool, trace: Path | None, results: Results,
                    quiet: bool) -> None:
    """Reduced model of CASE: events, state jump, history.

    \b
    Examples:
      statejump reduced cases/table1.toml
      statejump reduced --dynamic cases/trusses/chain_10.toml
      statejump reduced --quasi-static cases/umbrella_bias.toml
      statejump reduced --trace trace.csv cases/trusses/chain_10.toml
    """
    console = make_console(quiet)
    if trace is not None and (dynamic or slow):
        raise click.UsageError(f"'--trace' shows the quasi-static solver of trusses, "
                               f"'{'--dynamic' if dynamic else '--quasi-static'}' runs another model.")
    if slow:
        if dynamic:
            raise click.UsageError("'--dynamic' is with inertia, '--quasi-static' without.")
        _quasi_static(loaded(case_file, QuasiStaticModel), results, console)
        return
    case = loaded(case_file, DynamicModel if dynamic else ReducedModel if trace is None else TracedModel)
    with results.folder(_folder_name(case, dynamic), case) as folder:
        _check(case, folder, "reduced")
        try:
            with progress(console, "reduced model") as on_progress:
                run = case.reduced(on_progress, dynamic=dynamic, trace=trace)
        except Interrupted as stopped:
            raise _kept("reduced", "reduced", case, {}, folder, stopped) from None
        _finish("reduced", case, run, folder, console)
    if trace is not None:
        console.print(f"trace: {trace}")


def _quasi_static(case: Case, results: Results, console: Console) -> None:
    with results.folder(f"{case.name}_quasi_static", case) as folder:
        found = case.quasi_static()
        written = folder.publish(found.write(folder.staged))
    print_shown(found.summary_lines(), console)
    for warning in found.warnings:
        console.print(f"warning: {warning}")
    console.print(f"results: {', '.join(str(path) for path in written)}")


def _dem(command: str, case: Case, before: dict[str, Run], folder: ResultsFolder, console: Console) -> Run:
    """Run the DEM. If it is interrupted, write its samples together with the earlier runs of the command."""
    try:
        with progress(console, "DEM") as on_progress:
            return case.dem(on_progress)
    except Interrupted as stopped:
        raise _kept(command, "dem", case, before, folder, stopped) from None


def _kept(command: str, model: str, case: Case, before: dict[str, Run], folder: ResultsFolder,
          stopped: Interrupted) -> Interrupted:
    """Write the samples of an interrupted run; return the error that reports where they are."""
    if not isinstance(stopped.run, Run):
        return stopped
    written = folder.publish([save(command, case, {**before, model: stopped.run}, folder.staged)])
    return Interrupted(code="samples_interrupted", samples=len(stopped.run), kept=written[0])


@click.command("dem")
@CASE
@click.option("--keep-input", "kept", metavar="FOLDER", type=click.Path(path_type=Path),
              help="Folder that gets the YADE script and the data of the run; prints the command that repeats the run.")
@click.option("--view", "viewed", is_flag=True, help="Open YADE's 3-D view of the scene in place of a run.")
@RESULTS
@QUIET
def dem_command(case_file: Path, kept: Path | None, viewed: bool, results: Results, quiet: bool) -> None:
    """DEM run of CASE in YADE: history.

    \b
    Examples:
      statejump dem cases/table1.toml
      statejump dem cases/table1.toml --keep-input table1_input
      statejump dem cases/table1.toml --view
    """
    console = make_console(quiet)
    case = loaded(case_file, DemInput)
    if viewed:
        _view(case, kept)
        return
    with results.folder(case.name, case) as folder:
        _check(case, folder, "dem")
        if kept is not None:
            command = running.keep_input(case, kept)
            console.print(f"input of the DEM run: {kept}; to repeat the run:")
            console.print(command, soft_wrap=True, highlight=False)
        _finish("dem", case, _dem("dem", case, {}, folder, console), folder, console)


def _view(case: Case, kept: Path | None) -> None:
    """Open YADE's 3-D view."""
    case.check_dem()
    if kept is not None:
        running.view(case, kept)
        return
    with scratch() as folder:
        running.view(case, folder)


@click.command("compare")
@click.argument("files", metavar="CASE|FILE FILE", nargs=-1, required=True, type=CaseFile())
@DYNAMIC
@click.option("--fe", "finite", is_flag=True, help="With finite elements in CalculiX as a third column.")
@RESULTS
@QUIET
def compare_command(files: tuple[Path, ...], dynamic: bool, finite: bool, results: Results, quiet: bool) -> None:
    """Both models of CASE side by side, or two result files of the same case. The exit status is 1 when a
    tolerance is missed, 2 when the files are of different cases.

    \b
    Examples:
      statejump compare cases/table1.toml
      statejump compare --dynamic cases/trusses/chain_10.toml
      statejump compare --fe cases/table1.toml
      statejump compare results/table1/reduced.h5 results/table1/dem.h5
    """
    console = make_console(quiet)
    if len(files) > 1 or is_result_file(files[0]):
        if dynamic or finite:
            option = "--dynamic" if dynamic else "--fe"
            raise click.UsageError(f"'{option}' is for a case, result files say themselves what ran.")
        compare_files(files, console)
    else:
        _compare_case(files[0], dynamic, finite, results, console)


def _compare_case(case_file: Path, dynamic: bool, finite: bool, results: Results, console: Console) -> None:
    from statejump.core.figures import save as save_figure  # matplotlib, 0.4 s; compare alone draws
    case = loaded(case_file, ModelComparison, DemInput, *([DynamicModel] if dynamic else []))
    calculix = studies.module("studies.calculix") if finite else None
    if calculix is not None:
        calculix.check(case)
    case.check_dem()
    with results.folder(_folder_name(case, dynamic), case) as folder:
        _check(case, folder, "reduced", "dem")
        with progress(console, "reduced model") as on_progress:
            reduced = case.reduced(on_progress, dynamic=dynamic)
        # CalculiX runs before YADE, so that its errors appear early.
        elements = None if calculix is None else calculix.answer(case)
        dem = _dem("compare", case, {"reduced": reduced}, folder, console)
        comparison = api.compare(reduced, dem)
        if elements is not None:
            comparison = comparison.with_fe(elements.rows, elements.notes)
        runs = dict(comparison.models)
        files = comparison.write(folder.staged)
        figures = save_figure(comparison.plot(), folder.staged, case.name)
        written = folder.publish(
            [save("compare", case, runs, folder.staged, comparison), files[0], *figures])
    _print_summary(case, runs, console)
    print_comparison(case.title, comparison.rows, console)
    for note in comparison.notes:
        console.print(note)
    for reason in comparison.reasons:
        console.print(f"may be why: {reason}")
    _warn(case, runs, console)
    console.print(f"results: {', '.join(str(name) for name in written)}")
    if not comparison.passed:
        raise TolerancesMissed(comparison.missed, file=case_file)
