# SPDX-License-Identifier: GPL-3.0-or-later
"""What every kind of case is made of: parameters with unit and range, sections, sentences.

Every field carries default (or none: required), unit, allowed range and source. Only this module
knows pydantic. A kind of case is one module beside this one; :mod:`statejump.kinds.registry` registers it.
"""
from __future__ import annotations

import difflib
import math
import re
from typing import Any, ClassVar, Optional, Sequence, TypeVar

from pydantic import BaseModel, Extra, Field, ValidationError, validator
from pydantic.fields import ModelField

from statejump.core.errors import StatejumpError

CHOICE = "choice, the paper is silent"

SectionType = TypeVar("SectionType", bound="Section")


def parameter(
    default: Any,
    unit: str,
    low: float,
    high: float,
    source: str,
    *,
    above: bool = False,
) -> Any:
    """Return the pydantic field of a number.

    :param default: default value; ``...`` for a required key
    :param unit: unit, ``-`` for none
    :param low: lower end of the allowed range
    :param high: upper end, itself allowed
    :param source: where the default comes from
    :param above: whether ``low`` itself is excluded
    """
    return Field(default, unit=unit, low=low, high=high, above=above, description=source)


def allowed_range(extra: dict[str, Any]) -> str:
    """Return the sentence part that states the allowed range of a parameter."""
    if math.isinf(extra["high"]):
        return "must be a number" + (f" above {extra['low']:g}" if math.isfinite(extra["low"]) else "")
    if extra["above"]:
        return f"must be above {extra['low']:g} and at most {extra['high']:g} [{extra['unit']}]"
    return f"must be between {extra['low']:g} and {extra['high']:g} [{extra['unit']}]"


def choice(default: Any, names: Sequence[str], source: str) -> Any:
    """Return the pydantic field of one name out of several.

    :param default: default value; ``...`` for a required key
    :param names: the names
    :param source: where the default comes from
    """
    return Field(default, names=tuple(names), description=source)


FOLDER_NAME = "[A-Za-z0-9][A-Za-z0-9_-]*"


def folder_name() -> Any:
    """Return the pydantic field of a name that becomes that of the results folder."""
    return Field(..., pattern=FOLDER_NAME, description="name of the results folder")


def check_folder_name(value: str) -> str:
    """Return the value if it can be the name of a results folder, else raise ValueError."""
    if not re.fullmatch(FOLDER_NAME, value):
        raise ValueError("must consist of letters, digits, '_' and '-'")
    return value


def check_number(value: Any, extra: dict[str, Any], integer: bool) -> float | int:
    """Return the value if it is a number in range, else raise ValueError with the reason."""
    kind = "a whole number" if integer else "a number"
    if isinstance(value, bool) or not isinstance(value, int if integer else (int, float)):
        raise ValueError(f"must be {kind}, " + allowed_range(extra).removeprefix("must be "))
    if isinstance(value, float) and not math.isfinite(value):
        raise ValueError("must be finite, " + allowed_range(extra).removeprefix("must be "))
    too_low = value <= extra["low"] if extra["above"] else value < extra["low"]
    if too_low or value > extra["high"]:
        raise ValueError(allowed_range(extra))
    return value


def check_name(value: str, names: Sequence[str]) -> str:
    """Return the value if it is one of the names, else raise ValueError that suggests the nearest."""
    if value in names:
        return value
    listed = "must be " + " or ".join(repr(name) for name in names)
    nearest = difflib.get_close_matches(value, names, n=1, cutoff=0.5)
    raise ValueError(listed + (f"; did you mean {nearest[0]!r}?" if nearest else ""))


def check_value(value: Any, extra: dict[str, Any], kind: Any) -> Any:
    """Return the value if its key allows it, else raise ValueError with the reason.

    :param extra: what the field declares: range, names, lists
    :param kind: type of the value, of its items for a list
    """
    if extra.get("texts"):
        if not isinstance(value, list) or not all(isinstance(item, str) for item in value):
            raise ValueError("must be a list of texts in quotes")
        return [check_name(item, extra["names"]) for item in value] if "names" in extra else value
    if kind is bool:
        if not isinstance(value, bool):
            raise ValueError("must be true or false")
        return value
    if "low" not in extra:
        if not isinstance(value, str if kind is str else (str, dict)):
            raise ValueError("must be a text in quotes")
        return check_name(value, extra["names"]) if "names" in extra else value
    if extra.get("listed"):
        if not isinstance(value, list):
            raise ValueError(f"must be a list of numbers [{extra['unit']}]")
        return [float(check_number(item, extra, integer=False)) for item in value]
    return check_number(value, extra, integer=kind is int)


def check_radii(bearing_radius: float, journal_radius: float) -> None:
    """Raise ValueError unless a journal fits into its bearing; for cases with a revolute joint."""
    if not bearing_radius > journal_radius:
        raise ValueError(f"must be above journal_radius_m = {journal_radius!r} [m]")


class Section(BaseModel):
    """A table of the case file: unknown keys are refused, numbers are strict and in range."""

    # Choice of the section: keys that some of its names need and the others refuse.
    GOES_WITH: ClassVar[dict[str, dict[str, tuple[str, ...]]]] = {}

    class Config:
        extra = Extra.forbid
        allow_mutation = False

    @validator("*", pre=True)
    def _strict(cls, value: Any, field: ModelField) -> Any:
        return check_value(value, field.field_info.extra, field.type_)


class CaseHeader(Section):
    """What the case is."""

    name: str = folder_name()
    kind: str = Field(..., description="which experiment")
    title: str = Field("", description="one line for figures")
    source: str = Field("", description="where the numbers come from")

    @validator("name")
    def _name(cls, value: str) -> str:
        return check_folder_name(value)


class Thermal(Section):
    """The temperature program, one cycle repeated."""

    GOES_WITH = {"shape": {
        "temperature_change_max_K": ("triangle", "half_sine", "sine"),
        "table_time_s": ("table",),
        "table_temperature_change_K": ("table",),
    }}

    shape: str = choice(..., ("triangle", "half_sine", "sine", "table"), CHOICE)
    temperature_change_max_K: Optional[float] = parameter(None, "K", -1e4, 1e4, "Chen et al. (2021), sections 3.3 and 4.3")
    cycles: int = parameter(1, "-", 1, 100_000, "the paper runs one")
    table_time_s: Optional[list[float]] = Field(
        None, unit="s", low=0, high=1e12, above=False, listed=True, description="measured data"
    )
    table_temperature_change_K: Optional[list[float]] = Field(
        None, unit="K", low=-1e4, high=1e4, above=False, listed=True, description="measured data"
    )


class Case(Section):
    """What all kinds have in common. A whole case file in SI units, immutable.

    A kind adds its sections, ``KIND``, ``period_s``, ``samples_per_cycle`` and ``problem``.
    """

    KIND: ClassVar[str]
    # Sections that a file of this kind may not have.
    NOT_IN_FILE: ClassVar[tuple[str, ...]] = ()

    case: CaseHeader
    thermal: Thermal

    @property
    def name(self) -> str:
        """Name of the case and of its results folder."""
        return self.case.name

    @property
    def kind(self) -> str:
        """Which experiment."""
        return self.KIND

    @property
    def title(self) -> str:
        """One line for figures and tables."""
        return self.case.title or self.case.name

    @property
    def period_s(self) -> float:
        """Length of one cycle [s]."""
        raise NotImplementedError

    @property
    def samples_per_cycle(self) -> int:
        """Samples per cycle of both models."""
        raise NotImplementedError

    @property
    def duration_s(self) -> float:
        """Length of all cycles [s]."""
        return self.period_s * self.thermal.cycles

    @property
    def table_time_s(self) -> list[float]:
        """Times of the table, stretched so that one cycle lasts ``period_s``; else empty."""
        times = self.thermal.table_time_s or []
        return [self.period_s * (time / times[-1]) for time in times]

    @property
    def temperature_range_K(self) -> tuple[float, float]:
        """Smallest and largest ΔT [K] of the program."""
        return thermal_range_K(self.thermal)

    def problem(self) -> str | None:
        """Return what is wrong between several keys, without the file's name."""
        raise NotImplementedError


def thermal_range_K(thermal: Thermal) -> tuple[float, float]:
    """Return the smallest and the largest ΔT [K] of a program."""
    if thermal.shape == "table":
        changes = thermal.table_temperature_change_K or [0.0]
        return min(changes), max(changes)
    peak = thermal.temperature_change_max_K or 0.0
    if thermal.shape == "sine":
        return -abs(peak), abs(peak)
    return min(0.0, peak), max(0.0, peak)


def thermal_problem(thermal: Thermal) -> str | None:
    """Return what is wrong with the program as a whole, without the file's name."""
    if thermal.shape != "table":
        if thermal.temperature_change_max_K is None:
            extra = Thermal.__fields__["temperature_change_max_K"].field_info.extra
            return f"thermal.temperature_change_max_K is missing: {allowed_range(extra)}"
        for key in ("table_time_s", "table_temperature_change_K"):
            if getattr(thermal, key) is not None:
                return f"thermal.{key} is not allowed: only with thermal.shape = 'table'"
        return None
    if thermal.temperature_change_max_K is not None:
        return "thermal.temperature_change_max_K is not allowed with thermal.shape = 'table'"
    times, changes = thermal.table_time_s, thermal.table_temperature_change_K
    if times is None:
        return "thermal.table_time_s is missing: a list of times [s] is needed for a table"
    if changes is None:
        return "thermal.table_temperature_change_K is missing: one value [K] per time is needed"
    if len(times) < 2 or times[0] != 0 or any(b <= a for a, b in zip(times, times[1:])):
        return (
            f"thermal.table_time_s = {times} is not allowed: must be at least two times [s] "
            "that start at 0 and rise"
        )
    if len(changes) != len(times):
        return (
            f"thermal.table_temperature_change_K has {len(changes)} values: "
            f"must be {len(times)}, one per time"
        )
    if changes[0] != 0 or (thermal.cycles > 1 and changes[-1] != 0):
        return (
            f"thermal.table_temperature_change_K = {changes} is not allowed: must start at 0 [K]"
            " and, with several cycles, end at 0 [K]"
        )
    return None


def no_length_left(key: str, thermal_expansion_per_K: float, case: Case) -> str | None:
    """Return the sentence for a link that the program shrinks to nothing."""
    for change in case.temperature_range_K:
        if 1 + thermal_expansion_per_K * change <= 0:
            return (
                f"{key} = {thermal_expansion_per_K!r} is not allowed: the link has no length left "
                f"at a temperature change of {change:g} K"
            )
    return None


def shown(value: Any) -> str:
    """Return a value as one would write it in the file."""
    if isinstance(value, bool):
        return str(value).lower()
    return repr(value)


def suggestion(word: str, known: list[str], before: str, after: str) -> str:
    match = difflib.get_close_matches(word, known, n=1, cutoff=0.5)
    if match:
        return f"did you mean {before}{match[0]}{after}?"
    return "known are " + ", ".join(known)


def rule(extra: dict[str, Any]) -> str:
    """Return the sentence part that states what a key needs."""
    if extra.get("texts"):
        return "a list of texts in quotes is needed"
    if extra.get("listed"):
        return f"a list of numbers [{extra['unit']}] is needed"
    if "low" in extra:
        return allowed_range(extra)
    if "names" in extra:
        return "must be " + " or ".join(repr(name) for name in extra["names"])
    return "a text in quotes is needed"


def _sentence(error: dict[str, Any], data: dict[str, Any], sections: type[Section]) -> str:
    """Return one pydantic error as one sentence."""
    location = error["loc"]
    section = str(location[0])
    if len(location) == 1:
        if error["type"] == "value_error.extra":
            known = list(sections.__fields__)
            return f"section [{section}] is unknown: {suggestion(section, known, '[', ']')}"
        if error["type"] == "value_error.missing":
            is_list = sections.__fields__[section].field_info.extra.get("tables")
            return f"section [[{section}]] is missing" if is_list else f"section [{section}] is missing"
        if error["type"] == "value_error.table":
            return error["msg"]
        return f"{section} = {shown(data[section])} is not allowed: must be a section [{section}]"
    key = str(location[1])
    model = sections.__fields__[section].type_
    if error["type"] == "value_error.extra":
        known = list(model.__fields__)
        return f"{section}.{key} is unknown: {suggestion(key, known, section + '.', '')}"
    info = model.__fields__[key].field_info
    if error["type"] == "value_error.missing":
        return f"{section}.{key} is missing: {rule(info.extra)}"
    return f"{section}.{key} = {shown(data[section][key])} is not allowed: {error['msg']}"


_ORDER = {"value_error.extra": 0, "value_error.missing": 1}


def parsed(model: type[SectionType], data: dict[str, Any], name: str) -> SectionType:
    """Return what a parsed TOML document holds, else raise one sentence.

    :param model: the sections that are allowed
    :param data: what tomllib returned
    :param name: name of the file, for messages
    """
    try:
        return model.parse_obj(data)
    except ValidationError as failure:
        # An unknown key is reported first: a misspelt key is missing as well.
        first = min(failure.errors(), key=lambda error: _ORDER.get(error["type"], 2))
        raise StatejumpError(f"{name}: {_sentence(first, data, model)}") from None
