# SPDX-License-Identifier: GPL-3.0-or-later
"""A workbook of a result for Excel and LibreOffice: each table of the CSV export is a sheet. Cells are numbers with 16
digits, independent of the local decimal mark."""
from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import astuple, fields
from pathlib import Path
from typing import Any

from statejump.core.comparison import table
from statejump.core.errors import NotWritten, StatejumpError
from statejump.core.run import Event
from statejump.core.units import unit_of
from statejump.results.contents import Result

MOST_ROWS, MOST_COLUMNS = 1_048_576, 16_384  # limits of a sheet in ISO/IEC 29500 and Excel
LONGEST_NAME = 31  # of a sheet

Table = tuple[str, Sequence[str], int, Iterable[Sequence[Any]]]  # name, header, number of rows, rows


def _of_dicts(name: str, rows: Sequence[dict[str, Any]]) -> Table:
    header = list(rows[0]) if rows else []
    return name, header, len(rows), ([row.get(key) for key in header] for row in rows)


def _tables(result: Result) -> Iterator[Table]:
    for model, run in result.models.items():
        rows = [(name, unit_of(name), value) for name, value in run.summary.items()]
        yield f"{model} summary", ("quantity", "unit", "value"), len(rows), rows
    if result.rows:
        yield _of_dicts("comparison", table(result.rows))
    for model, run in result.models.items():
        yield (f"{model} events", [entry.name for entry in fields(Event)], len(run.events), map(astuple, run.events))
        columns = run.flat()
        yield f"{model} history", list(columns), len(run), zip(*(values.tolist() for values in columns.values()))
    for name, rows_of in result.answers.tables.items() if result.answers is not None else ():
        yield _of_dicts(name, list(rows_of))


def write(result: Result, path: Path) -> Path:
    """Write all tables of a result as sheets of one workbook; return its path.

    :raises StatejumpError: openpyxl is missing, or a table is too large for a sheet
    """
    try:
        from openpyxl import Workbook  # 0.2 s, which may be missing
        from openpyxl.cell import WriteOnlyCell  # as Workbook
    except ImportError:
        raise StatejumpError(code="openpyxl_missing") from None
    book = Workbook(write_only=True)
    for name, header, rows, content in _tables(result):
        if rows + 1 > MOST_ROWS or len(header) > MOST_COLUMNS:
            raise NotWritten(code="table_too_large", place=f"table {name!r}", rows=rows, columns=len(header),
                             most_rows=MOST_ROWS, most_columns=MOST_COLUMNS)
        sheet = book.create_sheet(name[:LONGEST_NAME])
        sheet.freeze_panes = "A2"

        def cell(value: Any) -> Any:
            if isinstance(value, float) and not math.isfinite(value):
                return None if math.isnan(value) else str(value)  # a sheet has no such numbers
            if isinstance(value, str) and value.startswith("="):  # a name, not a formula
                made = WriteOnlyCell(sheet, value)
                made.data_type = "s"
                return made
            return value

        sheet.append(list(map(cell, header)))
        for row in content:
            sheet.append(list(map(cell, row)))
    try:
        book.save(path)
    except OSError as error:
        raise NotWritten(code="write_failed", file=path, cause=error.strerror or str(error)) from None
    return path
