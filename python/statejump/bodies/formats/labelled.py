# SPDX-License-Identifier: GPL-3.0-or-later
"""A matrix whose rows and columns have labels."""
from __future__ import annotations

from collections.abc import Sequence

import attrs
import numpy as np
from numpy.typing import NDArray

from statejump.core.errors import Unreadable

Matrix = NDArray[np.float64]
Label = tuple[int, int]  # number of a node and its direction, 1 to 6; direction 0 of a mode
MODE = 0


@attrs.frozen
class Labelled:
    """A matrix by labels. Entries that a file omits are zero.

    :param rows: label of each row; empty: the file has no labels
    :param columns: label of each column; the number of a load case has the direction 0
    """

    name: str
    values: Matrix
    rows: tuple[Label, ...] = ()
    columns: tuple[Label, ...] = ()


def by_labels(name: str, entries: Sequence[tuple[Label, Label, float]], symmetric: bool, mirrored: bool = False
              ) -> Labelled:
    """Return a matrix of entries (row, column, value).

    :param symmetric: whether rows and columns have the same labels
    :param mirrored: whether an entry also stands for its mirror image
    :raises Unreadable: two different entries have the same labels
    """
    rows = {row for row, _, _ in entries}
    columns = {column for _, column, _ in entries}
    if symmetric:
        rows = columns = rows | columns
    row_places = {label: place for place, label in enumerate(sorted(rows))}
    column_places = {label: place for place, label in enumerate(sorted(columns))}
    values = np.zeros((len(row_places), len(column_places)))
    known: dict[tuple[int, int], float] = {}
    for row, column, value in entries:
        at = (row_places[row], column_places[column])
        if known.setdefault(at, value) != value:
            raise Unreadable(code="matrix_entry_twice", matrix=name, row=list(row), column=list(column))
        values[at] = value
    if mirrored:
        for (row_at, column_at), value in known.items():
            if (column_at, row_at) not in known:
                values[column_at, row_at] = value
    return Labelled(name, values, tuple(row_places), tuple(column_places))
