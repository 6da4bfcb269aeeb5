# SPDX-License-Identifier: GPL-3.0-or-later
"""ISO 8601 times, converted to seconds from the first."""
from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from datetime import datetime
from pathlib import Path

import numpy as np

from statejump.core.errors import Unreadable

_CLOCK = re.compile(r"(\d+):([0-5]\d):([0-5]\d(?:[.,]\d+)?)")
ACCEPTED = "2026-03-01T12:00:00 or 12:00:00"


def is_iso(cell: str) -> bool:
    """Return whether a text is a date with a time, or hours, minutes and seconds."""
    return bool(_CLOCK.fullmatch(cell.strip())) or _date(cell) is not None


def _date(cell: str) -> datetime | None:
    text = cell.strip()
    if len(text) < len("2026-03-01T12:00"):
        return None
    try:
        return datetime.fromisoformat(text)
    except ValueError:
        return None


def seconds(cells: Sequence[str], place: Callable[[int], tuple[int, str]], path: Path) -> np.ndarray:
    """Return the seconds from the first time to each time of a column.

    :raises Unreadable: a cell is not a time, or only some cells have a time zone
    """
    found = []
    first = _date(cells[0])
    for index, cell in enumerate(cells):
        clock, date = _CLOCK.fullmatch(cell.strip()), _date(cell)
        zone = date is not None and date.tzinfo is not None
        if first is None and clock:
            hours, minutes, rest = clock.groups()
            found.append(3600.0 * int(hours) + 60.0 * int(minutes) + float(rest.replace(",", ".")))
        elif first is not None and date is not None and zone == (first.tzinfo is not None):
            found.append((date - first).total_seconds())
        else:
            line, column = place(index)
            some_zones = first is not None and date is not None
            cause = "only some times name their time zone" if some_zones else f"{cell.strip()[:30]!r} is no time"
            raise Unreadable(code="no_iso_time", cause=cause, file=path, line=line, column=column, accepted=ACCEPTED,
                             reason="some_time_zones" if some_zones else "no_time")
    values = np.array(found)
    return np.asarray(values - values[0])
