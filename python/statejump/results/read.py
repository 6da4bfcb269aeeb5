# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads a result file; whatever is wrong with it is one sentence."""
from __future__ import annotations

import json
import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from statejump.core.comparison import SIDES, Quantity
from statejump.core.errors import Unreadable
from statejump.core.hdf5 import is_ours, opened
from statejump.core.run import Column, Event, Events, Run
from statejump.results.contents import Answers, Mesh, Result, Scalar
from statejump.results.layout import ENTRIES, FORMAT, MODELS, SUFFIX, TABLES, VERSION


def is_result_file(path: Path) -> bool:
    """Whether a path is meant as a result file: it is one, or is called so."""
    return path.suffix in (SUFFIX, ".hdf5") or is_ours(path)


def read(path: str | Path) -> Result:
    """Return what a result file holds.

    :raises Unreadable: no such file, not ours, of a newer layout, cut off or altered, a part is missing
    """
    path = Path(path)
    try:
        with opened(path) as file:
            _check(file, path)
            return _result(file)
    except (KeyError, ValueError, TypeError, AttributeError, IndexError) as error:
        raise Unreadable("damaged", cause=" ".join(str(error).split()), file=path) from None


def _check(file: h5py.File, path: Path) -> None:
    """Raise Unreadable unless the file is ours, of a layout we know, and nothing is missing."""
    if file.attrs.get("format") != FORMAT:
        raise Unreadable("not a result file", cause=f"HDF5, but its attribute format is not {FORMAT!r}", file=path)
    version = int(file.attrs.get("layout_version", 0))
    if version > VERSION:
        raise Unreadable(f"layout version {version} is newer than {VERSION}, the newest that this statejump reads",
                         file=path)
    models = [model for model in file.get("models", ())]
    for entry in ENTRIES:
        if not entry.required:
            continue
        for model in models if "{model}" in entry.path else [""]:
            place, _, attribute = entry.path.replace("{model}", model).partition("@")
            if place not in file or (attribute and attribute not in file[place].attrs):
                raise Unreadable(f"{place}{'@' if attribute else ''}{attribute} is missing", file=path)
    for model in models:
        if model not in MODELS:
            raise Unreadable(f"/models/{model} is not a model", cause=f"must be {' or '.join(MODELS)}", file=path)


def _result(file: h5py.File) -> Result:
    case = file["case"]
    names = {key: _texts(values) for key, values in file["names"].items()}
    complete = bool(file.attrs["complete"])
    made: list[Result] = []  # a run of the file reads its case only when it is asked for
    runs = {
        model: replace(_model(model, file["models"][model]), names=names, complete=complete, kind=case.attrs["kind"],
                       case_of=lambda: made[0].definition)
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
        case_json=_text(case["resolved"]),
        provenance={key: _plain(value) for key, value in file["provenance"].attrs.items()},
        names=names,
        scene=json.loads(_text(file["scene"])),
        models=runs,
        rows=_comparison(file["comparison"]) if "comparison" in file else None,
        warnings=_texts(file["warnings"]),
        meshes={
            name: Mesh(mesh["vertices_m"][()], mesh["triangles"][()]) for name, mesh in file.get("meshes", {}).items()
        },
        answers=_answers(file["answers"]) if "answers" in file else None,
    ))
    return made[0]


def _model(model: str, group: h5py.Group) -> Run:
    samples = group["history/time_s"].shape[0]
    columns = {
        part: {name: _column(values, samples) for name, values in group[part].items()}
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
        summary={name: float(value[()]) for name, value in group["summary"].items()},
    )


def _scalars(group: h5py.Group) -> dict[str, Scalar]:
    return {name: Scalar(float(value[()]), value.attrs["unit"]) for name, value in group.items()}


def _column(dataset: h5py.Dataset, samples: int) -> Column:
    if dataset.shape[:1] != (samples,):
        found = dataset.shape[0] if dataset.shape else "no"
        raise ValueError(f"{dataset.name} has {found} samples, time_s has {samples}")
    attributes = dataset.attrs
    return Column(
        dataset[()], attributes["unit"], attributes.get("items", ""),
        tuple(attributes.get("labels", ())), attributes.get("note", ""),
    )


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


def _answers(group: h5py.Group) -> Answers:
    return Answers(
        **{key: group.attrs[key] for key in ("output", "text", "unit", "verdict", "verdict_text")},
        notes=_texts(group["notes"]),
        summary=_scalars(group["summary"]),
        tables={name: _rows(name, table) for name, table in group.items() if name not in ("notes", "summary")},
    )


def _rows(name: str, group: h5py.Group) -> list[dict[str, Any]]:
    """Return the rows of a table, its columns in the order of the CSV file."""
    order = TABLES[name][1] if name in TABLES else ()
    keys = [key for key in order if key in group] + [key for key in group if key not in order]
    columns = [_cells(group[key]) for key in keys]
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
