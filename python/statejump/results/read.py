# SPDX-License-Identifier: GPL-3.0-or-later
"""Reader of result files. The error for a faulty file is one sentence."""
from __future__ import annotations

import json
import math
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from statejump.core.comparison import SIDES, Quantity
from statejump.core.errors import Unreadable
from statejump.core.hdf5 import is_ours, opened
from statejump.core.temperature_files import Histories
from statejump.core.run import Column, Event, Events, Parts, Run
from statejump.results.check import check
from statejump.results.contents import Answers, Mesh, Result, Scalar
from statejump.results.layout import ALWAYS, MODELS, SUFFIX, SUM_OF_CONTRIBUTIONS, TABLES, TEXTS, WITHOUT_GAPS
from statejump.results.scene_check import problems


def is_result_file(path: Path) -> bool:
    """Return whether a path names a result file, which its content or its name shows."""
    return path.suffix in (SUFFIX, ".hdf5") or is_ours(path)


def read(path: str | Path) -> Result:
    """Return the content of a result file (HDF5): runs by model, comparison, case, scene and provenance.

    :raises StatejumpError: the file does not exist, is not a result file, has a newer layout, or is damaged
    """
    path = Path(path)
    try:
        with opened(path) as file:
            check(file, path)
            result = _result(file, path)
    except RecursionError:
        raise Unreadable(code="objects_too_deep", file=path) from None
    except (KeyError, ValueError, TypeError, AttributeError, IndexError) as error:
        cause = " ".join(str(error).split())
        named = cause.split()[0] if cause.startswith("/") else "/"  # else HDF5's own message
        raise Unreadable(code="damaged", cause=cause, file=path, object=named) from None
    for problem in problems(result):
        raise Unreadable(code="scene_damaged", file=path, why=" ".join(problem.split()))
    return result


def _result(file: h5py.File, path: Path) -> Result:
    case = file["case"]
    case_json = _text(case["resolved"])
    _parsed("/case/resolved", case_json)
    names = Parts({key: _texts(values) for key, values in file["names"].items()}, "/names", path)
    complete = bool(file.attrs["complete"])
    made: list[Result] = []  # lets a run read its case from the file at the first access
    runs = {
        model: replace(_model(model, file["models"][model], path), names=names, complete=complete,
                       kind=case.attrs["kind"], case_of=lambda: made[0].definition)
        for model in MODELS if model in file["models"]
    }
    made.append(Result(
        command=file.attrs["command"],
        complete=complete,
        name=case.attrs["name"],
        kind=case.attrs["kind"],
        title=case.attrs["title"],
        source=case.attrs["source"],
        case_text=_text(case["text"]),
        case_json=case_json,
        provenance={key: _plain(value) for key, value in file["provenance"].attrs.items()},
        names=names,
        scene=_parsed("/scene", _text(file["scene"])),
        models=runs,
        rows=_comparison(file["comparison"]) if "comparison" in file else None,
        reasons=_texts(file["comparison/reasons"]) if "comparison/reasons" in file else [],
        warnings=_texts(file["warnings"]),
        meshes={
            name: _mesh(mesh) for name, mesh in file.get("meshes", {}).items()
        },
        answers=_answers(file["answers"], names) if "answers" in file else None,
        members=_members(case["members"]) if "members" in case else None,
    ))
    return made[0]


def _members(group: h5py.Group) -> Histories:
    return Histories(tuple(_texts(group["names"])), group["time_s"][()], group["temperature_change_K"][()])


def _parsed(place: str, text: str) -> dict[str, Any]:
    """Return the JSON object in a text. :raises ValueError: the text is not a JSON object"""
    found = json.loads(text)
    if not isinstance(found, dict):
        raise ValueError(f"{place} is no object of JSON")
    return found


def _mesh(group: h5py.Group) -> Mesh:
    mesh = Mesh(group["vertices_m"][()], group["triangles"][()])
    if mesh.triangles.size and not 0 <= mesh.triangles.min() <= mesh.triangles.max() < len(mesh.vertices_m):
        raise ValueError(f"{group.name} has triangles without a vertex")
    return mesh


def _model(model: str, group: h5py.Group, path: Path) -> Run:
    columns = {
        part: Parts({name: _column(values) for name, values in group[part].items()}, f"{group.name}/{part}", path)
        for part in ("history", "energy", "links", "contacts")
    }
    events = group["events"]
    return Run(
        model,
        columns["history"], columns["energy"], columns["links"], columns["contacts"],
        events=Events([
            Event(kind, float(time), float(change), joint, float(uncertainty))
            for kind, time, change, joint, uncertainty in zip(
                _texts(events["kind"]), events["time_s"][()], events["temperature_change_K"][()],
                _texts(events["joint"]), events["time_uncertainty_s"][()], strict=True,
            )
        ]),
        summary=Parts({name: float(value[()]) for name, value in group["summary"].items()},
                      f"{group.name}/summary", path),
    )


def _scalars(group: h5py.Group) -> dict[str, Scalar]:
    return {name: Scalar(float(value[()]), value.attrs["unit"]) for name, value in group.items()}


def _column(dataset: h5py.Dataset) -> Column:
    attributes = dataset.attrs
    column = Column(
        dataset[()], attributes["unit"], attributes.get("items", ""),
        tuple(attributes.get("labels", ())), attributes.get("note", ""),
    )
    if column.labels and int(column.values.max(initial=0)) >= len(column.labels):
        raise ValueError(f"{dataset.name} has values without a label")
    return column


def _comparison(group: h5py.Group) -> tuple[Quantity, ...]:
    def numbers(key: str) -> list[float | None]:
        return [None if math.isnan(value) else float(value) for value in group[key][()]]

    names = _texts(group["quantity"])
    compared = _texts(group["compared"]) if "compared" in group else ["reduced dem"] * len(names)
    values = {side: numbers(side) for side in SIDES if side in group}
    return tuple(
        Quantity(name, unit, {side: values[side][place] for side in sides.split()}, difference,
                 math.nan if tolerance is None else tolerance, bool(passed))
        for place, (name, unit, sides, difference, tolerance, passed) in enumerate(zip(
            names, _texts(group["unit"]), compared, numbers("difference"), numbers("tolerance"), group["passed"][()],
            strict=True,
        ))
    )


def _answers(group: h5py.Group, names: Mapping[str, list[str]]) -> Answers:
    summary = _scalars(group["summary"])
    # If the file has a sum of contributions, it must have its error.
    needed = ["jump", *(SUM_OF_CONTRIBUTIONS if any(name in summary for name in SUM_OF_CONTRIBUTIONS) else ())]
    missing = [name for name in needed if name not in summary]
    if missing:
        raise ValueError(f"{group.name}/summary/{missing[0]} is missing")
    tables = {name: _rows(name, table) for name, table in group.items() if name not in ("notes", "summary")}
    for name in ALWAYS:
        if name not in tables:
            raise ValueError(f"{group.name}/{name} is missing")
    wanted = len(tables["cycles"]) * len(names["nodes"])
    if not wanted or len(tables["node_jumps"]) != wanted:
        raise ValueError(f"{group.name}/node_jumps has {len(tables['node_jumps'])} rows, must have one for each of "
                         f"{len(names['nodes'])} nodes after each of {len(tables['cycles'])} cycles")
    return Answers(
        **{key: group.attrs[key] for key in ("output", "text", "unit", "verdict", "verdict_text")},
        notes=_texts(group["notes"]),
        summary=summary,
        tables=tables,
    )


def _rows(name: str, group: h5py.Group) -> list[dict[str, Any]]:
    """Return the rows of a table. The order of columns is that of the CSV file."""
    order = TABLES[name][1] if name in TABLES else ()
    missing = [key for key in order if key not in group] if len(group) else []
    if missing:
        raise ValueError(f"{group.name}/{missing[0]} is missing")
    keys = [*order, *(key for key in group if key not in order)] if len(group) else []
    columns = [_cells(group[key]) for key in keys]
    for key, cells in zip(keys, columns):
        if key not in order:
            continue
        if any(isinstance(cell, str) != (key in TEXTS) for cell in cells):
            raise ValueError(f"{group.name}/{key} must be {'text' if key in TEXTS else 'numbers'}")
        if name in WITHOUT_GAPS and any(cell is None or cell in (math.inf, -math.inf) for cell in cells):
            raise ValueError(f"{group.name}/{key} has a value that is no number")
    return [dict(zip(keys, values)) for values in zip(*columns, strict=True)]


def _cells(dataset: h5py.Dataset) -> list[Any]:
    if h5py.check_string_dtype(dataset.dtype):
        return _texts(dataset)
    values = dataset[()].tolist()
    return [None if value != value else value for value in values]


def _text(dataset: h5py.Dataset) -> str:
    return dataset.asstr()[()]


def _texts(dataset: h5py.Dataset) -> list[str]:
    return [str(text) for text in dataset.asstr()[()]]


def _plain(value: Any) -> Any:
    return value.item() if isinstance(value, np.generic) else value
