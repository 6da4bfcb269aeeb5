# SPDX-License-Identifier: GPL-3.0-or-later
"""A finished campaign: table, statistics, figures, files."""
from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Any

from statejump.campaign import execute
from statejump.campaign.execute import Statistics
from statejump.campaign.journal import Journal, Kept
from statejump.campaign.plan import Plan
from statejump.campaign.summary import COLUMNS, shown, summary, write_summary
from statejump.campaign.tables import Table, make_table, write_csv, write_hdf5
from statejump.core.errors import Interrupted
from statejump.core.later import Later
from statejump.core.progress import OnProgress
from statejump.core.tables import Shown, html_table, write_json
from statejump.core.yade_process import find_yade

if TYPE_CHECKING:
    import pandas
    from matplotlib.figure import Figure

    from statejump.core.case import Case

_FIGURES, _SAVED = Later("statejump.campaign.plots:figures"), Later("statejump.core.figures:save")


@dataclass(frozen=True)
class Campaign:
    """A finished campaign.

    :param plan: plan of the campaign
    :param table: varied keys and outcomes of every sample
    :param done: number of workers and run time [s]
    """

    plan: Plan
    table: Table
    done: Statistics

    @property
    def name(self) -> str:
        """Name of the campaign and of its results folder."""
        return self.plan.name

    @property
    def case(self) -> Case:
        """The case without variation."""
        return self.plan.case

    def __len__(self) -> int:
        return self.plan.samples

    def frame(self) -> pandas.DataFrame:
        """Return one row per sample: varied keys, outcomes with units in their names, and ``error``, the reason of a
        failure. An outcome is NaN if its event did not happen or if the sample failed."""
        return self.table.frame()

    @cached_property
    def _summary(self) -> dict[str, Any]:
        return summary(self.plan, self.table)

    def summary(self) -> dict[str, Any]:
        """Return mean, standard deviation, quantiles and extremes of every outcome and every varied key, their rank
        correlations, and the number of failures of each kind."""
        return self._summary

    @property
    def failed(self) -> int:
        """Samples that failed."""
        return int(self.table.failed.sum())

    def plot(self, name: str | None = None) -> Figure:
        """Draw the campaign: outcomes along the grid of a sweep, or the distributions of random samples.

        :param name: ``distributions`` or ``correlations`` for random samples, ``sweep`` for a grid
        :raises ValueError: there is no such figure, or every sample failed
        """
        found = _FIGURES(self.plan, self.table)
        if not found:
            raise ValueError("nothing to draw: every sample failed")
        if name is not None and name not in found:
            raise ValueError(f"name = {name!r} is not allowed: must be {' or '.join(map(repr, found))}")
        return found[name or next(iter(found))]

    def summary_lines(self) -> list[Shown | str]:
        """Return the tables and lines that a command prints."""
        found, done = self.summary(), self.done
        rows = [(name, *(shown(entry[key]) for key in COLUMNS)) for name, entry in found["outcomes"].items()]
        lines: list[Shown | str] = [
            Shown(self.plan.title, ("outcome", *COLUMNS.values()), rows, left=("outcome",))
        ]
        lines += [f"note: {note}" for note in self.plan.case.thermal_notes]
        if done.note:
            lines.append(f"warning: {done.note}")
        if done.already_there:
            lines.append(f"{done.already_there:,} samples were there already")
        if done.run_now:
            lines.append(
                f"{done.run_now:,} samples in {done.wall_time_s:.2f} s on {done.workers} worker(s), "
                + (f"{done.start_time_s:.2f} s of it to start them, " if done.start_time_s else "") +
                f"{shown(done.samples_per_second)} per second; {len(done.batch_sizes)} tasks of up to "
                f"{max(done.batch_sizes)} samples"
            )
        return lines + [f"failed: {entry['samples']:,} sample(s): {entry['sentence']}" for entry in found["failures"]]

    def write(self, folder: Path) -> list[Path]:
        """Write tables, summary, figures, and data about how the campaign ran; return the paths of the results."""
        csv, hdf5 = folder / "samples.csv", folder / "samples.h5"
        write_csv(self.table, csv)
        write_hdf5(self.plan, self.table, hdf5)
        written = [csv, hdf5, *write_summary(self.plan, self.summary(), folder)]
        for name, figure in _FIGURES(self.plan, self.table).items():
            written += _SAVED(figure, folder, name)
        self._write_run(folder)
        return written

    def _write_run(self, folder: Path) -> None:
        """Write data about the execution, such as the workers, into a separate file; no result depends on them."""
        done = self.done
        write_json(folder / "run.json", {
            "samples_already_there": done.already_there, "samples_run": done.run_now, "workers": done.workers,
            "wall_time_s": done.wall_time_s, "start_time_s": done.start_time_s, "worker_time_s": done.worker_time_s,
            "samples_per_second": done.samples_per_second, "tasks": len(done.batch_sizes),
            "largest_batch": max(done.batch_sizes, default=0),
        })

    def __repr__(self) -> str:
        counts = f"{len(self):,} samples, {self.failed:,} failed"
        return f"Campaign({self.plan.command} of {self.plan.case.name!r}, {counts})"

    def _repr_html_(self) -> str:
        found = self.summary()
        rows = [(name, *(shown(entry[key]) for key in COLUMNS)) for name, entry in found["outcomes"].items()]
        failures = "".join(
            f"<p>failed: {entry['samples']:,} sample(s): {escape(entry['sentence'])}</p>" for entry in found["failures"]
        )
        title = f"{self.plan.title}: {len(self):,} samples"
        return f"<h4>{escape(title)}</h4>{html_table(('outcome', *COLUMNS.values()), rows)}{failures}"


def run(plan: Plan, workers: int | None, on_progress: OnProgress) -> Campaign:
    """Run a campaign that leaves no files."""
    kept = Kept()
    _check_yade(plan, None)
    done = execute.run_missing(plan, kept, None, workers, on_progress)
    return Campaign(plan, make_table(plan, kept.batches), done)


def run_in(
    plan: Plan, folder: Path, scheduler: str | None, workers: int | None, restart: bool, on_progress: OnProgress
) -> Campaign:
    """Run the samples that are missing in the journal of a results folder.

    :raises Interrupted: Ctrl-C was pressed; finished samples are stored
    """
    _check_yade(plan, scheduler)
    with Journal(folder, plan, restart) as kept:
        try:
            done = execute.run_missing(plan, kept, scheduler, workers, on_progress)
            done.note = kept.note or ""
        except KeyboardInterrupt:
            finished = sum(index < plan.samples for index in kept.finished)
            raise Interrupted(code="campaign_interrupted", finished=finished, samples=plan.samples,
                              path=kept.path) from None
        return Campaign(plan, make_table(plan, kept.batches), done)


def _check_yade(plan: Plan, scheduler: str | None) -> None:
    """Raise FailedRun, before workers start, if DEM samples would run on this machine but YADE is missing."""
    if plan.model == "dem" and scheduler is None:
        find_yade()
