# SPDX-License-Identifier: GPL-3.0-or-later
"""``statejump bounds``: guaranteed bounds of the state jump over any temperature history."""
from __future__ import annotations

import json
from pathlib import Path

import click

from statejump.cli.terminal import CASE, QUIET, RESULTS, loaded, make_console, print_shown
from statejump.control.capabilities import RestBounds
from statejump.core.errors import NotAllowed
from statejump.core.results_folder import Results
from statejump.kinds import require

OPTIONS = {"output": "--output", "range": "--range"}


@click.command("bounds")
@CASE
@click.option("--output", multiple=True, metavar="WHAT", help="node:NAME, node:NAME.x, node:NAME.xy, rms, tilt, "
              "zernike:K or point; default: the nodes that may differ most. May be given several times.")
@click.option("--range", "range_K", metavar="LOW:HIGH", help="ΔT [K] of every member, each by itself, for example "
              "-80:60; default: the programs of the case.")
@click.option("--attain", is_flag=True, help="Write and simulate the history that attains each bound.")
@click.option("--simulate/--no-simulate", default=None, help="Simulate the case itself for comparison; default: up to "
              "100 joints.")
@click.option("--json", "as_json", is_flag=True, help="Print the bounds as JSON.")
@RESULTS
@QUIET
def bounds_command(case_file: Path, output: tuple[str, ...], range_K: str | None, attain: bool, simulate: bool | None,
                   as_json: bool, results: Results, quiet: bool) -> None:
    """How far CASE can come back from its first shape, whatever the temperature history, and why not farther.

    \b
    Examples:
      statejump bounds cases/trusses/chain_10.toml --attain
      statejump bounds cases/trusses/latch_boom.toml --output node:C.y --range -80:60
    """
    console = make_console(quiet or as_json)
    case = loaded(case_file, RestBounds)
    with results.folder(f"{case.name}_bounds", case) as folder:
        try:
            found = require(case, RestBounds).bounds(case, output, range_K, attain, simulate)
        except NotAllowed as refused:
            refused.key = OPTIONS.get(refused.key or "", refused.key)
            raise
        written = folder.publish(found.write(folder.staged))
    if as_json:
        click.echo(json.dumps(found.record(), indent=1))
    print_shown(found.summary_lines(), console)
    console.print(f"results: {', '.join(str(path) for path in written)}")
