# SPDX-License-Identifier: GPL-3.0-or-later
"""Writer of all tables: CSV with units in the headers, Markdown, JSON."""
from __future__ import annotations

import csv
import json
import math
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from html import escape
from pathlib import Path
from typing import Any

import numpy as np

from statejump.core.errors import NotAllowed, StatejumpError
from statejump.core.output import write_atomically


BLOCK = 4096  # rows that are written at a time
_SPECIAL = re.compile('[,"\r\n]')  # within a cell


def _cell(value: Any) -> Any:
    if value is None or (isinstance(value, float) and math.isnan(value)):
        return ""
    return repr(value) if isinstance(value, float) else value


def cells(row: Iterable[Any]) -> list[Any]:
    """Return a row as the cells of a CSV file. Numbers have full precision; None and NaN become empty cells."""
    return [_cell(value) for value in row]


def write_csv(path: Path, header: Sequence[str], rows: Iterable[Sequence[Any]]) -> Path:
    """Write a table as CSV with full precision; None and NaN become empty cells. Return the path.

    :param header: names of the columns, with their units
    """
    with write_atomically(path) as stream:
        writer = csv.writer(stream)
        writer.writerow(header)
        writer.writerows(map(cells, rows))
    return path


def write_rows(path: Path, rows: Sequence[Mapping[str, Any]], header: Sequence[str] = ()) -> Path:
    """Write rows, given as dicts of cells by column name, as CSV; see :func:`write_csv`.

    :param header: names of the columns; default: the names in the first row
    """
    names = list(header) or (list(rows[0]) if rows else [])
    return write_csv(path, names, ([row.get(name) for name in names] for row in rows))


def write_columns(columns: Mapping[str, np.ndarray], path: Path) -> None:
    """Write columns of equal length as CSV. NaN stays ``nan``, because a model returned it as a value."""
    length = max((len(values) for values in columns.values()), default=0)
    with write_atomically(path) as stream:
        csv.writer(stream).writerow(columns)
        for start in range(0, length, BLOCK):  # as Python numbers, a column takes four times the memory
            cells = [_cells(values[start:start + BLOCK]) for values in columns.values()]
            stream.writelines((",".join(row) or '""') + "\r\n" for row in zip(*cells))


def _cells(values: np.ndarray) -> Iterable[str]:
    """Return the texts of a column's cells. The writer of ``csv`` is slower: it searches even numbers for quotes."""
    if values.dtype.kind in "biuf":
        return map(repr, values.tolist())
    return (_quoted(value) if isinstance(value, str) else repr(value) for value in values.tolist())


def _quoted(text: str) -> str:
    return '"' + text.replace('"', '""') + '"' if _SPECIAL.search(text) else text


def finite(value: Any) -> Any:
    """Convert a value for JSON: NaN and infinity become None, also inside lists and dicts."""
    if isinstance(value, Mapping):
        return {key: finite(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [finite(item) for item in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value


def write_json(path: Path, document: Any, indent: int = 2) -> Path:
    """Write a document as JSON and return the path. Numbers that are not finite become null."""
    with write_atomically(path) as stream:
        stream.write(json.dumps(finite(document), indent=indent, ensure_ascii=False) + "\n")
    return path


def markdown(header: Sequence[str], rows: Iterable[Sequence[Any]], right: Iterable[int] = ()) -> list[str]:
    """Return a table as lines of Markdown.

    :param right: indices of the columns with right alignment
    """
    places = set(right)
    lines = ["| " + " | ".join(header) + " |",
             "|" + "|".join("---:" if place in places else "---" for place in range(len(header))) + "|"]
    return lines + ["| " + " | ".join(str(cell) for cell in row) + " |" for row in rows]


def html_table(header: Sequence[str], rows: Iterable[Sequence[object]]) -> str:
    """Return a table as HTML."""
    head = "".join(f"<th>{escape(cell)}</th>" for cell in header)
    body = "".join("<tr>" + "".join(f"<td>{escape(str(cell))}</td>" for cell in row) + "</tr>" for row in rows)
    return f"<table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"


def write_markdown(path: Path, lines: Sequence[str]) -> Path:
    """Write lines of Markdown and return the path. Because Markdown passes HTML through, ``<`` of tags is escaped."""
    return write_text(path, [re.sub("<(?=[A-Za-z/!?])", "&lt;", line) for line in lines])


def write_text(path: Path, lines: Sequence[str]) -> Path:
    """Write lines of text and return the path."""
    with write_atomically(path) as stream:
        stream.write("\n".join(lines) + "\n")
    return path


@dataclass(frozen=True)
class Shown:
    """A table to be shown to people.

    :param title: title of the table
    :param header: names of the columns with their units
    :param rows: cells as texts
    :param left: names of the columns with left alignment
    """

    title: str
    header: Sequence[str]
    rows: Sequence[Sequence[str]]
    left: Sequence[str] = ()


def check_columns(columns: Mapping[str, np.ndarray]) -> None:
    """Raise an error unless all columns consist of finite numbers and have the same length.

    :raises StatejumpError: columns differ in length, or a column has a missing or infinite number
    """
    if len({len(values) for values in columns.values()}) > 1:
        raise StatejumpError(code="columns_of_other_length",
                             cause=", ".join(f"{name} has {len(values)}" for name, values in columns.items()))
    for name, values in columns.items():
        if values.ndim != 1 or not np.issubdtype(values.dtype, np.number):
            raise NotAllowed(name, code="column_no_numbers")
        wrong = np.flatnonzero(~np.isfinite(values))
        if wrong.size:
            raise NotAllowed(name, float(values[wrong[0]]), code="not_finite", item=f"row {wrong[0] + 1}")
