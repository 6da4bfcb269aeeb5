# SPDX-License-Identifier: GPL-3.0-or-later
"""Check, before a run begins, that the machine has the memory and disk that the run needs."""
from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from statejump.core.case import Case
from statejump.core.errors import NotAllowed, size
from statejump.kinds import has, of, require
from statejump.kinds.protocol import ItemNames

# Number of samples above which a history is too long to read: a model that can compute its path at any time then omits
# some.
WHOLE_HISTORY = 200_000
# Peak memory for each value of a history [bytes]: the model's result, the columns, and the image of the result file;
# for the DEM also the cells of its table as texts.
PEAK_BYTES = {"reduced": 24, "dem": 160}
# Bytes on disk: eight in the result file and up to 24 in the table, twice while the files are moved to their final
# paths.
DISK_BYTES = 40
# Number of values of an item, by its list: two vectors for a node; three vectors, state, gap and heat for a contact.
WIDTHS = {"nodes": 6, "links": 3, "contacts": 12}
WIDTH = 6


@dataclass(frozen=True)
class History:
    """Size of the history of a run."""

    samples: int
    values: int

    @property
    def disk_bytes(self) -> int:
        """What its files need at most."""
        return DISK_BYTES * self.samples * self.values


def history_of(case: Case, model: str) -> History:
    """Return the expected size of the history of a run.

    :param model: ``reduced`` or ``dem``
    """
    kind = of(case)
    items = require(case, ItemNames).names(case) if has(case, ItemNames) else {}
    values = sum(WIDTHS.get(name, WIDTH) * len(found) for name, found in items.items())
    return History(kind.samples(case, model), len(kind.COLUMNS) + values)


def free_memory() -> int | None:
    """Return the memory that a new process can use [bytes]; None if the system does not report it."""
    try:
        lines = Path("/proc/meminfo").read_text(encoding="utf-8").splitlines()
        return next(1024 * int(line.split()[1]) for line in lines if line.startswith("MemAvailable:"))
    except (OSError, StopIteration):
        return None


def check_memory(case: Case, model: str) -> None:
    """Raise NotAllowed if the history of a run does not fit into the free memory."""
    history = history_of(case, model)
    needed, free = PEAK_BYTES[model] * history.samples * history.values, free_memory()
    if free is not None and needed > free:
        raise NotAllowed("thermal.cycles", case.thermal.cycles, code="too_little_memory", file=case.origin.file,
                         case=case.name, samples=history.samples, values=history.values, needed=size(needed),
                         free=size(free))
