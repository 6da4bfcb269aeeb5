# SPDX-License-Identifier: GPL-3.0-or-later
"""Matrices of Abaqus: ``*MATRIX OUTPUT`` (matrix input, labels, coordinate) and ``*USER ELEMENT`` with ``*MATRIX``."""
from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path

import attrs
import numpy as np

from statejump.bodies.formats.labelled import Label, Labelled, by_labels
from statejump.core.errors import Unreadable
from statejump.kinds.truss.importing.model import text_of

LARGEST_BYTES = 1 << 30
HELD = 1e36  # diagonal entry of a dof that a support holds
USER = re.compile(r"\*USER\s+ELEMENT\s*,.*NODES\s*=\s*(\d+)", re.IGNORECASE)
TYPE = re.compile(r"\*MATRIX\s*,.*TYPE\s*=\s*(\w+)", re.IGNORECASE)
NUMBERS = re.compile(r"\*\*[\s\d,]+$")
SPLIT = re.compile(r"[,\s]+")
KINDS = {"STIFFNESS": "STIFFNESS", "MASS": "MASS"}
SUFFIX = re.compile(r"_(STIF|MASS|DMPV|DMPS|LOAD)\d*$", re.IGNORECASE)


def read(path: Path) -> dict[str, Labelled]:
    """Return the matrices of a file by kind, ``STIFFNESS`` or ``MASS``. A matrix in coordinate format has no labels.

    :raises Unreadable: the file does not exist, or is damaged
    """
    lines = text_of(path, LARGEST_BYTES)
    try:
        if any(USER.match(line.strip()) for line in lines[:1000]):
            return _user_element(path, lines)
        return _entries(path, lines)
    except (ValueError, IndexError):
        raise Unreadable(code="matrix_file_damaged", file=path, form="a matrix file of Abaqus") from None


def _words(line: str) -> list[str]:
    return [word for word in SPLIT.split(line.strip()) if word]


def _number(text: str) -> float:
    return float(text.upper().replace("D", "E"))


def _entries(path: Path, lines: Sequence[str]) -> dict[str, Labelled]:
    suffix = SUFFIX.search(path.stem)
    name = "MASS" if suffix and suffix[1].upper() == "MASS" else "STIFFNESS"
    if suffix and suffix[1].upper() not in ("STIF", "MASS"):
        raise Unreadable(code="matrix_other_kind", file=path, kind=suffix[1].upper())
    entries: list[tuple[Label, Label, float]] = []
    places: list[tuple[int, int, float]] = []
    for line in lines:
        words = _words(line)
        if not words or line.lstrip().startswith("*"):
            continue
        if len(words) == 5:
            row, of_row, column, of_column = (int(word) for word in words[:4])
            entries.append(((row, of_row), (column, of_column), _number(words[4])))
        elif len(words) == 3:
            places.append((int(words[0]), int(words[1]), _number(words[2])))
        else:
            raise ValueError
    held = sorted({row for row, column, value in entries if row == column and value >= HELD})
    if held or any(i == j and value >= HELD for i, j, value in places):
        raise Unreadable(code="matrix_held", file=path, node=held[0][0] if held else 0)
    inner = next((label[0] for row, column, _ in entries for label in (row, column) if label[0] < 0), None)
    if inner is not None:
        raise Unreadable(code="matrix_inner_nodes", file=path, node=inner)
    if entries:
        return {name: by_labels(name, entries, True, True)}
    size = max(max(i, j) for i, j, _ in places)
    values = np.zeros((size, size))
    for i, j, value in places:
        values[i - 1, j - 1] = values[j - 1, i - 1] = value
    return {name: Labelled(name, values)}


@attrs.define
class _Element:
    """What the lines of a ``*USER ELEMENT`` have stated."""

    count: int
    nodes: list[int] = attrs.field(factory=list)
    dofs: list[tuple[int, list[int]]] = attrs.field(factory=list)  # from this node on
    values: dict[str, list[float]] = attrs.field(factory=dict)

    def labels(self) -> list[Label]:
        """Return the labels of the rows: of each node, or of each dof (CalculiX)."""
        per_node: list[list[int]] = []
        for place in range(1, len(self.nodes) + 1):
            per_node.append(next(dofs for start, dofs in reversed(self.dofs) if start <= place))
        return [(node, dof) for node, dofs in zip(self.nodes, per_node) for dof in dofs]


def _user_element(path: Path, lines: Sequence[str]) -> dict[str, Labelled]:
    element, kind = _Element(0), ""
    for line in lines:
        text = line.strip()
        if found := USER.match(text):
            element, kind = _Element(int(found[1])), ""
        elif found := TYPE.match(text):
            kind = KINDS.get(found[1].upper(), "OTHER")
            element.values[kind] = []
        elif NUMBERS.match(text):
            if len(element.nodes) < element.count:
                element.nodes += [int(word) for word in _words(text[2:])]
        elif text.startswith("*") or not text:
            kind = kind if text.startswith("**") or not text else "OTHER"
        elif not element.values:
            words = [int(word) for word in _words(text)]
            element.dofs.append((1, words) if not element.dofs else (words[0], words[1:]))
        elif kind in element.values:
            element.values[kind] += [_number(word) for word in _words(text)]
    labels = element.labels()
    if len(set(element.nodes)) < len(element.nodes):
        raise Unreadable(code="matrix_of_calculix", file=path)
    if len(element.nodes) != element.count or len(set(labels)) != len(labels):
        raise ValueError
    found_matrices = {}
    for kind in KINDS:
        if kind in element.values:
            found_matrices[kind] = Labelled(kind, _triangle(element.values[kind], len(labels)), tuple(labels),
                                            tuple(labels))
    return found_matrices


def _triangle(values: Sequence[float], size: int) -> np.ndarray:
    """Return a symmetric matrix from the rows of its lower triangle."""
    if len(values) != size * (size + 1) // 2:
        raise ValueError
    found = np.zeros((size, size))
    found[np.tril_indices(size)] = values
    return np.asarray(found + np.tril(found, -1).T)
