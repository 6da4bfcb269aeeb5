# SPDX-License-Identifier: GPL-3.0-or-later
"""``statejump modes``: natural frequencies and mode shapes."""
from __future__ import annotations

from pathlib import Path

import click

from statejump.cli.terminal import CASE, QUIET, RESULTS, loaded, make_console, print_shown
from statejump.control.capabilities import VibrationModes
from statejump.core.errors import NotAllowed
from statejump.core.results_folder import Results
from statejump.kinds import require


@click.command("modes")
@CASE
@click.option("--count", type=int, default=6, show_default=True, help="Number of modes, from the lowest.")
@RESULTS
@QUIET
def modes_command(case_file: Path, count: int, results: Results, quiet: bool) -> None:
    """Natural frequencies and mode shapes of CASE about its first equilibrium, every joint held.

    \b
    Examples:
      statejump modes cases/trusses/boom.toml
      statejump modes cases/trusses/mast_6.toml --count 12
    """
    console = make_console(quiet)
    case = loaded(case_file, VibrationModes)
    with results.folder(f"{case.name}_modes", case) as folder:
        try:
            found = require(case, VibrationModes).modes(case, count)
        except NotAllowed as refused:
            refused.key = "--count" if refused.key == "count" else refused.key
            raise
        written = folder.publish(found.write(folder.staged))
    print_shown(found.summary_lines(), console)
    console.print(f"results: {', '.join(str(path) for path in written)}")
