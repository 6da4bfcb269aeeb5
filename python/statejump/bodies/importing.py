# SPDX-License-Identifier: GPL-3.0-or-later
"""Import of reduced matrices: Nastran's DMIG, op2 and op4 files, matrix files of Abaqus."""
from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from types import MappingProxyType

import attrs
import numpy as np
from numpy.typing import NDArray

from statejump.bodies.body import CondensedBody, from_arrays
from statejump.bodies.formats import bulk, mtx, op2, op4
from statejump.bodies.formats.labelled import MODE, Label, Labelled
from statejump.core.errors import NotAllowed, StatejumpError, Unreadable, located
from statejump.core.table_files import check_table, read_known
from statejump.kinds.truss.importing.abaqus.nodes import read_nodes
from statejump.kinds.truss.importing.to_case import Units

Matrix = NDArray[np.float64]

STIFFNESS = ("KAAX", "KAA", "MATK", "KXX", "K2GG", "K2PP", "STIFFNESS", "KGG", "K")
MASS = ("MAAX", "MAA", "MATM", "MXX", "M2GG", "M2PP", "MASS", "MGG", "M")
DECKS = (".inp",)
OF_MATRICES = {".op4": op4.read, ".op2": op2.read, ".mtx": mtx.read}
TABLE = (".csv",)


@attrs.define
class _Found:
    """What the files contain, in their units."""

    matrices: dict[str, Labelled] = attrs.field(factory=dict)
    files: dict[str, Path] = attrs.field(factory=dict)
    positions: dict[int, Matrix] = attrs.field(factory=dict)
    axes: dict[int, Matrix] = attrs.field(factory=dict)
    labels: tuple[Label, ...] = ()


def import_body(
    files: Sequence[str | Path], *, stiffness: str | None = None, mass: str | None = None, load: str | None = None,
    pattern_names: Sequence[str] = (), units: Units = Units(), reference_temperature_K: float | None = None,
    systems: Mapping[int, int] = MappingProxyType({}),
) -> CondensedBody:
    """Return the condensed body in files of a finite-element program.

    Files are recognised by their suffix: ``.op4``; ``.op2``; ``.mtx``; ``.inp`` (Abaqus: nodes and ``*TRANSFORM``);
    ``.csv`` (nodes: columns name, x_m, y_m, z_m); all others are Nastran's bulk data (``.pch``, ``.asm``, ``.bdf``).

    :param stiffness: name of the stiffness; default: a usual name, such as KAAX, KAA, KXX
    :param load: name of a matrix of thermal loads, a column for each pattern
    :param pattern_names: names of its columns
    :param units: units of the files
    :param systems: displacement coordinate systems of nodes of Nastran, in place of those of the GRID cards
    :raises StatejumpError: files are damaged or incomplete, or belong to no free linear body
    """
    paths = [Path(one) for one in files]
    found = _read(paths, units, systems)
    name = _chosen(found, "stiffness", stiffness, STIFFNESS)
    given = found.matrices[name]
    labels = _labels(given, found, paths)
    place = found.files.get(name, paths[0])
    with located(file=place):
        nodes = _nodes(labels, found)
        turn = _turn(nodes, found, sum(1 for _, direction in labels if direction == MODE), units)
        size = len(turn)
        order = _order(nodes, labels)
        kept = _brought(given, labels, order, turn, size)
        mass_name = _optional(found, "mass", mass, MASS)
        masses = None if mass_name is None else _brought(found.matrices[mass_name], labels, order, turn, size)
        kept, masses, modes = _without_empty_modes(kept, masses, sum(nodes.values()))
        if masses is not None:
            masses *= units.mass / (units.force_N / units.length_m)
        loads = None if load is None else np.sqrt(units.force_N * units.length_m) * _loads(
            found, load, labels, order, turn, modes, len(pattern_names))
        return from_arrays(
            [str(node) for node in nodes], np.array([found.positions[node] for node in nodes]) * units.length_m, kept,
            node_freedoms=list(nodes.values()), mass=masses, loads=loads,
            pattern_names=pattern_names if load is not None else (),
            reference_temperature_K=reference_temperature_K, source=", ".join(path.name for path in paths))


def _read(paths: Sequence[Path], units: Units, systems: Mapping[int, int]) -> _Found:
    found = _Found()
    texts = []
    for path in paths:
        suffix = path.suffix.lower()
        if suffix in OF_MATRICES:
            for name, matrix in OF_MATRICES[suffix](path).items():
                found.matrices[name], found.files[name] = matrix, path
        elif suffix in DECKS:
            positions, axes, _ = read_nodes(path)
            found.positions.update({int(node): place for node, place in positions.items() if node.isdecimal()})
            found.axes.update({int(node): place for node, place in axes.items() if node.isdecimal()})
        elif suffix in TABLE:
            found.positions.update({node: place / units.length_m for node, place in _table(path).items()})
        else:
            texts.append(path)
    if texts:
        content = bulk.read(texts, systems)
        found.matrices.update(content.matrices)
        found.files.update(dict.fromkeys(content.matrices, texts[0]))
        found.positions.update(content.positions)
        found.axes.update(content.axes)
        found.labels = content.labels
    return found


def _table(path: Path) -> dict[int, Matrix]:
    check_table(path, "FILE", "file_not_found")
    columns = read_known(path, ("name", "x_m", "y_m", "z_m"))
    missing = next((name for name in ("name", "x_m", "y_m", "z_m") if name not in columns), None)
    if missing is not None:
        raise Unreadable(code="missing_column", file=path, column=missing, needed="name, x_m, y_m, z_m")
    return {int(name): np.array(place, dtype=float)
            for name, *place in zip(columns["name"], columns["x_m"], columns["y_m"], columns["z_m"])}


def _chosen(found: _Found, key: str, given: str | None, usual: Sequence[str]) -> str:
    name = _optional(found, key, given, usual)
    if name is None:
        known = ", ".join(found.matrices) or "none"
        raise StatejumpError(code="matrix_missing", known=known)
    return name


def _optional(found: _Found, key: str, given: str | None, usual: Sequence[str]) -> str | None:
    if given is not None:
        if given.upper() not in found.matrices:
            raise NotAllowed(key, given, code="matrix_unknown", known=", ".join(found.matrices) or "none")
        return given.upper()
    return next((name for name in usual if name in found.matrices and found.matrices[name].values.any()), None)


def _labels(given: Labelled, found: _Found, paths: Sequence[Path]) -> tuple[Label, ...]:
    """Return the labels of the rows of the stiffness."""
    if given.rows:
        return given.rows
    size = len(given.values)
    if not found.labels:  # rows by ascending number of the nodes, with equally many dofs each
        nodes = sorted(found.positions)
        if nodes and size in (3 * len(nodes), 6 * len(nodes)):
            return tuple((node, k + 1) for node in nodes for k in range(size // len(nodes)))
        raise Unreadable(code="matrix_without_labels", file=found.files.get(given.name), rows=size)
    if len(found.labels) != size:
        raise Unreadable(code="matrix_labels_count", file=found.files.get(given.name), rows=size,
                         labels=len(found.labels))
    return found.labels


def _nodes(labels: Iterable[Label], found: _Found) -> dict[int, int]:
    """Return the number of dofs of each node, 3 or 6. A dof without a row has no stiffness."""
    directions: dict[int, set[int]] = {}
    for node, direction in labels:
        if direction != MODE:
            directions.setdefault(node, set()).add(direction)
    missing = next((node for node in directions if node not in found.positions), None)
    if missing is not None:
        raise StatejumpError(code="matrix_node_missing", node=missing)
    if not directions:
        raise StatejumpError(code="matrix_without_nodes")
    return {node: 3 if several <= {1, 2, 3} else 6 for node, several in directions.items()}


def _order(nodes: Mapping[int, int], labels: Sequence[Label]) -> dict[Label, int]:
    """Return the place in the body of each label."""
    starts = dict(zip(nodes, np.cumsum([0, *nodes.values()]).tolist()))
    order = {(node, direction): starts[node] + direction - 1 for node, direction in labels if direction != MODE}
    modes = [label for label in labels if label[1] == MODE]
    return order | {label: sum(nodes.values()) + place for place, label in enumerate(modes)}


def _turn(nodes: Mapping[int, int], found: _Found, modes: int, units: Units) -> Matrix:
    """Return the matrix that converts a stiffness in the axes and units of the files, from both sides. It contains the
    square root of the unit of energy."""
    size = sum(nodes.values())
    turn = np.eye(size + modes)
    at = 0
    for node, dofs in nodes.items():
        axes = found.axes.get(node, np.eye(3))
        for block in range(dofs // 3):
            turn[at:at + 3, at:at + 3] = axes.T / (units.length_m if block == 0 else 1.0)
            at += 3
    return turn * np.sqrt(units.force_N * units.length_m)


def _placed(given: Labelled, labels: Sequence[Label], order: Mapping[Label, int], size: int) -> Matrix:
    rows = given.rows or (labels if len(given.values) == len(labels) else ())
    stray = next((label for label in rows if label not in order), None)
    if stray is not None or not rows:
        raise StatejumpError(code="matrix_other_rows", matrix=given.name, rows=len(given.values))
    places = [order[label] for label in rows]
    placed = np.zeros((size, given.values.shape[1]))
    placed[places] = given.values
    return placed


def _brought(given: Labelled, labels: Sequence[Label], order: Mapping[Label, int], turn: Matrix, size: int) -> Matrix:
    """Return a square matrix in the order, the axes and the units of the body."""
    half = _placed(given, labels, order, size)
    columns = given.columns or given.rows
    whole = _placed(Labelled(given.name, half.T, columns), labels, order, size)
    return np.asarray(turn @ whole.T @ turn.T)


def _loads(found: _Found, name: str, labels: Sequence[Label], order: Mapping[Label, int], turn: Matrix,
           modes: NDArray[np.int64], patterns: int) -> Matrix:
    if name.upper() not in found.matrices:
        raise NotAllowed("load", name, code="matrix_unknown", known=", ".join(found.matrices))
    given = found.matrices[name.upper()]
    placed = _placed(given, labels, order, len(turn))
    if placed.shape[1] != patterns:
        raise NotAllowed("load", name, code="matrix_load_columns", columns=placed.shape[1], names=patterns)
    return np.asarray((turn @ placed).T[:, modes])


def _without_empty_modes(stiffness: Matrix, mass: Matrix | None, nodes: int
                         ) -> tuple[Matrix, Matrix | None, NDArray[np.int64]]:
    """Return the matrices without modes that have neither stiffness nor mass: scalar points that were not used."""
    used = stiffness.any(axis=1) | (np.zeros(len(stiffness), dtype=bool) if mass is None else mass.any(axis=1))
    used[:nodes] = True
    kept = np.flatnonzero(used)
    return (stiffness[np.ix_(kept, kept)], None if mass is None else mass[np.ix_(kept, kept)], kept)
