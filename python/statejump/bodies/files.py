# SPDX-License-Identifier: GPL-3.0-or-later
"""Files of condensed bodies (HDF5). docs/reference/body_file.md describes the layout."""
from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from statejump.bodies.body import CondensedBody, Mesh, Points, from_arrays
from statejump.bodies.mesh_deck import MeshDeck
from statejump.core import libraries
from statejump.core.errors import Unreadable, located
from statejump.core.hdf5 import foreign, is_ours, made, objects, opened
from statejump.core.reading import is_file

if TYPE_CHECKING:
    import h5py

FORMAT = "statejump condensed body"
VERSION = 1
UNITS = "SI"


def write_body(path: str | Path, body: CondensedBody) -> None:
    """Write a condensed body.

    :raises NotWritten: the file cannot be written
    """
    with made(Path(path)) as file:
        file.attrs.update({"format": FORMAT, "version": VERSION, "units": UNITS, "source": body.source,
                           "patch": body.patch})
        if body.reference_temperature_K is not None:
            file.attrs["reference_temperature_K"] = float(body.reference_temperature_K)
        arrays: dict[str, Any] = {
            "node/name": body.node_names, "node/position_m": body.node_positions_m,
            "node/freedoms": body.node_freedoms, "stiffness": body.stiffness,
            "pattern/name": body.pattern_names or None, "pattern/free_shape": body.free_shapes, "mass": body.mass}
        if not body.pattern_names:
            del arrays["pattern/free_shape"]
        if body.points is not None:
            points = body.points
            arrays |= {"point/name": points.names, "point/position_m": points.positions_m,
                       "point/rows": points.rows, "point/pattern": points.patterns}
        if body.mesh is not None:
            mesh = body.mesh
            arrays |= {"mesh/point_m": mesh.points_m, "mesh/cells": mesh.cells, "mesh/rows": mesh.rows,
                       "mesh/pattern": mesh.patterns}
        if body.deck is not None:
            arrays |= _of_deck(body.deck)
            file.attrs.update({"deck_length_m": body.deck.length_m, "deck_force_N": body.deck.force_N})
        for name, values in arrays.items():
            if values is None:
                continue
            if isinstance(values, tuple):
                file.create_dataset(name, data=list(values), dtype=libraries.h5py().string_dtype())
            else:
                packed = {"compression": "gzip"} if values.size > 4096 else {}
                file.create_dataset(name, data=values, **packed)


def _of_deck(deck: MeshDeck) -> dict[str, Any]:
    text = np.frombuffer(deck.text.encode("utf-8"), dtype=np.uint8)
    return {"deck/text": text, "deck/kind": deck.kinds, "deck/node": deck.nodes,
            "deck/temperature": deck.temperatures, "deck/gradient": deck.gradients}


def read_body(path: str | Path) -> CondensedBody:
    """Return a condensed body: read, checked, symmetrised and with rigid motions projected out.

    Files that another program wrote with an HDF5 library are accepted.

    :raises StatejumpError: the file is no body, is damaged, or its matrices belong to no free linear body; the message
        states the probable cause
    """
    path = Path(path)
    if not is_file(path):
        raise Unreadable(code="file_not_found", file=path)
    with located(file=path):
        if is_ours(path):
            with opened(path) as file:
                return _body({"/": file, **objects(file, path)})
        with foreign(path) as found:
            return _body(found)


def _body(found: dict[str, h5py.Group | h5py.Dataset]) -> CondensedBody:
    about = dict(found["/"].attrs)
    if _text(about.get("format")) != FORMAT:
        raise Unreadable(code="body_format", wanted=FORMAT)
    if not isinstance(about.get("version"), (int, np.integer)) or about["version"] > VERSION:
        raise Unreadable(code="body_version", found=str(about.get("version")), newest=VERSION)
    if _text(about.get("units", UNITS)) != UNITS:
        raise Unreadable(code="body_file_units", found=_text(about["units"]))
    reference = about.get("reference_temperature_K")
    patterns = _names(found, "pattern/name", ())
    return from_arrays(
        _names(found, "node/name"), _numbers(found, "node/position_m"), _numbers(found, "stiffness"),
        node_freedoms=_numbers(found, "node/freedoms"), pattern_names=patterns,
        free_shapes=_numbers(found, "pattern/free_shape", needed=False),
        loads=_numbers(found, "pattern/load", needed=False), mass=_numbers(found, "mass", needed=False),
        points=_points(found, len(patterns)), mesh=_mesh(found),
        reference_temperature_K=None if reference is None else float(np.asarray(reference).item()),
        source=_text(about.get("source", "")), patch=_text(about.get("patch", "")), deck=_deck(found, about))


def _deck(found: dict[str, h5py.Group | h5py.Dataset], about: dict[str, Any]) -> MeshDeck | None:
    if "/deck/text" not in found:
        return None
    text = np.asarray(_numbers(found, "deck/text"), dtype=np.uint8).tobytes().decode("utf-8", "replace")
    units = [float(np.asarray(about.get(key, 1.0)).item()) for key in ("deck_length_m", "deck_force_N")]
    return MeshDeck(text, _names(found, "deck/kind"), _numbers(found, "deck/node"),
                    _numbers(found, "deck/temperature"), _numbers(found, "deck/gradient"), *units)


def _points(found: dict[str, h5py.Group | h5py.Dataset], patterns: int) -> Points | None:
    if "/point/name" not in found:
        return None
    names = _names(found, "point/name")
    moved = _numbers(found, "point/pattern", needed=False)
    return Points(names, _numbers(found, "point/position_m"), _numbers(found, "point/rows"),
                  np.zeros((patterns, 3 * len(names))) if moved is None else moved)


def _mesh(found: dict[str, h5py.Group | h5py.Dataset]) -> Mesh | None:
    if "/mesh/cells" not in found:
        return None
    return Mesh(_numbers(found, "mesh/point_m"), _numbers(found, "mesh/cells"),
                _numbers(found, "mesh/rows", needed=False), _numbers(found, "mesh/pattern", needed=False))


def _text(value: Any) -> str:
    return value.decode("utf-8", "replace") if isinstance(value, bytes) else str(value)


def _dataset(found: dict[str, h5py.Group | h5py.Dataset], name: str, needed: bool) -> Any:
    item = found.get(f"/{name}")
    if item is None and not needed:
        return None
    if not isinstance(item, libraries.h5py().Dataset):
        raise Unreadable(code="body_data_missing", data_set=name)
    return item


def _names(found: dict[str, h5py.Group | h5py.Dataset], name: str, default: tuple[str, ...] | None = None
           ) -> tuple[str, ...]:
    item = _dataset(found, name, default is None)
    if item is None:
        return default or ()
    values = np.atleast_1d(item[()])
    if values.dtype.kind not in "SO":
        raise Unreadable(code="body_data_type", data_set=name, wanted="texts")
    return tuple(_text(one) for one in values.tolist())


def _numbers(found: dict[str, h5py.Group | h5py.Dataset], name: str, needed: bool = True) -> Any:
    item = _dataset(found, name, needed)
    if item is None:
        return None
    if item.dtype.kind not in "iuf" or item.shape is None:
        raise Unreadable(code="body_data_type", data_set=name, wanted="numbers")
    return item[()]
