# SPDX-License-Identifier: GPL-3.0-or-later
"""Properties of every case and every result file, tested on randomly generated cases and files."""
from __future__ import annotations

import json
import math
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from hypothesis import HealthCheck, given, settings, strategies as st

from conftest import REPOSITORY
from statejump import Case, load
from statejump.core.comparison import Quantity, quantity
from statejump.core.errors import StatejumpError
from statejump.core.run import Column, Event, Events, Run
from statejump.results import read as reading, record
from statejump.results.write import write

# A slow machine is no failure, and the same examples are tried every time.
OFTEN = settings(max_examples=100, deadline=None, derandomize=True, database=None,
                 suppress_health_check=[HealthCheck.too_slow, HealthCheck.function_scoped_fixture])
SHIPPED = ("table1", "umbrella", "umbrella_damped", "statics_lobed", "trusses/chain_10")


@cache
def shipped(name: str) -> Case:
    return load(REPOSITORY / "cases" / f"{name}.toml")


@cache
def numbers_of(name: str) -> list[tuple[str, Any]]:
    """Every number of a case by its key."""
    found = []
    for section, keys in shipped(name).to_dict().items():
        for key, value in (keys.items() if isinstance(keys, dict) else ()):
            if isinstance(value, (int, float)) and not isinstance(value, bool):
                found.append((f"{section}.{key}", value))
    return found


@st.composite
def changes(draw: Any) -> tuple[str, dict[str, Any]]:
    """A shipped case with up to three changed numbers: near the original, far from it, or not finite."""
    name = draw(st.sampled_from(SHIPPED))
    found = {}
    for key, value in draw(st.lists(st.sampled_from(numbers_of(name)), min_size=1, max_size=3)):
        near = st.floats(0.5, 2.0).map(lambda factor: type(value)(value * factor))
        found[key] = draw(st.one_of(near, near, st.floats(), st.integers(-10, 10**6)))
    return name, found


def same(first: Any, second: Any) -> bool:
    return json.dumps(first, sort_keys=True) == json.dumps(second, sort_keys=True)


@OFTEN
@given(changes())
def test_case_survives_json(change: tuple[str, dict[str, Any]]) -> None:
    """A valid case is unchanged by the conversions case → dict → JSON → dict → case."""
    name, values = change
    try:
        case = shipped(name).changed(values)
    except StatejumpError as refused:
        assert "\n" not in str(refused) and refused.key
        return
    again = load(json.loads(json.dumps(case.to_dict())) if case.kind != "truss" else case.origin.document)
    assert again == case and hash(again) == hash(case) and same(again.to_dict(), case.to_dict())


@OFTEN
@given(changes())
def test_changed_changes_what_it_says_and_nothing_else(change: tuple[str, dict[str, Any]]) -> None:
    name, values = change
    before = shipped(name).to_dict()
    try:
        case = shipped(name).changed(values)
    except StatejumpError:
        assert same(shipped(name).to_dict(), before)
        return
    assert same(shipped(name).to_dict(), before)
    for key, value in values.items():
        assert case[key] == value
    old = {key: value for key, value in numbers_of(name)}
    # What follows from other keys by itself: the step from the number of steps, the period from the table.
    for key, value in old.items():
        if key not in values:
            assert case[key] == value or key.startswith("dem.") or key.endswith("period_s"), key
    assert case.changed({key: old[key] for key in values}) == shipped(name)


@OFTEN
@given(st.floats(), st.floats(), st.floats(min_value=0))
def test_a_row_passes_only_with_finite_numbers(first: float, second: float, tolerance: float) -> None:
    row = quantity("a", "-", tolerance, reduced=first, dem=second)
    assert row.passed == (math.isfinite(second - first) and abs(second - first) <= tolerance)


TEXT = st.text(st.characters(blacklist_categories=("Cs",), blacklist_characters="\0"), max_size=20)
NUMBER = st.floats()
KNOWN = st.floats(allow_nan=False)  # of a row, where a file writes NaN for none


@st.composite
def runs(draw: Any, base: Run) -> Run:
    """A run with the array shapes of a given run, and arbitrary numbers, events and summary."""
    groups = {group: dict(getattr(base, group)) for group in ("history", "energy", "links", "contacts")}
    places = [(group, name) for group, columns in groups.items() for name, column in columns.items() if not column.labels]
    for group, name in draw(st.lists(st.sampled_from(places), max_size=3)):
        column = groups[group][name]
        values = np.array(column.values, dtype=float)
        values.ravel()[draw(st.integers(0, values.size - 1))] = draw(NUMBER)
        groups[group][name] = Column(values, column.unit, column.items, column.labels, draw(TEXT))
    events = draw(st.lists(st.builds(Event, TEXT, NUMBER, NUMBER, TEXT, NUMBER), max_size=3))
    summary = draw(st.dictionaries(st.sampled_from(("state_jump_m", "other_N", "ratio")), NUMBER))
    return Run("reduced", **groups, events=Events(events), summary=summary, names=base.names, kind=base.kind,
               case_of=base.case_of)


@cache
def short_run() -> Run:
    case = load(REPOSITORY / "cases" / "table1.toml").changed({"dem.samples_per_cycle": 20})
    return case.reduced()


@settings(OFTEN, max_examples=15)
@given(run=runs(short_run()), warnings=st.lists(TEXT, max_size=2), rows=st.lists(
    st.builds(Quantity, TEXT, TEXT, st.fixed_dictionaries({"reduced": KNOWN, "dem": st.none() | KNOWN}),
              st.none() | KNOWN, st.floats(0, 1), st.booleans()), min_size=1, max_size=3))
def test_result_file_gives_back_what_was_written(tmp_path: Path, run: Run, warnings: list[str],
                                                 rows: list[Quantity]) -> None:
    from dataclasses import replace

    made = replace(record.result_of("reduced", run.definition, {"reduced": run}), warnings=warnings, rows=tuple(rows))
    path = tmp_path / "a.h5"
    write(made, path)
    once = path.read_bytes()
    back = reading.read(path)
    found = back.models["reduced"]
    for group in ("history", "energy", "links", "contacts"):
        for name, column in getattr(run, group).items():
            other = getattr(found, group)[name]
            assert np.array_equal(column.values, other.values, equal_nan=not column.labels), name
            assert (column.unit, column.items, column.labels, column.note) == (
                other.unit, other.items, tuple(other.labels), other.note)
    assert repr(list(found.events)) == repr(list(run.events)) and repr(back.warnings) == repr(warnings)
    assert {name: repr(value) for name, value in found.summary.items()} == {
        name: repr(float(value)) for name, value in run.summary.items()}
    assert [(row.name, row.unit, row.passed) for row in back.rows or ()] == [(row.name, row.unit, row.passed) for row in rows]
    assert back.definition == run.definition
    write(back, path)
    assert path.read_bytes() == once
