# SPDX-License-Identifier: GPL-3.0-or-later
"""``statejump convergence``: how the DEM approaches the reduced model."""
from __future__ import annotations

from pathlib import Path

import click

from statejump.cli.terminal import CASE, QUIET, RESULTS, loaded, make_console, progress
from statejump.control.capabilities import ConvergenceStudy
from statejump.core.results_folder import Results
from statejump.kinds import require


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
    case = loaded(case_file, ConvergenceStudy)
    case.check_dem()
    with results.folder(case.name, case) as folder:
        with progress(console, "convergence") as tell:
            found = require(case, ConvergenceStudy).convergence(case, tell, decades)
        _, text = folder.publish(found.write(folder.staged))
    console.print(text.read_text(encoding="utf-8"))
