# SPDX-License-Identifier: GPL-3.0-or-later
"""``statejump design``: variables of least cost that meet requirements."""
from __future__ import annotations

import json
from pathlib import Path

import click

from statejump.cli.terminal import CASE, QUIET, RESULTS, loaded, make_console, print_shown, progress, since_start_s
from statejump.control.capabilities import TrussDesign
from statejump.core.errors import Interrupted
from statejump.core.results_folder import Results
from statejump.kinds import require


@click.command("design")
@CASE
@click.argument("design_file", metavar="DESIGN", type=click.Path(path_type=Path))
@click.option("--json", "as_json", is_flag=True, help="Print the result as JSON.")
@RESULTS
@QUIET
def design_command(case_file: Path, design_file: Path, as_json: bool, results: Results, quiet: bool) -> None:
    """Variables of least cost with which CASE meets the requirements of a DESIGN file, over friction and clearances.

    After Ctrl-C, the files contain the best design so far.

    \b
    Example:
      statejump design umbrella_5.toml cases/designs/umbrella_5.toml
    """
    console = make_console(quiet or as_json)
    case = loaded(case_file, TrussDesign)
    with results.folder(f"{case.name}_design", case) as folder:
        with progress(console, f"{case.name}, design") as on_progress:
            found = require(case, TrussDesign).design(case, design_file, on_progress)
        written = folder.publish(found.write(folder.staged))
    if as_json:
        click.echo(json.dumps(found.record(), indent=1))
    print_shown(found.summary_lines(), console)
    console.print(f"results: {', '.join(str(path) for path in written)}")
    console.print(f"wall time: {since_start_s():.1f} s")
    if found.interrupted:
        raise Interrupted(code="design_interrupted", path=str(written[0]))
