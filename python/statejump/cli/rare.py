# SPDX-License-Identifier: GPL-3.0-or-later
"""``statejump rare``: the small probability that an outcome of a campaign is beyond a limit."""
from __future__ import annotations

import json
from pathlib import Path

import click

from statejump.campaign.campaign_file import load_campaign
from statejump.campaign.plan import MONTECARLO
from statejump.campaign.rare.calls import VARIATION, event_of, run
from statejump.campaign.rare.kept import Kept
from statejump.campaign.rare.model import METHODS
from statejump.cli.terminal import QUIET, RESULTS, CaseFile, make_console, print_shown, progress, since_start_s
from statejump.core.errors import Interrupted, NotAllowed, located
from statejump.core.results_folder import Results

OPTIONS = ("outcome", "above", "method", "runs", "variation", "sobol", "workers")


@click.command("rare")
@click.argument("file", metavar="CAMPAIGN", type=CaseFile())
@click.option("--outcome", required=True, metavar="NAME", help="Outcome of the campaign, for example state_jump_m.")
@click.option("--above", type=float, metavar="VALUE", help="Limit, in the unit of the outcome; larger values count.")
@click.option("--below", type=float, metavar="VALUE", help="Limit, in the unit of the outcome; smaller values count.")
@click.option("--method", default="form", show_default=True, metavar="NAME",
              help="form: FORM, then importance sampling. subset: subset simulation.")
@click.option("--runs", type=int, metavar="N", help="Most runs of importance sampling, or runs per level of subset "
              "simulation.  [default: 5000, 1000]")
@click.option("--variation", type=float, default=VARIATION, show_default=True, metavar="V",
              help="Coefficient of variation at which importance sampling ends.")
@click.option("--sobol", type=int, default=0, metavar="N", help="Sobol indices of the outcome, with N times the number "
              "of random variables plus two runs.")
@click.option("--workers", type=int, metavar="N", help="Processes for importance sampling.  [default: this process]")
@click.option("--scheduler", metavar="ADDRESS", help="Dask scheduler for importance sampling, as tcp://host:8786.")
@click.option("--restart", is_flag=True, help="Drop finished runs of an earlier command.")
@click.option("--json", "as_json", is_flag=True, help="Print the result as JSON.")
@RESULTS
@QUIET
def rare_command(
    file: Path, outcome: str, above: float | None, below: float | None, method: str, runs: int | None,
    variation: float, sobol: int, workers: int | None, scheduler: str | None, restart: bool, as_json: bool,
    results: Results, quiet: bool,
) -> None:
    """The small probability that an outcome of a Monte Carlo CAMPAIGN is beyond a limit, with its interval.

    \b
    Example:
      statejump rare cases/campaigns/table1_tolerances.toml --outcome state_jump_m --above 47e-6
    """
    console = make_console(quiet or as_json)
    plan = load_campaign(file, MONTECARLO)
    try:
        with located(file=file):
            event = event_of(plan, outcome, above, below)
            with results.folder(f"{plan.name}_rare") as folder:
                kept = Kept(plan, folder.path, restart)
                try:
                    with progress(console, f"{plan.name}, {METHODS.get(method, method)}") as on_progress:
                        found = run(plan, event, method, runs, variation, sobol, on_progress, kept, workers, scheduler)
                except (KeyboardInterrupt, Interrupted):
                    raise Interrupted(code="rare_interrupted", finished=len(kept.samples), path=kept.path) from None
                finally:
                    kept.close()
                written = folder.publish(found.write(folder.staged))
    except NotAllowed as refused:
        refused.key = f"--{refused.key}" if refused.key in OPTIONS else refused.key
        raise
    if as_json:
        click.echo(json.dumps(found.record(), indent=1))
    print_shown(found.summary_lines(), console)
    console.print(f"results: {', '.join(str(path) for path in written)}")
    console.print(f"wall time: {since_start_s():.1f} s")
