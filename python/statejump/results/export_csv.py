# SPDX-License-Identifier: GPL-3.0-or-later
"""CSV files of a result: ``<model>_history.csv``, ``<model>_events.csv``, ``comparison.csv``, tables of answers."""
from __future__ import annotations

from dataclasses import astuple, fields
from pathlib import Path

from statejump.core.comparison import write_comparison_csv
from statejump.core.run import Event
from statejump.core.tables import write_csv, write_rows
from statejump.results.contents import Answers, Result


def write_histories(result: Result, folder: Path, mark: str = "") -> list[Path]:
    """Write ``<model>_history<mark>.csv``."""
    written = []
    for model, run in result.models.items():
        written.append(folder / f"{model}_history{mark}.csv")
        run.write_csv(written[-1])
    return written


def write_answers(answers: Answers, folder: Path) -> list[Path]:
    """Write a CSV file for every table of answers."""
    return [write_rows(folder / f"{name}.csv", rows) for name, rows in answers.tables.items()]


def write_all(result: Result, folder: Path) -> list[Path]:
    """Write all CSV files of a result and return their paths."""
    written = write_histories(result, folder)
    header = [entry.name for entry in fields(Event)]
    for model, run in result.models.items():
        written.append(write_csv(folder / f"{model}_events.csv", header, map(astuple, run.events)))
    if result.rows:
        written.append(write_comparison_csv(result.rows, folder))
    if result.answers is not None:
        written += write_answers(result.answers, folder)
    return written
