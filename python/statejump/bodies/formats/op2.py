# SPDX-License-Identifier: GPL-3.0-or-later
"""Matrices of Nastran's OUTPUT2 with words of four bytes, of either byte order.

The file is a sequence of Fortran records. A data block has its name, a trailer of seven numbers (the second is the
number of columns, the third that of rows, the fifth the type), a header, then the type of its content: 1 is a matrix.
A column is a sequence of strings: number of the first row, values. EXTSEOUT(DMIGOP2) calls all data blocks EXTDB; the
header has the name of the matrix.
"""
from __future__ import annotations

from pathlib import Path

import numpy as np

from statejump.bodies.formats.labelled import Labelled
from statejump.bodies.formats.op4 import COMPLEX, LARGEST_BYTES, MOST_ROWS
from statejump.core.errors import Unreadable
from statejump.core.reading import check_size, is_file

EXTERNAL = "EXTDB"
SINGLE = (1, 3)


def read(path: Path) -> dict[str, Labelled]:
    """Return the real matrices of a file by name. The last one of a name counts.

    :raises Unreadable: the file does not exist, is damaged, or has words of eight bytes
    """
    if not is_file(path):
        raise Unreadable(code="file_not_found", file=path)
    check_size(path, LARGEST_BYTES)
    data = path.read_bytes()
    order = next((one for one in "<>" if data[:4] == np.array(4, f"{one}i4").tobytes()), None)
    if order is None:
        raise Unreadable(code="matrix_op2_words", file=path)
    try:
        found = Records(data, order)
        return {one.name: one for one in found.matrices()}
    except (ValueError, IndexError, UnicodeError):
        raise Unreadable(code="matrix_file_damaged", file=path, form="an op2 file") from None


class Records:
    """The records of a file."""

    def __init__(self, data: bytes, order: str) -> None:
        self.order = order
        self.records: list[bytes] = []
        at = 0
        while at + 8 <= len(data):
            length = int(np.frombuffer(data, f"{order}i4", 1, at)[0])
            if length < 0 or at + 8 + length > len(data):
                raise ValueError
            self.records.append(data[at + 4:at + 4 + length])
            at += 8 + length

    def key(self, at: int) -> int:
        """Return the number in a record of one word."""
        if len(self.records[at]) != 4:
            raise ValueError
        return int(np.frombuffer(self.records[at], f"{self.order}i4")[0])

    def matrices(self) -> list[Labelled]:
        """Return all matrices."""
        found = []
        for at, record in enumerate(self.records[:-11]):
            if len(record) != 8 or not record[:1].isalpha() or len(self.records[at + 3]) != 28:
                continue
            if [len(one) for one in self.records[at + 1:at + 3]] != [4, 4] or self.key(at + 1) != -1:
                continue
            if self.key(at + 9) != -3 or self.key(at + 11) != 1:
                continue  # a table
            name = record.decode("ascii").strip().upper()
            if name == EXTERNAL:
                name = self.records[at + 8][:8].decode("ascii").strip().upper()
            matrix = self._matrix(at)
            if matrix is not None:
                found.append(Labelled(name, matrix))
        return found

    def _matrix(self, at: int) -> np.ndarray | None:
        """Return the matrix of the data block whose name is a record; None: it is complex or too large."""
        trailer = np.frombuffer(self.records[at + 3], f"{self.order}i4").tolist()
        columns, rows, kind = trailer[1], trailer[2], trailer[4]
        if kind in COMPLEX or not (0 <= rows <= MOST_ROWS and 0 <= columns <= MOST_ROWS):
            return None
        values = np.zeros((rows, columns))
        real = np.dtype(f"{self.order}f{4 if kind in SINGLE else 8}")
        place, column = at + 11, 0
        while self.key(place) == 1:
            place += 1
            while self.key(place) > 0:
                string = self.records[place + 1]
                first = int(np.frombuffer(string, f"{self.order}i4", 1)[0]) - 1
                given = np.frombuffer(string[4:], real)
                if first < 0 or first + len(given) > rows:
                    raise ValueError
                values[first:first + len(given), column] = given
                place += 2
            column += 1
            place += 2  # its end, and the number of words of the next key
        if column != columns:
            raise ValueError
        return values
