# SPDX-License-Identifier: GPL-3.0-or-later
"""File in which a running model stores its samples. The first line has the column names as a JSON list; rows of numbers
in double precision follow. Readers ignore an incomplete last row."""
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
    """Return the bytes of rows of samples, from columns of equal length; a 2-D array holds several columns."""
    return np.column_stack(columns).astype(NUMBER).tobytes()


def read_samples(path: Path, whole: bool = True) -> dict[str, np.ndarray]:
    """Return the columns of a file of samples.

    :param whole: whether an incomplete last row is an error; otherwise it is omitted
    :raises Unreadable: the file contains no samples, or its rows do not match its header
    """
    with path.open("rb") as stream:
        names = json.loads(stream.readline() or b"[]")
        numbers = stream.read()
    if not isinstance(names, list) or not all(isinstance(name, str) for name in names):
        raise Unreadable(code="samples_without_header", file=path)
    size = NUMBER.itemsize * len(names)
    if not names or len(numbers) < size:
        raise Unreadable(code="no_samples", file=path)
    if whole and len(numbers) % size:
        raise Unreadable(code="truncated_samples", file=path)
    rows = np.frombuffer(numbers[: len(numbers) // size * size], NUMBER).reshape(-1, len(names))
    return dict(zip(names, rows.T.copy()))
