# SPDX-License-Identifier: GPL-3.0-or-later
"""Nodes and bars of a mesh. VTK reads its own formats, the library meshio all others. Meshes are in SI units, without
sections and supports. Properties of bars are cell data named after case keys, or options."""
from __future__ import annotations

import contextlib
import io
import re
import subprocess
import sys
import warnings
import zipfile
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np

from statejump.core import libraries
from statejump.core.errors import StatejumpError, Unreadable
from statejump.core.hdf5 import objects
from statejump.core.reading import check_size, is_file
from statejump.kinds.truss.importing.model import LARGEST_BYTES, Bar, Deck, quoted

FORMATS = {".vtk": "vtk", ".vtu": "vtu", ".vtp": "vtp", ".msh": "gmsh", ".med": "med", ".mesh": "medit"}
BY_VTK = (".vtk", ".vtu", ".vtp")
ADDRESS = re.compile(r"\(0x[0-9a-f]+\)")  # address of an object in messages of VTK
LINES = ("line", "polyline", "line3")  # cells of two nodes, of straight segments, or with an omitted middle node
# Cell data that are read, and the attribute of a bar that they set.
DATA = {"young_modulus_Pa": "young_modulus", "cross_section_area_m2": "area", "thermal_expansion_per_K": "expansion",
        "density_kg_per_m3": "density", "poisson_ratio": "poisson_ratio", "temperature_change_K": "temperature_change"}


def read(path: Path) -> Deck:
    """Return the content of a mesh. The names of nodes and bars are their numbers, counted from 1.

    :raises StatejumpError: VTK or meshio is missing, or the file is faulty: one sentence with its name
    """
    mesh = _read(path)
    deck = Deck(path)
    points = np.asarray(mesh.points, dtype=float)
    if points.ndim != 2 or points.shape[1] not in (2, 3) or not np.isfinite(points).all():
        raise deck.fail(0, "mesh_bad_data", problem="the points are not two or three finite numbers each")
    deck.room(0, len(points))
    for number, point in enumerate(points, start=1):
        x, y, z = (*map(float, point), 0.0)[:3]
        deck.add_node(0, str(number), (x, y, z))
    deck.take("point", "node", len(points))
    for block, cells in enumerate(mesh.cells):
        if cells.type in LINES:
            _add(deck, mesh, block, cells.type, np.asarray(cells.data))
        else:
            deck.leave(f"cells {cells.type}", "no part of a truss", 0)
    for what, names in (("point data", mesh.point_data), ("cell data", set(mesh.cell_data) - set(DATA))):
        for name in sorted(names):
            deck.leave(f"{what} {quoted(name)}", "is not read", 0)
    return deck


def _add(deck: Deck, mesh: Any, block: int, kind: str, ends: np.ndarray) -> None:
    """Add the bars of a block of lines."""
    deck.room(0, len(deck.bars) + len(ends))
    if len(ends) and not (0 <= ends.min() and ends.max() < len(deck.nodes)):
        raise deck.fail(0, "mesh_bad_data", problem=f"cells {kind} name points that are not there")
    known = {}
    for name, key in DATA.items():
        values = mesh.cell_data[name][block] if name in mesh.cell_data else None
        if values is not None:
            known[key] = np.asarray(values, dtype=float).ravel()
            if len(known[key]) != len(ends) or not np.isfinite(known[key]).all():
                raise deck.fail(0, "mesh_bad_data",
                                problem=f"cell data {quoted(name)} are not one finite number for each line")
            deck.take(f"cell data {quoted(name)}", "number of its link", len(ends))
    for place, nodes in enumerate(ends):
        first, second = (str(int(node) + 1) for node in nodes[:2])
        numbers: dict[str, Any] = {key: float(values[place]) for key, values in known.items()}
        deck.bars.append(Bar(str(len(deck.bars) + 1), (first, second), "line", **numbers))
    deck.take(f"cells {kind}", "link", len(ends))
    if kind == "line3" and len(ends):
        deck.leave("cells line3", "the node in the middle: a link is straight", 0)


def _read(path: Path) -> Any:
    if not is_file(path):
        raise Unreadable(code="file_not_found", file=path)
    check_size(path, LARGEST_BYTES)
    return _by_vtk(path) if path.suffix.lower() in BY_VTK else _by_meshio(path)


def _by_vtk(path: Path) -> Any:
    """Return points, cells and data with the interface of meshio."""
    program = Path(__file__).with_name("vtk_lines.py")
    done = subprocess.run([sys.executable, str(program), str(path.resolve())], stdin=subprocess.DEVNULL,
                          capture_output=True, check=False)
    said = done.stderr.decode("utf-8", "replace")
    if "No module named 'vtkmodules" in said:
        raise StatejumpError(code="vtk_missing", file=path)
    try:
        with np.load(io.BytesIO(done.stdout), allow_pickle=False) as archive:
            found = dict(archive)
        points = found["points"]
    except (ValueError, EOFError, OSError, KeyError, zipfile.BadZipFile):
        cause = ADDRESS.sub("", said.rsplit("): ", 1)[-1]) or f"VTK ends with status {done.returncode}"
        raise Unreadable(code="not_vtk", cause=" ".join(cause.split())[:200], file=path) from None
    named: dict[str, dict[str, np.ndarray]] = {"cells": {}, "ends": {}, "point data": {}, "cell data": {}}
    for key, values in found.items():
        group, _, name = key.partition("/")
        if name:
            named[group][name] = values
    blocks = [(kind, places) for kind, places in named["cells"].items()]
    return SimpleNamespace(
        points=points, point_data=named["point data"],
        cells=[SimpleNamespace(type=kind, data=named["ends"].get(kind, places)) for kind, places in blocks],
        cell_data={name: [values[places] if len(values) else values for _, places in blocks]
                   for name, values in named["cell data"].items()})


def _by_meshio(path: Path) -> Any:
    try:
        import meshio  # 0.3 s, which may be missing
    except ImportError:
        raise StatejumpError(code="meshio_missing", file=path) from None
    form = FORMATS[path.suffix.lower()]
    try:
        # meshio prints remarks about a file, and for some faults it tries to end the program.
        with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()), \
                warnings.catch_warnings():
            warnings.filterwarnings("error", message="string or file could not be read")  # numpy's, of a short file
            if form == "med":
                _check_hdf5(path)
            return meshio.read(path, form)
    except StatejumpError:
        raise
    except (Exception, SystemExit) as failure:  # third-party parsers raise any exception for a damaged file
        cause = " ".join(str(failure).split()) or type(failure).__name__
        raise Unreadable(code="not_meshio", cause=cause[:200], file=path, form=form) from None


def _check_hdf5(path: Path) -> None:
    """Raise Unreadable for an HDF5 file that has parts in other files."""
    h5py = libraries.h5py()

    with h5py.File(path, "r") as file:
        objects(file, path)
