# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes a result file: the same result gives the same bytes."""
from __future__ import annotations

import json
import math
from pathlib import Path
from collections.abc import Sequence

import h5py
import numpy as np

from statejump.core.comparison import SIDES, sides
from statejump.core.hdf5 import made
from statejump.core.run import Column, Run
from statejump.core.units import unit_of
from statejump.results.contents import Answers, Result
from statejump.results.layout import FORMAT, VERSION

COMPRESSED_FROM = 4096  # bytes; for smaller data sets the overhead of chunks exceeds the savings


def write(result: Result, path: Path) -> None:
    """Write the result file, with all entries in the order of their names. :raises NotWritten: it cannot be written"""
    with made(path) as file:
        file.attrs["format"] = FORMAT
        file.attrs["layout_version"] = VERSION
        file.attrs["complete"] = result.complete
        file.attrs["command"] = result.command
        case = file.create_group("case")
        for key in ("name", "kind", "title", "source"):
            case.attrs[key] = getattr(result, key)
        _text(case, "text", result.case_text)
        _text(case, "resolved", result.case_json)
        if result.members is not None:
            _texts(case, "members/names", result.members.names)
            for key in ("time_s", "temperature_change_K"):
                _numbers(case, f"members/{key}", getattr(result.members, key), unit_of(key))
        file.create_group("provenance").attrs.update(dict(sorted(result.provenance.items())))
        names = file.create_group("names")
        for key, values in sorted(result.names.items()):
            _texts(names, key, values)
        _text(file, "scene", json.dumps(result.scene, indent=1))
        _texts(file, "warnings", result.warnings)
        for name, mesh in sorted(result.meshes.items()):
            _numbers(file, f"meshes/{name}/vertices_m", mesh.vertices_m, "m")
            _numbers(file, f"meshes/{name}/triangles", mesh.triangles.astype(np.int64), "-")
        models = file.create_group("models")
        for model, run in result.models.items():
            _model(models.create_group(model), run)
        if result.rows is not None:
            _comparison(file.create_group("comparison"), result)
        if result.answers is not None:
            _answers(file.create_group("answers"), result.answers)


def _model(group: h5py.Group, run: Run) -> None:
    for name in ("history", "energy", "links", "contacts"):
        part = group.create_group(name)
        for key, column in sorted(getattr(run, name).items()):
            _column(part, key, column)
    events = group.create_group("events")
    _texts(events, "kind", [event.kind for event in run.events])
    _texts(events, "joint", [event.joint for event in run.events])
    for key, unit in (("time_s", "s"), ("temperature_change_K", "K"), ("time_uncertainty_s", "s")):
        _numbers(events, key, np.array([getattr(event, key) for event in run.events], dtype=float), unit)
    summary = group.create_group("summary")
    for key, value in sorted(run.summary.items()):
        _numbers(summary, key, np.array(value, dtype=float), unit_of(key))


def _comparison(group: h5py.Group, result: Result) -> None:
    rows = result.rows or ()
    group.attrs["passed"] = bool(result.passed)
    _texts(group, "quantity", [row.name for row in rows])
    _texts(group, "unit", [row.unit for row in rows])
    known = sides(rows)
    for key in (*known, "difference", "tolerance"):
        values = [row.values.get(key) if key in SIDES else getattr(row, key) for row in rows]
        # The unit differs between rows; the column `unit` has it.
        group.create_dataset(key, data=np.array([math.nan if value is None else value for value in values], float),
                             track_times=False)
    if known != ["reduced", "dem"]:
        _texts(group, "compared", [" ".join(row.values) for row in rows])
    group.create_dataset("passed", data=np.array([row.passed for row in rows], dtype=bool), track_times=False)
    if result.reasons:
        _texts(group, "reasons", result.reasons)


def _answers(group: h5py.Group, answers: Answers) -> None:
    for key in ("output", "text", "unit", "verdict", "verdict_text"):
        group.attrs[key] = getattr(answers, key)
    _texts(group, "notes", answers.notes)
    summary = group.create_group("summary")
    for key, scalar in sorted(answers.summary.items()):
        _numbers(summary, key, np.array(scalar.value, dtype=float), scalar.unit)
    for name, rows in sorted(answers.tables.items()):
        table = group.create_group(name)
        for key in sorted(rows[0]) if rows else ():
            values = [row[key] for row in rows]
            if isinstance(values[0], str):
                _texts(table, key, values)
            elif all(isinstance(value, int) for value in values):
                _numbers(table, key, np.array(values, dtype=np.int64), answers.unit_of(key))
            else:
                numbers = [math.nan if value is None else value for value in values]
                _numbers(table, key, np.array(numbers, dtype=float), answers.unit_of(key))


def _column(group: h5py.Group, name: str, column: Column) -> None:
    dataset = _numbers(group, name, column.values, column.unit)
    if column.items:
        dataset.attrs["items"] = column.items
    if column.labels:
        dataset.attrs["labels"] = np.array(column.labels, dtype=h5py.string_dtype())
    if column.note:
        dataset.attrs["note"] = column.note


def _numbers(group: h5py.Group, name: str, values: np.ndarray, unit: str) -> h5py.Dataset:
    packed = {"compression": "gzip", "shuffle": True} if values.nbytes >= COMPRESSED_FROM else {}
    dataset = group.create_dataset(name, data=values, track_times=False, **packed)
    dataset.attrs["unit"] = unit
    return dataset


def _text(group: h5py.Group, name: str, text: str) -> None:
    group.create_dataset(name, data=text, dtype=h5py.string_dtype(), track_times=False)


def _texts(group: h5py.Group, name: str, texts: Sequence[str]) -> None:
    encoded = [text.encode() for text in texts]
    longest = max([1, *map(len, encoded)])
    group.create_dataset(name, data=np.array(encoded, dtype=h5py.string_dtype("utf-8", longest)), track_times=False)
