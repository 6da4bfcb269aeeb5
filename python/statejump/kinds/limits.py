# SPDX-License-Identifier: GPL-3.0-or-later
"""What a run needs is known before it begins: what the machine has not got is refused in one sentence."""
from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from statejump.core.errors import NotAllowed, size
from statejump.kinds import has, of, require
from statejump.kinds.protocol import ItemNames

if TYPE_CHECKING:
    from statejump.core.case import Case

# Samples beyond which nobody reads a whole history: a model that can tell its path at any time leaves some out.
WHOLE_HISTORY = 200_000
# Bytes at the peak for each value of a history: what the model returns, the columns, the image of the result file; of
# the DEM also the cells of its table as texts.
PEAK_BYTES = {"reduced": 24, "dem": 160}
# Bytes on disk: eight in the result file, up to 24 in the table, twice while the results are brought to their place.
DISK_BYTES = 40
# Values of an item, by the list that names it: of a node two vectors, of a contact three, its state, gap and heat.
WIDTHS = {"nodes": 6, "links": 3, "contacts": 12}
WIDTH = 6


@dataclass(frozen=True)
class History:
    """How large the history of a run is."""

    samples: int
    values: int

    @property
    def disk_bytes(self) -> int:
        """What its files need at most."""
        return DISK_BYTES * self.samples * self.values


def history_of(case: Case, model: str) -> History:
    """Return how large the history of a run will be.

    :param model: ``reduced`` or ``dem``
    """
    kind = of(case)
    items = require(case, ItemNames).names(case) if has(case, ItemNames) else {}
    values = sum(WIDTHS.get(name, WIDTH) * len(found) for name, found in items.items())
    return History(kind.samples(case, model), len(kind.COLUMNS) + values)


def free_memory() -> int | None:
    """Return the memory that a new process can have [bytes]; None: the system does not say."""
    try:
        lines = Path("/proc/meminfo").read_text(encoding="utf-8").splitlines()
        return next(1024 * int(line.split()[1]) for line in lines if line.startswith("MemAvailable:"))
    except (OSError, StopIteration):
        return None


def check_memory(case: Case, model: str) -> None:
    """Raise NotAllowed where the history of a run does not fit into the memory that is free."""
    history = history_of(case, model)
    needed, free = PEAK_BYTES[model] * history.samples * history.values, free_memory()
    if free is not None and needed > free:
        raise NotAllowed("thermal.cycles", case.thermal.cycles, code="too_little_memory", file=case.origin.file,
                         case=case.name, samples=history.samples, values=history.values, needed=size(needed),
                         free=size(free))
