# SPDX-License-Identifier: GPL-3.0-or-later
"""``statejump montecarlo`` and ``statejump sweep``: many samples of one case."""
from __future__ import annotations

from pathlib import Path
from typing import Any, cast

import click

from statejump.campaign.campaign_file import check_workers, load_campaign, plan_for, vary_tables
from statejump.campaign.plan import MONTECARLO, SWEEP, Plan
from statejump.campaign.result import run_in
from statejump.campaign.yade_batch import write_table
from statejump.cli.terminal import QUIET, RESULTS, CaseFile, make_console, print_shown, progress, since_start_s
from statejump.core.errors import FailedRun, MissingKey, NotAllowed
from statejump.core.results_folder import Results
from statejump.kinds.loading import load_case
from statejump.schema.toml import read_toml


def _of_case(command: Any) -> Any:
    """Add to a command the options that define a campaign without a campaign file."""
    for option in reversed((
        click.option("--vary", "tables", multiple=True, type=click.Path(path_type=Path), metavar="FILE",
                     help="Of a CASE: file of [[vary]] tables, as vary.toml of 'statejump identify'."),
        click.option("--samples", type=int, default=None, metavar="N", help="Of a CASE: how many.  [default: 1000]"),
        click.option("--seed", type=int, default=None, metavar="N", help="Of a CASE: of the random numbers.  "
                     "[default: 1]"),
        click.option("--output", "outputs", multiple=True, metavar="HOW:COLUMN",
                     help="Of a CASE: more to record, as max:surface.pointing_error_rad."),
    )):
        command = option(command)
    return command


def _plan(file: Path, name: str, of_case: dict[str, Any]) -> Plan:
    """Return the campaign of a campaign file, or the one that a case and options define."""
    given = [option for option, value in of_case.items() if value not in (None, ())]
    _, data = read_toml(file, "campaign")
    if name != MONTECARLO or "case" not in data or "campaign" in data:
        for option in given:
            raise NotAllowed(option, code="conflicts_with_campaign_file", file=file)
        return load_campaign(file, name)
    if not of_case["--vary"]:
        raise MissingKey("--vary", code="vary_file_missing", file=file)
    tables = [table for path in of_case["--vary"] for table in vary_tables(path)]
    samples, seed = (default if of_case[option] is None else of_case[option]
                     for option, default in (("--samples", 1000), ("--seed", 1)))
    try:
        return plan_for(load_case(file), name, tables, samples=samples, seed=seed, asked=of_case["--output"])
    except NotAllowed as refused:
        if f"--{refused.key}".removesuffix("s") in ("--sample", "--seed", "--output"):
            refused.key = f"--{refused.key}" if refused.key != "outputs" else "--output"
        raise


def _command(name: str, text: str) -> click.Command:
    @click.command(name, help=text)
    @click.argument("file", metavar="CAMPAIGN" if name == SWEEP else "CAMPAIGN|CASE", type=CaseFile())
    @click.option("--workers", type=int, metavar="N", help="Processes on this machine.  [default: one per core]")
    @click.option("--scheduler", metavar="ADDRESS",
                  help="Dask scheduler that runs already, as tcp://host:8786, instead of a cluster on this machine.")
    @click.option("--restart", is_flag=True, help="Drop finished samples of an earlier run.")
    @click.option("--yade-batch", "table", type=click.Path(path_type=Path), metavar="FILE",
                  help="Only write a parameter table for yade-batch and yade_scripts/runner/batch_case.py.")
    @RESULTS
    @QUIET
    def command(
        file: Path, workers: int | None, scheduler: str | None, restart: bool, table: Path | None, results: Results,
        quiet: bool, tables: tuple[Path, ...] = (), samples: int | None = None, seed: int | None = None,
        outputs: tuple[str, ...] = (),
    ) -> None:
        console = make_console(quiet)
        check_workers("--workers", workers)
        if workers is not None and scheduler is not None:
            raise NotAllowed("--workers", code="conflicts_with_scheduler")
        plan = _plan(file, name, {"--vary": tables, "--samples": samples, "--seed": seed, "--output": outputs})
        if table is not None:
            write_table(plan, table)
            console.print(f"table of {plan.samples:,} samples: {table}")
            return
        with results.folder(plan.name) as folder:
            with progress(console, f"{plan.name}, {plan.samples:,} samples") as on_progress:
                campaign = run_in(plan, folder.path, scheduler, workers, restart, on_progress)
            written = folder.publish(campaign.write(folder.staged))
        print_shown(campaign.summary_lines(), console)
        console.print(f"results: {', '.join(str(path) for path in written)}")
        console.print(f"wall time: {since_start_s():.1f} s, start and figures included")
        if campaign.failed == plan.samples:
            raise FailedRun(code="every_sample_failed", file=file,
                            cause=campaign.summary()["failures"][0]["first_sentence"])

    return command if name == SWEEP else cast(click.Command, _of_case(command))


montecarlo_command = _command(MONTECARLO, """Samples of a case whose parameters are random, either model.

\b
Examples:
  statejump montecarlo cases/campaigns/table1_tolerances.toml
  statejump montecarlo mast.toml --vary results/identify_hinge/vary.toml --output max:surface.rms_rigid_m
""")

sweep_command = _command(SWEEP, """A case on a grid of its parameters, either model.

\b
Example:
  statejump sweep cases/campaigns/table1_friction.toml
""")
