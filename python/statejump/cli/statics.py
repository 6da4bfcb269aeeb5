# SPDX-License-Identifier: GPL-3.0-or-later
"""``statejump statics``: rest positions of a loaded joint."""
from __future__ import annotations

from pathlib import Path

import click

from statejump import api
from statejump.cli.terminal import CASE, QUIET, RESULTS, loaded, make_console, print_shown
from statejump.control.capabilities import JointStatics
from statejump.core.results_folder import Results


@click.command("statics")
@CASE
@RESULTS
@QUIET
def statics_command(case_file: Path, results: Results, quiet: bool) -> None:
    """Where the joint of CASE can rest: parts, measure, and the largest jump that friction allows.

    \b
    Example:
      statejump statics cases/statics_journal.toml
    """
    console = make_console(quiet)
    case = loaded(case_file, JointStatics)
    with results.folder(case.name, case) as folder:
        statics = api.statics(case)
        written = folder.publish(statics.write(folder.staged))
    print_shown(statics.summary_lines(), console)
    console.print(f"results: {', '.join(str(path) for path in written)}")
