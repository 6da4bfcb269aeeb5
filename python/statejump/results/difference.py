# SPDX-License-Identifier: GPL-3.0-or-later
"""Comparison of two result files of the same case."""
from __future__ import annotations

import json
import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from statejump.core.comparison import Quantity, of_two
from statejump.core.errors import StatejumpError
from statejump.core.run import Run
from statejump.core.units import unit_of
from statejump.kinds import protocol, require
from statejump.results.contents import Result

# Sections about solution, output and tolerances. All other sections define the structure.
NUMERICAL_SECTIONS = ("case", "dem", "reduced", "motion", "output", "ensemble", "tolerance")
# Compared groups of columns. Contacts are omitted, because columns of an open contact may be NaN.
COMPARED = ("history", "energy", "links")
SAME_TIME = 1e-9  # fraction of the duration: rounding of the time of the last sample


@dataclass(frozen=True)
class ColumnDifference:
    """Largest difference of a column over time and over its items. ``name`` is the column's path below the model,
    ``range`` its largest minus smallest value in the first run, ``time_s`` the time of the largest difference."""

    name: str
    unit: str
    largest: float
    time_s: float
    range: float


@dataclass(frozen=True)
class EventDifference:
    """Events of one kind in two runs: their number in each run, and ΔT [K] of the first one (None: no event)."""

    kind: str
    counts: tuple[int, int]
    first_K: tuple[float | None, float | None]


@dataclass(frozen=True)
class RunDifference:
    """Comparison of two runs. ``rows`` are the quantities with tolerances; None if a run is incomplete.

    :param lacking: columns that only one of both runs has
    :param not_finite: columns with a value that is finite in only one run
    """

    names: tuple[str, str]
    summary: list[tuple[str, str, float, float]]  # quantity, unit, first, second; NaN: no value
    columns: list[ColumnDifference]
    events: list[EventDifference]
    rows: list[Quantity] | None
    lacking: list[str]
    not_finite: list[str]

    @property
    def missed(self) -> list[str]:
        """Faults of the comparison: rows beyond their tolerance, columns that only one file has (if both runs are of
        one model), and columns that are finite in only one run."""
        beyond = [row.name for row in self.rows or () if not row.passed]
        alone = [f"{name} (in one file only)" for name in self.lacking] if self.names[0] == self.names[1] else []
        return beyond + alone + [f"{name} (not finite)" for name in self.not_finite]


def _entries(values: Any, path: str = "") -> Iterator[tuple[str, Any]]:
    if isinstance(values, dict):
        for key, value in values.items():
            yield from _entries(value, f"{path}.{key}" if path else key)
    else:
        yield path, values


def case_differences(first: Result, second: Result) -> tuple[list[str], list[str]]:
    """Return the differences between two cases as ``section.key = first and second``: first those of the structure,
    then those of numerical settings."""
    entries = [dict(_entries(json.loads(result.case_json))) for result in (first, second)]
    physical: list[str] = []
    numerical: list[str] = []
    for key in dict.fromkeys([*entries[0], *entries[1]]):
        values = [found.get(key) for found in entries]
        if values[0] != values[1]:
            # A whole list is too long for a sentence.
            shown = " and ".join(text if len(text) <= 60 else "(another list)" for text in map(repr, values))
            (numerical if key.partition(".")[0] in NUMERICAL_SECTIONS else physical).append(f"{key} = {shown}")
    return physical, numerical


def check_comparable(first: Result, second: Result) -> None:
    """Raise StatejumpError unless both files are of the same case."""
    if first.kind != second.kind:
        raise StatejumpError(code="kinds_differ", first=first.kind, second=second.kind)
    physical, _ = case_differences(first, second)
    if physical:
        more = f", and {len(physical) - 1} more" if len(physical) > 1 else ""
        raise StatejumpError(code="cases_differ", key_that_differs=physical[0], more=more)
    if first.names != second.names:
        raise StatejumpError(code="result_items_differ")


def pairs(first: Result, second: Result) -> list[tuple[str, str]]:
    """Return the pairs of models to compare: the models that both files have, or else the first model of each file."""
    common = [(model, model) for model in first.models if model in second.models]
    if common:
        return common
    if not first.models or not second.models:
        raise StatejumpError(code="result_without_run")
    return [(next(iter(first.models)), next(iter(second.models)))]


def _lacking(first: Run, second: Run) -> list[str]:
    return sorted(
        f"{group}/{name}" for group in COMPARED
        for name in set(getattr(first, group)).symmetric_difference(getattr(second, group))
    )


def _not_finite(first: Run, second: Run) -> list[str]:
    """Return the columns with values that are finite in only one run, or whose NaN and infinity differ."""
    found = []
    for group in COMPARED:
        for name, column in getattr(first, group).items():
            other = getattr(second, group).get(name)
            if other is None or column.labels or other.labels:
                continue
            one, two = (np.where(np.isfinite(values), 0.0, values) for values in (column.values, other.values))
            if not np.array_equal(one, two, equal_nan=True):
                found.append(f"{group}/{name}")
    return found


def _columns(first: Run, second: Run) -> list[ColumnDifference]:
    found = []
    for group in COMPARED:
        other = getattr(second, group)
        for name, column in getattr(first, group).items():
            if name == "time_s" or column.labels or name not in other:
                continue
            difference = np.abs(other[name].values - column.values).reshape(len(first.time_s), -1)
            over_items = np.where(np.isnan(difference), -1.0, difference).max(axis=1, initial=-1.0)
            place = int(np.argmax(over_items))
            if over_items[place] < 0:
                continue  # neither has a value
            spread = float(np.nanmax(column.values) - np.nanmin(column.values))
            found.append(ColumnDifference(
                f"{group}/{name}", column.unit, float(over_items[place]), float(first.time_s[place]), spread
            ))
    return found


def _events(first: Run, second: Run) -> list[EventDifference]:
    kinds = dict.fromkeys(event.kind for run in (first, second) for event in run.events)
    found = []
    for kind in kinds:
        changes = [[event.temperature_change_K for event in run.events if event.kind == kind]
                   for run in (first, second)]
        found.append(EventDifference(
            kind, (len(changes[0]), len(changes[1])),
            (changes[0][0] if changes[0] else None, changes[1][0] if changes[1] else None),
        ))
    return found


def _summary(first: Run, second: Run) -> list[tuple[str, str, float, float]]:
    return [
        (name, unit_of(name), first.summary.get(name, math.nan), second.summary.get(name, math.nan))
        for name in dict.fromkeys([*first.summary, *second.summary])
    ]


def difference(first: Result, second: Result) -> list[RunDifference]:
    """Compare the runs in two result files.

    The second run is interpolated linearly at the times of the first. If a run is incomplete, only the common time is
    compared, without a verdict.

    :raises StatejumpError: the files belong to different cases, or the cases have different durations
    """
    check_comparable(first, second)
    complete = first.complete and second.complete
    judge = require(first.definition, protocol.RunDifference).difference
    found = []
    for names in pairs(first, second):
        one, other = first.models[names[0]], second.models[names[1]]
        ends = float(one.time_s[-1]), float(other.time_s[-1])
        if complete and not abs(ends[0] - ends[1]) <= SAME_TIME * max(ends):
            raise StatejumpError(code="durations_differ", first_s=ends[0], second_s=ends[1])
        times = one.time_s[one.time_s <= min(ends) * (1 + SAME_TIME)]
        left, right = one.at(times), other.at(times)
        with np.errstate(over="ignore", invalid="ignore"):  # reported in rows and columns as values that are not finite
            found.append(RunDifference(
                names, _summary(one, other), _columns(left, right), _events(one, other),
                of_two(judge(first.definition, left, right)) if complete else None,
                _lacking(left, right), _not_finite(left, right),
            ))
    return found
