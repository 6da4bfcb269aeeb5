# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks types, axes and attributes of an HDF5 file against the layout of result files, before data are read."""
from __future__ import annotations

from pathlib import Path
from typing import Any

import h5py
import numpy as np

from statejump.core.errors import Unreadable
from statejump.core.hdf5 import objects
from statejump.results.layout import ENTRIES, FORMAT, MODELS, VERSION, Form, entry_of

# Names of axes over items; an attribute of the column refers to the list of the items' names.
OF_ITEMS = ("items", "links", "contacts")


def check(file: h5py.File, path: Path) -> None:
    """Raise Unreadable unless a file is a result file of a known layout, and its contents match the layout."""
    form = file.attrs.get("format")
    if not isinstance(form, str) or form != FORMAT:
        raise Unreadable(code="result_other_format", file=path, wanted=FORMAT)
    version = file.attrs.get("layout_version", 0)
    if isinstance(version, np.integer) and version > VERSION:
        raise Unreadable(code="layout_newer", file=path, found=version, newest=VERSION)
    found = {"/": file, **objects(file, path)}
    models = [model for model in file["models"]] if isinstance(found.get("/models"), h5py.Group) else []
    _check_missing(found, models, path)
    for model in models:
        if model not in MODELS:
            raise Unreadable(code="model_unknown_in_file", file=path, model=model, models=" or ".join(MODELS))
    if not models:
        raise Unreadable(code="result_without_model", file=path)
    axes: dict[tuple[str, str], list[tuple[str, int]]] = {}
    for place, item in found.items():
        _check_attributes(place, item, path)
        entry = entry_of(place)
        if entry is not None:
            axis_lengths = _check_form(place, item, entry.form, path)
            if entry.form.types != ("group",):
                _check_column(place, item, file["names"], path)
            for axis, length in axis_lengths:
                if not axis.isdecimal() and axis not in OF_ITEMS:
                    axes.setdefault((_scope(place, axis), axis), []).append((place, length))
    for (_, axis), lengths in axes.items():
        lengths.sort(key=lambda one: not one[0].endswith("/history/time_s"))
        first, wanted = lengths[0]
        for place, length in lengths[1:]:
            if length != wanted:
                raise _damaged(path, f"{place} has {length} {axis}, {first.rpartition('/')[2]} has {wanted}")
        if axis == "samples" and not wanted:
            raise _damaged(path, f"{first} has no samples")


def _damaged(path: Path, cause: str) -> Unreadable:
    return Unreadable(code="damaged", cause=cause, file=path, object=cause.split()[0])


def _check_missing(found: dict[str, Any], models: list[str], path: Path) -> None:
    for entry in ENTRIES:
        if not entry.required:
            continue
        for model in models if "{model}" in entry.path else [""]:
            place, _, attribute = entry.path.replace("{model}", model).partition("@")
            if place not in found or (attribute and attribute not in found[place].attrs):
                raise Unreadable(code="object_missing", file=path, object=place, at="@" if attribute else "",
                                 attribute=attribute)


def _type(item: Any) -> str:
    """Return the layout's name for the type of an HDF5 object or of an attribute's value."""
    if isinstance(item, h5py.Group):
        return "group"
    if isinstance(item, str):
        return "text"
    if not isinstance(item, (h5py.Dataset, np.ndarray, np.generic)):
        return type(item).__name__
    if h5py.check_string_dtype(item.dtype) is not None:
        return "text"
    return str(item.dtype)


def _check_form(place: str, item: Any, form: Form, path: Path) -> list[tuple[str, int]]:
    """Raise Unreadable if the layout does not allow a type or a shape; return the lengths of the axes by name."""
    found = _type(item)
    if found not in form.types:
        raise _damaged(path, f"{place} is {found}, must be {' or '.join(form.types)}")
    if found == "group":
        return []
    shape = () if isinstance(item, str) else item.shape
    for axes in form.shapes:
        if shape is not None and len(shape) == len(axes):
            pairs = list(zip(axes, shape))
            if all(length == int(axis) for axis, length in pairs if axis.isdecimal()):
                return pairs
    raise _damaged(path, f"{place} has shape {shape}, must be {form}")


def _check_column(place: str, item: h5py.Dataset, names: h5py.Group, path: Path) -> None:
    """Raise Unreadable if the length of a column's second axis differs from that of its list of names."""
    items = item.attrs.get("items")
    if not place.startswith("/models/"):
        return
    if len(item.shape) < 2:
        if items is not None:
            raise _damaged(path, f"{place}@items = {items!r}, but it has no second axis")
        return
    if items not in names or names[items].shape != item.shape[1:2]:
        raise _damaged(path, f"{place} has {item.shape[1]} items, which /names does not name")


def _scope(place: str, axis: str) -> str:
    """Return the scope within which an axis has a single length."""
    if axis in ("samples", "events"):
        return "/".join(place.split("/")[:3])  # of a model
    return place if axis in ("sentences", "vertices", "triangles") else place.rpartition("/")[0]


def _check_attributes(place: str, item: Any, path: Path) -> None:
    """Raise Unreadable for attributes whose types do not match the layout."""
    for key, value in item.attrs.items():
        if isinstance(item, h5py.Group):
            entry = entry_of(f"{place}@{key}")
            if entry is not None:
                _check_form(f"{place}@{key}", value, entry.form, path)
            elif _type(value) not in ("text", "int64", "float64", "bool") or np.ndim(value):
                raise _damaged(path, f"{place}@{key} is {_type(value)}, must be one text or number")
        elif key in ("unit", "items", "note"):
            if not isinstance(value, str):
                raise _damaged(path, f"{place}@{key} is {_type(value)}, must be text")
        elif key == "labels" and (_type(value) != "text" or np.ndim(value) != 1):
            raise _damaged(path, f"{place}@labels is {_type(value)}, must be a list of texts")
