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
    """Return whether there is a file that is no folder, device or pipe.

    :raises Unreadable: the system does not report it: a folder without search permission, or a name that is too long
    """
    try:
        return stat.S_ISREG(path.stat().st_mode)
    except (FileNotFoundError, NotADirectoryError):
        return False
    except OSError as error:
        raise Unreadable(code="read_failed", cause=error.strerror, file=path) from None


def check_size(path: Path, largest_bytes: int, beside: str = "") -> None:
    """Raise Unreadable for a file that is too large to be read as a whole; ``beside`` adds a hint."""
    if path.stat().st_size > largest_bytes:
        raise Unreadable(code="file_too_large_to_read", file=path, largest=size(largest_bytes), why=beside)


def finite_number(text: str) -> float | None:
    """Return the finite number of a text; None if it has none. Python accepts 1_000 as a number, files must not contain
    it."""
    try:
        value = float(text)
    except ValueError:
        return None
    return value if isfinite(value) and "_" not in text else None


@contextmanager
def open_csv(path: Path, encoding: str = "utf-8-sig") -> Iterator[TextIO]:
    """Open a CSV file for one of the readers of ``csv``. A fault found during reading becomes one sentence.

    :raises Unreadable: it may not be read, is not UTF-8 text or not CSV
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
