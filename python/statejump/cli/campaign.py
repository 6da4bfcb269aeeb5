# SPDX-License-Identifier: GPL-3.0-or-later
"""``statejump montecarlo`` and ``statejump sweep``: many samples of one case."""
from __future__ import annotations

from pathlib import Path

import click

from statejump.campaign.campaign_file import check_workers, load_campaign
from statejump.campaign.plan import MONTECARLO, SWEEP
from statejump.cli.terminal import QUIET, RESULTS, CaseFile, make_console, print_shown, progress
from statejump.core.errors import FailedRun, NotAllowed
from statejump.core.results_folder import Results


def _command(name: str, text: str) -> click.Command:
    @click.command(name, help=text)
    @click.argument("file", metavar="CAMPAIGN", type=CaseFile())
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
        quiet: bool,
    ) -> None:
        from statejump.campaign.result import run_in
        from statejump.campaign.yade_batch import write_table

        console = make_console(quiet)
        check_workers("--workers", workers)
        if workers is not None and scheduler is not None:
            raise NotAllowed("--workers", beside="with --scheduler", cause="that cluster has its own")
        plan = load_campaign(file, name)
        if table is not None:
            write_table(plan, table)
            console.print(f"table of {plan.samples:,} samples: {table}")
            return
        with results.folder(plan.name) as folder:
            with progress(console, f"{plan.name}, {plan.samples:,} samples") as tell:
                campaign = run_in(plan, folder.path, scheduler, workers, restart, tell)
            written = folder.publish(campaign.write(folder.staged))
        print_shown(campaign.told(), console)
        console.print(f"results: {', '.join(str(path) for path in written)}")
        if campaign.failed == plan.samples:
            raise FailedRun("every sample failed, the first one", file=file,
                            cause=campaign.summary()["failures"][0]["first_sentence"])

    return command


montecarlo_command = _command(MONTECARLO, """Samples of a case whose parameters are random, either model.

\b
Example:
  statejump montecarlo cases/campaigns/table1_tolerances.toml
""")

sweep_command = _command(SWEEP, """A case on a grid of its parameters, either model.

\b
Example:
  statejump sweep cases/campaigns/table1_friction.toml
""")
