# SPDX-License-Identifier: GPL-3.0-or-later
"""A measured loop: force over displacement, or moment over rotation, with rows in the order of measurement."""
from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from statejump.core.column_units import TIMES, matched
from statejump.core.errors import MissingKey, NotAllowed, StatejumpError, located
from statejump.core.table_files import read_known
from statejump.core.tables import check_columns
from statejump.identification.hysteresis import Memory, from_any_start, remembered

PAIRS = (("displacement_m", "force_N"), ("rotation_rad", "moment_N_m"))
COLUMNS = ("time_s", *(name for pair in PAIRS for name in pair))
# What test rigs call these quantities.
WORDS = {
    "time_s": TIMES,
    "displacement_m": ("disp", "displ", "position", "travel", "stroke", "deflection", "slip", "extension",
                       "elongation", "Weg", "Verschiebung", "u", "x"),
    "force_N": ("load", "friction", "friction force", "axial force", "Kraft", "F"),
    "rotation_rad": ("angle", "rot", "theta", "Winkel"),
    "moment_N_m": ("torque", "Drehmoment", "M"),
}
STARTS = ("unknown", "fresh", "cycled")
UNITS = {"displacement": ("m", "rad"), "force": ("N", "N m"), "stiffness": ("N/m", "N m/rad"), "-": ("-", "-")}
FORCES, DISPLACEMENTS = ("force", "moment"), ("displacement", "rotation")
FEWEST_ROWS = 20
# Energy that a loop may generate, as a fraction of largest force times path length. Phase shifts between sensors cause
# it.
PHASE = 0.01
# Number of standard deviations of the energy, due to noise of the force, that count as chance.
CHANCE = 6.0
# Correlation of force and displacement below which the sign of the force is that of a reaction.
PUSHES = -0.5


@dataclass(frozen=True)
class Loop:
    """A measured loop of a joint.

    :param name: name in tables and figures: the name of the file
    :param displacement: displacement [m] or rotation [rad] of every row
    :param force: force [N] or moment [N m] of every row
    :param angular: whether the loop is moment over rotation
    :param start: state of the joint before the first row. ``fresh``: friction is zero; ``cycled``: the joint has
        traversed the same path before; ``unknown``: friction is fitted
    """

    name: str
    displacement: np.ndarray
    force: np.ndarray
    angular: bool
    start: str

    @cached_property
    def memory(self) -> Memory:
        """What friction remembers in every row."""
        if self.start == "unknown":
            return from_any_start(self.displacement)
        return remembered(self.displacement, self.start == "fresh")

    def check_sign(self) -> None:
        """Reject a loop whose force has the sign of a reaction, as some solvers and load cells report it.

        :raises NotAllowed: the joint generates energy along the path, or the force falls as the displacement rises
        """
        energy, doubt = self._energy()
        largest = float(np.ptp(self.force)) / 2 * float(np.abs(np.diff(self.displacement)).sum())
        force, displacement = FORCES[self.angular], DISPLACEMENTS[self.angular]
        remedy = f"multiply {force} by -1: it is positive where it resists a positive {displacement}"
        if energy < -max(CHANCE * doubt, PHASE * largest):
            raise StatejumpError(code="loop_gives_energy", remedy=remedy, energy_J=-energy, force=force)
        if energy <= PHASE * largest and np.corrcoef(self.displacement, self.force)[0, 1] < PUSHES:
            raise StatejumpError(code="loop_falls", remedy=remedy, force=force, displacement=displacement)

    def _energy(self) -> tuple[float, float]:
        """Return the energy that the joint dissipates, and its standard deviation due to noise of the force. The
        integral begins and ends at rows in the middle of the path, so that springs do not contribute."""
        middle = float(np.min(self.displacement) + np.max(self.displacement)) / 2
        above = self.displacement > middle
        crossings = np.flatnonzero(above[1:] != above[:-1])
        same_way = crossings[above[crossings] == above[crossings[0]]]
        rows = slice(int(same_way[0]), int(same_way[-1]) + 1)
        displacement, force = self.displacement[rows], self.force[rows]
        if len(force) < 3:
            return 0.0, 0.0
        weights = np.zeros(len(force))
        weights[1:] += np.diff(displacement) / 2
        weights[:-1] += np.diff(displacement) / 2
        # The force has few corners, so its second differences are noise.
        noise = 1.4826 * float(np.median(np.abs(np.diff(force, 2)))) / 6**0.5
        return float(weights @ force), noise * float(np.linalg.norm(weights))

    def unit(self, dimension: str) -> str:
        """Return the unit of a displacement, a force or a stiffness of this loop; ``-`` for a ratio."""
        return UNITS[dimension][self.angular]


def read_loop(source: str | Path | Mapping[str, Any], start: str = "unknown", ignored: Sequence[str] = (),
              columns: Sequence[str] = ()) -> Loop:
    """Return the loop in a table or in given columns.

    :param source: table or columns ``displacement_m`` and ``force_N``, or ``rotation_rad`` and ``moment_N_m``;
        ``time_s`` is ignored
    :param ignored: names of columns to omit from a table
    :param columns: names of the columns, for a table without a header or in place of its own
    :raises StatejumpError: the file does not exist, a column is missing or unknown, a value is not finite, or the path
        is constant or has too few rows
    """
    if start not in STARTS:
        raise NotAllowed("start", start, code="not_one_of", allowed=STARTS, known=", ".join(STARTS))
    if isinstance(source, Mapping):
        return _loop("loop", _named(source), start)
    file = Path(source)
    found = read_known(file, COLUMNS, WORDS, ignored=ignored, names=columns)
    with located(file=file):
        return _loop(file.stem, found, start)


def _named(source: Mapping[str, Any]) -> dict[str, np.ndarray]:
    """Return columns under keys with units, converted to these; ISO times are omitted."""
    given = {str(name): np.atleast_1d(np.asarray(values)) for name, values in source.items()}
    columns = [column for column in matched(list(given), COLUMNS, WORDS) if not column.iso]
    return {column.key: column.converted(given[column.name]) if given[column.name].dtype.kind in "iuf"
            else given[column.name] for column in columns}


def _loop(name: str, columns: Mapping[str, np.ndarray], start: str) -> Loop:
    pairs = [pair for pair in PAIRS if pair[0] in columns or pair[1] in columns]
    if not pairs:
        raise MissingKey("displacement_m", code="loop_columns_missing", section="column displacement_m")
    if len(pairs) > 1:
        beside = next(name for name in PAIRS[1] if name in columns)
        raise NotAllowed(beside, code="loop_of_two_kinds", other=next((name for name in PAIRS[0] if name in columns)))
    for column in pairs[0]:
        if column not in columns:
            raise MissingKey(column, code="partner_missing", section=f"column {column}",
                             partner=next((one for one in pairs[0] if one != column)))
    check_columns(columns)
    displacement, force = (np.array(columns[column], dtype=float) for column in pairs[0])
    for column, values in zip(pairs[0], (displacement, force)):
        if not np.ptp(values) > 0:
            raise NotAllowed(column, float(values[0]), code="loop_constant")
    if len(displacement) < FEWEST_ROWS:
        raise StatejumpError(code="too_few_rows", rows=len(displacement), fewest=FEWEST_ROWS)
    found = Loop(name, displacement, force, pairs[0] == PAIRS[1], start)
    found.check_sign()
    return found
