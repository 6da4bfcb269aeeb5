#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Compares the results of the shipped cases on two machines, releases or builds, value by value.

    PYTHONPATH=build/python scripts/shipped_results.py run FOLDER [--model dem] [--case NAME ...] [--yade-loop]
    PYTHONPATH=build/python scripts/shipped_results.py compare FIRST SECOND

``run`` writes a result file of every shipped case that the model supports to FOLDER/MODEL/CASE. Existing results are
kept, so an interrupted call can be continued. With ``--yade-loop``, YADE's own loop runs the DEM; otherwise the stepper
that the case names. ``compare`` prints a Markdown table with a row per case and model: count of numbers, count of
numbers that differ in any bit, the column with the largest difference, this difference, and the column's largest value.
Exit status 1: a number differs, or one folder lacks a file.
"""
from __future__ import annotations

import argparse
import sys
import time
from pathlib import Path

import numpy as np
import statejump as sj
from statejump import _paths
from statejump.core.run import GROUPS, Run
from statejump.core.tables import markdown
from statejump.results.record import FILES, save
from statejump.results.layout import SUFFIX

HEADER = ("case", "numbers", "that differ", "largest difference / largest value")


def shipped() -> list[Path]:
    """Return the files of the shipped cases."""
    folder = _paths.SHARE / "cases"
    return sorted([*folder.glob("*.toml"), *folder.glob("trusses/*.toml")])


def run(folder: Path, models: list[str], names: list[str], changes: dict[str, str]) -> None:
    """Run the shipped cases that a model supports, one after the other."""
    for path in shipped():
        case = sj.load(path)
        if changes and case.definition.behaviour.has_model("dem"):
            case = case.changed(changes)
        for model in models:
            target = folder / model / path.stem
            unable = not case.definition.behaviour.has_model(model)
            if unable or (names and path.stem not in names) or (target / f"{FILES[model]}{SUFFIX}").exists():
                continue
            start = time.monotonic()
            try:
                made: Run = getattr(case, model)()
            except sj.StatejumpError as failure:
                print(f"{path.stem} {model}: {failure}", flush=True)
                continue
            target.mkdir(parents=True, exist_ok=True)
            save(model, case.definition, {model: made}, target)
            print(f"{path.stem} {model}: {time.monotonic() - start:.1f} s", flush=True)


def numbers(made: Run) -> dict[str, np.ndarray]:
    """Return the numbers of a run by name: columns, times of events, summary."""
    found = {name: np.asarray(column.values) for group in GROUPS for name, column in getattr(made, group).items()}
    found["times of events"] = np.array([event.time_s for event in made.events])
    found["summary"] = np.array(list(made.summary.values()))
    return found


def row(name: str, first: Run, second: Run) -> tuple[list[str], bool]:
    """Return a row of :data:`HEADER` that compares two runs of a case and model, and whether all bits are equal."""
    one, other = numbers(first), numbers(second)
    count = differing = 0
    worst, worst_column = 0.0, ""
    for column in sorted({*one, *other}):
        values, others = one.get(column, np.empty(0)), other.get(column, np.empty(0))
        count += values.size
        if values.shape != others.shape:
            differing, worst, worst_column = differing + values.size, np.inf, column
            continue
        differs = ~((values == others) | ((values != values) & (others != others)))
        differing += int(differs.sum())
        if differs.any():
            largest = np.nanmax(np.abs(values.astype(float)))
            relative = float(np.nanmax(np.abs(values.astype(float) - others))) / largest if largest else np.inf
            if relative >= worst:
                worst, worst_column = relative, column
    return [name, str(count), str(differing), f"{worst:.2g} {worst_column}" if differing else ""], not differing


def compare(first: Path, second: Path) -> int:
    """Print the table; return the exit status."""
    rows: list[list[str]] = []
    status = 0
    files = sorted({path.relative_to(folder) for folder in (first, second) for path in folder.rglob(f"*{SUFFIX}")})
    for file in files:
        name, model = file.parent.name, file.parent.parent.name
        if not (first / file).exists() or not (second / file).exists():
            print(f"{file}: only in {first if (first / file).exists() else second}", file=sys.stderr)
            status = 1
            continue
        one, other = (sj.read(folder / file).models[model] for folder in (first, second))
        cells, equal = row(f"{name}, {model}", one, other)
        rows.append(cells)
        status = status if equal else 1
    print("\n".join(markdown(HEADER, rows, right=(1, 2))))
    return status


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    commands = parser.add_subparsers(dest="command", required=True)
    runs = commands.add_parser("run")
    runs.add_argument("folder", type=Path)
    runs.add_argument("--model", action="append", choices=("reduced", "dem"))
    runs.add_argument("--case", action="append", default=[])
    runs.add_argument("--yade-loop", action="store_true")
    comparison = commands.add_parser("compare")
    comparison.add_argument("first", type=Path)
    comparison.add_argument("second", type=Path)
    given = parser.parse_args()
    if given.command == "compare":
        sys.exit(compare(given.first, given.second))
    run(given.folder, given.model or ["reduced", "dem"], given.case, {"dem.stepper": "yade"} if given.yade_loop else {})
