# SPDX-License-Identifier: GPL-3.0-or-later
"""``statejump montecarlo`` and ``statejump sweep``: many samples of one case on Dask's distributed."""
from __future__ import annotations

import json
from pathlib import Path
from typing import Any, Callable, Optional

import click
import rich.table
from rich.console import Console

from statejump.core import yade_process as dem
from statejump.core.errors import FailedRun, Interrupted, StatejumpError
from statejump.core.output import results_folder, write_atomically
from statejump.cli.terminal import CaseFile, QUIET, RESULTS, make_console, progress
from statejump.campaign import campaign_file, yade_batch
from statejump.campaign.campaign_file import MONTECARLO, SWEEP, Campaign

# Heavy modules (distributed, h5py, matplotlib) are imported where a campaign is run: other commands
# and the workers do without.


def run_campaign(
    campaign: Campaign, folder: Path, scheduler: Optional[str], workers: Optional[int], restart: bool,
    console: Console,
) -> dict[str, Any]:
    """Run what is missing, write tables, summary and figures; return the summary.

    :raises Interrupted: Ctrl-C; finished samples are kept
    """
    from statejump.campaign import execute, journal, plots, summary, tables

    if campaign.model == "dem" and scheduler is None:
        dem.find_yade()
    with journal.Journal(folder, campaign, restart) as kept:
        label = f"{campaign.name}, {campaign.samples:,} samples"
        try:
            with progress(console, label) as tell:
                done = execute.run_missing(campaign, kept, scheduler, workers, tell)
        except KeyboardInterrupt:
            finished = sum(index < campaign.samples for index in kept.finished)
            raise Interrupted(
                f"interrupted; {finished:,} of {campaign.samples:,} samples are kept in {kept.path}, the same "
                "command goes on with the others"
            ) from None
        table = tables.make_table(campaign, kept.batches)
    tables.write_csv(table, folder / "samples.csv")
    tables.write_hdf5(campaign, table, folder / "samples.h5")
    found = summary.summary(campaign, table)
    summary.write_summary(campaign, found, folder)
    drawn = plots.figures(campaign, table, folder)
    _write_run(folder, done)
    _print(campaign, found, done, console)
    written = [folder / name for name in ("samples.csv", "samples.h5", "summary.md", "summary.json")] + drawn
    console.print(f"results: {', '.join(str(path) for path in written)}")
    return found


def _write_run(folder: Path, done: Any) -> None:
    """How the last run went; not part of the result, which does not depend on it."""
    sizes = done.batch_sizes
    entry = {
        "samples_already_there": done.already_there, "samples_run": done.run_now, "workers": done.workers,
        "wall_time_s": done.wall_time_s, "worker_time_s": done.worker_time_s,
        "samples_per_second": done.samples_per_second, "tasks": len(sizes),
        "largest_batch": max(sizes, default=0),
    }
    with write_atomically(folder / "run.json") as stream:
        stream.write(json.dumps(entry, indent=2) + "\n")


def _print(campaign: Campaign, found: dict[str, Any], done: Any, console: Console) -> None:
    from statejump.campaign.summary import COLUMNS, shown

    table = rich.table.Table(title=campaign.title)
    table.add_column("outcome")
    for heading in COLUMNS.values():
        table.add_column(heading, justify="right")
    for name, entry in found["outcomes"].items():
        table.add_row(name, *(shown(entry[key]) for key in COLUMNS))
    console.print(table)
    if done.already_there:
        console.print(f"{done.already_there:,} samples were there already")
    if done.run_now:
        console.print(
            f"{done.run_now:,} samples in {done.wall_time_s:.2f} s on {done.workers} worker(s), "
            f"{shown(done.samples_per_second)} per second; {len(done.batch_sizes)} tasks of up to "
            f"{max(done.batch_sizes)} samples"
        )
    for entry in found["failures"]:
        console.print(f"failed: {entry['samples']:,} sample(s): {entry['sentence']}")


def _command(name: str, text: str) -> Callable[..., click.Command]:
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
        file: Path, workers: Optional[int], scheduler: Optional[str], restart: bool, table: Optional[Path],
        results: Path, quiet: bool,
    ) -> None:
        console = make_console(quiet)
        if workers is not None and workers < 1:
            raise StatejumpError(f"--workers = {workers} is not allowed: must be at least 1")
        if workers is not None and scheduler is not None:
            raise StatejumpError("--workers is not allowed with --scheduler: that cluster has its own")
        campaign = campaign_file.load_campaign(file, name)
        if table is not None:
            yade_batch.write_table(campaign, table)
            console.print(f"table of {campaign.samples:,} samples: {table}")
            return
        found = run_campaign(
            campaign, results_folder(results, campaign.name), scheduler, workers, restart, console
        )
        if found["failed"] == campaign.samples:
            raise FailedRun(
                f"{file}: every sample failed, the first one: {found['failures'][0]['first_sentence']}"
            )

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
