# SPDX-License-Identifier: GPL-3.0-or-later
"""Matrices of Nastran's OUTPUT4: text and binary of either byte order, dense and sparse, also BIGMAT.

A column is either dense (first row, values) or a sequence of strings (row 0, then strings with their own first row).
A string counts words: a number has two, in double precision on machines with words of four bytes, else one.
"""
from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from statejump.bodies.formats.labelled import Labelled
from statejump.core.errors import Unreadable
from statejump.core.reading import check_size, is_file

LARGEST_BYTES = 1 << 30
MOST_ROWS = 20_000  # of a matrix that is not null; a condensed body is dense
FORMAT = re.compile(r"(?:1P,)?\s*(\d+)[ED](\d+)\.\d+", re.IGNORECASE)
COMPLEX = (3, 4)


def read(path: Path) -> dict[str, Labelled]:
    """Return the matrices of a file by name.

    :raises Unreadable: the file does not exist, or is damaged
    """
    if not is_file(path):
        raise Unreadable(code="file_not_found", file=path)
    check_size(path, LARGEST_BYTES)
    data = path.read_bytes()
    try:
        binary = _order(data)
        made = _Binary(data, *binary).matrices() if binary else _Text(data).matrices()
        return {one.name: one for one in made}
    except (ValueError, IndexError, KeyError, OverflowError, UnicodeError):
        raise Unreadable(code="matrix_file_damaged", file=path, form="an op4 file") from None


def _order(data: bytes) -> tuple[str, bool] | None:
    """Return the byte order of a binary file, and whether its words have eight bytes; None: the file is text."""
    for order in "<>":
        length = int.from_bytes(data[:4], "little" if order == "<" else "big")
        if length in (24, 48):
            return order, length == 48
    return None


def _empty(rows: int, columns: int, kind: int) -> np.ndarray | None:
    """Return a null matrix; None: the matrix is complex or too large, and is omitted."""
    if abs(rows) > MOST_ROWS or columns > MOST_ROWS or kind in COMPLEX:
        return None
    return np.zeros((abs(rows), columns))


class _Binary:
    """Fortran records: length, bytes, length."""

    def __init__(self, data: bytes, order: str, long: bool) -> None:
        self.data, self.order, self.long = data, order, long
        self.whole = np.dtype(f"{order}i{8 if long else 4}")

    def records(self) -> Iterator[bytes]:
        """Yield the records."""
        at = 0
        while at + 8 <= len(self.data):
            length = int(np.frombuffer(self.data, f"{self.order}i4", 1, at)[0])
            if length < 0 or at + 8 + length > len(self.data):
                raise ValueError
            yield self.data[at + 4:at + 4 + length]
            at += 8 + length

    def matrices(self) -> list[Labelled]:
        """Return all matrices."""
        found, records = [], self.records()
        size = self.whole.itemsize
        for head in records:
            columns, rows, _, kind = np.frombuffer(head, self.whole, 4).tolist()
            name = head[4 * size:].decode("ascii")[:8].strip().upper()
            values = _empty(rows, columns, kind)
            single = kind in (1, 3) and not self.long
            real = np.dtype(f"{self.order}f{4 if single else 8}")
            for record in records:
                column, first, _ = np.frombuffer(record, self.whole, 3).tolist()
                if column > columns:
                    break
                if values is not None:
                    self._column(values[:, column - 1], record[3 * size:], first, rows < 0, real)
            if values is not None:
                found.append(Labelled(name, values))
        return found

    def _column(self, column: np.ndarray, body: bytes, first: int, big: bool, real: np.dtype[Any]) -> None:
        if first:
            given = np.frombuffer(body, real)
            column[first - 1:first - 1 + len(given)] = given
            return
        at, size = 0, self.whole.itemsize
        while at < len(body):
            if big:
                words, row = np.frombuffer(body, self.whole, 2, at).tolist()
                at += 2 * size
            else:
                words, row = divmod(int(np.frombuffer(body, self.whole, 1, at)[0]), 1 << 16)
                at += size
            count = (words - 1) * size // real.itemsize
            if count < 1 or row < 1 or row - 1 + count > len(column):
                raise ValueError
            column[row - 1:row - 1 + count] = np.frombuffer(body, real, count, at)
            at += count * real.itemsize


class _Text:
    """Lines: a head for each matrix, a head for each column, values in columns of equal width."""

    def __init__(self, data: bytes) -> None:
        self.lines = data.decode("ascii").replace("\r", "").split("\n")
        self.at = 0

    def _next(self) -> str:
        line = self.lines[self.at]
        self.at += 1
        return line

    def matrices(self) -> list[Labelled]:
        """Return all matrices."""
        found = []
        while self.at < len(self.lines):
            head = self._next()
            if not head.strip():
                continue
            width = 16 if len(head) > 80 else 8
            columns, rows, _, kind = (int(head[k * width:(k + 1) * width]) for k in range(4))
            rest = head[4 * width:]
            form = FORMAT.search(rest)
            name = rest[:8].strip().upper()
            per_line, digits = (int(form[1]), int(form[2])) if form else (5, 16)
            values = _empty(rows, columns, kind)
            self._columns(values, kind, (rows < 0, columns), (per_line, digits))
            if values is not None:
                found.append(Labelled(name, values))
        return found

    def _columns(self, values: np.ndarray | None, kind: int, size: tuple[bool, int], form: tuple[int, int]) -> None:
        """Read all columns of a matrix: BIGMAT or not, number of columns."""
        big, columns = size
        while True:
            column, first, words = _whole(self._next(), 3)
            if column > columns:
                self._values(1, form)
                return
            if first:
                given = self._values(words, form)
                if values is not None:
                    values[first - 1:first - 1 + len(given), column - 1] = given
                continue
            while words > 0:
                if big:
                    length, row = _whole(self._next(), 2)
                    words -= length + 1
                else:
                    length, row = divmod(_whole(self._next(), 1)[0], 1 << 16)
                    words -= length
                self._string(values, kind, (length - 1, row, column), form)

    def _string(self, values: np.ndarray | None, kind: int, place: tuple[int, int, int], form: tuple[int, int]) -> None:
        """Read a string: number of words, first row, column."""
        words, row, column = place
        given = self._values(words // (2 if kind in (2, 4) else 1), form)
        if values is not None:
            if row < 1 or row - 1 + len(given) > len(values):
                raise ValueError
            values[row - 1:row - 1 + len(given), column - 1] = given

    def _values(self, count: int, form: tuple[int, int]) -> list[float]:
        per_line, width = form
        found: list[float] = []
        while len(found) < count:
            line = self._next()
            fields = [line[k * width:(k + 1) * width] for k in range(min(per_line, count - len(found)))]
            found += [float(text.upper().replace("D", "E")) for text in fields]
        return found


def _whole(line: str, count: int) -> list[int]:
    words = line.split()
    if len(words) != count:  # numbers of eight columns touch each other
        words = [line[k * 8:(k + 1) * 8] for k in range(count)]
    return [int(word) for word in words]
