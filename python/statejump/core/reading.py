# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks of a path before it is read."""
from __future__ import annotations

import csv
import stat
from collections.abc import Iterator
from contextlib import contextmanager
from math import isfinite
from pathlib import Path
from typing import TextIO

from statejump.core.errors import Unreadable, size


def is_file(path: Path) -> bool:
    """Return whether a path is a regular file, not a folder, device or pipe.

    :raises Unreadable: the system cannot tell, because a folder has no search permission or the name is too long
    """
    try:
        return stat.S_ISREG(path.stat().st_mode)
    except (FileNotFoundError, NotADirectoryError):
        return False
    except OSError as error:
        raise Unreadable(code="read_failed", cause=error.strerror, file=path) from None


def check_size(path: Path, largest_bytes: int, beside: str = "") -> None:
    """Raise Unreadable if a file is too large to be read as a whole. ``beside`` is a hint for the message."""
    if path.stat().st_size > largest_bytes:
        raise Unreadable(code="file_too_large_to_read", file=path, largest=size(largest_bytes), why=beside)


def finite_number(text: str) -> float | None:
    """Return the finite number in a text; None if the text is not one. Python accepts 1_000 as a number, but files must
    not contain it."""
    try:
        value = float(text)
    except ValueError:
        return None
    return value if isfinite(value) and "_" not in text else None


@contextmanager
def open_csv(path: Path, encoding: str = "utf-8-sig") -> Iterator[TextIO]:
    """Open a CSV file for a reader of the module ``csv``. A fault found during reading is raised as one sentence.

    :raises Unreadable: the file may not be read, is not UTF-8 text, or is not CSV
    """
    try:
        with path.open(newline="", encoding=encoding) as stream:
            yield stream
    except UnicodeError:
        raise Unreadable(code="csv_not_utf8", file=path) from None
    except csv.Error as failure:
        raise Unreadable(code="not_csv", cause=str(failure), file=path) from None
    except OSError as failure:
        raise Unreadable(code="read_failed", cause=failure.strerror, file=path) from None
