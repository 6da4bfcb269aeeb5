# SPDX-License-Identifier: GPL-3.0-or-later
"""``statejump figures``: run everything and write each file as soon as its runs are there."""
from __future__ import annotations

from contextlib import contextmanager
from functools import partial
from pathlib import Path
from typing import Callable, Iterator

import click
from rich.console import Console

from statejump.kinds.umbrella.case import UmbrellaCase
from statejump.core.errors import Interrupted, StatejumpError
from statejump.core.output import results_folder
from statejump.cli.terminal import QUIET, RESULTS, counted, load_kind, make_console, progress
from statejump.kinds.umbrella import dem, reduced as model
from statejump.paper import claims
from statejump.paper.figures.drawing import figure_13, figure_of
from statejump.paper.figures.files import write_claims, write_curves, write_ensembles
from statejump.paper.figures.findings import findings_of
from statejump.paper.figures.runs import Part, Study, Variant, first_contacts, run_variants, stiffness_jumps, studies


def make(case: UmbrellaCase, case_file: Path, folder: Path, part: Part) -> tuple[claims.Findings, list[Path]]:
    """Run everything; write each file as soon as its runs are there.

    :param case_file: named in the text
    :param part: gets the name and the number of runs of a part, see :func:`_part`
    :raises Interrupted: Ctrl-C; names the files that are finished
    """
    if case.start.mode == "loaded":
        raise StatejumpError(
            f"case {case.name}: start.mode = 'loaded' is not allowed: the figures vary what would load the joint"
        )
    case = model.for_ensemble(case)
    written: list[Path] = []
    try:
        known: dict[str, Variant] = {}
        itself = Study("fig13", "joint.radial_clearance_m", (case.joint.radial_clearance_m,), "", "", "")
        (base,) = run_variants(case, itself, known, part)
        with part("fig13, DEM ensemble", case.ensemble.dem_runs) as step:
            dem_ensemble = dem.ensemble(case, progress=step)
        written += figure_13(base, dem_ensemble, case.title, folder)
        done = []
        for study in studies(case):
            variants = run_variants(case, study, known, part)
            written += figure_of(study, variants, case.title, folder)
            done.append((study, variants))
            write_curves(done, folder)
            write_ensembles(done, dem_ensemble, base, folder)
        contacts = first_contacts(case, [variant.value for variant in done[0][1]], part)
        stiffness = stiffness_jumps(case, base, part)
        findings = findings_of(case, done, base, dem_ensemble, contacts, stiffness)
        write_claims(case, case_file, findings, folder)
    except (KeyboardInterrupt, Interrupted):
        finished = ", ".join(path.name for path in written if path.suffix == ".png") or "nothing"
        raise Interrupted(f"interrupted; finished in {folder}: {finished}") from None
    written += [folder / name for name in ("curves.csv", "ensembles.csv", "ensembles.json", "README.md")]
    return findings, written


@contextmanager
def _part(console: Console, text: str, runs: int) -> Iterator[Callable[[], None]]:
    """Yield what to call after each run: moves a bar on a terminal; elsewhere one line per part."""
    if not console.is_terminal:
        console.print(f"{text}: {runs} runs")
        yield lambda: None
        return
    with progress(console, f"{text}, {runs} runs") as tell:
        yield counted(tell, runs)


@click.command("figures")
@click.argument("case_file", metavar="[CASE]", default="cases/umbrella.toml", type=click.Path(path_type=Path))
@RESULTS
@QUIET
def figures_command(case_file: Path, results: Path, quiet: bool) -> None:
    """Figures 13 to 16 of the paper for CASE, both models, and a test of each of its claims.

    \b
    Example:
      statejump figures cases/umbrella.toml
    """
    console = make_console(quiet)
    case = load_kind(case_file, UmbrellaCase)
    folder = results_folder(results, case.name)
    findings, written = make(case, case_file, folder, partial(_part, console))
    for claim in claims.all_claims(findings):
        console.print(f"{claim.verdict}: {claim.statement}")
    console.print(f"results: {', '.join(str(path) for path in written)}")
