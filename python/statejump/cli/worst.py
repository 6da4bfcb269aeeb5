# SPDX-License-Identifier: GPL-3.0-or-later
"""``statejump worst``: the temperature histories with the largest state jump and the largest excursion."""
from __future__ import annotations

import json
from pathlib import Path

import click

from statejump.cli.terminal import CASE, QUIET, RESULTS, loaded, make_console, print_shown, progress
from statejump.control.capabilities import WorstCases
from statejump.core.errors import NotAllowed
from statejump.core.results_folder import Results
from statejump.kinds import require


@click.command("worst")
@CASE
@click.option("--range", "range_K", required=True, metavar="LOW:HIGH", help="ΔT [K] of every member, each by itself, "
              "for example -80:60.")
@click.option("--output", multiple=True, metavar="OUTPUT", help="As of bounds; default: the displacement "
              "that may differ most. May be given several times.")
@click.option("--group", "groups", multiple=True, metavar="NAMES", help="Members with one common temperature, for "
              "example 'L1*,L20'. May be given several times.")
@click.option("--cycles", type=int, default=3, show_default=True, help="Largest number of cycles of a history.")
@click.option("--paths", type=int, default=300, show_default=True, help="Paths for each quantity of each output.")
@click.option("--seed", type=int, default=0, show_default=True, help="Of the random histories.")
@click.option("--json", "as_json", is_flag=True, help="Print the result as JSON.")
@RESULTS
@QUIET
def worst_command(case_file: Path, range_K: str, output: tuple[str, ...], groups: tuple[str, ...], cycles: int,
                  paths: int, seed: int, as_json: bool, results: Results, quiet: bool) -> None:
    """Temperature histories with the largest state jump and the largest excursion of CASE, beside their bounds.

    \b
    Examples:
      statejump worst cases/trusses/chain_10.toml --range -80:60
      statejump worst cases/trusses/umbrella_8.toml --range -60:100 --output tilt
    """
    console = make_console(quiet or as_json)
    case = loaded(case_file, WorstCases)
    with results.folder(f"{case.name}_worst", case) as folder:
        try:
            with progress(console, f"{case.name}, worst histories") as on_progress:
                found = require(case, WorstCases).worst(case, range_K, output=output, groups=groups, cycles=cycles,
                                                        paths=paths, seed=seed, on_progress=on_progress)
        except NotAllowed as refused:
            refused.key = f"--{refused.key}"
            raise
        written = folder.publish(found.write(folder.staged))
    if as_json:
        click.echo(json.dumps(found.record(), indent=1))
    print_shown(found.summary_lines(), console)
    console.print(f"results: {', '.join(str(path) for path in written)}")
