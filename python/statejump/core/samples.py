# SPDX-License-Identifier: GPL-3.0-or-later
"""Samples that a run leaves on its way: a line with the names of columns, as a list of JSON, then one row after the
other, numbers in double precision. What a row cut short leaves behind the last whole one says nothing."""
from __future__ import annotations

import json
from collections.abc import Iterable, Sequence
from pathlib import Path

import numpy as np

from statejump.core.errors import Unreadable

NUMBER = np.dtype("<f8")


def names_line(names: Iterable[str]) -> bytes:
    """Return the beginning of a file."""
    return json.dumps(list(names)).encode() + b"\n"


def rows_of(columns: Sequence[np.ndarray]) -> bytes:
    """Return rows as they stand in a file, of columns of equal length; arrays with two axes are several of them."""
    return np.column_stack(columns).astype(NUMBER).tobytes()


def read_samples(path: Path, whole: bool = True) -> dict[str, np.ndarray]:
    """Return the columns of a file.

    :param whole: whether the last row has to be whole; else it is left out
    :raises Unreadable: the file holds no samples, or not these
    """
    with path.open("rb") as stream:
        names = json.loads(stream.readline() or b"[]")
        numbers = stream.read()
    if not isinstance(names, list) or not all(isinstance(name, str) for name in names):
        raise Unreadable(code="samples_without_names", file=path)
    size = NUMBER.itemsize * len(names)
    if not names or len(numbers) < size:
        raise Unreadable(code="no_samples", file=path)
    if whole and len(numbers) % size:
        raise Unreadable(code="samples_cut", file=path)
    rows = np.frombuffer(numbers[: len(numbers) // size * size], NUMBER).reshape(-1, len(names))
    return dict(zip(names, rows.T.copy()))
