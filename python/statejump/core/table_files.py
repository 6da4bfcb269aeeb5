# SPDX-License-Identifier: GPL-3.0-or-later
"""Reader of text tables of spreadsheets and test rigs.

The separator is ``,``, ``;``, a tab or blanks. The decimal mark is a point or, if no cell has a point, a comma. The
file is UTF-8 or UTF-16, with or without a byte order mark, or in Excel's code page 1252. The reader ignores blank rows,
blank columns at the end, and a first column without a name that numbers the rows, as pandas writes it. Comments (``#``,
``%``) may precede the table; the last one may be the header. Units may be in a row of their own below the header. The
reader also accepts groups of thousands if a cell has both marks, durations of MATLAB (``0.05 sec``), and measurements
of LabVIEW.
"""
from __future__ import annotations

import codecs
import csv
import re
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from itertools import chain
from pathlib import Path
from typing import Any, TextIO

import numpy as np

from statejump.core.column_units import NO_UNIT, Column, accepted, matched
from statejump.core.errors import NotAllowed, Unreadable, located, printable
from statejump.core.iso_times import is_iso, seconds
from statejump.core.reading import check_size, finite_number, is_file, open_csv
from statejump.core.units import split_unit

SUFFIXES = (".csv", ".txt", ".tsv", ".dat", ".lvm")
BLOCK = 4096  # rows that are converted at a time
SEPARATORS = ("\t", ";", ",")  # in order of preference, if a header has several
BLANKS = " "
_WORD = re.compile(r'"((?:[^"]|"")*)"(?=\s|$)|(\S+)')
_QUOTED = re.compile(r'"(?:[^"]|"")*"')
_DECIMAL_COMMA = re.compile(r"[+-]?(\d+,\d*|,\d+)([eE][+-]?\d+)?")
_THOUSANDS = re.compile(r"[+-]?[1-9]\d{0,2},\d{3}")
# Characters beyond ASCII that Excel's older code page has in usual texts: ° ² ³ µ · and letters of western Europe.
# Bytes 0x80 to 0x9f are umlauts in the code pages of DOS and of old Macintoshes.
_BYTES_1252 = b"\xb0\xb2\xb3\xb5\xb7" + bytes({*range(0xC0, 0x100)} - {0xD7, 0xF7})
_GROUPS = (re.compile(r"[+-]?\d{1,3}(?:,\d{3})+\.\d*"), re.compile(r"[+-]?\d{1,3}(?:\.\d{3})+,\d*"))
_DURATION = re.compile(r"\s*([+-]?[\d.]+(?:[eE][+-]?\d+)?)\s+(sec|min|hr|s|h)\s*")
_SECONDS = {"sec": 1.0, "s": 1.0, "min": 60.0, "hr": 3600.0, "h": 3600.0}
_LABVIEW = "LabVIEW Measurement"
_COMMENT = ("#", "%")
_FORTRAN = re.compile(r"([+-]?(?:\d+\.?\d*|\.\d+))[dD]([+-]?\d+)")
_NUMERIC = re.compile(r"^[+-]?[.,]?\d")
Place = Callable[[int], tuple[int, str]]


def quoted(text: object) -> str:
    """Return a part of a file, quoted for a sentence."""
    shown = repr(printable(str(text)))
    return shown if len(shown) <= 40 else shown[:36] + "...'"


class Table:
    """A text table that is being read.

    :param path: file of the table
    :param separator: separator of the cells
    :param header: names of the columns
    :param names: names of the columns, for a table without a header or in place of its own; empty: the header's
    """

    def __init__(self, path: Path, stream: TextIO, names: Sequence[str] = ()) -> None:
        self.path = path
        self._skipped = 0
        self.separator, lines = self._begin(stream)
        self._reader: Any = _BlankSeparated(lines) if self.separator == BLANKS else csv.reader(
            lines, delimiter=self.separator, skipinitialspace=True)
        cells = [cell.strip() for cell in next(iter(self._reader), [])]
        if self.separator == BLANKS:
            cells = _joined(cells)
        while cells and not cells[-1]:
            cells.pop()
        if not cells:
            raise Unreadable(code="no_column", file=path)
        self._counts = len(cells) > 1 and not cells[0]
        if self._counts:
            del cells[0]
        is_header = not all(finite_number(cell.replace(",", ".")) is not None for cell in cells)
        if not names and not is_header:
            raise Unreadable(code="table_without_header", file=path, line=self.line)
        for place, cell in enumerate(cells, start=1):
            if not cell:
                raise Unreadable(code="column_without_name", file=path, line=self.line, column=place + self._counts)
        self._first = list(self._taken()) if is_header else [cells]
        own = self._with_units(cells) if is_header else names
        self.header = tuple(names or own)
        # Whether a comma is known to be a decimal mark: German Excel uses semicolons for this reason.
        self._decided = self.separator == ";"
        self._comma: tuple[int, str, str] | None = None
        self._point: tuple[int, str, str] | None = None

    def _taken(self) -> Iterator[list[str]]:
        """Return the first row that is not empty."""
        for row in self._reader:
            if any(map(str.strip, row)):
                yield row
                return

    def _with_units(self, names: Sequence[str]) -> Sequence[str]:
        """Return the column names with the units of the units row, which is then removed; unchanged without such a
        row."""
        row = self._first[0][self._counts:] if self._first else []
        units = [cell.strip().strip("[]()").strip() for cell in row[:len(names)]]
        if len(units) < len(names) or any(_NUMERIC.search(unit) for unit in units) or not any(units):
            return names
        from statejump.core.unit_library import is_unit  # pint, 0.3 s; few tables need it

        if not all(unit in NO_UNIT or is_unit(unit) for unit in units):
            return names
        if any(unit not in NO_UNIT and split_unit(name)[1] not in ("-", unit) for name, unit in zip(names, units)):
            return names  # a key with another unit
        self._first.clear()
        return [name if unit in NO_UNIT or split_unit(name)[1] == unit else f"{name} [{unit}]"
                for name, unit in zip(names, units)]

    def _begin(self, stream: TextIO) -> tuple[str, Iterator[str]]:
        """Return the separator, and the lines from the header on."""
        comment = ""
        for line in stream:
            if line.lstrip().startswith(_COMMENT):
                comment = line.lstrip().lstrip("#%")
                self._skipped += 1
                continue
            said = line.strip().strip('"').lower()
            if said in ("sep=,", "sep=;") or line.strip("\r\n\"").lower() == "sep=\t":
                return line.strip("\r\n\"")[4], self._counted(stream, 1)
            if line.startswith(_LABVIEW):
                return self._labview(stream)
            if line.strip() and line.strip(" \t,;\r\n"):
                if comment.strip() and finite_number(_cells(line)[0].replace(",", ".")) is not None:
                    self._skipped -= 1  # the comment is the header
                    return _separator(comment), chain((comment, line), stream)
                return _separator(line), chain((line,), stream)
            self._skipped += 1
        return ",", iter(())

    def _labview(self, stream: TextIO) -> tuple[str, Iterator[str]]:
        """Return the separator of a measurement file of LabVIEW, and its lines from the row of column names on. Units
        of the columns are taken from the lines before that row. Comments after the last column are omitted."""
        separator = "\t"
        labels: dict[str, list[str]] = {}
        self._skipped += 1
        for line in stream:
            cells = [cell.strip() for cell in line.rstrip("\r\n").split(separator)]
            if cells[0].startswith("Separator"):
                separator = "," if "Comma" in line else "\t"
            if cells[0] == "X_Value":
                names = cells[1:-1] if cells[-1] == "Comment" else cells[1:]
                units = [*labels.get("Y_Unit_Label", ()), *[""] * len(names)]
                names = [f"{name} [{unit}]" if unit else name for name, unit in zip(names, units)]
                first = "time [s]" if labels.get("X_Dimension", ["Time"])[0] == "Time" else cells[0]
                return separator, chain((separator.join((first, *names)) + "\n",), stream)
            labels[cells[0]] = cells[1:]
            self._skipped += 1
        return separator, iter(())

    def _counted(self, stream: TextIO, skipped: int) -> Iterator[str]:
        self._skipped += skipped
        return iter(stream)

    @property
    def line(self) -> int:
        """Number of the last line read."""
        return self._skipped + int(self._reader.line_num)

    def rows(self) -> Iterator[tuple[int, list[str]]]:
        """Yield the rows below the header, with their line numbers.

        :raises Unreadable: the number of cells of a row differs from that of the header
        """
        width, counted = len(self.header), None
        for row in chain(self._first, self._reader):
            if self._counts and row:
                counted = self._counted_on(counted, row.pop(0).strip())
            if len(row) > width and not any(map(str.strip, row[width:])):
                del row[width:]
            if len(row) != width:
                if not any(map(str.strip, row)):
                    continue
                commas = self.separator == "," and len(row) == 2 * width
                remedy = "decimal commas need ';' between the cells, or quotes" if commas else None
                raise Unreadable(code="row_of_other_length", remedy=remedy, file=self.path, line=self.line,
                                 cells=len(row), width=width, decimal_commas=commas)
            if not any(row) or not any(map(str.strip, row)):
                continue
            yield self.line, row

    def _counted_on(self, before: int | None, cell: str) -> int | None:
        """Return the row number in a first column that has no name.

        :raises Unreadable: the cells of this column are not consecutive row numbers
        """
        if not cell and before is None:
            return None
        if not cell.isdecimal() or (before is not None and int(cell) != before + 1):
            raise Unreadable(code="first_column_without_name", file=self.path, line=self.line)
        return int(cell)

    def blocks(self) -> Iterator[tuple[list[int], list[list[str]]]]:
        """Yield blocks of rows with their line numbers."""
        lines: list[int] = []
        rows: list[list[str]] = []
        for line, row in self.rows():
            lines.append(line)
            rows.append(row)
            if len(rows) == BLOCK:
                yield lines, rows
                lines, rows = [], []
        if rows:
            yield lines, rows

    def numbers(self, cells: Sequence[str], place: Place, empty: bool = False) -> np.ndarray:
        """Convert cells to finite numbers.

        :param place: function that returns line and column of the i-th cell
        :param empty: whether a cell may be empty; an empty cell becomes NaN
        :raises Unreadable: a cell is not a finite number; the message has its line and column
        """
        joined = "".join(cells)
        if "," in joined and "." in joined:
            cells = self._without_groups(cells, place)
            joined = "".join(cells)
        if "," in joined:
            cells = self._with_points(cells, place)
        if "." in joined and self._point is None:
            self._point = next((*place(i), cell) for i, cell in enumerate(cells) if "." in cell)
        self._check_marks()
        if "_" not in joined:  # Python accepts 1_000 as a number
            try:
                found = np.fromiter(map(float, cells), float, len(cells))
                if np.isfinite(found).all():
                    return found
            except ValueError:
                pass
        return np.array([self._number(cell, place, i, empty) for i, cell in enumerate(cells)], dtype=float)

    def _number(self, cell: str, place: Place, index: int, empty: bool) -> float:
        if empty and not cell.strip():
            return float("nan")
        value = finite_number(_FORTRAN.sub(r"\1e\2", cell.strip()) if "d" in cell.lower() else cell)
        if value is None:
            line, column = place(index)
            what = f"{quoted(cell)} is not a finite number" if cell.strip() else "the cell is empty"
            raise Unreadable(code="bad_cell", cause=what, file=self.path, line=line, column=quoted(column), cell=cell,
                             reason="no_finite_number" if cell.strip() else "empty")
        return value

    def _without_groups(self, cells: Sequence[str], place: Place) -> list[str]:
        """Remove the marks between groups of thousands from cells that contain both a comma and a point."""
        found = []
        for index, cell in enumerate(cells):
            if _GROUPS[0].fullmatch(cell.strip()):
                self._point = self._point or (*place(index), cell)
                cell = cell.replace(",", "")
            elif _GROUPS[1].fullmatch(cell.strip()):
                self._comma, self._decided = self._comma or (*place(index), cell), True
                cell = cell.replace(".", "")
            found.append(cell)
        return found

    def _with_points(self, cells: Sequence[str], place: Place) -> list[str]:
        """Return cells with points in place of decimal commas."""
        found = []
        for index, cell in enumerate(cells):
            if "," in cell and _DECIMAL_COMMA.fullmatch(cell.strip()):
                self._comma = self._comma or (*place(index), cell)
                self._decided = self._decided or not _THOUSANDS.fullmatch(cell.strip())
                cell = cell.replace(",", ".")
            elif "." in cell and self._point is None:
                self._point = (*place(index), cell)
            found.append(cell)
        return found

    def _check_marks(self) -> None:
        if self._comma and self._point:
            line, column, cell = self._comma
            raise Unreadable(code="decimal_comma_and_point", file=self.path, line=line, column=quoted(column),
                             cell=quoted(cell.strip()), other=quoted(self._point[2].strip()), other_line=self._point[0])

    def check_commas(self) -> None:
        """Raise an error, after all rows are read, if commas may be either decimal marks or thousands separators."""
        if self._comma and not self._decided:
            line, column, cell = self._comma
            raise Unreadable(code="decimal_comma_or_thousands", file=self.path, line=line, column=quoted(column),
                             cell=quoted(cell.strip()))


def _cells(line: str) -> list[str]:
    """Return the cells of a line, for any separator."""
    separator = _separator(line)
    return line.split() if separator == BLANKS else [cell.strip() for cell in line.split(separator)] or [""]


def _separator(header: str) -> str:
    plain = _QUOTED.sub('""', header)
    for separator in SEPARATORS:
        if separator in plain:
            return separator
    return BLANKS if len(_joined(_words(header))) > 1 else ","


def _words(line: str) -> list[str]:
    return [found[1].replace('""', '"') if found[1] is not None else found[2] for found in _WORD.finditer(line)]


def _joined(words: Iterable[str]) -> list[str]:
    """Join the words of a header to column names. A unit in brackets belongs to the word before it."""
    found: list[str] = []
    depth = 0
    for word in words:
        if found and (depth or word[:1] in "[("):
            found[-1] += f" {word}"
        else:
            found.append(word)
        depth += sum(word.count(bracket) for bracket in "[(") - sum(word.count(bracket) for bracket in "])")
    return found


class _BlankSeparated:
    """Reads rows of cells that are separated by blanks, with the interface of a reader of the module ``csv``."""

    def __init__(self, lines: Iterable[str]) -> None:
        self._lines = iter(lines)
        self.line_num = 0

    def __iter__(self) -> Iterator[list[str]]:
        return self

    def __next__(self) -> list[str]:
        line = next(self._lines)
        self.line_num += 1
        return _words(line) if '"' in line else line.split()


def _encoding(path: Path) -> str:
    """Return the encoding of a text file. If the guess is wrong, an error is raised when the file is read."""
    with path.open("rb") as stream:
        content = stream.read(1 << 16)
        if content.startswith((b"\xff\xfe", b"\xfe\xff")):
            return "utf-16"
        decoder = codecs.getincrementaldecoder("utf-8")()
        allowed = bytes(range(128)) + _BYTES_1252
        is_utf8, is_1252 = True, True
        while content and (is_utf8 or is_1252):
            if is_utf8:
                try:
                    decoder.decode(content)
                except UnicodeDecodeError:
                    is_utf8 = False
            is_1252 = is_1252 and not content.translate(None, allowed)
            content = stream.read(1 << 20) if is_file(path) else b""  # a device has no end
        return "cp1252" if is_1252 and not is_utf8 else "utf-8-sig"


def check_table(path: Path, key: str, missing: str) -> bool:
    """Return whether a table is a text file; otherwise it is HDF5.

    :raises StatejumpError: the file has another suffix than text or HDF5, or does not exist (code ``missing``)
    """
    known = (*SUFFIXES, ".h5", ".hdf5")
    if path.suffix.lower() not in known:
        raise NotAllowed(key, path.name, code="suffix_unknown", suffixes=", ".join(known))
    if not is_file(path):
        raise Unreadable(code=missing, file=path)
    return path.suffix.lower() in SUFFIXES


@contextmanager
def open_table(path: Path, largest_bytes: int | None = None, beside: str = "", names: Sequence[str] = ()
               ) -> Iterator[Table]:
    """Open a text table for reading.

    :param largest_bytes: largest allowed size; ``beside`` is a hint for the error
    :param names: names of the columns, for a table without a header or in place of its own
    :raises Unreadable: the file may not be read, is not a text table, or has ambiguous commas
    """
    try:
        encoding = _encoding(path)
    except OSError as failure:
        raise Unreadable(code="read_failed", cause=failure.strerror, file=path) from None
    with open_csv(path, encoding) as stream:
        if largest_bytes is not None:
            check_size(path, largest_bytes, beside)
        table = Table(path, stream, names)
        yield table
        table.check_commas()


def read_columns(path: Path) -> dict[str, np.ndarray]:
    """Return the columns of a table by their names. A column becomes numbers if all its cells are numbers or NaN.

    :raises Unreadable: the file may not be read, the number of cells of a row differs from that of the header, or the
        table has no samples
    """
    with open_table(path) as table:
        lines, cells = _all(table)
        found = {}
        for name, column in zip(table.header, cells):
            try:
                found[name] = np.array([float(cell) for cell in column])
            except ValueError:
                try:
                    found[name] = table.numbers(column, lambda index, name=name: (lines[index], name))  # type: ignore
                except Unreadable:
                    found[name] = np.array(column)
    return found


def _all(table: Table) -> tuple[list[int], list[tuple[str, ...]]]:
    """Read all rows of a table. Return their line numbers, and the cells by column."""
    lines, rows = [], []
    for line, row in table.rows():
        lines.append(line)
        rows.append(row)
    if not rows:
        raise Unreadable(code="no_samples", file=table.path)
    return lines, list(zip(*rows))


def read_known(
    path: Path, known: Sequence[str], words: Mapping[str, Sequence[str]] | None = None, texts: Collection[str] = (),
    ignored: Collection[str] = (), names: Sequence[str] = (),
) -> dict[str, np.ndarray]:
    """Return the columns of a table by key. A key ends with the unit of its values.

    :param known: allowed keys
    :param words: other names of the quantity of a key, by key
    :param texts: keys whose cells are texts
    :param ignored: names of columns to omit
    :param names: names of the columns, for a table without a header or in place of its own
    :raises StatejumpError: one sentence with the file, and line or column
    """
    with open_table(path, names=names) as table:
        kept = [place for place, name in enumerate(table.header) if name not in ignored]
        with located(file=path):
            for name in sorted(set(ignored) - set(table.header)):
                raise NotAllowed("ignored", name, code="unknown_ignored_column")
            columns = matched([table.header[place] for place in kept], known, words)
        lines, cells = _all(table)
        return {column.key: np.array(part) if column.key in texts else numbers_of(table, column, part, lines)
                for column, part in zip(columns, (cells[place] for place in kept))}


def numbers_of(table: Table, column: Column, cells: Sequence[str], lines: Sequence[int], empty: bool = False
               ) -> np.ndarray:
    """Convert the cells of one column to numbers in the unit of its key."""
    def place(index: int) -> tuple[int, str]:
        return lines[index], column.name

    if column.iso:
        durations = [_DURATION.fullmatch(cell) for cell in cells]
        units = {found[2] for found in durations if found}
        if len(units) == 1 and all(durations):
            return table.numbers([found[1] for found in durations if found], place) * _SECONDS[units.pop()]
        if not is_iso(cells[0]):
            raise Unreadable(code="column_without_unit_or_times", **accepted(column.name, column.key, "s"),
                             file=table.path, column=quoted(column.name))
        return seconds(cells, place, table.path)
    return column.converted(table.numbers(cells, place, empty))
