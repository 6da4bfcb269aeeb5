# SPDX-License-Identifier: GPL-3.0-or-later
"""A measured loop: force over displacement, or moment over rotation, row by row as it was measured."""
from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from difflib import get_close_matches
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from scipy.sparse import csr_matrix

from statejump.core.errors import MissingKey, NotAllowed, StatejumpError, UnknownKey
from statejump.core.tables import check_columns, read_columns
from statejump.identification.hysteresis import Memory, remembered

PAIRS = (("displacement_m", "force_N"), ("rotation_rad", "moment_N_m"))
COLUMNS = ("time_s", *(name for pair in PAIRS for name in pair))
STARTS = ("unknown", "fresh", "cycled")
UNITS = {"displacement": ("m", "rad"), "force": ("N", "N m"), "stiffness": ("N/m", "N m/rad"), "-": ("-", "-")}
FEWEST_ROWS = 20
# Rows are fitted from where the path has been over this share of its range: what friction carried before is then
# forgotten but by sliders that only the last twentieth of the range moves.
SETTLED = 0.95


@dataclass(frozen=True)
class Loop:
    """A loop.

    :param name: for tables and figures: the file
    :param displacement: of every row [m], or the rotation [rad]
    :param force: likewise [N], or the moment [N m]
    :param angular: whether it is moment over rotation
    :param start: what is known of the joint before the first row: ``fresh``, friction carries nothing; ``cycled``,
        the joint has gone the same path before; ``unknown``: rows are left out until the path has wiped it out
    """

    name: str
    displacement: np.ndarray
    force: np.ndarray
    angular: bool
    start: str

    @cached_property
    def first(self) -> int:
        """First row that is fitted."""
        if self.start != "unknown":
            return 0
        reached = np.maximum.accumulate(self.displacement) - np.minimum.accumulate(self.displacement)
        return int(np.argmax(reached >= SETTLED * np.ptp(self.displacement)))

    @cached_property
    def memory(self) -> Memory:
        """What friction remembers in every row that is fitted."""
        found = remembered(self.displacement, self.start == "fresh")
        weights = csr_matrix(found.weights[self.first:])
        used = np.unique(weights.indices)
        return Memory(found.half_distance[used], csr_matrix(weights[:, used]))

    @cached_property
    def fitted(self) -> tuple[np.ndarray, np.ndarray]:
        """Displacement and force of the rows that are fitted."""
        return self.displacement[self.first:], self.force[self.first:]

    def unit(self, dimension: str) -> str:
        """Return the unit of a displacement, a force, a stiffness; ``-`` of a ratio."""
        return UNITS[dimension][self.angular]


def read_loop(source: str | Path | Mapping[str, Any], start: str = "unknown") -> Loop:
    """Return a loop of a CSV file, or of columns.

    :param source: columns ``displacement_m`` and ``force_N``, or ``rotation_rad`` and ``moment_N_m``; ``time_s`` may be
        there and is not used
    :raises StatejumpError: no such file, a column that is missing or unknown, a value that is no finite number, a path
        that does not move or has too few rows
    """
    if start not in STARTS:
        raise NotAllowed("start", start, f"must be one of {', '.join(STARTS)}", allowed=STARTS)
    if isinstance(source, Mapping):
        return _loop("loop", {str(name): np.atleast_1d(np.asarray(values)) for name, values in source.items()}, start)
    file = Path(source)
    columns = read_columns(file)
    try:
        return _loop(file.stem, columns, start)
    except StatejumpError as failure:
        raise failure.located(file=file) from None


def _loop(name: str, columns: Mapping[str, np.ndarray], start: str) -> Loop:
    for column in columns:
        if column not in COLUMNS:
            near = get_close_matches(column, COLUMNS, 1)
            raise UnknownKey(column, section=f"column {column}", cause=f"did you mean {near[0]}?" if near else
                             f"known are {', '.join(COLUMNS)}")
    pairs = [pair for pair in PAIRS if pair[0] in columns or pair[1] in columns]
    if not pairs:
        raise MissingKey("displacement_m", "a loop has displacement_m and force_N, or rotation_rad and moment_N_m",
                         section="column displacement_m")
    if len(pairs) > 1:
        beside = next(name for name in PAIRS[1] if name in columns)
        raise NotAllowed(beside, beside=f"beside {next(name for name in PAIRS[0] if name in columns)}",
                         cause="a loop is force over displacement or moment over rotation")
    for column in pairs[0]:
        if column not in columns:
            raise MissingKey(column, f"it goes with {next(one for one in pairs[0] if one != column)}",
                             section=f"column {column}")
    check_columns(columns)
    displacement, force = (np.array(columns[column], dtype=float) for column in pairs[0])
    for column, values in zip(pairs[0], (displacement, force)):
        if not np.ptp(values) > 0:
            raise NotAllowed(column, float(values[0]), "is the same in every row: that is no loop")
    found = Loop(name, displacement, force, pairs[0] == PAIRS[1], start)
    left = len(displacement) - found.first
    if left < FEWEST_ROWS:
        raise StatejumpError(
            f"{left} rows are left to fit, at least {FEWEST_ROWS} are needed",
            cause=f"{found.first} rows are before the path has been over its range" if found.first else None,
            remedy="start = 'fresh' or 'cycled' says what friction carried before and leaves none out"
            if found.first else None)
    return found
