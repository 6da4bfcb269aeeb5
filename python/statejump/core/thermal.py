# SPDX-License-Identifier: GPL-3.0-or-later
"""Temperature programs: their section in a case file, their temperature range, and their form for the engine.

A program with a shape repeats every ``period_s``. The cycle of a table ends at its last time. A table that does not end
at its first temperature gets a return: one more row, ΔT = 0 at ``period_s``.
"""
from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from statejump import _engine
from statejump.core.errors import ABSENT, MissingKey, NotAllowed
from statejump.core.notes import Note
from statejump.schema.fields import (
    CHOICE, Section, choice, definition, evolved, fields_of, numbers, parameter, rule_of, switch, text, whole,
)

Numbers = NDArray[np.float64]
SHAPES = ("triangle", "half_sine", "sine", "table")
PERIOD_s = 1.0  # default duration of a cycle
SAME_TIME = 1e-9  # relative difference below which two durations are equal up to rounding
SAME_TEMPERATURE_K = 1e-9  # difference below which two temperatures are equal up to the conversion from °C to kelvin
LONGEST_TABLE_S, LARGEST_CHANGE_K = 1e12, 1e4
LONGEST_PERIOD_S = 1e6
MOST_SHOWN = 20  # values of a list in a sentence
# Keys that name a file of temperatures, or describe its content; see :mod:`statejump.core.temperature_files`.
KEYS_OF_FILES = ("table_file", "table_column", "members_file", "reference_temperature_K", "lead_in_s",
                 "lead_out_s")


@definition
class Thermal(Section):
    """The temperature program, one cycle repeated."""

    GOES_WITH = {"shape": {"temperature_change_max_K": ("triangle", "half_sine", "sine")}}
    ONE_OF = {"shape": {"table": (("table_time_s", "table_temperature_change_K"), ("table_file",))}}

    shape: str = choice(..., SHAPES, CHOICE)
    temperature_change_max_K: float | None = parameter(
        None, "K", -LARGEST_CHANGE_K, LARGEST_CHANGE_K, "Chen et al. (2021), sections 3.3 and 4.3"
    )
    cycles: int = whole(1, 1, 100_000, "the paper runs one")
    period_s: float = parameter(
        None, "s", 0, LONGEST_PERIOD_S, "1 s; a table lasts as long as its last time says", above=True)
    table_time_s: list[float] | None = numbers(None, "s", 0, LONGEST_TABLE_S, "measured data")
    table_temperature_change_K: list[float] | None = numbers(
        None, "K", -LARGEST_CHANGE_K, LARGEST_CHANGE_K, "measured data"
    )
    table_file: str | None = text(None, "CSV or HDF5 file with the table, beside the case file")
    table_column: str | None = text(None, "its column without unit; the program's name, or the only column")
    reference_temperature_K: float | None = parameter(
        None, "K", 0, LARGEST_CHANGE_K, "where the parts are free of stress; none: the file has changes", above=True
    )
    lead_in_s: float | None = parameter(
        None, "s", 0, LONGEST_TABLE_S, "straight way from the reference temperature to the file's first row", above=True
    )
    lead_out_s: float | None = parameter(
        None, "s", 0, LONGEST_TABLE_S, "straight way back from the file's last row; none", above=True
    )

    def repeated(self, cycles: int) -> Self:
        """Return the program with another number of cycles."""
        return evolved(self, cycles=cycles)


@definition
class CaseThermal(Thermal):
    """The temperature program of a case.

    ``return_to_reference`` is true by default: a state jump is a change at one temperature, so a program that ends at
    another one has none. On the quasi-static path the jump does not depend on the duration of the return.
    """

    return_to_reference: bool = switch(
        True, "whether a table that ends elsewhere returns to ΔT = 0 at its mean rate, or until period_s")


@dataclass(frozen=True)
class MemberProgram:
    """The temperature table of one member, with the interface of a temperature program."""

    table_time_s: Numbers
    table_temperature_change_K: Numbers
    cycles: int
    shape: str = "table"

    @property
    def period_s(self) -> float:
        """Length of a cycle [s]."""
        return float(self.table_time_s[-1])

    def repeated(self, cycles: int) -> MemberProgram:
        """Return the program with another number of cycles."""
        return MemberProgram(self.table_time_s, self.table_temperature_change_K, cycles)


RETURNS = {
    "return_to_reference": "set thermal.return_to_reference to true to add a return",
    "tables_of_equal_cycles": "give all programs as tables of as many cycles to add a return",
}


@dataclass(frozen=True)
class Ending:
    """The last row of a table that does not end at the reference temperature.

    :param time_s: time of this row [s], in the last cycle
    :param temperature_change_K: ΔT [K] at this row, of the program furthest from the reference temperature
    :param return_s: duration of the added return [s]; 0: none is added
    :param setting: the setting that adds a return: a key of ``RETURNS``
    """

    time_s: float
    temperature_change_K: float
    return_s: float
    setting: str = ""

    @property
    def remedy(self) -> str:
        """What adds a return."""
        return RETURNS.get(self.setting, "")

    @property
    def returns(self) -> bool:
        """Whether a return to the reference temperature is added."""
        return self.return_s > 0

    @property
    def where(self) -> str:
        """The ending as a clause."""
        return f"the program ends at a temperature change of {self.temperature_change_K:.6g} K"

    @property
    def note(self) -> Note:
        """The ending in a sentence."""
        where = {"time_s": self.time_s, "temperature_change_K": self.temperature_change_K}
        if self.returns:
            return Note("return_added", where=self.where, **where, return_s=self.return_s)
        return Note("no_return", where=self.where, **where, remedy=self.remedy, setting=self.setting)


def ending(
    programs: Sequence[Thermal | MemberProgram], returns: bool, period_s: float | None,
) -> Ending | None:
    """Return the last row of the programs of a case, if it is not at the reference temperature.

    The added return ends at ``period_s``. Without this key, the furthest program returns at the mean rate of its table.

    :param programs: programs as given, without a return, the common program first
    :param returns: whether the case requests a return
    :param period_s: duration of a cycle; None: not given
    :raises NotAllowed: ``period_s`` is before the last row
    """
    tables = [one for one in programs if one.shape == "table"]
    if not tables or not all(map(_is_sound, tables)):  # :func:`check` refuses the others
        return None
    furthest = max(tables, key=lambda one: abs(float(_changes(one)[-1])))
    changes, lasts, cycles = _changes(furthest), float(_times(furthest)[-1]), programs[0].cycles
    last = float(changes[-1])
    if abs(last) < SAME_TEMPERATURE_K:
        return None
    if not returns:
        return Ending(cycles * lasts, last, 0.0, "return_to_reference")
    if len(tables) < len(programs) or any((one.cycles or cycles) != cycles for one in tables):
        return Ending(cycles * lasts, last, 0.0, "tables_of_equal_cycles")
    takes = abs(last) * lasts / float(np.abs(np.diff(changes)).sum())
    if lasts < LONGEST_PERIOD_S:
        takes = min(takes, LONGEST_PERIOD_S - lasts)
    if period_s is not None and abs(period_s - lasts) > SAME_TIME * lasts:
        takes = period_s - lasts
    if takes < 0:
        key = "thermal.period_s"
        raise NotAllowed(key, period_s, code="return_too_late", lasts=lasts, key_to_leave_out=key)
    return Ending((cycles - 1) * (lasts + takes) + lasts, last, takes)


def _is_sound(program: Thermal | MemberProgram) -> bool:
    """Return whether a table has rising times and equally many temperatures."""
    if program.table_time_s is None or program.table_temperature_change_K is None:
        return False
    times = _times(program)
    return len(times) > 1 and len(times) == len(_changes(program)) and bool(np.all(np.diff(times) > 0))


def _times(program: Thermal | MemberProgram) -> Numbers:
    return np.asarray(program.table_time_s, dtype=float)


def _changes(program: Thermal | MemberProgram) -> Numbers:
    return np.asarray(program.table_temperature_change_K, dtype=float)


def rows(program: Thermal | MemberProgram, period_s: float) -> tuple[Numbers, Numbers]:
    """Return times [s] and temperature changes [K] of a table, including the added return until ``period_s``."""
    times, changes = _times(program), _changes(program)
    if period_s - times[-1] <= SAME_TIME * times[-1]:
        return times, changes
    return np.append(times, period_s), np.append(changes, 0.0)


def check(thermal: Thermal, section: str = "thermal.", returns: bool = False) -> None:
    """Raise StatejumpError if a temperature program is invalid.

    :param section: prefix of the keys; "" for keys in a table of their own
    :param returns: whether a return is added to a table that does not end at the reference temperature
    """
    for key in KEYS_OF_FILES:
        if getattr(thermal, key, None) is not None:
            # Loading a case replaces the names of files by their contents, so a name left here comes from elsewhere.
            raise NotAllowed(f"{section}{key}", getattr(thermal, key), code="key_of_case_file")
    if thermal.shape != "table":
        if thermal.temperature_change_max_K is None:
            rule = rule_of(fields_of(Thermal)["temperature_change_max_K"])
            raise MissingKey(f"{section}temperature_change_max_K", allowed=rule.allowed, code="missing_key")
        for key in ("table_time_s", "table_temperature_change_K"):
            if getattr(thermal, key) is not None:
                raise NotAllowed(f"{section}{key}", code="requires_table_shape", in_section=section)
        return
    if thermal.temperature_change_max_K is not None:
        raise NotAllowed(f"{section}temperature_change_max_K", code="conflicting_key",
                         other=f"{section}shape = 'table'")
    times, changes = thermal.table_time_s, thermal.table_temperature_change_K
    if times is None:
        raise MissingKey(f"{section}table_time_s", code="table_times_missing")
    if changes is None:
        raise MissingKey(f"{section}table_temperature_change_K", code="table_values_missing")
    if len(times) < 2 or times[0] != 0 or any(b <= a for a, b in zip(times, times[1:])):
        raise NotAllowed(f"{section}table_time_s", _short(times), code="table_times")
    if len(changes) != len(times):
        raise NotAllowed(f"{section}table_temperature_change_K", ABSENT, code="table_length", times=len(times),
                         values=len(changes))
    if changes[0] != 0 or (thermal.cycles > 1 and changes[-1] != 0 and not returns):
        raise NotAllowed(f"{section}table_temperature_change_K", _short(changes), code="table_ends")


def _short(values: list[float]) -> Any:
    """Return a list in a length that fits into a sentence."""
    return values if len(values) <= MOST_SHOWN else ABSENT


def period_of(
    thermal: Thermal, given_s: float | None, key: str, default_s: float = PERIOD_s, return_s: float = 0.0
) -> float:
    """Return the duration of a cycle [s]: for a table its last time plus the return, else the given duration.

    :param given_s: duration in the case; None: not given
    :param key: the key of the duration
    :param default_s: duration if none is given
    :param return_s: duration of the added return of the table
    :raises NotAllowed: the table has another duration
    """
    lasts = thermal.table_time_s[-1] if thermal.shape == "table" and thermal.table_time_s else 0.0
    if not lasts > 0:  # no table, or one that :func:`check` refuses
        return default_s if given_s is None else given_s
    if return_s and given_s is not None and abs(given_s - lasts) <= SAME_TIME * lasts:
        given_s = None  # a further program has the duration of its table
    lasts += return_s
    if given_s is not None and abs(given_s - lasts) > SAME_TIME * lasts:
        raise NotAllowed(key, given_s, code="period_beside_table", lasts=lasts, key_to_leave_out=key)
    return lasts


def range_K(thermal: Thermal | MemberProgram) -> tuple[float, float]:
    """Return the smallest and the largest ΔT [K] of a program."""
    if not isinstance(thermal, Thermal):
        return float(thermal.table_temperature_change_K.min()), float(thermal.table_temperature_change_K.max())
    if thermal.shape == "table":
        changes = thermal.table_temperature_change_K or [0.0]
        return min(changes), max(changes)
    peak = thermal.temperature_change_max_K or 0.0
    if thermal.shape == "sine":
        return -abs(peak), abs(peak)
    return min(0.0, peak), max(0.0, peak)


def parameters(thermal: Thermal | MemberProgram, period_s: float) -> dict[str, Any]:
    """Return a temperature program as plain values, for the engine and for the YADE script.

    :param period_s: duration of a cycle [s], see :func:`period_of`
    """
    if not isinstance(thermal, Thermal):
        return {"shape": "table", "cycles": thermal.cycles, "table_time_s": thermal.table_time_s.tolist(),
                "table_temperature_change_K": thermal.table_temperature_change_K.tolist()}
    if thermal.shape == "table":
        times, changes = rows(thermal, period_s)
        return {"shape": "table", "cycles": thermal.cycles, "table_time_s": times.tolist(),
                "table_temperature_change_K": changes.tolist()}
    return {"shape": thermal.shape, "cycles": thermal.cycles, "period_s": period_s,
            "temperature_change_max_K": thermal.temperature_change_max_K}


def returns_s(programs: Sequence[Thermal | MemberProgram], period_s: float) -> Numbers:
    """Return the times [s] at which all items have their initial temperatures: ends of cycles, rows of a table.

    :param programs: all programs of a case, the common program first; all have the same duration
    """
    common, own = programs[0], [period_s]
    if common.shape == "table" and common.table_time_s is not None:
        own = rows(common, period_s)[0][1:].tolist()
    times: Numbers = (np.arange(common.cycles)[:, None] * period_s + np.array(own)).ravel()
    for one in programs:
        times = times[np.abs(program(one, period_s).temperature_change(times)) < SAME_TEMPERATURE_K]
    return times


def program(thermal: Thermal | MemberProgram, period_s: float) -> _engine.ThermalProgram:
    """Return a temperature program as the engine's."""
    return _engine.ThermalProgram(**parameters(thermal, period_s))
