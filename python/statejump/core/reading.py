# SPDX-License-Identifier: GPL-3.0-or-later
"""What is asked of a path before it is read."""
from __future__ import annotations

import csv
import stat
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TextIO

from statejump.core.errors import Unreadable


def is_file(path: Path) -> bool:
    """Whether there is a file: no folder, device or pipe.

    :raises Unreadable: the system does not say: a folder that may not be searched, a name that is too long
    """
    try:
        return stat.S_ISREG(path.stat().st_mode)
    except (FileNotFoundError, NotADirectoryError):
        return False
    except OSError as error:
        raise Unreadable("cannot be read", cause=error.strerror, file=path) from None


@contextmanager
def open_csv(path: Path) -> Iterator[TextIO]:
    """Open a CSV file for one of the readers of ``csv``; what is wrong with it while it is read is one sentence.

    :raises Unreadable: it may not be read, is not UTF-8 text or not CSV
    """
    try:
        with path.open(newline="", encoding="utf-8-sig") as stream:
            yield stream
    except UnicodeDecodeError:
        raise Unreadable("not CSV", cause="the file is not UTF-8 text", file=path) from None
    except csv.Error as failure:
        raise Unreadable("not CSV", cause=str(failure), file=path) from None
    except OSError as failure:
        raise Unreadable("cannot be read", cause=failure.strerror, file=path) from None
