# SPDX-License-Identifier: GPL-3.0-or-later
"""Two result files of the same case beside each other."""
from __future__ import annotations

import json
import math
from dataclasses import dataclass, replace
from typing import Any, Iterator, Optional

import numpy as np

from statejump.core.comparison import Quantity
from statejump.core.errors import StatejumpError
from statejump.results.contents import Column, ModelRun, Result
from statejump.results.kinds import kind_of

# How a case is computed, written and judged; the other sections say what it is.
NUMERICAL_SECTIONS = ("case", "dem", "reduced", "output", "ensemble", "tolerance")
SAME_TIME = 1e-9  # of the duration: rounding of the last sample's time


@dataclass(frozen=True)
class ColumnDifference:
    """Largest difference of a column over time, over all its items. ``name`` is its place below the
    model, ``range`` largest less smallest value of the first run, ``time_s`` where the difference is
    largest."""

    name: str
    unit: str
    largest: float
    time_s: float
    range: float


@dataclass(frozen=True)
class EventDifference:
    """Events of one kind: how many in either run, ΔT [K] of the first ones (None: there is none)."""

    kind: str
    counts: tuple[int, int]
    first_K: tuple[Optional[float], Optional[float]]


@dataclass(frozen=True)
class RunDifference:
    """Two runs beside each other. ``rows``: against the tolerances; None if a run is not complete."""

    names: tuple[str, str]
    summary: list[tuple[str, str, float, float]]  # quantity, unit, first, second; NaN: none
    columns: list[ColumnDifference]
    events: list[EventDifference]
    rows: Optional[list[Quantity]]


def _entries(values: Any, path: str = "") -> Iterator[tuple[str, Any]]:
    if isinstance(values, dict):
        for key, value in values.items():
            yield from _entries(value, f"{path}.{key}" if path else key)
    else:
        yield path, values


def case_differences(first: Result, second: Result) -> tuple[list[str], list[str]]:
    """Return what differs between the cases: what they are, and how they are computed; as
    ``section.key = first and second``."""
    entries = [dict(_entries(json.loads(result.case_json))) for result in (first, second)]
    physical, numerical = [], []
    for key in dict.fromkeys([*entries[0], *entries[1]]):
        values = [found.get(key) for found in entries]
        if values[0] != values[1]:
            # A list of the nodes of a truss is no sentence.
            shown = " and ".join(text if len(text) <= 60 else "(another list)" for text in map(repr, values))
            (numerical if key.partition(".")[0] in NUMERICAL_SECTIONS else physical).append(f"{key} = {shown}")
    return physical, numerical


def check_comparable(first: Result, second: Result) -> None:
    """Raise StatejumpError unless both files are of the same case."""
    if first.kind != second.kind:
        raise StatejumpError(f"not comparable: kinds {first.kind} and {second.kind}")
    physical, _ = case_differences(first, second)
    if physical:
        more = f", and {len(physical) - 1} more" if len(physical) > 1 else ""
        raise StatejumpError(f"not comparable: the cases differ: {physical[0]}{more}")
    if first.names != second.names:
        raise StatejumpError("not comparable: the files name other links or contacts")


def pairs(first: Result, second: Result) -> list[tuple[str, str]]:
    """Return which model is compared with which: the common ones, or the only one of each file."""
    common = [(model, model) for model in first.models if model in second.models]
    if common:
        return common
    if not first.models or not second.models:
        raise StatejumpError("not comparable: a file holds no run")
    return [(next(iter(first.models)), next(iter(second.models)))]


def _at(run: ModelRun, time_s: np.ndarray) -> ModelRun:
    """Return a run at other times: linear between samples, labels those of the sample before."""
    if np.array_equal(run.time_s, time_s):
        return run
    before = np.clip(np.searchsorted(run.time_s, time_s, side="right") - 1, 0, len(run.time_s) - 1)
    after = np.minimum(before + 1, len(run.time_s) - 1)
    step = run.time_s[after] - run.time_s[before]
    weight = np.divide(time_s - run.time_s[before], step, out=np.zeros(len(time_s)), where=step > 0)

    def moved(column: Column) -> Column:
        if column.labels:
            return replace(column, values=column.values[before])
        shape = (-1,) + (1,) * (column.values.ndim - 1)
        here, there = column.values[before], column.values[after]
        return replace(column, values=here + np.clip(weight, 0, 1).reshape(shape) * (there - here))

    return replace(run, **{
        group: {name: moved(column) for name, column in getattr(run, group).items()}
        for group in ("history", "energy", "links", "contacts")
    })


def _columns(first: ModelRun, second: ModelRun) -> list[ColumnDifference]:
    found = []
    for group in ("history", "energy", "links"):
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


def _events(first: ModelRun, second: ModelRun) -> list[EventDifference]:
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


def _summary(first: ModelRun, second: ModelRun) -> list[tuple[str, str, float, float]]:
    found = []
    for name in dict.fromkeys([*first.summary, *second.summary]):
        scalars = [run.summary.get(name) for run in (first, second)]
        unit = next(scalar.unit for scalar in scalars if scalar is not None)
        values = [math.nan if scalar is None else scalar.value for scalar in scalars]
        found.append((name, unit, values[0], values[1]))
    return found


def difference(first: Result, second: Result) -> list[RunDifference]:
    """Compare two result files.

    The second run is taken at the times of the first, linear between its samples. If one of the files is
    not complete, the common time is compared and nothing is judged.

    :raises StatejumpError: they are not of the same case or do not last equally long
    """
    check_comparable(first, second)
    complete = first.complete and second.complete
    found = []
    for names in pairs(first, second):
        one, other = first.models[names[0]], second.models[names[1]]
        ends = float(one.time_s[-1]), float(other.time_s[-1])
        if complete and abs(ends[0] - ends[1]) > SAME_TIME * max(ends):
            raise StatejumpError(f"not comparable: the runs last {ends[0]:g} s and {ends[1]:g} s")
        times = one.time_s[one.time_s <= min(ends) * (1 + SAME_TIME)]
        left, right = _at(one, times), _at(other, times)
        found.append(RunDifference(
            names, _summary(one, other), _columns(left, right), _events(one, other),
            kind_of(first.case()).difference_rows(first.case(), left, right) if complete else None,
        ))
    return found
