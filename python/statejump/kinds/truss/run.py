# SPDX-License-Identifier: GPL-3.0-or-later
"""What ``statejump reduced``, ``dem`` and ``compare`` do with a ``truss`` case."""
from __future__ import annotations

from pathlib import Path

import numpy as np
from rich.console import Console
from rich.table import Table

from statejump.kinds.truss.case import TrussCase
from statejump.core.comparison import Quantity
from statejump.core.yade_process import DemRun
from statejump.core.errors import Interrupted
from statejump.kinds.truss import result as kind_truss
from statejump.results.contents import ModelRun
from statejump.results.record import Record
from statejump.cli.terminal import print_comparison, progress
from statejump.kinds.truss import compare, dem, figure as plot
from statejump.kinds.truss.solve import TrussPath, solve


def path_of(case: TrussCase, console: Console) -> TrussPath:
    """Return the quasi-static path, with progress. :raises Interrupted: Ctrl-C"""
    with progress(console, "quasi-static path") as report:

        def told(share: float) -> bool:
            report(share)
            return True

        path = solve(case, told)
    if not path.complete:
        raise Interrupted("interrupted; nothing was written")
    return path


def _sample_times(case: TrussCase) -> np.ndarray:
    """Times of the DEM's samples [s]."""
    cycles = case.thermal.cycles
    return np.linspace(0, case.period_s * cycles, case.samples_per_cycle * cycles + 1)


def reduced(case: TrussCase, record: Record, console: Console) -> None:
    """Run the quasi-static solver and print jumps, events and energy residue."""
    path = path_of(case, console)
    run = record.models["reduced"] = kind_truss.reduced_run(case, path, _sample_times(case))
    print_jumps(case, run, console)
    console.print(f"{path.solves:,} solves, {len(path.events)} changes of joints, {path.unknowns} unknowns")


def run_dem(case: TrussCase, path: TrussPath, record: Record, console: Console) -> DemRun:
    """Run the DEM, with progress."""
    with progress(console, f"DEM, {dem.number_of_steps(case, path):,} steps") as report:
        return dem.run(case, path, record.folder, report, record.keep)


def only_dem(case: TrussCase, record: Record, console: Console) -> DemRun:
    """Run the DEM from the equilibrium of the solver and print jumps, events and energy residue."""
    dem.check(case)
    done = run_dem(case, path_of(case, console), record, console)
    print_jumps(case, kind_truss.dem_run(case, done), console)
    return done


def both(case: TrussCase, record: Record, console: Console) -> tuple[list[Quantity], list[Path]]:
    """Run both models, print jumps side by side and the comparison."""
    dem.check(case)
    path = path_of(case, console)
    ours = record.models["reduced"] = kind_truss.reduced_run(case, path, _sample_times(case))
    done = run_dem(case, path, record, console)
    ours = record.models["reduced"] = kind_truss.reduced_run(case, path, done.history["time_s"])
    record.add_dem(done)
    other = record.models["dem"]
    rows = compare.compare(case, ours, other)
    figures = plot.figure(case, ours, other, record.folder)
    print_jumps(case, ours, console, other)
    print_comparison(case.title, rows, console, ("solver", "DEM"))
    return rows, figures


def print_jumps(case: TrussCase, run: ModelRun, console: Console, dem_run: ModelRun | None = None) -> None:
    """Print the nodes that jump most, the number of events and the energy residue."""
    table = Table(title=f"{case.title}: state jump after {case.thermal.cycles} cycle(s)")
    table.add_column("node")
    axes = "xyz"[: case.truss.dimension]
    headings = [f"along {axis} [m]" for axis in axes] + ["length [m]"]
    for heading in headings + (["DEM, length [m]"] if dem_run is not None else []):
        table.add_column(heading, justify="right")
    others = None if dem_run is None else np.linalg.norm(compare.jumps_m(dem_run), axis=1)
    numbers = {node.name: place for place, node in enumerate(case.node)}
    for name, x, y, z, length in compare.jump_table(case, run):
        row = [name, *(f"{value:.6e}" for value in (x, y, z)[: case.truss.dimension]), f"{length:.6e}"]
        table.add_row(*row, *([] if others is None else [f"{others[numbers[name]]:.6e}"]))
    console.print(table)
    for model, found in ((None, run),) if dem_run is None else (("solver", run), ("DEM", dem_run)):
        label = f"{model}: " if model else ""
        console.print(f"{label}{len(found.events)} events, energy residue {found.summary['energy_residue_J'].value:.3g} J")
