# SPDX-License-Identifier: GPL-3.0-or-later
"""Fields of a ``[[vary]]`` table, and their conversion to varied parameters of a case.

Which fields are allowed depends on other fields. An error names the field; the caller adds the name of the table.
"""
from __future__ import annotations

import difflib
import math
import re
from collections.abc import Mapping
from typing import Any

import numpy as np

from statejump.campaign.plan import MONTECARLO, MOST_SAMPLES, SWEEP
from statejump.campaign.sampling import DISTRIBUTIONS, Distribution, Independent, Values, Varied
from statejump.core.case import Case
from statejump.core.errors import MissingKey, NotAllowed, UnknownKey
from statejump.kinds import kind, names_of_kinds_with
from statejump.kinds.protocol import Outcomes
from statejump.schema.fields import (
    CHOICE, Section, choice, definition, fields_of, numbers, parameter, rule_of, text, texts, whole,
)
from statejump.schema.paths import attribute_of, keys_of, meant, pattern_of, split_path
from statejump.schema.rules import NUMBER, WHOLE, check_name, is_finite_number, suggestion

SPACINGS = ("linear", "log")
OWN = "section.key as in the case file, of a list section.item.key, * for all items or as part of a name"
LIKE = "must be section.key as in the case file"


def numbers_of(model: type[Case]) -> dict[str, Any]:
    """Return every key of a kind whose value is a single number; keys of list items as ``section.*.key``."""
    return {path: key for path, key in keys_of(model).items() if rule_of(key).form in (NUMBER, WHOLE)}


def _expression() -> str:
    """Return a regular expression that matches every key that can vary. Editors use it to complete keys."""
    paths = sorted({path for name in names_of_kinds_with(Outcomes) for path in numbers_of(kind(name).Case)})
    return "(?:" + "|".join(re.escape(path).replace(r"\*", ".+") for path in paths) + ")"


def _free(source: str, *, unit: str = "as key", above: float | None = None) -> Any:
    """Declare a number in the unit of the varied key, without an upper bound."""
    return parameter(None, unit, -math.inf if above is None else above, math.inf, source, above=above is not None)


@definition
class MonteCarloVary(Section):
    """A [[vary]] table of a Monte Carlo campaign."""

    key: str = text(..., OWN, pattern=_expression)
    also: list[str] = texts([], "keys that get the same value", pattern=_expression)
    distribution: str = choice(..., DISTRIBUTIONS, "of the parameter")
    mean: float | None = _free("the case's own")
    standard_deviation: float | None = _free("this or relative", above=0)
    relative: float | None = _free(
        "standard deviation, of a uniform distribution the half width, over the mean", unit="-", above=0
    )
    low: float | None = _free("no lower limit")
    high: float | None = _free("no upper limit")


@definition
class SweepVary(Section):
    """A [[vary]] table of a sweep."""

    key: str = text(..., OWN, pattern=_expression)
    also: list[str] = texts([], "keys that get the same value", pattern=_expression)
    values: list[float] | None = numbers(None, "as key", -math.inf, math.inf, "these, or start, stop and count")
    start: float | None = _free("first value")
    stop: float | None = _free("last value")
    count: int | None = whole(None, 2, MOST_SAMPLES, "number of values")
    spacing: str = choice("linear", SPACINGS, CHOICE)


TABLES: dict[str, type[Section]] = {MONTECARLO: MonteCarloVary, SWEEP: SweepVary}


def varied(table: Mapping[str, Any], case: Case, command: str) -> Varied:
    """Return the varied parameter that a ``[[vary]]`` table defines.

    :param command: ``montecarlo`` or ``sweep``
    :raises StatejumpError: the table is invalid; the error names the key
    """
    known = list(fields_of(TABLES[command]))
    other = SWEEP if command == MONTECARLO else MONTECARLO
    for name in table:
        if name in known:
            continue
        if name in fields_of(TABLES[other]):
            raise NotAllowed(name, code="key_of_other_campaign", command=command, other=other)
        raise UnknownKey(name, **suggestion(name, known))
    if "key" not in table:
        raise MissingKey("key", LIKE, code="key_missing")
    main = _checked_path(table["key"], "key", case)
    also = table.get("also", [])
    if not isinstance(also, (list, tuple)):
        raise NotAllowed("also", also, code="also_not_list")
    keys = (main, *(_checked_path(path, "also", case) for path in also))
    if command == SWEEP:
        return _values(table, keys, case)
    section, item, _ = split_path(main)
    if not item or item in _items(case, main):
        return _distribution(table, keys, case)
    for path in keys[1:]:
        if split_path(path)[:2] != (section, item):
            raise NotAllowed("also", path, code="items_share_values", main=main)
    return Independent(keys, tuple(
        _distribution(table, tuple(f"{section}.{name}.{split_path(path)[2]}" for path in keys), case)
        for name in meant(item, _items(case, main))
    ))


def check_apart(found: list[Varied], case: Case) -> None:
    """Raise NotAllowed if the last varied parameter changes a number that it or another parameter already changes."""
    taken = [key for parameter in found[:-1] for key in parameter.keys]
    for key in found[-1].keys:
        if any(_overlap(key, other, case) for other in taken) or found[-1].keys.count(key) > 1:
            raise NotAllowed("key", key, code="duplicate_vary")


def _overlap(one: str, other: str, case: Case) -> bool:
    """Return whether two paths of keys refer to a common number of the case."""
    if pattern_of(one) != pattern_of(other):
        return False
    if one == other:
        return True
    names = _items(case, one)
    return not set(meant(split_path(one)[1], names)).isdisjoint(meant(split_path(other)[1], names))


def _items(case: Case, path: str) -> list[str]:
    """Return the names of the items in the list with which a path begins."""
    return [item.name for item in case.value_named(split_path(path)[0])]


def _own_value(case: Case, path: str) -> float | None:
    """Return the value of a key in the case; for a pattern, the common value of the matching items, None if they
    differ."""
    section, item, key = split_path(path)
    if not item:
        found: float | None = getattr(case.value_named(section), key)
        return found
    wanted = set(meant(item, _items(case, path)))
    values = {getattr(one, key) for one in case.value_named(section) if one.name in wanted}
    return values.pop() if len(values) == 1 else None


def _checked_path(path: Any, name: str, case: Case) -> str:
    if not isinstance(path, str):
        raise NotAllowed(name, path, code="path_not_string")
    known = numbers_of(type(case))
    section, item, _ = split_path(path)
    if pattern_of(path) in known:
        names = _items(case, path) if item else []
        if item and not names:
            raise NotAllowed(name, path, code="section_not_in_case", table=section)
        if not item or meant(item, names):
            return path
        raise UnknownKey(name, code="item_not_in_case", value=path, remedy=_meant(item, names), table=section,
                         name=item)
    if pattern_of(path) in keys_of(type(case)):
        raise NotAllowed(name, path, code="key_not_numeric")
    remedy = _meant(path, list(known))
    raise UnknownKey(name, code="key_not_in_kind", value=path, cause=None if remedy else LIKE, remedy=remedy,
                     kind=case.kind)


def _meant(word: str, known: list[str]) -> str | None:
    near = difflib.get_close_matches(word, known, n=1, cutoff=0.5)
    return f"did you mean {near[0]!r}?" if near else None


def _number(table: Mapping[str, Any], name: str, *, above: float | None = None) -> float | None:
    """Return a field of a ``[[vary]]`` table as a finite number; None if the field is missing."""
    if name not in table:
        return None
    value = table[name]
    if above is not None and not (is_finite_number(value) and value > above):
        raise NotAllowed(name, value, code="not_finite_above", least=above)
    if not is_finite_number(value):
        raise NotAllowed(name, value, code="not_finite")
    return float(value)


def _distribution(table: Mapping[str, Any], keys: tuple[str, ...], case: Case) -> Distribution:
    rules = {path: rule_of(attribute_of(type(case), path)) for path in keys}
    for path, rule in rules.items():
        if rule.form == WHOLE:
            raise NotAllowed("key", path, code="integer_not_random")
    kind_name = table.get("distribution")
    if kind_name is None:
        raise MissingKey("distribution", code="missing_distribution",
                         known=" or ".join((repr(name) for name in DISTRIBUTIONS)))
    check_name("distribution", kind_name, DISTRIBUTIONS)
    low, high = _number(table, "low"), _number(table, "high")
    deviation, relative = (_number(table, name, above=0) for name in ("standard_deviation", "relative"))
    limits = {"low": low, "high": high}
    bounded = kind_name in ("uniform", "truncated_normal")
    for name, value in limits.items():
        if value is not None and not bounded:
            raise NotAllowed(name, code="distribution_without_limits", distribution=kind_name)
    if low is not None and high is not None and not low < high:
        raise NotAllowed("high", high, code="not_above_low", low=low)
    if kind_name == "uniform" and relative is None:
        for name in ("mean", "standard_deviation"):
            if name in table:
                raise NotAllowed(name, code="uniform_limits")
        for name, value in limits.items():
            if value is None:
                raise MissingKey(name, code="uniform_limits")
        assert low is not None and high is not None
        return Distribution(keys, kind_name, low=low, high=high)
    mean = table.get("mean", _own_value(case, keys[0]))
    if mean is None:
        raise MissingKey("mean", code="mean_not_in_case", mean_of=keys[0])
    rules[keys[0]].check("mean", mean)
    mean = float(mean)
    if relative is not None:
        if mean == 0:
            raise NotAllowed("relative", relative, code="zero_mean")
        if deviation is not None:
            raise NotAllowed("relative", code="conflicting_key", other="standard_deviation")
        deviation = relative * abs(mean)
        if not 0 < deviation < math.inf:
            raise NotAllowed("relative", relative, code="deviation_not_positive", deviation=deviation)
    if deviation is None:
        raise MissingKey("standard_deviation", code="deviation_missing")
    if kind_name == "uniform":
        if low is not None or high is not None:
            raise NotAllowed("relative", code="conflicting_key", other="low and high")
        return Distribution(keys, kind_name, low=mean - deviation, high=mean + deviation)
    if kind_name == "lognormal" and not mean > 0:
        raise NotAllowed("mean", mean, code="lognormal_mean")
    if kind_name != "truncated_normal":
        return Distribution(keys, kind_name, mean, deviation)
    if low is None and high is None:
        raise MissingKey("low", code="limits_missing")
    found = Distribution(keys, kind_name, mean, deviation, -math.inf if low is None else low,
                         math.inf if high is None else high)
    below, up_to, _ = found.probabilities()
    if not up_to - below > 1e-12:
        raise NotAllowed("mean", mean, code="empty_truncated_distribution")
    return found


def _spaced(table: Mapping[str, Any], spacing: str, is_whole: bool) -> list[Any]:
    """Return the values of a table with start, stop and count."""
    for name in ("start", "stop", "count"):
        if name not in table:
            raise MissingKey(name, code="range_missing")
    start, stop, count = _number(table, "start"), _number(table, "stop"), table["count"]
    assert start is not None and stop is not None
    if isinstance(count, bool) or not isinstance(count, int) or not 2 <= count <= MOST_SAMPLES:
        raise NotAllowed("count", count, code="grid_count_out_of_range", most_samples=MOST_SAMPLES)
    if spacing == "log" and not (start > 0 and stop > 0):
        raise NotAllowed("start", start, code="log_spacing_not_positive")
    spaced = np.geomspace(start, stop, count) if spacing == "log" else np.linspace(start, stop, count)
    wanted = [float(value) for value in spaced]
    return [int(value) if value.is_integer() else value for value in wanted] if is_whole else wanted


def _values(table: Mapping[str, Any], keys: tuple[str, ...], case: Case) -> Values:
    rules = [rule_of(attribute_of(type(case), path)) for path in keys]
    is_whole = rules[0].form == WHOLE
    spacing = table.get("spacing", "linear")
    if not isinstance(spacing, str) or spacing not in SPACINGS:
        raise NotAllowed("spacing", spacing, code="unknown_name", known=" or ".join((repr(name) for name in SPACINGS)))
    if "values" in table:
        for name in ("start", "stop", "count"):
            if name in table:
                raise NotAllowed(name, code="conflicting_key", other="values")
        name, wanted = "values", table["values"]
        if not isinstance(wanted, (list, tuple)) or not wanted:
            raise NotAllowed(name, wanted, code="not_list_of_numbers")
    else:
        name, wanted = "start", _spaced(table, spacing, is_whole)
    checked = []
    for value in wanted:
        for rule in rules:
            if value is None:
                raise NotAllowed(name, value, rule.needs(), code="out_of_range", allowed=rule.allowed)
            rule.check(name, value)
        checked.append(value if is_whole else float(value))
    if len(set(checked)) != len(checked):
        raise NotAllowed(name, code="duplicate_value")
    return Values(keys, tuple(checked), spacing)
