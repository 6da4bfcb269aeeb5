# SPDX-License-Identifier: GPL-3.0-or-later
"""Variables of a design: factors on numbers of a case, and shifts of positions."""
from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from statejump.core.case import Case
from statejump.core.errors import NotAllowed, UnknownKey
from statejump.design.file import DesignVariable
from statejump.schema.fields import rule_of
from statejump.schema.paths import attribute_of, meant, pattern_of, split_path
from statejump.schema.rules import NUMBER, NUMBERS

POSITION = "node.*.position_m"
MOST = 10_000


@dataclass(frozen=True)
class Target:
    """One number of the case: ``path`` is that of its key.

    :param axis: index in a position; -1: the key is a number
    """

    path: str
    value: float
    axis: int = -1


@dataclass(frozen=True)
class Group:
    """Numbers that one variable x of the search changes together.

    :param label: name for tables, as ``K[2]``
    :param low: smallest factor, or shift [m]
    """

    label: str
    name: str
    targets: tuple[Target, ...]
    low: float
    high: float
    log: bool
    shifts: bool

    @property
    def _size(self) -> float:
        return max(abs(self.low), abs(self.high)) if self.shifts else 1.0

    def factor(self, x: float) -> float:
        """Return the factor, or the shift [m]."""
        return float(np.exp(x)) if self.log else float(x) * self._size

    def slope(self, x: float) -> float:
        """Return the derivative of the factor by x."""
        return self.factor(x) if self.log else self._size

    def x(self, factor: float) -> float:
        """Return the variable of the search for a factor."""
        return float(np.log(factor)) if self.log else factor / self._size

    @property
    def start(self) -> float:
        """x of the case, within the bounds."""
        return self.x(min(max(0.0 if self.shifts else 1.0, self.low), self.high))

    def values(self, x: float) -> list[tuple[Target, float]]:
        """Return the new number of every target."""
        factor = self.factor(x)
        return [(one, one.value + factor if self.shifts else one.value * factor) for one in self.targets]


def groups_of(case: Case, wanted: Sequence[DesignVariable]) -> list[Group]:
    """Return the variables of the search. :raises StatejumpError: a key or bound is invalid"""
    found: list[Group] = []
    taken: dict[tuple[str, int], str] = {}
    names: set[str] = set()
    for variable in wanted:
        where = f"variable {variable.name!r}"
        try:
            if variable.name in names:
                raise NotAllowed("name", variable.name, code="duplicate")
            names.add(variable.name)
            targets = [target for key in variable.keys for target in _targets(case, key, variable.axis)]
            if not targets:
                raise NotAllowed("keys", variable.keys, code="design_no_keys")
            for target in targets:
                if (target.path, target.axis) in taken:
                    raise NotAllowed("keys", target.path, code="design_key_twice",
                                     other=taken[target.path, target.axis])
                taken[target.path, target.axis] = variable.name
            found += _groups(variable, targets)
        except (NotAllowed, UnknownKey) as refused:
            refused.item = refused.item or where
            raise
    if len(found) > MOST:
        raise NotAllowed("variable", code="design_too_many", count=len(found), most=MOST)
    return found


def _groups(variable: DesignVariable, targets: list[Target]) -> list[Group]:
    shifts = variable.axis is not None
    log = variable.scale == "log" and not shifts
    if not (np.isfinite(variable.low) and np.isfinite(variable.high)):
        raise NotAllowed("high", variable.high, code="not_finite")
    if not variable.low < variable.high:
        raise NotAllowed("high", variable.high, code="not_above_low", low=variable.low)
    if log and not variable.low > 0:
        raise NotAllowed("low", variable.low, code="design_log_not_positive")
    sets: list[tuple[Target, ...]] = [(one,) for one in targets] if variable.each else [tuple(targets)]
    return [Group(f"{variable.name}[{number}]" if len(sets) > 1 else variable.name, variable.name, one, variable.low,
                  variable.high, log, shifts) for number, one in enumerate(sets, start=1)]


def _targets(case: Case, path: str, axis: str | None) -> list[Target]:
    """Return the numbers that a key means."""
    rule = rule_of(attribute_of(type(case), path))
    section, item, key = split_path(path)
    position = pattern_of(path) == POSITION
    if rule.form != (NUMBERS if position else NUMBER):
        raise NotAllowed("keys", path, code="key_not_numeric")
    if position != (axis is not None):
        raise NotAllowed("axis", axis, code="design_axis_and_position")
    if not item:
        return [_target(path, getattr(case.value_named(section), key), axis)]
    items = {one.name: one for one in case.value_named(section)}
    chosen = meant(item, items)
    if not items:
        raise NotAllowed("keys", path, code="section_not_in_case", table=section)
    if not chosen:
        raise NotAllowed("keys", path, code="no_item_fits", table=section, pattern=item,
                         known=", ".join(list(items)[:5]))
    return [_target(f"{section}.{name}.{key}", getattr(items[name], key), axis) for name in chosen]


def _target(path: str, value: Any, axis: str | None) -> Target:
    if axis is not None:
        place = "xyz".index(axis)
        if place >= len(value):
            raise NotAllowed("axis", axis, code="design_axis_of_plane")
        return Target(path, float(value[place]), place)
    if value is None or value == 0:
        raise NotAllowed("keys", path, code="design_no_value")
    return Target(path, float(value))
