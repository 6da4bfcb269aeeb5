# SPDX-License-Identifier: GPL-3.0-or-later
"""Campaign files: which case, which model, what varies and how; checked as strictly as a case."""
from __future__ import annotations

import difflib
import hashlib
import json
import math
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, Optional, Sequence, Union

import numpy as np
from pydantic import Field, validator
from pydantic.fields import ModelField

from statejump import __version__
from statejump.kinds.registry import KINDS as CASE_KINDS
from statejump.kinds.registry import Case, load_case
from statejump.schema.fields import (
    CHOICE, Section, check_folder_name, check_name, check_number, choice, folder_name, parameter, parsed,
)
from statejump.schema.items import is_tables, numbers
from statejump.core.errors import StatejumpError
from statejump.schema.toml import read_toml
from statejump.campaign.outcomes import KINDS, MODELS
from statejump.campaign.sampling import (
    DISTRIBUTIONS, Distribution, Independent, Values, changed_data, montecarlo_draws, montecarlo_values,
    number_of_points, split_path, sweep_values,
)

MONTECARLO, SWEEP = "montecarlo", "sweep"
MOST_SAMPLES = 10_000_000
SPACINGS = ("linear", "log")


class SweepHeader(Section):
    """The [campaign] section of a sweep."""

    name: str = folder_name()
    title: str = Field("", description="one line for figures")
    case: str = Field(..., description="case file, relative to the campaign file")
    model: str = choice("reduced", MODELS, CHOICE + ": the fast one")

    @validator("name")
    def _name(cls, value: str) -> str:
        return check_folder_name(value)


class MonteCarloHeader(SweepHeader):
    """The [campaign] section of a Monte Carlo campaign."""

    samples: int = parameter(..., "-", 1, MOST_SAMPLES, CHOICE)
    seed: int = parameter(..., "-", 0, 2**31 - 1, CHOICE)


class _SweepFile(Section):
    campaign: SweepHeader


class _MonteCarloFile(Section):
    campaign: MonteCarloHeader


def _numbers(kind: type[Case]) -> dict[str, ModelField]:
    """Every key of a kind of case that holds one number, as ``section.key``; of items of a list as
    ``section.*.key``."""
    found = {}
    for section, field in kind.__fields__.items():
        item = ".*" if is_tables(field) else ""
        for key, inner in getattr(field.type_, "__fields__", {}).items():
            extra = inner.field_info.extra
            if "low" in extra and not extra.get("listed"):
                found[f"{section}{item}.{key}"] = inner
    return found


_PATHS = sorted({path for kind in KINDS for path in _numbers(CASE_KINDS[kind])})
_PATTERN = "(?:" + "|".join(path.replace(".", r"\.").replace("*", ".+") for path in _PATHS) + ")"
_OWN = "section.key as in the case file, of a list section.item.key, * for all items"


def _free(source: str, *, unit: str = "as key", above: Optional[float] = None) -> Any:
    """A number without range, in the unit of the varied key."""
    low = -math.inf if above is None else above
    return parameter(None, unit, low, math.inf, source, above=above is not None)


# What a [[vary]] table may hold. _vary() judges it: most keys depend on each other.
class MonteCarloVary(Section):
    """A [[vary]] table of a Monte Carlo campaign."""

    key: str = Field(..., pattern=_PATTERN, description=_OWN)
    also: list[str] = Field([], texts=True, pattern=_PATTERN, description="keys that get the same value")
    distribution: str = choice(..., DISTRIBUTIONS, "of the parameter")
    mean: Optional[float] = _free("the case's own")
    standard_deviation: Optional[float] = _free("this or relative", above=0)
    relative: Optional[float] = _free(
        "standard deviation, of a uniform distribution the half width, over the mean", unit="-", above=0
    )
    low: Optional[float] = _free("no lower limit")
    high: Optional[float] = _free("no upper limit")


class SweepVary(Section):
    """A [[vary]] table of a sweep."""

    key: str = Field(..., pattern=_PATTERN, description=_OWN)
    also: list[str] = Field([], texts=True, pattern=_PATTERN, description="keys that get the same value")
    values: Optional[list[float]] = numbers(None, "as key", -math.inf, math.inf, "these, or start, stop and count")
    start: Optional[float] = _free("first value")
    stop: Optional[float] = _free("last value")
    count: Optional[int] = parameter(None, "-", 2, MOST_SAMPLES, "number of values")
    spacing: str = choice("linear", SPACINGS, CHOICE)


MONTECARLO_KEYS, SWEEP_KEYS = tuple(MonteCarloVary.__fields__), tuple(SweepVary.__fields__)


class MonteCarloCampaign(_MonteCarloFile):
    """A case whose parameters are random."""

    vary: Any = Field(..., tables=MonteCarloVary, description="sections [[vary]]")


class SweepCampaign(_SweepFile):
    """A case on a grid of its parameters."""

    vary: Any = Field(..., tables=SweepVary, description="sections [[vary]]")


FILES: dict[str, type[Section]] = {MONTECARLO: MonteCarloCampaign, SWEEP: SweepCampaign}


@dataclass(frozen=True)
class Campaign:
    """A checked campaign and all that its samples need."""

    command: str  # montecarlo or sweep
    file: Path
    text: str
    name: str
    title: str
    model: str
    case: Case
    case_data: dict[str, dict[str, Any]]  # as in the case file, without what it leaves out
    vary: tuple[Union[Distribution, Independent, Values], ...]
    samples: int
    seed: Optional[int]

    @property
    def units(self) -> dict[str, str]:
        """Unit of every outcome, in the order of the table."""
        return KINDS[self.case.kind].units

    def unit_of(self, path: str) -> str:
        """Unit of a varied key."""
        return _field(self.case, path).field_info.extra["unit"]

    def values(self, index: int) -> list[Union[int, float]]:
        """Values of sample ``index``, one per varied parameter."""
        if self.command == SWEEP:
            return sweep_values(self.vary, index)  # type: ignore[arg-type]
        return montecarlo_values(self.vary, self.seed, index)  # type: ignore[arg-type]

    def data(self, index: int) -> dict[str, dict[str, Any]]:
        """The case file of sample ``index``, parsed but not checked."""
        if self.command == SWEEP:
            return changed_data(self.case_data, self.vary, self.values(index))  # type: ignore[arg-type]
        draws = montecarlo_draws(self.vary, self.seed, index)  # type: ignore[arg-type]
        return changed_data(self.case_data, [item for item, _ in draws], [value for _, value in draws])

    @property
    def key(self) -> str:
        """SHA-256 of all that a sample depends on. Name, title and number of samples are not in it:
        a campaign may be extended."""
        resolved = {
            "version": __version__, "command": self.command, "model": self.model, "seed": self.seed,
            "case": self.case.dict(), "vary": [asdict(parameter) for parameter in self.vary],
        }
        return hashlib.sha256(json.dumps(resolved, sort_keys=True).encode()).hexdigest()


def load_campaign(path: Path, command: str) -> Campaign:
    """Return the checked campaign of a TOML file.

    :param command: ``montecarlo`` or ``sweep``
    :raises StatejumpError: one sentence with file, key, value and what is allowed
    """
    text, data = read_toml(path, "campaign")
    tables = data.pop("vary", None)
    file = _MonteCarloFile if command == MONTECARLO else _SweepFile
    for key in ("samples", "seed"):
        if command == SWEEP and isinstance(data.get("campaign"), dict) and key in data["campaign"]:
            raise StatejumpError(
                f"{path}: campaign.{key} is not allowed in a sweep: only 'statejump montecarlo' draws samples"
            )
    unknown = [key for key in data if key != "campaign"]
    if unknown:
        match = difflib.get_close_matches(unknown[0], ["campaign", "vary"], n=1, cutoff=0.5)
        hint = {"campaign": "did you mean [campaign]?", "vary": "did you mean [[vary]]?"}
        raise StatejumpError(
            f"{path}: section [{unknown[0]}] is unknown: "
            + (hint[match[0]] if match else "known are [campaign] and [[vary]]")
        )
    header = parsed(file, data, str(path)).campaign
    case_file = path.parent / header.case
    case = load_case(case_file)
    if case.kind not in KINDS:
        raise StatejumpError(f"{path}: campaign.case = {header.case!r} is not allowed: no campaign runs {case.kind!r}")
    if header.model == "dem" and KINDS[case.kind].of_dem_run is None:
        raise StatejumpError(
            f"{path}: campaign.model = 'dem' is not allowed: a campaign of {case.kind!r} has model = 'reduced'"
        )
    if not isinstance(tables, list) or not tables or not all(isinstance(table, dict) for table in tables):
        raise StatejumpError(f"{path}: [[vary]] is missing: at least one table says what varies")
    vary = []
    for number, table in enumerate(tables, start=1):
        try:
            vary.append(_vary(table, case, command))
        except ValueError as reason:
            raise StatejumpError(f"{path}: vary[{number}].{reason}") from None
        taken = [key for parameter in vary[:-1] for key in parameter.keys]
        for key in vary[-1].keys:
            if any(_overlap(key, other) for other in taken) or vary[-1].keys.count(key) > 1:
                raise StatejumpError(f"{path}: vary[{number}].key = {key!r} is not allowed: it varies already")
    if command == SWEEP:
        samples, seed = number_of_points(vary), None
        if samples > MOST_SAMPLES:
            raise StatejumpError(
                f"{path}: [[vary]] is not allowed: the grid has {samples} points, must be at most {MOST_SAMPLES}"
            )
    else:
        samples, seed = header.samples, header.seed
    return Campaign(
        command, path, text, header.name, header.title or header.name, header.model, case,
        read_toml(case_file, "case")[1], tuple(vary), samples, seed,
    )


def _pattern(path: str) -> str:
    """The path with ``*`` for the name of its item."""
    section, item, key = split_path(path)
    return f"{section}.*.{key}" if item else path


def _overlap(one: str, other: str) -> bool:
    """Whether two paths have a number of the case in common."""
    if _pattern(one) != _pattern(other):
        return False
    return one == other or "*" in (split_path(one)[1], split_path(other)[1])


def _field(case: Case, path: str) -> ModelField:
    return _numbers(type(case))[_pattern(path)]


def _items(case: Case, path: str) -> list[str]:
    """Names of the items that a path with ``*`` stands for."""
    return [item.name for item in getattr(case, split_path(path)[0])]


def own_value(case: Case, path: str) -> Optional[float]:
    """What the case itself says, for ``*`` if its items agree; None: nothing."""
    section, item, key = split_path(path)
    if not item:
        return getattr(getattr(case, section), key)
    values = {getattr(one, key) for one in getattr(case, section) if item in ("*", one.name)}
    return values.pop() if len(values) == 1 else None


def _checked_path(path: Any, name: str, case: Case) -> str:
    if not isinstance(path, str):
        raise ValueError(f"{name} = {path!r} is not allowed: must be a text such as 'joint.friction_coefficient'")
    known = _numbers(type(case))
    section, item, key = split_path(path)
    if _pattern(path) in known:
        names = _items(case, path) if item else []
        if item and not names:
            raise ValueError(f"{name} = {path!r} is not allowed: the case has no [[{section}]]")
        if not item or item == "*" or item in names:
            return path
        match = difflib.get_close_matches(item, names, n=1, cutoff=0.5)
        raise ValueError(f"{name} = {path!r} is unknown: the case has no {section} {item!r}"
                         + (f": did you mean {match[0]!r}?" if match else ""))
    model = getattr(type(case).__fields__.get(section), "type_", None)
    if key in getattr(model, "__fields__", {}):
        raise ValueError(f"{name} = {path!r} is not allowed: it is not a number")
    match = difflib.get_close_matches(path, known, n=1, cutoff=0.5)
    raise ValueError(
        f"{name} = {path!r} is unknown in a case of kind {case.kind!r}"
        + (f": did you mean {match[0]!r}?" if match else ": must be section.key as in the case file")
    )


def _number(table: dict[str, Any], name: str, *, above: Optional[float] = None) -> Optional[float]:
    """Return a finite number of a [[vary]] table; None: it is not there."""
    if name not in table:
        return None
    value = table[name]
    rule = "must be a finite number" + ("" if above is None else f" above {above:g}")
    if isinstance(value, bool) or not isinstance(value, (int, float)) or not math.isfinite(value):
        raise ValueError(f"{name} = {_shown(value)} is not allowed: {rule}")
    if above is not None and not value > above:
        raise ValueError(f"{name} = {_shown(value)} is not allowed: {rule}")
    return float(value)


def _shown(value: Any) -> str:
    return str(value).lower() if isinstance(value, bool) else repr(value)


def _in_range(name: str, value: Any, field: ModelField) -> Union[int, float]:
    try:
        return check_number(value, field.field_info.extra, integer=field.type_ is int)
    except ValueError as reason:
        raise ValueError(f"{name} = {_shown(value)} is not allowed: {reason}") from None


def _vary(table: dict[str, Any], case: Case, command: str) -> Union[Distribution, Independent, Values]:
    """Return one [[vary]] table. :raises ValueError: what is wrong, begins with the key"""
    known, others = (MONTECARLO_KEYS, SWEEP_KEYS) if command == MONTECARLO else (SWEEP_KEYS, MONTECARLO_KEYS)
    for name in table:
        if name in known:
            continue
        if name in others:
            other = SWEEP if command == MONTECARLO else MONTECARLO
            raise ValueError(
                f"{name} is not allowed in a campaign of 'statejump {command}': it is for 'statejump {other}'"
            )
        match = difflib.get_close_matches(name, known, n=1, cutoff=0.5)
        hint = f"did you mean {match[0]}?" if match else "known are " + ", ".join(known)
        raise ValueError(f"{name} is unknown: {hint}")
    if "key" not in table:
        raise ValueError("key is missing: must be section.key as in the case file")
    main = _checked_path(table["key"], "key", case)
    also = table.get("also", [])
    if not isinstance(also, list):
        raise ValueError(f"also = {also!r} is not allowed: must be a list of keys that get the same value")
    keys = (main, *(_checked_path(path, "also", case) for path in also))
    if command == SWEEP:
        return _values(table, keys, case)
    if split_path(main)[1] != "*":
        return _distribution(table, keys, case)
    for path in keys[1:]:
        if split_path(path)[:2] != split_path(main)[:2]:
            raise ValueError(f"also = {path!r} is not allowed: items of {main!r} share their values with their own keys")
    return Independent(keys, tuple(
        _distribution(table, tuple(path.replace(".*.", f".{item}.", 1) for path in keys), case)
        for item in _items(case, main)
    ))


def _distribution(table: dict[str, Any], keys: tuple[str, ...], case: Case) -> Distribution:
    for path in keys:
        if _field(case, path).type_ is int:
            raise ValueError(f"key = {path!r} is not allowed: it is a whole number, only 'statejump sweep' varies it")
    kind = table.get("distribution")
    try:
        if not isinstance(kind, str):
            raise ValueError("must be " + " or ".join(repr(name) for name in DISTRIBUTIONS))
        check_name(kind, DISTRIBUTIONS)
    except ValueError as reason:
        is_missing = "distribution is missing" if kind is None else f"distribution = {_shown(kind)} is not allowed"
        raise ValueError(f"{is_missing}: {reason}") from None
    low, high = _number(table, "low"), _number(table, "high")
    deviation, relative = (_number(table, name, above=0) for name in ("standard_deviation", "relative"))
    bounded = kind in ("uniform", "truncated_normal")
    for name, value in (("low", low), ("high", high)):
        if value is not None and not bounded:
            raise ValueError(f"{name} is not allowed: a {kind} distribution has no limits")
    if low is not None and high is not None and not low < high:
        raise ValueError(f"high = {high!r} is not allowed: must be above low = {low!r}")
    if kind == "uniform" and relative is None:
        for name in ("mean", "standard_deviation"):
            if name in table:
                raise ValueError(f"{name} is not allowed: a uniform distribution has low and high, or relative")
        for name, value in (("low", low), ("high", high)):
            if value is None:
                raise ValueError(f"{name} is missing: a uniform distribution has low and high, or relative")
        return Distribution(keys, kind, low=low, high=high)  # type: ignore[arg-type]
    mean = table.get("mean", own_value(case, keys[0]))
    if mean is None:
        raise ValueError(f"mean is missing: the case gives no {keys[0]}")
    mean = float(_in_range("mean", mean, _field(case, keys[0])))
    if relative is not None:
        if mean == 0:
            raise ValueError(f"relative = {relative!r} is not allowed: the mean is 0")
        if deviation is not None:
            raise ValueError("relative is not allowed beside standard_deviation")
        deviation = relative * abs(mean)
    if deviation is None:
        raise ValueError("standard_deviation is missing: either it or relative is needed, above 0")
    if kind == "uniform":
        if low is not None or high is not None:
            raise ValueError("relative is not allowed beside low and high")
        return Distribution(keys, kind, low=mean - deviation, high=mean + deviation)
    if kind == "lognormal" and not mean > 0:
        raise ValueError(f"mean = {mean!r} is not allowed: must be above 0 for a lognormal distribution")
    if kind != "truncated_normal":
        return Distribution(keys, kind, mean, deviation)
    if low is None and high is None:
        raise ValueError("low is missing: a truncated_normal distribution has low or high or both")
    ends = {"low": -math.inf if low is None else low, "high": math.inf if high is None else high}
    found = Distribution(keys, kind, mean, deviation, **ends)
    below, up_to, _ = found.probabilities()
    if not up_to - below > 1e-12:
        raise ValueError(
            f"mean = {mean!r} is not allowed: practically nothing of the normal distribution is left between the limits"
        )
    return found


def _values(table: dict[str, Any], keys: tuple[str, ...], case: Case) -> Values:
    field = _field(case, keys[0])
    spacing = table.get("spacing", "linear")
    if not isinstance(spacing, str) or spacing not in SPACINGS:
        raise ValueError(f"spacing = {_shown(spacing)} is not allowed: must be 'linear' or 'log'")
    if "values" in table:
        for name in ("start", "stop", "count"):
            if name in table:
                raise ValueError(f"{name} is not allowed beside values")
        listed = table["values"]
        if not isinstance(listed, list) or not listed:
            raise ValueError(f"values = {listed!r} is not allowed: must be a list of numbers")
        wanted: Sequence[Any] = listed
    else:
        for name in ("start", "stop", "count"):
            if name not in table:
                raise ValueError(f"{name} is missing: either values, or start, stop and count are needed")
        start, stop = _number(table, "start"), _number(table, "stop")
        count = table["count"]
        if isinstance(count, bool) or not isinstance(count, int) or not 2 <= count <= MOST_SAMPLES:
            raise ValueError(
                f"count = {_shown(count)} is not allowed: must be a whole number, between 2 and {MOST_SAMPLES}"
            )
        if spacing == "log" and not (start > 0 and stop > 0):  # type: ignore[operator]
            raise ValueError(f"start = {start!r} is not allowed: must, as stop, be above 0 for a log spacing")
        space = np.geomspace if spacing == "log" else np.linspace
        wanted = [float(value) for value in space(start, stop, count)]
        if field.type_ is int:
            wanted = [int(value) if value.is_integer() else value for value in wanted]
    name = "values" if "values" in table else "start"
    checked = []
    for value in wanted:
        for path in keys:
            _in_range(name, value, _field(case, path))
        checked.append(value if field.type_ is int else float(value))
    if len(set(checked)) != len(checked):
        raise ValueError(f"{name} is not allowed: a value is there twice")
    return Values(keys, tuple(checked), spacing)
