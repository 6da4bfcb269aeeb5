# SPDX-License-Identifier: GPL-3.0-or-later
"""Temperature programs: the section of a case file, its range, the engine's program of it.

A program of a shape is repeated every ``period_s``. The times of a table are the times: its cycle lasts as
long as its last one says.
"""
from __future__ import annotations

from typing import TYPE_CHECKING, Any

from statejump.core.errors import ABSENT, MissingKey, NotAllowed
from statejump.schema.fields import CHOICE, Section, choice, definition, fields_of, numbers, parameter, rule_of, whole

if TYPE_CHECKING:
    from statejump import _engine

SHAPES = ("triangle", "half_sine", "sine", "table")
PERIOD_s = 1.0  # where nothing says how long a cycle lasts
SAME_TIME = 1e-9  # two durations that differ by less, relatively, are the same but for rounding


@definition
class Thermal(Section):
    """The temperature program, one cycle repeated."""

    GOES_WITH = {"shape": {
        "temperature_change_max_K": ("triangle", "half_sine", "sine"),
        "table_time_s": ("table",),
        "table_temperature_change_K": ("table",),
    }}

    shape: str = choice(..., SHAPES, CHOICE)
    temperature_change_max_K: float | None = parameter(None, "K", -1e4, 1e4, "Chen et al. (2021), sections 3.3 and 4.3")
    cycles: int = whole(1, 1, 100_000, "the paper runs one")
    table_time_s: list[float] | None = numbers(None, "s", 0, 1e12, "measured data")
    table_temperature_change_K: list[float] | None = numbers(None, "K", -1e4, 1e4, "measured data")


def period() -> Any:
    """Declare the key that says how long a cycle lasts."""
    return parameter(None, "s", 0, 1e6, "1 s; a table lasts as long as its last time says", above=True)


def check(thermal: Thermal, section: str = "thermal.") -> None:
    """Raise StatejumpError for what is wrong with a program as a whole.

    :param section: how its keys begin, "" in a table of its own
    """
    if thermal.shape != "table":
        if thermal.temperature_change_max_K is None:
            rule = rule_of(fields_of(Thermal)["temperature_change_max_K"])
            raise MissingKey(f"{section}temperature_change_max_K", str(rule.allowed), allowed=rule.allowed)
        for key in ("table_time_s", "table_temperature_change_K"):
            if getattr(thermal, key) is not None:
                raise NotAllowed(f"{section}{key}", cause=f"only with {section}shape = 'table'")
        return
    if thermal.temperature_change_max_K is not None:
        raise NotAllowed(f"{section}temperature_change_max_K", beside=f"with {section}shape = 'table'")
    times, changes = thermal.table_time_s, thermal.table_temperature_change_K
    if times is None:
        raise MissingKey(f"{section}table_time_s", "a list of times [s] is needed for a table")
    if changes is None:
        raise MissingKey(f"{section}table_temperature_change_K", "one value [K] per time is needed")
    if len(times) < 2 or times[0] != 0 or any(b <= a for a, b in zip(times, times[1:])):
        raise NotAllowed(f"{section}table_time_s", times, "must be at least two times [s] that start at 0 and rise")
    if len(changes) != len(times):
        raise NotAllowed(f"{section}table_temperature_change_K", ABSENT, f"must be {len(times)} values, one per time, "
                         f"not {len(changes)}")
    if changes[0] != 0 or (thermal.cycles > 1 and changes[-1] != 0):
        raise NotAllowed(f"{section}table_temperature_change_K", changes,
                         "must start at 0 [K] and, with several cycles, end at 0 [K]")


def period_of(thermal: Thermal, given_s: float | None, key: str, default_s: float = PERIOD_s) -> float:
    """Return how long a cycle lasts [s]: of a table its last time, else what is given.

    :param given_s: what the case says of it; None: nothing
    :param key: the key that says it
    :param default_s: where nothing says it
    :raises NotAllowed: a table lasts otherwise
    """
    lasts = thermal.table_time_s[-1] if thermal.shape == "table" and thermal.table_time_s else 0.0
    if not lasts > 0:  # no table, or one that :func:`check` refuses
        return default_s if given_s is None else given_s
    if given_s is not None and abs(given_s - lasts) > SAME_TIME * lasts:
        raise NotAllowed(key, given_s, f"the table lasts {lasts:g} s, and its own times are the times",
                         remedy=f"leave {key} out")
    return lasts


def range_K(thermal: Thermal) -> tuple[float, float]:
    """Return the smallest and the largest ΔT [K] of a program."""
    if thermal.shape == "table":
        changes = thermal.table_temperature_change_K or [0.0]
        return min(changes), max(changes)
    peak = thermal.temperature_change_max_K or 0.0
    if thermal.shape == "sine":
        return -abs(peak), abs(peak)
    return min(0.0, peak), max(0.0, peak)


def parameters(thermal: Thermal, period_s: float) -> dict[str, Any]:
    """Return a program as plain values: those that the engine's program and the YADE script take.

    :param period_s: how long a cycle lasts [s], see :func:`period_of`
    """
    if thermal.shape == "table":
        return {"shape": "table", "cycles": thermal.cycles, "table_time_s": thermal.table_time_s,
                "table_temperature_change_K": thermal.table_temperature_change_K}
    return {"shape": thermal.shape, "cycles": thermal.cycles, "period_s": period_s,
            "temperature_change_max_K": thermal.temperature_change_max_K}


def program(thermal: Thermal, period_s: float) -> _engine.ThermalProgram:
    """Return a temperature program as the engine's."""
    from statejump import _engine

    return _engine.ThermalProgram(**parameters(thermal, period_s))
