# SPDX-License-Identifier: GPL-3.0-or-later
"""CSV files of a result: ``<model>_history.csv``, ``<model>_events.csv``, ``comparison.csv``, tables of answers."""
from __future__ import annotations

import csv
from dataclasses import asdict, fields
from pathlib import Path
from typing import Any, Iterable, Iterator

import numpy as np

from statejump.core.comparison import write_comparison_csv
from statejump.core.history import common_order, write_columns
from statejump.core.output import write_atomically
from statejump.results.contents import Answers, Column, Event, ModelRun, Result, history_of

AXES = ("x", "y", "z")


def _flat(name: str, column: Column, names: dict[str, list[str]]) -> Iterator[tuple[str, np.ndarray]]:
    """Yield a column of several items as columns of one value: ``name[item]``, ``name[item].x``."""
    for place, item in enumerate(names[column.items]):
        values = column.values[:, place]
        if values.ndim == 1:
            yield f"{name}[{item}]", values
        else:
            for axis, letter in enumerate(AXES):
                yield f"{name}[{item}].{letter}", values[:, axis]


def _order(names: Iterable[str]) -> list[str]:
    """Return the common order of the names; where a kind has none, the program first, then by name."""
    try:
        return common_order(names)
    except ValueError:
        return sorted(names, key=lambda name: ({"time_s": 0, "temperature_change_K": 1}.get(name, 2), name))


def history_columns(run: ModelRun, names: dict[str, list[str]]) -> dict[str, np.ndarray]:
    """Return the columns of the CSV file of a model, in their order."""
    plain = history_of(run).columns
    found = {name: plain[name] for name in _order(plain)}
    for name, column in {**run.history, **run.energy}.items():
        if column.values.ndim > 1:
            found.update(_flat(name, column, names))
    return found


def write_histories(result: Result, folder: Path, mark: str = "") -> list[Path]:
    """Write ``<model>_history<mark>.csv``."""
    written = []
    for model, run in result.models.items():
        written.append(folder / f"{model}_history{mark}.csv")
        write_columns(history_columns(run, result.names), written[-1])
    return written


def _cell(value: Any) -> Any:
    if value is None or value != value:
        return ""
    return repr(value) if isinstance(value, float) else value


def write_answers(answers: Answers, folder: Path) -> list[Path]:
    """Write a CSV file for every table of answers."""
    written = []
    for name, rows in answers.tables.items():
        written.append(folder / f"{name}.csv")
        with write_atomically(written[-1]) as stream:
            writer = csv.writer(stream)
            writer.writerow(rows[0] if rows else [])
            writer.writerows([_cell(value) for value in row.values()] for row in rows)
    return written


def write_all(result: Result, folder: Path) -> list[Path]:
    """Write all CSV files of a result and return their paths."""
    written = write_histories(result, folder)
    for model, run in result.models.items():
        path = folder / f"{model}_events.csv"
        with write_atomically(path) as stream:
            writer = csv.DictWriter(stream, fieldnames=[entry.name for entry in fields(Event)])
            writer.writeheader()
            writer.writerows(asdict(event) for event in run.events)
        written.append(path)
    if result.comparison:
        path = folder / "comparison.csv"
        write_comparison_csv(result.comparison, path)
        written.append(path)
    if result.answers is not None:
        written += write_answers(result.answers, folder)
    return written
