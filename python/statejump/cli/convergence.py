# SPDX-License-Identifier: GPL-3.0-or-later
"""``statejump convergence``: how the DEM approaches the reduced model."""
from __future__ import annotations

from pathlib import Path

import click

from statejump.cli.terminal import CASE, QUIET, RESULTS, loaded, make_console, progress
from statejump.core.output import results_folder


@click.command("convergence")
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
    case = loaded(case_file, "convergence")
    folder = results_folder(results, case.name)
    with progress(console, "convergence") as tell:
        found = case.behaviour.ability("convergence", case)(case, tell)
    _, text = found.write(folder)
    console.print(text.read_text(encoding="utf-8"))
